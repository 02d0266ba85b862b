/* SPDX-License-Identifier: MIT */
#include "solve/level.h"

#include <math.h>

#include "grid/sweep.h"
#include "solve/colours.h"

/* What the kernels of a row see: the tables of x as pointers, those of y and z as numbers. */
typedef struct row {
  const cf_level *level;
  const cf_real *x, *b;
  cf_real *out;
  cf_real omega;
  int colour;
} row;

typedef struct couplings {
  const cf_real *lo_x, *hi_x;
  cf_real lo[3], hi[3];
  cf_real alpha;
  ptrdiff_t stride[3];
} couplings;

CF_KERNEL couplings couplings_of(const int dim, const cf_level *l, const ptrdiff_t r) {
  couplings c = {.lo_x = l->axis[0].lo, .hi_x = l->axis[0].hi, .alpha = (cf_real)l->alpha};
  const int at[3] = {0, (int)(r % l->box.n[1]), (int)(r / l->box.n[1])};
  CF_AXIS_LOOP
  for (int a = 0; a < dim; ++a) {
    c.lo[a] = l->axis[a].lo[at[a]];
    c.hi[a] = l->axis[a].hi[at[a]];
    c.stride[a] = l->box.stride[a];
  }
  return c;
}

/* (A x)_p for the i-th cell of a row as differences, which are exact where x is smooth; *diagonal is A's diagonal there. */
CF_KERNEL cf_real apply_at(const int dim, const couplings *c, const cf_real *x, const int i,
                           const ptrdiff_t p, cf_real *diagonal) {
  cf_real sum = 0, off = 0;
  CF_AXIS_LOOP
  for (int a = 0; a < dim; ++a) {
    const cf_real lo = a == 0 ? c->lo_x[i] : c->lo[a], hi = a == 0 ? c->hi_x[i] : c->hi[a];
    sum += lo * (x[p] - x[p - c->stride[a]]) - hi * (x[p + c->stride[a]] - x[p]);
    off += lo + hi;
  }
  *diagonal = c->alpha + off;
  return c->alpha * x[p] + sum;
}

CF_KERNEL void apply_row(const int dim, const int n, const row *w, const ptrdiff_t r) {
  const couplings c = couplings_of(dim, w->level, r);
  const ptrdiff_t start = cf_box_row(&w->level->box, r);
  const cf_real *x = w->x;
  cf_real *out = w->out;
  CF_ROW_LOOP
  for (int i = 0; i < n; ++i) {
    cf_real diagonal;
    out[start + i] = apply_at(dim, &c, x, i, start + i, &diagonal);
  }
}

CF_KERNEL void residual_row(const int dim, const int n, const row *w, const ptrdiff_t r) {
  const couplings c = couplings_of(dim, w->level, r);
  const ptrdiff_t start = cf_box_row(&w->level->box, r);
  const cf_real *x = w->x, *b = w->b;
  cf_real *out = w->out;
  CF_ROW_LOOP
  for (int i = 0; i < n; ++i) {
    cf_real diagonal;
    out[start + i] = b[start + i] - apply_at(dim, &c, x, i, start + i, &diagonal);
  }
}

/* Cells of one colour (parity of i + j + k) are updated in place; their neighbours have the other colour (but for two
 * across the seam of an odd periodic axis, where the other couplings are enough), so rows may run in any order. */
CF_KERNEL void smooth_row(const int dim, const int n, const row *w, const ptrdiff_t r) {
  const couplings c = couplings_of(dim, w->level, r);
  const ptrdiff_t start = cf_box_row(&w->level->box, r);
  const int n1 = w->level->box.n[1];
  const int skip = (int)((r % n1 + r / n1 + w->colour) & 1);
  const cf_real *b = w->b;
  cf_real *x = w->out;
  const cf_real omega = w->omega;
  CF_ROW_LOOP
  for (int i = 0; i < n; ++i) {
    CF_THROWN_AWAY(((i ^ skip) & 1) != 0);
    cf_real diagonal;
    const cf_real residual = b[start + i] - apply_at(dim, &c, x, i, start + i, &diagonal);
    const cf_real inverse = 1 / (diagonal > 0 ? diagonal : 1);
    if (((i ^ skip) & 1) == 0 && diagonal > 0) x[start + i] += omega * (residual * inverse);
  }
}

CF_CLONED(apply_row, const row *, const ptrdiff_t)
CF_CLONED(residual_row, const row *, const ptrdiff_t)
CF_CLONED(smooth_row, const row *, const ptrdiff_t)

static void fill_seams(const cf_level *l, const cf_cell x) {
  if (l->has_seam) cf_halo_fill(&l->box, &l->wrap, 1, -1, x.at);
}

void cf_level_apply(const cf_level *l, const cf_cell x, const cf_cell y) {
  fill_seams(l, x);
  const row w = {.level = l, .x = x.at, .out = y.at};
  CF_PARALLEL_ROWS (&l->box, l->threads, at) apply_row_by_dim(l->box.dim, l->box.n[0], &w, at);
}

void cf_level_residual(const cf_level *l, const cf_cell x, const cf_cell b, const cf_cell r) {
  fill_seams(l, x);
  const row w = {.level = l, .x = x.at, .b = b.at, .out = r.at};
  CF_PARALLEL_ROWS (&l->box, l->threads, at) residual_row_by_dim(l->box.dim, l->box.n[0], &w, at);
}

void cf_level_smooth(const cf_level *l, const cf_cell b, const cf_real omega, const cf_cell x) {
  for (int colour = 0; colour < 2; ++colour) {
    fill_seams(l, x);
    const row w = {l, NULL, b.at, x.at, omega, colour};
    CF_PARALLEL_ROWS (&l->box, l->threads, at) smooth_row_by_dim(l->box.dim, l->box.n[0], &w, at);
  }
}

double cf_level_stiffness(const cf_level *l) {
  double off = 0;
  for (int a = 0; a < l->box.dim; ++a) {
    const int middle = l->axis[a].n / 2;
    off += (double)l->axis[a].lo[middle] + (double)l->axis[a].hi[middle];
  }
  if (l->alpha == 0) return INFINITY;
  return off / l->alpha;
}

/* Widths vary in the last cell of an axis only, but that may be any level's. */
CF_CLONES static double dot_row(const int n, const cf_real *x, const cf_real *y, const double *width) {
  double lane[CF_SUM_LANES] = {0};
  int i = 0;
  for (; i + CF_SUM_LANES <= n; i += CF_SUM_LANES)
    for (int l = 0; l < CF_SUM_LANES; ++l) lane[l] += width[i + l] * ((double)x[i + l] * (double)y[i + l]);
  for (int l = 0; i < n; ++i, ++l) lane[l] += width[i] * ((double)x[i] * (double)y[i]);
  return cf_sum_lanes(lane);
}

CF_CLONES static double weighted_row(const int n, const cf_real *x, const double *width) {
  double lane[CF_SUM_LANES] = {0};
  int i = 0;
  for (; i + CF_SUM_LANES <= n; i += CF_SUM_LANES)
    for (int l = 0; l < CF_SUM_LANES; ++l) lane[l] += width[i + l] * (double)x[i + l];
  for (int l = 0; i < n; ++i, ++l) lane[l] += width[i] * (double)x[i];
  return cf_sum_lanes(lane);
}

static double weighted_sum(const cf_level *l, const cf_real *x, const cf_real *y) {
  CF_PARALLEL_ROWS (&l->box, l->threads, r) {
    const ptrdiff_t p = cf_box_row(&l->box, r);
    const double *width = l->axis[0].width;
    const double area =
        l->axis[1].width[r % l->box.n[1]] * (l->box.dim == 3 ? l->axis[2].width[r / l->box.n[1]] : 1);
    const int n = l->box.n[0];
    l->rows[r] = area * (y != NULL ? dot_row(n, x + p, y + p, width) : weighted_row(n, x + p, width));
  }
  return cf_sum_ordered(l->rows, cf_box_rows(&l->box));
}

double cf_level_dot(const cf_level *l, const cf_cell x, const cf_cell y) {
  return weighted_sum(l, x.at, y.at);
}

double cf_level_sum(const cf_level *l, const cf_cell x) { return weighted_sum(l, x.at, NULL); }
