/* SPDX-License-Identifier: MIT
 *
 * Stationary cycles on a finest level apart by colour (fields.h), as passes of stages.h: what varied_cycles.c does, with half
 * sweeps that cost half.
 *
 * Couplings are rounded to single precision, each for itself, which changes the flux of a smooth e by some 6e-8 of it at random,
 * and that is the more of the residual the more cells there are. So r is formed anew, in double and from the caller's fields,
 * after every cycle in which this would be seen: after the first, as a rule, which finds all that is smooth.
 */
#include <math.h>

#include "grid/sweep.h"
#include "solve/varied_part.h"

/* Half sweeps. */
#define AFTER 4
#define OMEGA 1.2
/* What rounded couplings do to the residual, of what it was, for each cell across the box; and how much of what is asked for that
 * may be. */
#define ROUNDED 1e-8
#define SEEN    0.1

static void push(cf_pass *p, const cf_pass_stage stage, const double omega) {
  p->omega[p->count] = (float)omega;
  p->stage[p->count++] = stage;
}

static cf_pass pass_of(const cf_cycling *w) {
  const cf_fields *f = &w->v->fields;
  return (cf_pass){.at = &f->split,
                   .below = &w->v->level[1],
                   .x = w->x.at,
                   .b = w->b.at,
                   .scale = 1 / w->unit,
                   .gain = w->v->scale / w->unit,
                   .sums = f->sums,
                   .rows = f->rows};
}

static double sum_of(const cf_fields *f, const cf_pass_sum kind) {
  return cf_sum_ordered(f->rows + kind * f->sums, f->sums);
}

/* What comes before the coarse correction, but for the first half sweep. */
static void push_down(cf_pass *p) {
  push(p, CF_PASS_SECOND, OMEGA);
  push(p, CF_PASS_RESTRICT, 1);
}

void cf_fields_begin(cf_cycling *w) {
  const cf_fields *f = &w->v->fields;
  cf_pass p = pass_of(w);
  cf_varied_set_ghosts(w->v, w->x);
  push(&p, CF_PASS_FORM, OMEGA);
  push_down(&p);
  cf_wave_run(&f->wave, &p);
  w->rr = sum_of(f, CF_SUM_RESIDUAL);
  w->xx = sum_of(f, CF_SUM_X2);
}

cf_varied_sums cf_fields_form(const cf_varied *v, const cf_cell x, const cf_cell b) {
  const cf_cycling w = {.v = v, .x = x, .b = b, .unit = 1};
  cf_pass p = pass_of(&w);
  cf_varied_set_ghosts(v, x);
  push(&p, CF_PASS_FORM, 1);
  cf_wave_run(&v->fields.wave, &p);
  return (cf_varied_sums){sum_of(&v->fields, CF_SUM_RESIDUAL), sum_of(&v->fields, CF_SUM_B2),
                          sum_of(&v->fields, CF_SUM_X2)};
}

void cf_fields_go_down(cf_cycling *w) {
  cf_pass p = pass_of(w);
  push_down(&p);
  cf_wave_run(&w->v->fields.wave, &p);
}

void cf_fields_go_up(cf_cycling *w, const bool last) {
  const cf_fields *f = &w->v->fields;
  const int *n = f->split.n;
  const double rounded = ROUNDED * CF_MAX(n[0], CF_MAX(n[1], n[2]));
  const bool anew = rounded * rounded * w->rr > SEEN * SEEN * w->target;
  cf_pass p = pass_of(w);
  cf_varied_correct(w->v, 1);
  cf_coupled_wrap(&w->v->level[1], w->v->level[1].e);
  push(&p, CF_PASS_PROLONG, 1);
  for (int v = 0; v < AFTER - 1; ++v) push(&p, v % 2 == 0 ? CF_PASS_RED : CF_PASS_BLACK, OMEGA);
  push(&p, anew ? CF_PASS_BLACK : CF_PASS_LAST, OMEGA);
  push(&p, anew ? CF_PASS_ADD : CF_PASS_UPDATE, OMEGA);
  if (!anew && !last) push_down(&p);
  p.sums_of_x = last;
  cf_wave_run(&f->wave, &p);
  if (anew) {
    cf_fields_begin(w);
    return;
  }
  w->rr = sum_of(f, CF_SUM_RESIDUAL) / (w->unit * w->unit);
  if (last) w->xx = sum_of(f, CF_SUM_X2);
}
