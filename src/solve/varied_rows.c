/* SPDX-License-Identifier: MIT
 *
 * What conjugate gradients (varied_cg.c) do to the region's rows, in passes.
 *
 * Sums: one number for every row of the box, lanes counted from the row's first cell, rows added in a fixed tree. A row
 * of which only runs are visited has the bits of the whole row with zeros elsewhere.
 */
#include <math.h>
#include <string.h>

#include "grid/sweep.h"
#include "solve/varied.h"
#include "solve/varied_part.h"
#include "solve/varied_row.h"

/* --- rows --------------------------------------------------------------------------------------------- */

CF_KERNEL void operate(const int dim, const int form, const int n, const cf_varied_row *of,
                       const int unused) {
  (void)unused;
  const cf_varied_row o = *of;
  CF_ROW_LOOP
  for (int i = 0; i < n; ++i) {
    cf_real sum = cf_alpha_at(form, &o, i) * o.x[i];
    CF_AXIS_LOOP
    for (int a = 0; a < dim; ++a) {
      const ptrdiff_t s = o.stride[a];
      sum += cf_low_at(form, &o, a, i) * (o.x[i] - o.x[i - s]) -
             cf_high_at(form, &o, a, i) * (o.x[i + s] - o.x[i]);
    }
    o.y[i] = sum;
  }
}
CF_VARIED_ROWS(operate, const int)

/* y = b - A x where the cell has an equation, else 0. */
CF_KERNEL void remain(const int dim, const int form, const int n, const cf_varied_row *of, const int unused) {
  (void)unused;
  const cf_varied_row o = *of;
  CF_ROW_LOOP
  for (int i = 0; i < n; ++i) {
    o.y[i] = o.inverse[i] > 0 ? (cf_real)((double)o.b[i] - cf_apply_at(dim, form, &o, i)) : 0;
  }
}
CF_VARIED_ROWS(remain, const int)

/* y = A x on a run. */
static void operate_run(const cf_varied *v, const cf_run *run, const int j, const int k, const cf_cell x,
                        const cf_cell y) {
  cf_varied_row o = cf_varied_row_of(v, run, j, k, x);
  o.y = y.at + cf_box_at(&v->A->grid.box, run->low, j, k);
  operate_row(v->A->grid.box.dim, cf_varied_form_of(v), run->high - run->low, &o, 0);
}

/* Adds the products of two runs to the lanes of their row. */
#define DOT_LOOP(n, f, g, lane)                                                           \
  double sum[CF_SUM_LANES];                                                               \
  int i = 0;                                                                              \
  memcpy(sum, lane, sizeof sum);                                                          \
  for (; i + CF_SUM_LANES <= n; i += CF_SUM_LANES)                                        \
    for (int l = 0; l < CF_SUM_LANES; ++l) sum[l] += (double)f[i + l] * (double)g[i + l]; \
  for (int l = 0; i < n; ++i, ++l) sum[l] += (double)f[i] * (double)g[i];                 \
  memcpy(lane, sum, sizeof sum);

CF_CLONES static void dot_run(const int n, const cf_real *x, const cf_real *y,
                              double lane[CF_SUM_LANES]){DOT_LOOP(n, x, y, lane)}

CF_CLONES static void mixed_dot_run(const int n, const float *z, const cf_real *y,
                                    double lane[CF_SUM_LANES]){DOT_LOOP(n, z, y, lane)}

/* The squares of b where the cell has an equation. */
CF_CLONES static void side_run(const int n, const cf_varied_row *o, double lane[CF_SUM_LANES]) {
  double sum[CF_SUM_LANES], b[CF_SUM_LANES];
  memcpy(sum, lane, sizeof sum);
  for (int i = 0; i < n; i += CF_SUM_LANES) {
    const int lanes = CF_MIN(CF_SUM_LANES, n - i);
    for (int l = 0; l < CF_SUM_LANES; ++l) b[l] = 0;
    CF_ROW_LOOP
    for (int l = 0; l < lanes; ++l) b[l] = o->inverse[i + l] > 0 ? (double)o->b[i + l] : 0;
    for (int l = 0; l < CF_SUM_LANES; ++l) sum[l] += b[l] * b[l];
  }
  memcpy(lane, sum, sizeof sum);
}

/* The squares of x times the diagonal, where the cell has an equation. */
CF_CLONES static void size_run(const int n, const cf_varied_row *o, double lane[CF_SUM_LANES]) {
  double sum[CF_SUM_LANES], x[CF_SUM_LANES];
  memcpy(sum, lane, sizeof sum);
  for (int i = 0; i < n; i += CF_SUM_LANES) {
    const int lanes = CF_MIN(CF_SUM_LANES, n - i);
    for (int l = 0; l < CF_SUM_LANES; ++l) x[l] = 0;
    CF_ROW_LOOP
    for (int l = 0; l < lanes; ++l) {
      const bool has = o->inverse[i + l] > 0;
      x[l] = has ? (double)o->x[i + l] * (double)(1 / (has ? o->inverse[i + l] : 1)) : 0;
    }
    for (int l = 0; l < CF_SUM_LANES; ++l) sum[l] += x[l] * x[l];
  }
  memcpy(lane, sum, sizeof sum);
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

/* Up to three sums along a row. */
typedef struct lanes {
  double sum[3][CF_SUM_LANES];
} lanes;

static void keep_row(const cf_varied *v, const int count, const int j, const int k, const lanes *w) {
  const cf_box *b = &v->A->grid.box;
  for (int s = 0; s < count; ++s)
    v->sums[s * cf_box_rows(b) + j + (ptrdiff_t)k * b->n[1]] = cf_sum_lanes(w->sum[s]);
}

cf_varied_sums cf_varied_add_up(const cf_varied *v, const int count) {
  const ptrdiff_t rows = cf_box_rows(&v->A->grid.box);
  double total[3] = {0};
  for (int s = 0; s < count; ++s)
    total[s] = v->tiles != NULL ? cf_tiles_sum_rows(v->tiles, v->sums + s * rows)
                                : cf_sum_ordered(v->sums + s * rows, rows);
  return (cf_varied_sums){total[0], total[1], total[2]};
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

/* r on a run, and `count` sums of it. */
static void form_run(const cf_varied *v, const cf_run *run, const int j, const int k, const int count,
                     const cf_cell x, const cf_cell b, lanes *sums) {
  const cf_coupled *l = &v->level[0];
  const ptrdiff_t p = cf_box_at(&l->box, run->low, j, k);
  const int n = run->high - run->low;
  cf_varied_row o = cf_varied_row_of(v, run, j, k, x);
  o.b = b.at + p;
  o.y = v->r.at + p;
  remain_row(l->dim, cf_varied_form_of(v), n, &o, 0);
  dot_run(n, v->r.at + p, v->r.at + p, sums->sum[0]);
  if (v->sweeps) /* every cell has an equation */
    dot_run(n, o.b, o.b, sums->sum[1]);
  else
    side_run(n, &o, sums->sum[1]);
  if (count > 2) size_run(n, &o, sums->sum[2]);
}

void cf_varied_form_run(const cf_varied *v, const int j, const int k, const cf_run *run, const cf_cell x,
                        const cf_cell b) {
  lanes sums = {{{0}}};
  if (run->low < run->high) form_run(v, run, j, k, 2, x, b, &sums);
  keep_row(v, 2, j, k, &sums);
}

cf_varied_sums cf_varied_form(const cf_varied *v, const cf_cell x, const cf_cell b) {
  const cf_coupled *l = &v->level[0];
  cf_varied_set_ghosts(v, x);
  CF_PARALLEL_COUPLED (l, w)
    CF_TILE_ROWS (l, w, j, k) {
      lanes sums = {{{0}}};
      CF_TILE_RUNS (l, w, run) form_run(v, run, j, k, 3, x, b, &sums);
      keep_row(v, 3, j, k, &sums);
    }
  return cf_varied_add_up(v, 3);
}

void cf_varied_convert(const cf_varied *v, const double scale) {
  const cf_coupled *l = &v->level[0];
  CF_PARALLEL_COUPLED (l, w)
    CF_TILE_ROWS (l, w, j, k)
      CF_TILE_RUNS (l, w, run) {
        const ptrdiff_t p = cf_box_at(&l->box, run->low, j, k);
        convert_run(run->high - run->low, scale, v->r.at + p, l->r + p);
      }
}

cf_varied_sums cf_varied_test_correction(const cf_varied *v) {
  const cf_coupled *l = &v->level[0];
  CF_PARALLEL_COUPLED (l, w)
    CF_TILE_ROWS (l, w, j, k) {
      lanes row = {{{0}}};
      CF_TILE_RUNS (l, w, run) {
        const ptrdiff_t p = cf_box_at(&l->box, run->low, j, k);
        mixed_dot_run(run->high - run->low, l->e + p, v->Ap.at + p, row.sum[0]);
        mixed_dot_run(run->high - run->low, l->e + p, v->r.at + p, row.sum[1]);
      }
      keep_row(v, 2, j, k, &row);
    }
  return cf_varied_add_up(v, 2);
}

void cf_varied_turn(const cf_varied *v, const double beta) {
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

cf_varied_sums cf_varied_probe(const cf_varied *v) {
  const cf_coupled *l = &v->level[0];
  cf_varied_set_ghosts(v, v->p);
  CF_PARALLEL_COUPLED (l, w)
    CF_TILE_ROWS (l, w, j, k) {
      lanes row = {{{0}}};
      CF_TILE_RUNS (l, w, run) {
        const ptrdiff_t p = cf_box_at(&l->box, run->low, j, k);
        operate_run(v, run, j, k, v->p, v->Ap);
        dot_run(run->high - run->low, v->p.at + p, v->Ap.at + p, row.sum[0]);
        dot_run(run->high - run->low, v->p.at + p, v->r.at + p, row.sum[1]);
      }
      keep_row(v, 2, j, k, &row);
    }
  return cf_varied_add_up(v, 2);
}

double cf_varied_advance(const cf_varied *v, const double a, const double scale, const cf_cell x) {
  const cf_coupled *l = &v->level[0];
  CF_PARALLEL_COUPLED (l, w)
    CF_TILE_ROWS (l, w, j, k) {
      lanes row = {{{0}}};
      CF_TILE_RUNS (l, w, run) {
        const ptrdiff_t p = cf_box_at(&l->box, run->low, j, k);
        const int n = run->high - run->low;
        advance_run(n, (cf_real)a, v->p.at + p, v->Ap.at + p, x.at + p, v->r.at + p);
        dot_run(n, v->r.at + p, v->r.at + p, row.sum[0]);
        convert_run(n, scale, v->r.at + p, l->r + p);
      }
      keep_row(v, 1, j, k, &row);
    }
  return cf_varied_add_up(v, 1).first;
}

void cf_varied_clear(const cf_varied *v, const cf_cell x) {
  const cf_coupled *l = &v->level[0];
  CF_PARALLEL_COUPLED (l, w)
    CF_TILE_ROWS (l, w, j, k)
      CF_TILE_RUNS (l, w, run)
        for (ptrdiff_t i = run->low, p = cf_box_at(&l->box, 0, j, k); i < run->high; ++i)
          if (cf_coupled_has(l, p + i)) x.at[p + i] = 0;
}

void cf_varied_copy(const cf_varied *v, const cf_cell from, const cf_cell to) {
  const cf_coupled *l = &v->level[0];
  CF_PARALLEL_COUPLED (l, w)
    CF_TILE_ROWS (l, w, j, k)
      CF_TILE_RUNS (l, w, run) {
        const ptrdiff_t p = cf_box_at(&l->box, run->low, j, k);
        memcpy(to.at + p, from.at + p, (size_t)(run->high - run->low) * sizeof(cf_real));
      }
}

void cf_varied_apply(cf_varied *v, const cf_cell x, const cf_cell y) {
  const cf_coupled *l = &v->level[0];
  cf_varied_set_ghosts(v, x);
  CF_PARALLEL_COUPLED (l, w)
    CF_TILE_ROWS (l, w, j, k)
      CF_TILE_RUNS (l, w, run) operate_run(v, run, j, k, x, y);
}

double cf_varied_residual(cf_varied *v, const cf_cell x, const cf_cell b) {
  const cf_varied_sums s = v->apart ? cf_fields_form(v, x, b) : cf_varied_form(v, x, b);
  return s.second > 0 ? sqrt(s.first / s.second) : sqrt(s.first);
}
