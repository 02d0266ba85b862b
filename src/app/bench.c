/* SPDX-License-Identifier: MIT
 *
 * cattaneo bench [NAME]
 */
#include "app/bench.h"

#include <ctype.h>
#include <math.h>
#include <omp.h>
#include <stdlib.h>
#include <string.h>

#include "app/command.h"
#include "base/param.h"

enum { CELLS_MOST = 1 << 20 };

void cf_bench_json_number(const char *name, const double value) {
  if (isfinite(value))
    printf(", \"%s\": %.6g", name, value);
  else
    printf(", \"%s\": null", name);
}

/* --- filters ---------------------------------------------------------------------------------------------- */

/* "256", "1024x512" or "64x128x64"; *end is what follows. */
static cf_status read_box(const char *text, const char **end, int *dim, int n[3]) {
  const char *p = text;
  char *stop;
  *dim = 0;
  do {
    const long v = strtol(p, &stop, 10);
    if (stop == p || !isdigit((unsigned char)*p) || v < 1 || v > CELLS_MOST || *dim == 3)
      return cf_fail(CF_BAD_USAGE, "--n %.64s: must be extents like 256, 1024x1024 or 64x128x64", text);
    n[(*dim)++] = (int)v;
    p = stop + 1;
  } while (*stop == 'x');
  if (*dim == 1) {
    n[1] = n[2] = n[0];
    *dim = 3;
  }
  if (*dim == 2) n[2] = 1;
  *end = stop;
  return CF_OK;
}

static cf_status read_sigma(const char *text, const char **end, double *sigma) {
  static const char poisson[] = "poisson";
  char *stop;
  if (strncmp(text, poisson, strlen(poisson)) == 0) {
    *sigma = INFINITY;
    *end = text + strlen(poisson);
    return CF_OK;
  }
  *sigma = strtod(text, &stop);
  if (stop == text || !(*sigma >= 0))
    return cf_fail(CF_BAD_USAGE, "--sigma %.64s: must be numbers not below 0, or inf for Poisson's equation",
                   text);
  *end = stop;
  return CF_OK;
}

/* Whether another entry of the list follows. */
static cf_status next_entry(const char *option, const char *whole, const int entries, const char **p,
                            bool *more) {
  *more = **p == ',';
  if (**p != ',' && **p != '\0')
    return cf_fail(CF_BAD_USAGE, "--%s %.64s: what is %.16s?", option, whole, *p);
  if (*more && entries == CF_BENCH_LIST_MAX)
    return cf_fail(CF_BAD_USAGE, "--%s: more than %d entries", option, CF_BENCH_LIST_MAX);
  if (*more) ++*p;
  return CF_OK;
}

static cf_status read_filter(const cf_arguments *a, cf_bench_filter *f) {
  *f = (cf_bench_filter){.threads = a->threads > 0 ? a->threads : omp_get_num_procs(), .json = a->json};
  bool more = a->cells != NULL;
  for (const char *p = a->cells; more; ++f->boxes) {
    CF_TRY(read_box(p, &p, &f->dim[f->boxes], f->n[f->boxes]));
    CF_TRY(next_entry("n", a->cells, f->boxes + 1, &p, &more));
  }
  more = a->sigmas != NULL;
  for (const char *p = a->sigmas; more; ++f->sigmas) {
    CF_TRY(read_sigma(p, &p, &f->sigma[f->sigmas]));
    CF_TRY(next_entry("sigma", a->sigmas, f->sigmas + 1, &p, &more));
  }
  return CF_OK;
}

/* --- the command ------------------------------------------------------------------------------------------ */

cf_status cf_bench_command(cf_arguments *a) {
  static const char words[] = "solver|table2";
  static cf_status (*const table[])(const cf_bench_filter *) = {cf_bench_solver, cf_bench_table2};
  cf_bench_filter f;
  CF_TRY(read_filter(a, &f));
  int chosen = -1;
  if (a->operands > 0) {
    const char *name = a->operand[0];
    char near[64];
    chosen = cf_param_word_index(words, name, strlen(name));
    if (chosen < 0 && cf_param_word_nearest(words, name, near, sizeof near))
      return cf_fail(CF_BAD_USAGE, "there is no bench %.64s: did you mean %s?", name, near);
    if (chosen < 0) return cf_fail(CF_BAD_USAGE, "there is no bench %.64s: there are %s", name, words);
  }
  for (int v = 0; v < 2; ++v)
    if (chosen < 0 || chosen == v) CF_TRY(table[v](&f));
  return CF_OK;
}
