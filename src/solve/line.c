/* SPDX-License-Identifier: MIT */
#include "solve/line.h"

static int line_axis(const cf_level *l) {
  int axis = 0;
  for (int a = 0; a < l->box.dim; ++a)
    if (l->box.n[a] > 1) axis = a;
  return axis;
}

bool cf_level_is_line(const cf_level *l) {
  int longer = 0;
  for (int a = 0; a < l->box.dim; ++a) longer += l->box.n[a] > 1;
  return longer <= 1;
}

static double coefficient(const cf_level *l, const int a, const int i, const int high, const ptrdiff_t p) {
  const double table = (double)(high ? l->axis[a].hi[i] : l->axis[a].lo[i]);
  return l->variable ? table * (double)l->beta.at[a][high ? p + l->box.stride[a] : p] : table;
}

typedef struct line {
  int n;
  double *lo, *hi, *d; /* couplings to the low and high neighbour, and the diagonal, then the pivots */
} line;

/* Thomas' algorithm in two parts. A pivot that vanishes belongs to a cell without an equation: its x is 0. */
static void factor(const line *t) {
  for (int i = 0; i < t->n; ++i) {
    const double whole = t->d[i];
    if (i > 0 && t->d[i - 1] > 0) t->d[i] -= t->lo[i] * t->hi[i - 1] / t->d[i - 1];
    if (!(t->d[i] > 1e-13 * whole)) t->d[i] = 0;
  }
}

static void substitute(const line *t, double *x) {
  for (int i = 0; i < t->n; ++i) {
    const double sum = x[i] + (i > 0 ? t->lo[i] * x[i - 1] : 0);
    x[i] = t->d[i] > 0 ? sum / t->d[i] : 0;
  }
  for (int i = t->n - 2; i >= 0; --i)
    if (t->d[i] > 0) x[i] += t->hi[i] / t->d[i] * x[i + 1];
}

/* A ring: A = T + u v^T with u = (g, 0 ... 0, -high), v = (1, 0 ... 0, -low/g), where low couples the first cell
 * to the last and high the last to the first. */
static void solve_ring(line *t, double *u, double *x) {
  const int n = t->n;
  const double low = t->lo[0], high = t->hi[n - 1], g = -t->d[0];
  t->d[0] -= g;
  t->d[n - 1] -= low * high / g;
  factor(t);
  for (int i = 0; i < n; ++i) u[i] = i == 0 ? g : i == n - 1 ? -high : 0;
  substitute(t, u);
  substitute(t, x);
  const double share = (x[0] - low / g * x[n - 1]) / (1 + u[0] - low / g * u[n - 1]);
  for (int i = 0; i < n; ++i) x[i] -= share * u[i];
}

/* Known up to a constant: the last cell is set to 0, then the mean. */
static void solve_singular(line *t, const double *width, double *x) {
  double sum = 0, length = 0;
  x[--t->n] = 0;
  factor(t);
  substitute(t, x);
  for (int i = 0; i <= t->n; ++i) sum += width[i] * x[i], length += width[i];
  for (int i = 0; i <= t->n; ++i) x[i] -= sum / length;
}

void cf_level_solve_line(const cf_level *l, const bool singular, const cf_cell b, double *work,
                         const cf_cell x) {
  const int axis = line_axis(l), n = l->box.n[axis];
  const ptrdiff_t step = l->box.stride[axis];
  line t = {n, work, work + n, work + 2 * n};
  double *y = work + 3 * n;
  for (int i = 0; i < n; ++i) {
    const ptrdiff_t p = i * step;
    t.lo[i] = coefficient(l, axis, i, 0, p);
    t.hi[i] = coefficient(l, axis, i, 1, p);
    t.d[i] = (l->variable ? (double)l->alpha_cell.at[p] : l->alpha) + t.lo[i] + t.hi[i];
    for (int a = 0; a < l->box.dim; ++a)
      if (a != axis) t.d[i] += coefficient(l, a, 0, 0, p) + coefficient(l, a, 0, 1, p);
    y[i] = (double)b.at[p];
  }
  if (singular) {
    solve_singular(&t, l->axis[axis].width, y);
  } else if (l->axis[axis].periodic && n > 1 && t.lo[0] > 0) {
    solve_ring(&t, work + 4 * n, y);
  } else {
    factor(&t);
    substitute(&t, y);
  }
  for (int i = 0; i < n; ++i) x.at[i * step] = (cf_real)y[i];
}
