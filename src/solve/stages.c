/* SPDX-License-Identifier: MIT */
#include "solve/stages_part.h"

/* The omega of each half sweep of a cycle: one of its own, or the level's. */
static float omega_of(const cf_pass *p, const int number, const int sweep) {
  return p->omega[number] > 0 ? p->omega[number] : p->at->omega[sweep];
}

void cf_stage_run(const cf_pass *p, const int number, const cf_strip *t) {
  const cf_split *s = p->at;
  switch (p->stage[number]) {
    case CF_PASS_FORM:
      cf_stage_form(p, t);
      cf_stage_first(s, t, omega_of(p, number, 0));
      break;
    case CF_PASS_FIRST:
      cf_stage_first(s, t, omega_of(p, number, 0));
      break;
    case CF_PASS_SECOND:
      cf_stage_second(s, t, omega_of(p, number, 1));
      break;
    case CF_PASS_RED:
      cf_stage_relax(s, t, 0, omega_of(p, number, 2));
      break;
    case CF_PASS_BLACK:
      cf_stage_relax(s, t, 1, omega_of(p, number, 3));
      break;
    case CF_PASS_LAST:
      cf_stage_last(s, t, omega_of(p, number, 3));
      break;
    case CF_PASS_UPDATE:
      cf_stage_update(p, t, omega_of(p, number, 0));
      break;
    case CF_PASS_RESTRICT:
      cf_stage_restrict(p, t);
      break;
    case CF_PASS_PROLONG:
      cf_stage_prolong(p, t);
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
         stage == CF_PASS_RESTRICT || stage == CF_PASS_RESIDUAL || stage == CF_PASS_UPDATE;
}
