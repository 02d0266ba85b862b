/* SPDX-License-Identifier: MIT
 *
 * The models that a scene can name, in the order of CF_MODEL_WORDS; and what all of them do with reports.
 */
#define _GNU_SOURCE
#include <string.h>
#include <time.h>

#include "base/real.h"
#include "model/model.h"

static const cf_model *const models[] = {
#define CF_MODEL_ENTRY(upper, lower) &cf_model_##lower,
    CF_MODEL_WORDS(CF_MODEL_ENTRY)
#undef CF_MODEL_ENTRY
};

const cf_model *cf_model_of(const int word) {
  return word >= 0 && word < (int)(sizeof models / sizeof *models) ? models[word] : NULL;
}

static bool lists(const cf_model *model, const char *key) {
  for (const char *const *own = model->keys; *own != NULL; ++own)
    if (strcmp(*own, key) == 0) return true;
  return false;
}

bool cf_model_reads(const cf_model *model, const char *key) {
  if (lists(model, key)) return true;
  for (int i = 0; cf_model_of(i) != NULL; ++i)
    if (lists(cf_model_of(i), key)) return false;
  return true;
}

/* --- reports ---------------------------------------------------------------------------------------------- */

void cf_step_report_add(cf_step_report *report, const cf_stage stage, const cf_solve_report *solve) {
  report->solve.iterations += solve->iterations;
  report->iterations[stage] += solve->iterations;
  report->solve.levels = solve->levels;
  report->solve.residual = CF_MAX(report->solve.residual, solve->residual);
  report->solve.converged = report->solve.converged && solve->converged;
}

double cf_stage_clock(void) {
  struct timespec t;
  clock_gettime(CLOCK_MONOTONIC, &t);
  return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

double cf_stage_end(cf_step_report *report, const cf_stage stage, const double from) {
  const double now = cf_stage_clock();
  report->seconds[stage] += now - from;
  return now;
}
