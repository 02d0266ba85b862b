/* SPDX-License-Identifier: MIT */
#include "solve/level.h"

#include <math.h>

#include "grid/sweep.h"

/* What the kernels of a row see: the tables of x as pointers, those of y and z as numbers. */
typedef struct row {
  const cf_level *level;
  const cf_real *x, *b;
  cf_real *out;
  cf_real omega;
  int colour;
  bool clashes; /* some cells have neighbours of their own colour */
} row;

typedef struct couplings {
  const cf_real *lo_x, *hi_x;
  cf_real lo[3], hi[3];
  cf_real alpha;
  const cf_real *alpha_cell, *beta[3];
  ptrdiff_t stride[3];
  cf_real clash[3][2]; /* see clash_at */
} couplings;

CF_KERNEL couplings couplings_of(const int dim, const cf_level *l, const ptrdiff_t r) {
  couplings c = {.lo_x = l->axis[0].lo, .hi_x = l->axis[0].hi, .alpha = (cf_real)l->alpha};
  const int at[3] = {0, (int)(r % l->box.n[1]), (int)(r / l->box.n[1])};
  CF_AXIS_LOOP
  for (int a = 0; a < dim; ++a) {
    c.lo[a] = l->axis[a].lo[at[a]];
    c.hi[a] = l->axis[a].hi[at[a]];
    c.beta[a] = l->beta.at[a];
    c.stride[a] = l->box.stride[a];
    const cf_real half = l->axis[a].periodic && l->axis[a].n % 2 == 1 ? (cf_real)0.5 : 0;
    c.clash[a][0] = a == 0 || at[a] == 0 ? half : 0;
    c.clash[a][1] = a == 0 || at[a] == l->axis[a].n - 1 ? half : 0;
  }
  c.alpha_cell = l->alpha_cell.at;
  return c;
}

/* The coupling of cell p (the i-th of its row) to its low and high neighbour along axis a. */
CF_KERNEL cf_real coupling(const int variable, const couplings *c, const int a, const int high, const int i,
                           const ptrdiff_t p) {
  const cf_real table = a == 0 ? (high ? c->hi_x[i] : c->lo_x[i]) : (high ? c->hi[a] : c->lo[a]);
  return variable ? table * c->beta[a][high ? p + c->stride[a] : p] : table;
}

/* (A x)_p as differences, which are exact where x is smooth; *diagonal is A's diagonal there. */
CF_KERNEL cf_real apply_at(const int dim, const int variable, const couplings *c, const cf_real *x,
                           const int i, const ptrdiff_t p, cf_real *diagonal) {
  const cf_real alpha = variable ? c->alpha_cell[p] : c->alpha;
  cf_real sum = 0, off = 0;
  CF_AXIS_LOOP
  for (int a = 0; a < dim; ++a) {
    const cf_real lo = coupling(variable, c, a, 0, i, p), hi = coupling(variable, c, a, 1, i, p);
    sum += lo * (x[p] - x[p - c->stride[a]]) - hi * (x[p + c->stride[a]] - x[p]);
    off += lo + hi;
  }
  *diagonal = alpha + off;
  return alpha * x[p] + sum;
}

CF_KERNEL void apply_row(const int dim, const int variable, const int n, const row *w, const ptrdiff_t r) {
  const couplings c = couplings_of(dim, w->level, r);
  const ptrdiff_t start = cf_box_row(&w->level->box, r);
  const cf_real *x = w->x;
  cf_real *out = w->out;
  CF_ROW_LOOP
  for (int i = 0; i < n; ++i) {
    cf_real diagonal;
    out[start + i] = apply_at(dim, variable, &c, x, i, start + i, &diagonal);
  }
}

CF_KERNEL void residual_row(const int dim, const int variable, const int n, const row *w, const ptrdiff_t r) {
  const couplings c = couplings_of(dim, w->level, r);
  const ptrdiff_t start = cf_box_row(&w->level->box, r);
  const cf_real *x = w->x, *b = w->b;
  cf_real *out = w->out;
  CF_ROW_LOOP
  for (int i = 0; i < n; ++i) {
    cf_real diagonal;
    out[start + i] = b[start + i] - apply_at(dim, variable, &c, x, i, start + i, &diagonal);
  }
}

/* Around an odd periodic axis the first and the last cell are neighbours of one colour, moved at once without
 * seeing each other: where their coupling dominates, that is no smoothing but growth. Half of the coupling added
 * to the diagonal mends it (l1 smoothing: Baker, Falgout, Kolev, Yang 2011). With a constant beta there are
 * always enough other couplings. */
CF_KERNEL cf_real clash_at(const int dim, const int n, const couplings *c, const int i, const ptrdiff_t p) {
  cf_real sum = 0;
  CF_AXIS_LOOP
  for (int a = 0; a < dim; ++a) {
    const cf_real lo = a == 0 && i != 0 ? 0 : c->clash[a][0], hi = a == 0 && i != n - 1 ? 0 : c->clash[a][1];
    sum += lo * coupling(1, c, a, 0, i, p) + hi * coupling(1, c, a, 1, i, p);
  }
  return sum;
}

/* Cells of one colour (parity of i + j + k) are updated in place; their neighbours have the other colour, so
 * rows may run in any order. */
CF_KERNEL void smooth_cells(const int dim, const int variable, const int clashes, const int n, const row *w,
                            const ptrdiff_t r) {
  const couplings c = couplings_of(dim, w->level, r);
  const ptrdiff_t start = cf_box_row(&w->level->box, r);
  const int n1 = w->level->box.n[1];
  const int skip = (int)((r % n1 + r / n1 + w->colour) & 1);
  const cf_real *b = w->b;
  cf_real *x = w->out;
  const cf_real omega = w->omega;
  CF_ROW_LOOP
  for (int i = 0; i < n; ++i) {
    cf_real diagonal;
    const cf_real residual = b[start + i] - apply_at(dim, variable, &c, x, i, start + i, &diagonal);
    if (clashes) diagonal += clash_at(dim, n, &c, i, start + i);
    const cf_real inverse = 1 / (diagonal > 0 ? diagonal : 1);
    const cf_real share = variable ? 1 - c.alpha_cell[start + i] * inverse : 0;
    const cf_real factor = variable ? 1 + (omega - 1) * share * share : omega;
    if (((i ^ skip) & 1) == 0 && diagonal > 0) x[start + i] += factor * (residual * inverse);
  }
}

CF_KERNEL void smooth_row(const int dim, const int variable, const int n, const row *w, const ptrdiff_t r) {
  if (variable && w->clashes)
    smooth_cells(dim, variable, 1, n, w, r);
  else
    smooth_cells(dim, variable, 0, n, w, r);
}

CF_CLONED_FORMS(apply_row, const row *, const ptrdiff_t)
CF_CLONED_FORMS(residual_row, const row *, const ptrdiff_t)
CF_CLONED_FORMS(smooth_row, const row *, const ptrdiff_t)

static void fill_seams(const cf_level *l, const cf_cell x) {
  if (l->has_seam) cf_halo_fill(&l->box, &l->wrap, 1, -1, x.at);
}

void cf_level_apply(const cf_level *l, const cf_cell x, const cf_cell y) {
  fill_seams(l, x);
  const row w = {.level = l, .x = x.at, .out = y.at};
  CF_PARALLEL_ROWS (&l->box, l->threads, at) apply_row_by_form(l->box.dim, l->variable, l->box.n[0], &w, at);
}

void cf_level_residual(const cf_level *l, const cf_cell x, const cf_cell b, const cf_cell r) {
  fill_seams(l, x);
  const row w = {.level = l, .x = x.at, .b = b.at, .out = r.at};
  CF_PARALLEL_ROWS (&l->box, l->threads, at)
    residual_row_by_form(l->box.dim, l->variable, l->box.n[0], &w, at);
}

static bool has_odd_ring(const cf_level *l) {
  for (int a = 0; a < l->box.dim; ++a)
    if (l->axis[a].periodic && l->axis[a].n % 2 == 1) return true;
  return false;
}

void cf_level_smooth(const cf_level *l, const cf_cell b, const cf_real omega, const cf_cell x) {
  for (int colour = 0; colour < 2; ++colour) {
    fill_seams(l, x);
    const row w = {l, NULL, b.at, x.at, omega, colour, has_odd_ring(l)};
    CF_PARALLEL_ROWS (&l->box, l->threads, at)
      smooth_row_by_form(l->box.dim, l->variable, l->box.n[0], &w, at);
  }
}

double cf_level_stiffness(const cf_level *l) {
  double off = 0;
  for (int a = 0; a < l->box.dim; ++a) {
    const int middle = l->axis[a].n / 2;
    off += (double)l->axis[a].lo[middle] + (double)l->axis[a].hi[middle];
  }
  if (l->variable || l->alpha == 0) return INFINITY;
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
