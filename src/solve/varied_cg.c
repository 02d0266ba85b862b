/* SPDX-License-Identifier: MIT
 *
 * Conjugate gradients around the cycle, in passes over the region's rows:
 *
 *     z = cycle(r)
 *     beta = -a (z . A p) / (z_old . r_old),   p = z + beta p     (Polak-Ribiere: flexible, as in pcg.c)
 *     a = (p . r) / (p . A p),   x += a p,   r -= a A p
 *
 * The residual is formed anew at the end; where rounding has made it differ from the recursion, the iteration starts
 * again from there as long as that brings something.
 *
 * Sums: one number for every row of the box, lanes counted from the row's first cell, rows added in a fixed tree. A row
 * of which only runs are visited has the bits of the whole row with zeros elsewhere.
 */
#include <math.h>
#include <string.h>

#include "grid/sweep.h"
#include "solve/varied.h"
#include "solve/varied_part.h"

/* Beyond this many starts, or a start that gains less than half, rounding is all that is left. */
#define STARTS_MOST 5
/* Near walls, before and after the coarse correction. */
#define BAND_SWEEPS 2
/* So many iterations are far more than any equation should need: then the cycle becomes symmetric, with which conjugate
 * gradients cannot stall. */
#define PATIENCE 40

/* --- rows --------------------------------------------------------------------------------------------- */

typedef struct operator_row {
  const cf_real *x, *alpha, *beta[3];
  const cf_real *lo_x, *hi_x;
  cf_real lo[3], hi[3], alpha_number;
  ptrdiff_t stride[3];
  cf_real *y;
} operator_row;

/* form: alpha is a number (0) or a field (1). */
CF_KERNEL void operate(const int dim, const int form, const int n, const operator_row *of, const int unused) {
  (void)unused;
  const operator_row o = *of;
  CF_ROW_LOOP
  for (int i = 0; i < n; ++i) {
    cf_real sum = (form ? o.alpha[i] : o.alpha_number) * o.x[i];
    CF_AXIS_LOOP
    for (int a = 0; a < dim; ++a) {
      const ptrdiff_t s = o.stride[a];
      const cf_real lo = (a == 0 ? o.lo_x[i] : o.lo[a]) * o.beta[a][i];
      const cf_real hi = (a == 0 ? o.hi_x[i] : o.hi[a]) * o.beta[a][i + s];
      sum += lo * (o.x[i] - o.x[i - s]) - hi * (o.x[i + s] - o.x[i]);
    }
    o.y[i] = sum;
  }
}
CF_CLONED_FORMS(operate, const operator_row *, const int)

/* y = A x on a run. */
static void operate_run(const cf_varied *v, const cf_run *run, const int j, const int k, const cf_real *x,
                        cf_real *y) {
  const cf_box *b = &v->A->grid.box;
  const ptrdiff_t p = cf_box_at(b, run->low, j, k);
  const bool deep = b->dim == 3;
  const operator_row o = {.x = x + p,
                          .alpha = v->alpha.at != NULL ? v->alpha.at + p : NULL,
                          .beta = {v->beta.at[0] + p, v->beta.at[1] + p, deep ? v->beta.at[2] + p : NULL},
                          .lo_x = v->lo[0] + run->low,
                          .hi_x = v->hi[0] + run->low,
                          .lo = {0, v->lo[1][j], deep ? v->lo[2][k] : 0},
                          .hi = {0, v->hi[1][j], deep ? v->hi[2][k] : 0},
                          .alpha_number = (cf_real)v->alpha_number,
                          .stride = {b->stride[0], b->stride[1], b->stride[2]},
                          .y = y + p};
  operate_by_form(b->dim, v->alpha.at != NULL, run->high - run->low, &o, 0);
}

CF_CLONES static void dot_run(const int n, const cf_real *x, const cf_real *y, double lane[CF_SUM_LANES]) {
  int i = 0;
  for (; i + CF_SUM_LANES <= n; i += CF_SUM_LANES)
    for (int l = 0; l < CF_SUM_LANES; ++l) lane[l] += (double)x[i + l] * (double)y[i + l];
  for (int l = 0; i < n; ++i, ++l) lane[l] += (double)x[i] * (double)y[i];
}

CF_CLONES static void mixed_dot_run(const int n, const float *z, const cf_real *y,
                                    double lane[CF_SUM_LANES]) {
  int i = 0;
  for (; i + CF_SUM_LANES <= n; i += CF_SUM_LANES)
    for (int l = 0; l < CF_SUM_LANES; ++l) lane[l] += (double)z[i + l] * (double)y[i + l];
  for (int l = 0; i < n; ++i, ++l) lane[l] += (double)z[i] * (double)y[i];
}

/* r = b - r where the cell has an equation, else 0; and b's own squares there. */
CF_CLONES static void subtract_run(const int n, const cf_real *b, const float *inverse, cf_real *r,
                                   double bb[CF_SUM_LANES]) {
  CF_ROW_LOOP
  for (int i = 0; i < n; ++i) r[i] = inverse[i] > 0 ? b[i] - r[i] : 0;
  for (int i = 0; i < n; ++i) {
    const double value = inverse[i] > 0 ? (double)b[i] : 0;
    bb[i % CF_SUM_LANES] += value * value;
  }
}

CF_CLONES static void convert_run(const int n, const double scale, const cf_real *r, float *single) {
  CF_ROW_LOOP
  for (int i = 0; i < n; ++i) single[i] = (float)(scale * (double)r[i]);
}

CF_CLONES static void direction_run(const int n, const cf_real beta, const float *z, cf_real *p) {
  CF_ROW_LOOP
  for (int i = 0; i < n; ++i) p[i] = (cf_real)z[i] + beta * p[i];
}

CF_CLONES static void advance_run(const int n, const cf_real a, const cf_real *p, const cf_real *Ap,
                                  cf_real *x, cf_real *r) {
  CF_ROW_LOOP
  for (int i = 0; i < n; ++i) {
    x[i] += a * p[i];
    r[i] -= a * Ap[i];
  }
}

/* --- passes ------------------------------------------------------------------------------------------- */

typedef struct pair {
  double first, second;
} pair;

static pair add_up(const cf_varied *v) {
  const ptrdiff_t rows = cf_box_rows(&v->A->grid.box);
  if (v->tiles != NULL)
    return (pair){cf_tiles_sum_rows(v->tiles, v->sums), cf_tiles_sum_rows(v->tiles, v->sums + rows)};
  return (pair){cf_sum_ordered(v->sums, rows), cf_sum_ordered(v->sums + rows, rows)};
}

static void keep_row(const cf_varied *v, const int j, const int k, const double first[CF_SUM_LANES],
                     const double second[CF_SUM_LANES]) {
  const cf_box *b = &v->A->grid.box;
  const ptrdiff_t row = j + (ptrdiff_t)k * b->n[1];
  v->sums[row] = cf_sum_lanes(first);
  v->sums[cf_box_rows(b) + row] = cf_sum_lanes(second);
}

void cf_varied_set_ghosts(const cf_varied *v, const cf_cell x) {
  const cf_coupled *l = &v->level[0];
  const cf_box *b = &l->box;
  for (ptrdiff_t r = 0; r < l->rows; ++r)
    CF_TILE_ROWS (l, r, j, k) {
      const int at[3] = {0, j, k};
      CF_TILE_RUNS (l, r, run) {
        cf_real *row = x.at + cf_box_at(b, 0, j, k);
        if (run->low == 0) row[-1] = l->periodic[0] ? row[b->n[0] - 1] : 0;
        if (run->high == b->n[0]) row[b->n[0]] = l->periodic[0] ? row[0] : 0;
        for (int a = 1; a < b->dim; ++a)
          for (int side = 0; side < 2; ++side) {
            if (at[a] != (side ? b->n[a] - 1 : 0)) continue;
            const ptrdiff_t out = side ? b->stride[a] : -b->stride[a], across = -(b->n[a] - 1) * out;
            for (int i = run->low; i < run->high; ++i) row[i + out] = l->periodic[a] ? row[i + across] : 0;
          }
      }
    }
}

/* r = b - A x; squares of r and b. */
static pair form(const cf_varied *v, const cf_cell x, const cf_cell b) {
  const cf_coupled *l = &v->level[0];
  cf_varied_set_ghosts(v, x);
  CF_PARALLEL_COUPLED (l, w)
    CF_TILE_ROWS (l, w, j, k) {
      double rr[CF_SUM_LANES] = {0}, bb[CF_SUM_LANES] = {0};
      CF_TILE_RUNS (l, w, run) {
        const ptrdiff_t p = cf_box_at(&l->box, run->low, j, k);
        const int n = run->high - run->low;
        operate_run(v, run, j, k, x.at, v->r.at);
        subtract_run(n, b.at + p, l->inverse + p, v->r.at + p, bb);
        dot_run(n, v->r.at + p, v->r.at + p, rr);
      }
      keep_row(v, j, k, rr, bb);
    }
  return add_up(v);
}

/* The cycle's right side. */
static void convert(const cf_varied *v, const double scale) {
  const cf_coupled *l = &v->level[0];
  CF_PARALLEL_COUPLED (l, w)
    CF_TILE_ROWS (l, w, j, k)
      CF_TILE_RUNS (l, w, run) {
        const ptrdiff_t p = cf_box_at(&l->box, run->low, j, k);
        convert_run(run->high - run->low, scale, v->r.at + p, l->r + p);
      }
}

/* z . A p and z . r. */
static pair test_correction(const cf_varied *v) {
  const cf_coupled *l = &v->level[0];
  CF_PARALLEL_COUPLED (l, w)
    CF_TILE_ROWS (l, w, j, k) {
      double zAp[CF_SUM_LANES] = {0}, zr[CF_SUM_LANES] = {0};
      CF_TILE_RUNS (l, w, run) {
        const ptrdiff_t p = cf_box_at(&l->box, run->low, j, k);
        mixed_dot_run(run->high - run->low, l->e + p, v->Ap.at + p, zAp);
        mixed_dot_run(run->high - run->low, l->e + p, v->r.at + p, zr);
      }
      keep_row(v, j, k, zAp, zr);
    }
  return add_up(v);
}

static void turn(const cf_varied *v, const double beta) {
  const cf_coupled *l = &v->level[0];
  CF_PARALLEL_COUPLED (l, w)
    CF_TILE_ROWS (l, w, j, k)
      CF_TILE_RUNS (l, w, run) {
        const ptrdiff_t p = cf_box_at(&l->box, run->low, j, k);
        if (beta == 0) /* p may hold anything */
          for (int i = 0; i < run->high - run->low; ++i) v->p.at[p + i] = (cf_real)l->e[p + i];
        else
          direction_run(run->high - run->low, (cf_real)beta, l->e + p, v->p.at + p);
      }
}

/* A p, with p . A p and p . r. */
static pair probe(const cf_varied *v) {
  const cf_coupled *l = &v->level[0];
  cf_varied_set_ghosts(v, v->p);
  CF_PARALLEL_COUPLED (l, w)
    CF_TILE_ROWS (l, w, j, k) {
      double pAp[CF_SUM_LANES] = {0}, pr[CF_SUM_LANES] = {0};
      CF_TILE_RUNS (l, w, run) {
        const ptrdiff_t p = cf_box_at(&l->box, run->low, j, k);
        operate_run(v, run, j, k, v->p.at, v->Ap.at);
        dot_run(run->high - run->low, v->p.at + p, v->Ap.at + p, pAp);
        dot_run(run->high - run->low, v->p.at + p, v->r.at + p, pr);
      }
      keep_row(v, j, k, pAp, pr);
    }
  return add_up(v);
}

/* x += a p, r -= a A p, and the next right side of the cycle; the square of r. */
static double advance(const cf_varied *v, const double a, const double scale, const cf_cell x) {
  const cf_coupled *l = &v->level[0];
  CF_PARALLEL_COUPLED (l, w)
    CF_TILE_ROWS (l, w, j, k) {
      double rr[CF_SUM_LANES] = {0};
      const double none[CF_SUM_LANES] = {0};
      CF_TILE_RUNS (l, w, run) {
        const ptrdiff_t p = cf_box_at(&l->box, run->low, j, k);
        const int n = run->high - run->low;
        advance_run(n, (cf_real)a, v->p.at + p, v->Ap.at + p, x.at + p, v->r.at + p);
        dot_run(n, v->r.at + p, v->r.at + p, rr);
        convert_run(n, scale, v->r.at + p, l->r + p);
      }
      keep_row(v, j, k, rr, none);
    }
  return add_up(v).first;
}

void cf_varied_clear(const cf_varied *v, const cf_cell x) {
  const cf_coupled *l = &v->level[0];
  CF_PARALLEL_COUPLED (l, w)
    CF_TILE_ROWS (l, w, j, k)
      CF_TILE_RUNS (l, w, run)
        for (ptrdiff_t i = run->low, p = cf_box_at(&l->box, 0, j, k); i < run->high; ++i)
          if (cf_coupled_has(l, p + i)) x.at[p + i] = 0;
}

static void copy(const cf_varied *v, const cf_cell from, const cf_cell to) {
  const cf_coupled *l = &v->level[0];
  CF_PARALLEL_COUPLED (l, w)
    CF_TILE_ROWS (l, w, j, k)
      CF_TILE_RUNS (l, w, run) {
        const ptrdiff_t p = cf_box_at(&l->box, run->low, j, k);
        memcpy(to.at + p, from.at + p, (size_t)(run->high - run->low) * sizeof(cf_real));
      }
}

void cf_varied_keep(const cf_varied *v, const cf_cell x) { copy(v, x, v->p); }

void cf_varied_recall(const cf_varied *v, const cf_cell x) { copy(v, v->p, x); }

/* --- the iteration ------------------------------------------------------------------------------------ */

/* A power of two that makes the residual's values about 1. */
static double scale_for(const cf_varied *v, const double rr) {
  const double size = sqrt(rr / (double)cf_box_cells(&v->A->grid.box));
  int exponent;
  (void)frexp(size, &exponent);
  return ldexp(1, CF_MAX(-1000, CF_MIN(1000, -exponent)));
}

/* Conjugate gradients from the residual formed; returns the square that the recursion ends with. */
static double iterate(const cf_varied *v, double rr, const double enough, const int limit, const cf_cell x,
                      int *iterations) {
  const double scale = scale_for(v, rr);
  const int most = v->careful ? limit : CF_MIN(limit, *iterations + PATIENCE);
  double zr_old = 0, a = 0;
  convert(v, scale);
  for (int it = 0; rr > enough && *iterations < most; ++it) {
    cf_varied_cycle(v, 0);
    const pair z = test_correction(v);
    turn(v, it == 0 ? 0 : -a * z.first / zr_old);
    const pair p = probe(v);
    if (!(p.first > 0) || !isfinite(p.second)) break; /* round-off is all that is left */
    a = p.second / p.first;
    rr = advance(v, a, scale, x);
    zr_old = z.second;
    ++*iterations;
  }
  return rr;
}

cf_status cf_varied_solve(cf_varied *v, const cf_cell b, const cf_solve_options *o, const cf_cell x,
                          cf_solve_report *report) {
  const cf_coupled *l = &v->level[0];
  cf_pockets_remove_means(&v->pockets, l, b);
  cf_pockets_keep_means(&v->pockets, l, x);
  pair s = form(v, x, b);
  if (!isfinite(s.first) || !isfinite(s.second))
    return cf_fail(CF_NOT_FINITE,
                   "the equation to solve holds a value that is not finite (|b| = %g, |b - A x| = %g)",
                   sqrt(s.second), sqrt(s.first));
  if (s.second == 0) {
    cf_varied_clear(v, x);
    s.first = 0;
  }
  const double bb = s.second, enough = o->tolerance * o->tolerance * bb;
  v->careful = false;
  v->band_sweeps = BAND_SWEEPS;
  for (int start = 0; start < STARTS_MOST && s.first > enough && report->iterations < o->max_iterations;
       ++start) {
    const double before = s.first;
    const int begun = report->iterations;
    iterate(v, s.first, enough, o->max_iterations, x, &report->iterations);
    s = form(v, x, b);
    if (!isfinite(s.first)) return cf_fail(CF_NOT_FINITE, "the solution has grown beyond all numbers");
    const bool stalled = s.first > 0.25 * before;
    if (stalled && v->careful) break;
    v->careful = v->careful || stalled || report->iterations - begun >= PATIENCE;
  }
  cf_pockets_restore_means(&v->pockets, l, x);
  report->residual = bb > 0 ? sqrt(s.first / bb) : 0;
  report->converged = s.first <= enough;
  report->pockets = v->pockets.count;
  return CF_OK;
}

void cf_varied_apply(cf_varied *v, const cf_cell x, const cf_cell y) {
  const cf_coupled *l = &v->level[0];
  cf_varied_set_ghosts(v, x);
  CF_PARALLEL_COUPLED (l, w)
    CF_TILE_ROWS (l, w, j, k)
      CF_TILE_RUNS (l, w, run) operate_run(v, run, j, k, x.at, y.at);
}

double cf_varied_residual(cf_varied *v, const cf_cell x, const cf_cell b) {
  const pair s = form(v, x, b);
  return s.second > 0 ? sqrt(s.first / s.second) : sqrt(s.first);
}
