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

/* Half sweeps after the coarse correction. */
#define AFTER 4
#define OMEGA 1.2
/* What rounded couplings do to the residual, of what it was, for each cell across the box; and how much of what is asked for that
 * may be. */
#define ROUNDED 1e-8
#define SEEN    0.1
/* Where half sweeps are alone: what is to be gained in one pass at most; and their number. */
#define PASS_GAIN 1e-4
#define LEAST     8
#define MOST      36
/* r is to be within such a factor of 1. */
#define FAR_OFF 1e4

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

static bool is_alone(const cf_cycling *w) { return w->v->fields.alone; }

/* What comes before the coarse correction, but for the first half sweep. */
static void push_down(const cf_cycling *w, cf_pass *p) {
  if (is_alone(w)) return;
  cf_pass_push(p, CF_PASS_SECOND, OMEGA);
  cf_pass_push(p, CF_PASS_RESTRICT, 1);
}

static double first_omega(const cf_cycling *w) { return is_alone(w) ? 1 : OMEGA; }

static void push_form(const cf_cycling *w, cf_pass *p) {
  cf_pass_push(p, CF_PASS_FORM, first_omega(w));
  push_down(w, p);
}

static void take_formed(cf_cycling *w) {
  const cf_fields *f = &w->v->fields;
  w->rr = sum_of(f, CF_SUM_RESIDUAL);
  w->xx = sum_of(f, CF_SUM_X2);
  w->bb = sum_of(f, CF_SUM_B2);
  w->x_sum = sum_of(f, CF_SUM_X);
  w->b_sum = sum_of(f, CF_SUM_B);
}

static void form(cf_cycling *w) {
  cf_pass p = pass_of(w);
  cf_varied_set_ghosts(w->v, w->x);
  push_form(w, &p);
  cf_wave_run(&w->v->fields.wave, &p);
  take_formed(w);
}

/* The largest value of some rows of b. */
static double sample(const cf_box *b, const cf_cell f) {
  const ptrdiff_t rows = cf_box_rows(b), step = CF_MAX(rows / 61, 1);
  double largest = 0;
  for (ptrdiff_t r = 0; r < rows; r += step)
    for (int i = 0; i < b->n[0]; ++i) largest = CF_MAX(largest, fabs((double)f.at[cf_box_row(b, r) + i]));
  return largest;
}

/* A power of two that makes numbers of a size about 1. */
static double unit_for(const double size) {
  int exponent = 0;
  if (size > 0 && isfinite(size)) (void)frexp(size, &exponent);
  return ldexp(1, CF_MAX(-1000, CF_MIN(1000, -exponent)));
}

void cf_fields_begin(cf_cycling *w) {
  const cf_box *b = &w->v->level[0].box;
  w->unit = unit_for(sample(b, w->b));
  form(w);
  const double size = sqrt(CF_MAX(w->bb, isfinite(w->rr) ? w->rr : 0) / (double)cf_box_cells(b));
  if (size * w->unit < FAR_OFF && size * w->unit * FAR_OFF > 1) return;
  w->unit = unit_for(size);
  form(w);
}

void cf_fields_go_down(cf_cycling *w) {
  cf_pass p = pass_of(w);
  push_down(w, &p);
  if (p.count > 0) cf_wave_run(&w->v->fields.wave, &p);
}

cf_varied_sums cf_fields_form(const cf_varied *v, const cf_cell x, const cf_cell b) {
  const cf_cycling w = {.v = v, .x = x, .b = b, .unit = 1};
  cf_pass p = pass_of(&w);
  cf_varied_set_ghosts(v, x);
  cf_pass_push(&p, CF_PASS_FORM, 1);
  cf_wave_run(&v->fields.wave, &p);
  return (cf_varied_sums){sum_of(&v->fields, CF_SUM_RESIDUAL), sum_of(&v->fields, CF_SUM_B2),
                          sum_of(&v->fields, CF_SUM_X2)};
}

/* Half sweeps that damp all errors alike (Golub and Varga 1961), as many as are to bring r where it is to be, or half the way
 * there: single precision does not go further at once. The first one is done. */
static void push_half_sweeps(const cf_cycling *w, cf_pass *p, double *last) {
  const double J = w->v->fields.radius, J2 = J * J;
  const double per_sweep = J / (1 + sqrt(1 - J2));
  double gain = sqrt(w->target / w->rr), omega = 1;
  if (gain < PASS_GAIN) gain = sqrt(gain);
  const int wanted = (int)ceil(log(gain / 2) / log(CF_MAX(per_sweep, 1e-12)));
  const int count = CF_MIN(CF_MAX((wanted + 1) / 2 * 2, LEAST), MOST);
  for (int v = 1; v < count; ++v) {
    omega = cf_omega_after(v, J2, omega);
    if (v + 1 < count)
      cf_pass_push(p, v == 1 ? CF_PASS_SECOND : v % 2 == 0 ? CF_PASS_RED : CF_PASS_BLACK, omega);
  }
  *last = omega;
}

/* The coarse correction, and half sweeps after it. */
static void push_up(const cf_cycling *w, cf_pass *p, double *last) {
  const cf_coupled *coarse = &w->v->level[1];
  cf_varied_correct(w->v, 1);
  cf_coupled_wrap(coarse, coarse->e);
  cf_pass_push(p, CF_PASS_PROLONG, 1);
  for (int v = 0; v < AFTER - 1; ++v) cf_pass_push(p, v % 2 == 0 ? CF_PASS_RED : CF_PASS_BLACK, OMEGA);
  *last = OMEGA;
}

/* Whether the rounding of couplings would be seen in r. */
static bool is_seen(const cf_cycling *w) {
  const int *n = w->v->fields.split.n;
  const double rounded = ROUNDED * CF_MAX(n[0], CF_MAX(n[1], n[2]));
  return rounded * rounded * w->rr > SEEN * SEEN * w->target;
}

void cf_fields_go_up(cf_cycling *w, const bool last) {
  const cf_fields *f = &w->v->fields;
  const bool anew = is_seen(w), at_once = anew && !f->split.has_seam;
  double omega;
  cf_pass p = pass_of(w);
  (is_alone(w) ? push_half_sweeps : push_up)(w, &p, &omega);
  cf_pass_push(&p, anew ? CF_PASS_BLACK : CF_PASS_LAST, omega);
  cf_pass_push(&p, anew ? CF_PASS_ADD : CF_PASS_UPDATE, first_omega(w));
  if (at_once) push_form(w, &p);
  if (!anew && !last) push_down(w, &p);
  p.sums_of_x = !anew && (last || is_alone(w) || w->v->pockets.count > 0);
  p.keep = w->kept || is_alone(w) ? NULL : w->v->best.at; /* half sweeps alone do no harm */
  cf_wave_run(&f->wave, &p);
  w->kept = !is_alone(w);
  if (at_once) take_formed(w);
  if (anew && !at_once) form(w);
  if (!anew) w->rr = sum_of(f, CF_SUM_RESIDUAL) / (w->unit * w->unit);
  if (!p.sums_of_x) return;
  w->xx = sum_of(f, CF_SUM_X2);
  w->x_sum = sum_of(f, CF_SUM_X);
}
