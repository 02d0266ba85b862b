/* SPDX-License-Identifier: MIT
 *
 * What the fast path is made of, and the iteration around its cycle.
 */
#include <float.h>
#include <math.h>

#include "base/mem.h"
#include "grid/sweep.h"
#include "solve/box_part.h"
#include "solve/pcg.h"
#include "solve/setting.h"

/* The polynomials' bound holds for the error; a pass aims so much below what is asked of the residual, since a second
 * pass costs more than a half sweep. */
#define PASS_MARGIN 0.25
/* In a region: with steps chosen anew, cycles gain more and less in turn. */
#define WINDOW    4
#define FAR_OFF   1e4 /* times the scale of r */
#define LOITERING 0.35
/* What rounding leaves of the residual that a recursion started from; a new start is due well before. */
#define RECURSION_FLOOR 5e-7
#define RECURSION_TURN  2e-5
/* In a region, where differences are not exact at edges, so much of the tolerance is left to what the recursion does not
 * see. */
#define RECURSION_SLACK 0.01
/* A cycle that leaves more than this of the residual, so many times in a row: not a case for this path. */
#define SLOW       0.5
#define SLOW_TIMES 3
/* Above this stiffness the mean of x is computed from the mean of b, where no wall is held. */
#define MEAN_APART 1e5
/* Above this one the constant is out of a direct solution's sight. */
#define MEAN_LOST 1e10
/* Extents that a cycle of eight half sweeps is for: Fourier's analysis knows of no walls. */
#define THIN 16
/* Of what the tolerance allows, a mean that is not as it should be may take up so much. */
#define MEAN_SHARE 0.1

/* --- making ------------------------------------------------------------------------------------------- */

void cf_box_solver_destroy(cf_box_solver *f) {
  if (f == NULL) return;
  for (int l = 0; l < f->levels; ++l) cf_split_destroy(&f->level[l]);
  cf_wave_destroy(&f->wave);
  cf_segments_destroy(&f->segments);
  cf_direct_destroy(&f->direct);
  cf_free(f->line);
  cf_free(f->rows);
  cf_free(f);
}

static cf_status levels_create(cf_box_solver *f, const cf_helmholtz *A) {
  for (int l = 0; l < A->levels; ++l) {
    f->levels = l + 1; /* counted first, so that a failure within frees it */
    CF_TRY(cf_split_create(&f->level[l], &A->level[l], true));
  }
  const cf_split *finest = &f->level[0];
  CF_TRY(cf_wave_create(&f->wave, finest));
  CF_TRY(cf_direct_create(&f->direct));
  CF_TRY(CF_NEW(&f->line, 5 * CF_MAX(finest->n[0], CF_MAX(finest->n[1], finest->n[2]))));
  f->sums = (ptrdiff_t)finest->n[1] * finest->n[2] * cf_wave_pieces(finest);
  return CF_NEW(&f->rows, CF_PASS_SUMS * f->sums);
}

cf_status cf_box_solver_create(cf_box_solver **f, const cf_helmholtz *A) {
  *f = NULL;
  cf_box_solver *fresh;
  CF_TRY(CF_NEW(&fresh, 1));
  const cf_status s = levels_create(fresh, A);
  if (s != CF_OK) {
    cf_box_solver_destroy(fresh);
    return s;
  }
  *f = fresh;
  return CF_OK;
}

/* The level as the direct solution takes it: without an alpha too small to be seen beside beta. */
cf_level cf_box_coarsest(const cf_box_solver *f) {
  cf_level l = *f->level[f->depth - 1].plain;
  if (f->lost) l.alpha = 0;
  return l;
}

/* Levels to use: the finest alone where half sweeps do. */
static int depth_for(const cf_helmholtz *A) {
  return cf_level_stiffness(&A->level[0]) <= CF_BOX_SWEEPS_ENOUGH ? 1 : A->depth;
}

/* Whether single precision can do this at all, half sweeps of one colour are independent on the finest level, and
 * levels go far enough. */
static bool is_suitable(const cf_box_solver *f, const cf_level *finest, const cf_level *coarsest) {
  if (cf_level_is_solved_directly(finest) || f->level[0].odd_seam) return false;
  if (!(f->scale > 0) || !(f->scale < 1e100)) return false;
  /* The direct solution takes cf_real. */
  if (sizeof(cf_real) == sizeof(float) && f->scale > 1e30) return false;
  return cf_level_is_solved_directly(coarsest) ||
         cf_level_stiffness(coarsest) <= (f->depth == 1 ? CF_BOX_SWEEPS_ENOUGH : CF_STIFF_ENOUGH);
}

/* omega of the four half sweeps of other cycles: 1 + (share of diffusion in the diagonal)^2 / 5, on the finest level so much of
 * what is above 1, and none in the first one after the coarse correction, which starts anew (stages.h). */
static void choose_omega(const cf_level *l, const bool finest, const bool half_sweeps_only, double omega[4]) {
  static const double on_finest[4] = {1.2, 1.2, 0, CF_BOX_FINEST_OVER};
  const double over = (double)cf_level_relaxation(l) - 1;
  for (int v = 0; v < 4; ++v) omega[v] = half_sweeps_only ? 1 : 1 + (finest ? on_finest[v] : 1) * over;
}

static bool is_thin(const cf_box *b) {
  for (int a = 0; a < b->dim; ++a)
    if (b->n[a] < THIN) return true;
  return false;
}

bool cf_box_solver_set(cf_box_solver *f, const cf_helmholtz *A) {
  f->depth = depth_for(A);
  const cf_level *finest = &A->level[0], *coarsest = &A->level[f->depth - 1];
  const double h = A->grid.h, stiffness = cf_level_stiffness(coarsest);
  f->alpha = finest->alpha;
  f->beta = A->beta;
  f->scale = f->alpha + 2 * A->grid.box.dim * f->beta / (h * h);
  if (!is_suitable(f, finest, coarsest)) return false;
  f->jacobi = stiffness / (1 + stiffness);
  f->singular = A->singular;
  f->free_mean = !A->has_held_wall && cf_level_stiffness(finest) > MEAN_APART;
  f->lost = f->singular || (f->free_mean && cf_level_stiffness(finest) > MEAN_LOST);
  f->thorough = f->depth > 1 && !is_thin(&A->grid.box);
  const cf_setting on =
      f->thorough ? cf_setting_for(A->grid.box.dim, cf_level_stiffness(finest)) : (cf_setting){0};
  for (int v = 0; v < CF_BOX_HALF_SWEEPS; ++v) f->omega[v] = 1 + on.over[v];
  for (int l = 0; l < f->depth; ++l) {
    const bool half_sweeps_only = l == f->depth - 1 && !cf_level_is_solved_directly(coarsest);
    const double alpha = l == 0 ? f->alpha : (1 + on.alpha) * f->alpha;
    const double beta = l == 0 ? f->beta : (1 + on.beta) * f->beta;
    double omega[4];
    choose_omega(&A->level[l], l == 0, half_sweeps_only, omega);
    cf_split_set(&f->level[l], alpha, beta, f->scale, omega);
  }
  const cf_level plain = cf_box_coarsest(f);
  if (cf_level_is_few(&plain)) cf_direct_factor(&plain, &f->direct);
  return true;
}

const char *cf_box_solver_method(const cf_box_solver *f) { return f->depth == 1 ? "sor" : "multigrid"; }

/* --- the iteration ------------------------------------------------------------------------------------ */

/* A power of two near v, at which floats are at home. */
static double near_power(const double v) {
  if (!(v > 0) || !isfinite(v)) return 1;
  int exponent;
  (void)frexp(v, &exponent);
  return ldexp(1, exponent);
}

/* The largest value among a few rows: enough to choose a scale. */
static double sample_scale(const cf_box_solver *f, const cf_cell b, const cf_cell x) {
  const cf_box *box = &f->level[0].plain->box;
  const ptrdiff_t rows = cf_box_rows(box), step = CF_MAX(rows / 61, 1);
  double largest = 0;
  for (ptrdiff_t r = 0; r < rows; r += step)
    for (int i = 0; i < box->n[0]; ++i) {
      const ptrdiff_t p = cf_box_row(box, r) + i;
      largest = CF_MAX(largest, CF_MAX(fabs((double)b.at[p]), f->scale * fabs((double)x.at[p])));
    }
  return largest;
}

static double cells_of(const cf_box_solver *f) {
  return (double)(f->varied != NULL ? f->segments.cells : cf_box_cells(&f->level[0].plain->box));
}

static double scale_for(const cf_box_solver *f, const cf_level *l, const cf_cell b, const cf_cell x) {
  if (f->varied != NULL) return near_power(cf_box_sample_around(f, b, x));
  double size = sample_scale(f, b, x);
  if (!(size > 1e-15 && size < 1e15))
    size = sqrt((cf_level_dot(l, b, b) + f->scale * f->scale * cf_level_dot(l, x, x)) /
                (double)cf_box_cells(&l->box));
  return near_power(size);
}

/* The sample may have missed what is large, in the few cells beside a body say: r must not grow out of single precision. */
static void rescale(const cf_box_solver *f, const cf_helmholtz *A, const cf_cell b, const cf_cell x,
                    cf_box_iteration *it) {
  const double size = sqrt(CF_MAX(it->bb, isfinite(it->rr) ? it->rr : 0) / cells_of(f));
  if (!(size > FAR_OFF * it->scale) || !isfinite(size)) return;
  it->scale = near_power(size);
  cf_box_form(f, A, b, x, it);
}

/* Where rounding of x itself is all that b - A x shows. What is wrong with x may be smoother and larger than that,
 * so cycles go on until the recursion, which does not know of it, has come to its end. */
static double floor_of(const cf_box_solver *f, const cf_box_iteration *it) {
  const double size = CF_REAL_EPSILON * f->scale;
  return size * size * it->xx;
}

static cf_status check_sums(const cf_box_iteration *it) {
  if (isfinite(it->bb) && isfinite(it->rr)) return CF_OK;
  return cf_fail(CF_NOT_FINITE,
                 "the equation to solve holds a value that is not finite (|b| = %g, |b - A x| = %g)",
                 sqrt(it->bb), sqrt(it->rr));
}

/* --- the mean where no wall is held ------------------------------------------------------------------- */

/* The mean of x that b asks for, where alpha is too small for cycles to find it: the first pass lifts x to it. */
static void set_mean(const cf_box_solver *f, const cf_level *l, const cf_cell b, const cf_cell x,
                     cf_box_iteration *it) {
  if (!f->free_mean || f->singular) return;
  const double cells = (double)cf_box_cells(&l->box);
  it->lift = cf_level_sum(l, b) / cells / f->alpha - cf_level_sum(l, x) / cells;
  it->shift = f->alpha * it->lift;
}

/* x += amount, where there is an equation. */
static void lift_all(const cf_box_solver *f, const cf_level *l, const double amount, const cf_cell x) {
  if (f->varied != NULL)
    cf_pockets_lift(&f->varied->level[0], amount, x);
  else
    cf_level_shift(l, amount, x);
}

/* Without alpha nothing solves for the mean of b. Mostly it is round-off; if not, it is taken out. */
static void balance(const cf_box_solver *f, const cf_helmholtz *A, const cf_cell b, const cf_cell x,
                    const double tolerance, cf_box_iteration *it) {
  const double cells = cells_of(f), allowed = MEAN_SHARE * tolerance;
  if (!f->singular || it->b_sum * it->b_sum / cells <= allowed * allowed * it->bb) return;
  if (f->varied != NULL)
    cf_pockets_remove_means(&f->varied->pockets, &f->varied->level[0], b);
  else
    cf_level_remove_mean(&A->level[0], b);
  cf_box_form(f, A, b, x, it);
}

/* How far the mean of x has gone from `mean`: the next pass brings it back. */
static void hold_mean(const cf_box_solver *f, const double cells, const double mean, cf_box_iteration *it) {
  if (f->singular) it->lift = mean - it->x_sum / cells;
}

/* After the last pass it goes back where that could be told at this tolerance. Rounding of a large lift is part
 * of the residual. */
static void settle_mean(const cf_box_solver *f, const cf_helmholtz *A, const cf_cell b, const cf_cell x,
                        const double tolerance, cf_box_iteration *it) {
  const cf_level *l = &A->level[0];
  const double allowed = MEAN_SHARE * tolerance, cells = cells_of(f);
  if (it->lift == 0) return;
  if (f->singular && it->lift * it->lift * cells <= allowed * allowed * it->xx) return;
  lift_all(f, l, it->lift, x);
  it->lift = it->shift = 0;
  if (!f->singular) cf_box_form(f, A, b, x, it);
}

/* Whether the latest WINDOW cycles have gained too little for conjugate gradients not to be the better choice; not so in the
 * first few, which go unevenly. */
static bool loiters(const double rr, const int iterations, double lately[WINDOW]) {
  const double before = lately[iterations % WINDOW];
  lately[iterations % WINDOW] = rr;
  return iterations > WINDOW && rr > pow(LOITERING, 2 * WINDOW) * before;
}

/* --- starting again ----------------------------------------------------------------------------------- */

/* Whether x is worth keeping as a start: it leaves less than nothing does. */
static bool is_better_than_nothing(const cf_box_iteration *it) { return it->rr < 0.25 * it->bb; }

/* Back to the start, or to nothing: what is far off is far off in few places, worse to start from than either. */
static void start_again(const cf_box_solver *f, const bool kept, const double mean, const cf_cell x,
                        cf_box_iteration *it) {
  it->lift = 0;
  if (kept) {
    cf_varied_copy(f->varied, f->varied->best, x);
  } else {
    cf_varied_clear(f->varied, x);
    if (f->singular) cf_pockets_lift(&f->varied->level[0], mean, x);
  }
}

/* --- all of it ---------------------------------------------------------------------------------------- */

/* One pass; the recursion of the residual starts anew where it has gained so much that rounding shows. False: there is
 * nothing more to gain. */
static bool iterate(const cf_box_solver *f, const cf_helmholtz *A, const cf_cell b, const cf_cell x,
                    const double enough, cf_box_iteration *it) {
  const bool far = enough < RECURSION_FLOOR * RECURSION_FLOOR * it->start;
  const double turn = far ? CF_MAX(RECURSION_TURN * RECURSION_TURN * it->start, enough) : enough;
  const double expected = 1.5 * it->rate * it->rate * it->rr;
  if (f->depth > 1)
    cf_box_cycle(f, b, x, expected <= turn, it);
  else
    cf_box_sweeps(f, b, x, PASS_MARGIN * sqrt(enough / it->rr), it);
  /* x may be coarser than what r can tell: in single precision, or next to a large lift. */
  const double rounding = CF_REAL_EPSILON * f->scale * it->lifted;
  const bool coarse =
      sizeof(cf_real) == sizeof(float) || rounding * rounding * cells_of(f) > MEAN_SHARE * enough;
  if (!(it->rr <= turn) || !(far || coarse)) return true;
  const double begun = it->start;
  it->scale = near_power(sqrt(it->rr / cells_of(f)));
  it->shift = 0;
  cf_box_form(f, A, b, x, it);
  return it->rr <= SLOW * SLOW * begun && it->rr > floor_of(f, it);
}

static cf_status run(const cf_box_solver *f, const cf_helmholtz *A, const cf_cell b,
                     const cf_solve_options *o, const cf_cell x, cf_solve_report *report, bool *finished) {
  const cf_level *l = &A->level[0];
  const double cells = cells_of(f);
  cf_box_iteration it = {.rate = 0.1, .step = 1};
  double lately[WINDOW] = {0};
  int slow = 0;
  report->levels = f->depth;
  it.scale = scale_for(f, l, b, x);
  set_mean(f, l, b, x, &it);
  cf_box_form(f, A, b, x, &it);
  rescale(f, A, b, x, &it);
  CF_TRY(check_sums(&it));
  balance(f, A, b, x, o->tolerance, &it);
  const double asked = (f->varied != NULL ? 1 - RECURSION_SLACK : 1) * o->tolerance;
  const double mean = it.x_sum / cells, enough = asked * asked * it.bb;
  if (it.bb == 0) {
    if (f->varied != NULL)
      cf_varied_clear(f->varied, x);
    else
      cf_level_clear(l, x);
    if (f->singular) lift_all(f, l, mean, x);
  }
  bool gains = it.bb > 0;
  const bool keeps = f->varied != NULL && f->depth > 1 && is_better_than_nothing(&it);
  if (keeps) cf_varied_copy(f->varied, x, f->varied->best);
  while (gains && slow < SLOW_TIMES && report->iterations < o->max_iterations) {
    if (it.rr <= enough) break;
    const double before = it.rr;
    gains = iterate(f, A, b, x, enough, &it);
    ++report->iterations;
    CF_TRY(check_sums(&it));
    hold_mean(f, cells, mean, &it);
    slow = it.rr > SLOW * SLOW * before ? slow + 1 : 0;
    if (f->varied != NULL && (it.overshoots || loiters(it.rr, report->iterations, lately))) slow = SLOW_TIMES;
  }
  *finished = slow < SLOW_TIMES;
  if (f->varied != NULL) /* conjugate gradients know better than to take rounding for the end */
    *finished = it.bb == 0 || it.rr <= enough || report->iterations >= o->max_iterations;
  if (!*finished && it.overshoots) start_again(f, keeps, mean, x, &it);
  settle_mean(f, A, b, x, o->tolerance, &it);
  report->residual = it.bb > 0 ? sqrt(it.rr / it.bb) : 0;
  const double rounding = CF_MIN(floor_of(f, &it), CF_ROUNDING_PASSES * it.bb);
  report->converged = it.bb == 0 || it.rr <= CF_MAX(enough, rounding);
  return CF_OK;
}

cf_status cf_box_solver_run(cf_box_solver *f, cf_helmholtz *A, const cf_cell b, const cf_solve_options *o,
                            const cf_cell x, cf_solve_report *report, bool *finished) {
  if (f->varied == NULL) return run(f, A, b, o, x, report, finished);
  const cf_pockets *pockets = &f->varied->pockets;
  const cf_coupled *l = &f->varied->level[0];
  report->pockets = pockets->count;
  f->varied->careful = false;
  f->varied->thorough = true;
  /* beside known values the coarse levels are swept once more */
  f->varied->band_sweeps = (cf_band_sweeps){f->segments.any_held ? 1 : 0, 1};
  if (f->singular)
    return run(f, A, b, o, x, report, finished); /* which looks after a single mean by itself */
  cf_pockets_remove_means(pockets, l, b);
  cf_pockets_keep_means(pockets, l, x);
  CF_TRY(run(f, A, b, o, x, report, finished));
  cf_pockets_restore_means(pockets, l, x);
  return CF_OK;
}
