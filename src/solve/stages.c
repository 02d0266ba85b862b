/* SPDX-License-Identifier: MIT */
#include "solve/stages_part.h"

/* Which half sweep of a cycle a stage is or contains. */
static int sweep_of(const cf_pass_stage stage) {
  switch (stage) {
    case CF_PASS_SECOND:
      return 1;
    case CF_PASS_RED:
      return 2;
    case CF_PASS_BLACK:
    case CF_PASS_LAST:
      return 3;
    default:
      return 0;
  }
}

/* One of its own, or the level's. */
static float omega_of(const cf_pass *p, const int number) {
  return p->omega[number] > 0 ? p->omega[number] : p->at->omega[sweep_of(p->stage[number])];
}

void cf_stage_run(const cf_pass *p, const int number, const cf_strip *t) {
  const cf_split *s = p->at;
  const float omega = omega_of(p, number);
  if (s->segments != NULL) {
    cf_stage_on_segments(p, number, t, omega);
    return;
  }
  if (s->fields != NULL) {
    cf_stage_on_fields(p, number, t, omega);
    return;
  }
  switch (p->stage[number]) {
    case CF_PASS_FORM:
      cf_stage_form(p, t);
      cf_stage_first(s, t, omega);
      break;
    case CF_PASS_FIRST:
      cf_stage_first(s, t, omega);
      break;
    case CF_PASS_SECOND:
      cf_stage_second(s, t, omega);
      break;
    case CF_PASS_RED:
      cf_stage_relax(s, t, 0, omega);
      break;
    case CF_PASS_BLACK:
      cf_stage_relax(s, t, 1, omega);
      break;
    case CF_PASS_RED_EDGES: /* only segments have any */
    case CF_PASS_BLACK_EDGES:
    case CF_PASS_ADD: /* only levels of fields do so */
      break;
    case CF_PASS_LAST:
      cf_stage_last(s, t, omega);
      break;
    case CF_PASS_UPDATE:
      cf_stage_update(p, t, omega);
      break;
    case CF_PASS_RESTRICT:
      cf_stage_restrict(p, t, false);
      break;
    case CF_PASS_RESTRICT_RED:
      cf_stage_restrict(p, t, true);
      break;
    case CF_PASS_PROLONG:
      cf_stage_prolong(p, t, omega_of(p, number + 1) == 1);
      break;
    case CF_PASS_CLEAR:
      cf_stage_clear(s, t);
      break;
    case CF_PASS_RESIDUAL:
      cf_stage_residual(s, t);
      break;
  }
}

size_t cf_stage_scratch(const cf_split *s) {
  return (size_t)(2 * s->width + 4 * CF_SPLIT_LANES) * (3 * sizeof(double) + sizeof(float));
}

bool cf_stage_reads_around(const cf_pass_stage stage) {
  return stage == CF_PASS_SECOND || stage == CF_PASS_RED || stage == CF_PASS_BLACK || stage == CF_PASS_LAST ||
         stage == CF_PASS_RED_EDGES || stage == CF_PASS_BLACK_EDGES || stage == CF_PASS_RESTRICT ||
         stage == CF_PASS_RESTRICT_RED || stage == CF_PASS_RESIDUAL || stage == CF_PASS_UPDATE;
}
