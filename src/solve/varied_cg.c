/* SPDX-License-Identifier: MIT
 *
 * Conjugate gradients around the cycle, in passes over the region's rows:
 *
 *     z = cycle(r)
 *     beta = -a (z . A p) / (z_old . r_old),   p = z + beta p     (Polak-Ribiere: flexible, as in pcg.c)
 *     a = (p . r) / (p . A p),   x += a p,   r -= a A p
 *
 * The residual is formed anew at the end; where rounding has made it differ from the recursion, the iteration starts
 * again from there as long as that brings something. It is over when the tolerance is met, or when what is left is
 * the rounding of x itself,
 *
 *     |b - A x| <= eps |D x|,     D the diagonal, eps the precision of the state,
 *
 * below which a residual says nothing about x. Pockets that little alpha fixes are the slowest part of all: their means follow from
 * those of b, and corrections are kept free of them (deflation; Nicolaides 1987). A start that makes things worse is taken back.
 */
#include <math.h>

#include "solve/varied.h"
#include "solve/varied_part.h"

/* Beyond this many starts, or a start that gains less than half, rounding is all that is left. */
#define STARTS_MOST 5
/* Near walls, before and after the coarse correction. */
#define BAND_SWEEPS 3
/* So many iterations are far more than any equation should need, and if two or four leave so much of the residual (in squares)
 * there will be as many: then the cycle becomes one with which conjugate gradients cannot stall. */
#define PATIENCE  25
#define SLOW_AT_2 0.5
#define SLOW_AT_4 0.01
/* One start gains so much at most: then how large x has become, and its rounding, is looked at anew. */
#define START_GAIN (1024 * CF_REAL_EPSILON)
/* Below this share of alpha in the diagonal a mean of b is round-off, and tells nothing. */
#define MEAN_LOST 1e-8
/* So far (in squares) above what rounding of x may do, a residual is told without being formed anew. */
#define ROUNDING_SEEN 1e4
/* A mean of b may be so much of what the tolerance allows where nothing fixes the level of x. */
#define MEAN_SHARE 1e-3
/* What is left may be so many times the floor (in squares) where rounding is the reason. */
#define NEAR_ROUNDING 16

/* --- the iteration ------------------------------------------------------------------------------------ */

/* A power of two that makes the residual's values about 1. */
static double scale_for(const cf_varied *v, const double rr) {
  const double size = sqrt(rr / (double)cf_box_cells(&v->A->grid.box));
  int exponent;
  (void)frexp(size, &exponent);
  return ldexp(1, CF_MAX(-1000, CF_MIN(1000, -exponent)));
}

/* Where all cells hang together their mean is no trouble. */
static bool has_loose(const cf_varied *v) { return v->loose.count > 0 && !v->loose.single; }

/* Conjugate gradients from the residual formed. */
static void iterate(const cf_varied *v, double rr, const double enough, const int limit, const cf_cell x,
                    int *iterations) {
  const double scale = scale_for(v, rr);
  const int most = v->careful ? limit : CF_MIN(limit, *iterations + PATIENCE);
  const double first = rr;
  double zr_old = 0, a = 0;
  cf_varied_convert(v, scale);
  for (int it = 0; rr > enough && *iterations < most; ++it) {
    cf_varied_cycle(v, 0);
    if (has_loose(v)) cf_pockets_level_out(&v->loose, &v->level[0], v->level[0].e);
    const cf_varied_sums z = cf_varied_test_correction(v);
    cf_varied_turn(v, it == 0 ? 0 : -a * z.first / zr_old);
    const cf_varied_sums p = cf_varied_probe(v);
    if (!(p.first > 0) || !isfinite(p.second)) break; /* round-off is all that is left */
    a = p.second / p.first;
    rr = cf_varied_advance(v, a, scale, x);
    zr_old = z.second;
    ++*iterations;
    if (!v->careful && ((it == 1 && rr > SLOW_AT_2 * first) || (it == 3 && rr > SLOW_AT_4 * first))) break;
  }
}

/* The square of the residual that rounding of x leaves. */
static double floor_of(const cf_varied *v, const cf_varied_sums *s) {
  const double size = CF_REAL_EPSILON / v->scale;
  return size * size * s->third;
}

cf_status cf_varied_judge(const cf_varied *v, const cf_varied_sums *s, const cf_solve_options *o,
                          cf_solve_report *report) {
  if (!isfinite(s->first) || !isfinite(s->second))
    return cf_fail(CF_NOT_FINITE,
                   "the equation to solve holds a value that is not finite (|b| = %g, |b - A x| = %g)",
                   sqrt(s->second), sqrt(s->first));
  const double bb = s->second, enough = o->tolerance * o->tolerance * bb;
  const double rounding = CF_MIN(NEAR_ROUNDING * floor_of(v, s), CF_ROUNDING_PASSES * bb);
  report->residual = bb > 0 ? sqrt(s->first / bb) : 0;
  report->converged = bb == 0 || s->first <= CF_MAX(enough, rounding);
  return CF_OK;
}

/* Pockets that only alpha fixes, where it is a number: b tells their means, and conjugate gradients need not find them. */
static cf_status find_loose(cf_varied *v) {
  const cf_coupled *l = &v->level[0];
  const bool numbers = v->stamp != 0 && v->scale * v->alpha_number > MEAN_LOST;
  if (!numbers) {
    v->loose.count = 0;
    v->loose_stamp = 0;
    return CF_OK;
  }
  if (v->loose_stamp == v->stamp) return CF_OK;
  v->loose_stamp = 0;
  CF_TRY(cf_pockets_find(&v->loose, l, true));
  v->loose_stamp = v->stamp;
  return CF_OK;
}

static void restore_means(const cf_varied *v, const cf_cell x) {
  cf_pockets_restore_means(&v->pockets, &v->level[0], x);
  if (has_loose(v)) cf_pockets_restore_means(&v->loose, &v->level[0], x);
}

/* From now on the cycle is symmetric: over clusters, wherever there are any; they are made here for the present coefficients. */
static cf_status take_care(cf_varied *v) {
  bool made = true;
  if (v->careful) return CF_OK;
  v->careful = true;
  if (v->depth > 1 && v->clusters.levels == 0) CF_TRY(cf_clusters_make(&v->clusters, &v->level[0], &made));
  v->clustered = v->depth > 1 && made;
  return CF_OK;
}

/* Starts until the residual's square is `enough` or nothing is gained; *s: what has been formed of x. */
static cf_status approach(cf_varied *v, const cf_cell b, const double enough, const int limit,
                          const cf_cell x, cf_varied_sums *s, int *iterations) {
  for (int start = 0; start < STARTS_MOST && *iterations < limit; ++start) {
    const cf_varied_sums before = *s;
    const double floor = floor_of(v, s), most = START_GAIN * START_GAIN * s->first;
    const double target = CF_MAX(enough, floor);
    if (s->first <= target) return CF_OK;
    cf_varied_copy(v, x, v->best);
    iterate(v, s->first, CF_MAX(target, most), limit, x, iterations);
    restore_means(v, x);
    *s = cf_varied_form(v, x, b);
    const bool stalled = !(s->first <= 0.25 * before.first);
    if (!(s->first < before.first)) {
      cf_varied_copy(v, v->best, x);
      *s = cf_varied_form(v, x, b);
    }
    if (stalled && v->careful) return CF_OK;
    if (s->first > target && (stalled || s->first > most)) CF_TRY(take_care(v));
  }
  return CF_OK;
}

/* Cycles have done harm if they leave so many times the residual (in squares) that they began with. A few times more of it may
 * stand for an error that is smaller. */
#define HARM 1e4

/* Whether the residual that cycles have kept is the true one: it does not see how x is rounded. */
static bool tells(const cf_varied *v, const cf_varied_sums *s, const double enough) {
  return sizeof(cf_real) == sizeof(double) && ROUNDING_SEEN * floor_of(v, s) <= enough;
}

/* Cycles on a finest level apart by colour add up b and x anyway. */
static bool watches_mean(const cf_varied *v) { return v->apart && v->pockets.all && v->pockets.count > 0; }

/* A mean of b that would be seen in the residual is taken out; that of x is to stay. */
static void watch_mean(cf_cycling *w, const double tolerance) {
  const cf_pockets *q = &w->v->pockets;
  const double most = MEAN_SHARE * tolerance;
  if (!(w->b_sum * w->b_sum <= most * most * w->bb * q->cells[0])) {
    cf_pockets_remove_means(q, &w->v->level[0], w->b);
    cf_varied_begin(w);
  }
  cf_pockets_take_mean(q, w->x_sum);
}

/* By stationary cycles, as far as they go. *done: the tolerance is met. x is what it was where b or A x is not finite, or
 * where cycles have done harm. */
static cf_status cycle(cf_varied *v, const cf_cell b, const cf_solve_options *o, const cf_cell x,
                       cf_solve_report *report, bool *done) {
  cf_cycling w = {.v = v, .x = x, .b = b};
  cf_varied_begin(&w);
  if (!(w.bb > 0) || !isfinite(w.bb)) return CF_OK;
  if (watches_mean(v)) watch_mean(&w, o->tolerance);
  const double enough = o->tolerance * o->tolerance * w.bb, start = w.rr;
  for (double before = INFINITY; w.rr <= 0.25 * before; cf_varied_begin(&w)) {
    before = w.rr;
    w.target = CF_MAX(enough, CF_CYCLES_TELL * CF_CYCLES_TELL * before);
    cf_varied_run_cycles(&w, o->max_iterations, &report->iterations);
    if (w.rr <= enough || !(w.rr <= w.target)) break;
  }
  if (w.kept && !(w.rr <= HARM * start))
    cf_varied_copy(v, v->best, x);
  else if (watches_mean(v))
    cf_pockets_restore_mean(&v->pockets, &v->level[0], w.x_sum, x);
  else
    restore_means(v, x);
  cf_varied_sums s = {w.rr, w.bb, w.xx};
  *done = s.first <= enough && tells(v, &s, enough);
  if (s.first <= enough && !*done && v->apart) {
    s = cf_fields_form(v, x, b);
    *done = s.first <= enough;
  }
  return *done ? cf_varied_judge(v, &s, o, report) : CF_OK;
}

/* By conjugate gradients, from where x is. */
static cf_status gradients(cf_varied *v, const cf_cell b, const cf_solve_options *o, const cf_cell x,
                           cf_solve_report *report) {
  cf_varied_sums s = cf_varied_form(v, x, b);
  CF_TRY(cf_varied_judge(v, &s, o, report));
  if (s.second == 0) {
    cf_varied_clear(v, x);
    return CF_OK;
  }
  v->careful = v->thorough = false;
  if (v->given_beta.at[0] != NULL && cf_clusters_are_called_for(&v->level[0])) CF_TRY(take_care(v));
  v->band_sweeps = (cf_band_sweeps){BAND_SWEEPS, 1}; /* over-relaxed ones do harm in necks of a cell */
  CF_TRY(
      approach(v, b, o->tolerance * o->tolerance * s.second, o->max_iterations, x, &s, &report->iterations));
  return cf_varied_judge(v, &s, o, report);
}

/* They work on level[0]. */
static cf_status go_on(cf_varied *v, const cf_cell b, const cf_solve_options *o, const cf_cell x,
                       cf_solve_report *report) {
  const bool apart = v->apart;
  if (watches_mean(v)) cf_pockets_remove_means(&v->pockets, &v->level[0], b);
  if (apart) CF_TRY(cf_varied_make_plain(v));
  v->apart = false;
  const cf_status s = gradients(v, b, o, x, report);
  v->apart = apart;
  return s;
}

cf_status cf_varied_solve(cf_varied *v, const cf_cell b, const cf_solve_options *o, const cf_cell x,
                          cf_solve_report *report) {
  if (v->sweeps) return cf_varied_sweep(v, b, o, x, report);
  const cf_coupled *l = &v->level[0];
  if (!watches_mean(v)) {
    cf_pockets_remove_means(&v->pockets, l, b);
    cf_pockets_keep_means(&v->pockets, l, x);
  }
  CF_TRY(find_loose(v));
  if (has_loose(v)) {
    cf_pockets_ask_means(&v->loose, l, v->alpha_number, b);
    cf_pockets_restore_means(&v->loose, l, x);
  }
  report->pockets = v->pockets.count;
  v->clustered = false;
  bool done = false;
  if (cf_varied_can_cycle(v)) CF_TRY(cycle(v, b, o, x, report, &done));
  return done ? CF_OK : go_on(v, b, o, x, report);
}
