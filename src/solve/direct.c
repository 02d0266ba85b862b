/* SPDX-License-Identifier: MIT */
#include "solve/direct.h"

#include <string.h>

#include "base/mem.h"

#define STEP CF_FEW_CELLS

static double coefficient(const cf_level *l, const int a, const int i, const int high) {
  return (double)(high ? l->axis[a].hi[i] : l->axis[a].lo[i]);
}

/* The cell next to index i of an axis; -1 where there is none (a wall, or the cell itself). */
static int neighbour(const cf_axis *axis, const int i, const int high) {
  const int next = high ? i + 1 : i - 1;
  if (next >= 0 && next < axis->n) return next;
  return axis->periodic ? (high ? 0 : axis->n - 1) : -1;
}

static double volume_at(const cf_level *l, const int at[3]) {
  double v = 1;
  for (int a = 0; a < l->box.dim; ++a) v *= l->axis[a].width[at[a]];
  return v;
}

/* --- few cells -------------------------------------------------------------------------------------------- */

cf_status cf_direct_create(cf_direct *d) {
  *d = (cf_direct){0};
  CF_TRY(CF_NEW(&d->coupling, STEP * STEP));
  CF_TRY(CF_NEW(&d->surplus, STEP));
  CF_TRY(CF_NEW(&d->pivot, STEP));
  CF_TRY(CF_NEW(&d->volume, STEP));
  return CF_NEW(&d->solution, STEP);
}

void cf_direct_destroy(cf_direct *d) {
  cf_free(d->coupling);
  cf_free(d->surplus);
  cf_free(d->pivot);
  cf_free(d->volume);
  cf_free(d->solution);
  *d = (cf_direct){0};
}

bool cf_level_is_few(const cf_level *l) { return cf_box_cells(&l->box) <= CF_FEW_CELLS; }

static int number_of(const cf_level *l, const int at[3]) {
  return at[0] + l->box.n[0] * (at[1] + l->box.n[1] * at[2]);
}

static ptrdiff_t place_of(const cf_level *l, const int number) {
  return cf_box_row(&l->box, number / l->box.n[0]) + number % l->box.n[0];
}

/* A row of the matrix times the cell's volume, which makes it symmetric. */
static void gather_cell(const cf_level *l, const int at[3], cf_direct *d) {
  const int me = number_of(l, at);
  const double v = volume_at(l, at);
  d->volume[me] = v;
  d->surplus[me] = v * l->alpha;
  for (int a = 0; a < l->box.dim; ++a)
    for (int high = 0; high < 2; ++high) {
      const double c = v * coefficient(l, a, at[a], high);
      int other[3] = {at[0], at[1], at[2]};
      other[a] = neighbour(&l->axis[a], at[a], high);
      if (other[a] < 0)
        d->surplus[me] += c;
      else
        d->coupling[me * STEP + number_of(l, other)] += c;
    }
}

/* Cell j leaves: its neighbours are coupled to each other, and its surplus is shared among them. */
static void eliminate(const int n, const int j, cf_direct *d) {
  double *row = d->coupling + j * STEP;
  double sum = d->surplus[j];
  for (int k = j + 1; k < n; ++k) sum += row[k];
  d->pivot[j] = sum;
  if (sum == 0) return;
  for (int i = j + 1; i < n; ++i) {
    const double share = row[i] / sum;
    if (share == 0) continue;
    d->surplus[i] += share * d->surplus[j];
    for (int k = j + 1; k < n; ++k)
      if (k != i) d->coupling[i * STEP + k] += share * row[k];
  }
}

void cf_direct_factor(const cf_level *l, cf_direct *d) {
  const int n = (int)cf_box_cells(&l->box);
  memset(d->coupling, 0, STEP * STEP * sizeof *d->coupling);
  int at[3];
  for (at[2] = 0; at[2] < l->box.n[2]; ++at[2])
    for (at[1] = 0; at[1] < l->box.n[1]; ++at[1])
      for (at[0] = 0; at[0] < l->box.n[0]; ++at[0]) gather_cell(l, at, d);
  for (int j = 0; j < n; ++j) eliminate(n, j, d);
}

void cf_direct_solve(const cf_level *l, const cf_direct *d, const cf_cell b, const cf_cell x) {
  const int n = (int)cf_box_cells(&l->box);
  double *y = d->solution;
  for (int i = 0; i < n; ++i) y[i] = d->volume[i] * (double)b.at[place_of(l, i)];
  for (int j = 0; j < n; ++j) {
    y[j] = d->pivot[j] > 0 ? y[j] / d->pivot[j] : 0;
    for (int k = j + 1; k < n; ++k) y[k] += d->coupling[j * STEP + k] * y[j];
  }
  for (int j = n - 1; j >= 0; --j) {
    double sum = 0;
    for (int k = j + 1; k < n; ++k) sum += d->coupling[j * STEP + k] * y[k];
    if (d->pivot[j] > 0) y[j] += sum / d->pivot[j];
  }
  for (int i = 0; i < n; ++i) x.at[place_of(l, i)] = (cf_real)y[i];
}

/* --- a line ----------------------------------------------------------------------------------------------- */

bool cf_level_is_line(const cf_level *l) {
  int longer = 0;
  for (int a = 0; a < l->box.dim; ++a) longer += l->box.n[a] > 1;
  return longer <= 1;
}

static int line_axis(const cf_level *l) {
  int axis = 0;
  for (int a = 0; a < l->box.dim; ++a)
    if (l->box.n[a] > 1) axis = a;
  return axis;
}

typedef struct line {
  int n;
  double *next, *last; /* couplings to the next cell, and to the last one (of a ring: what closes it) */
  double *s, *d, *y;   /* surplus, pivot; right side and solution */
} line;

static void gather_line(const cf_level *l, const int axis, const cf_cell b, const line *t) {
  const cf_axis *x = &l->axis[axis];
  int at[3] = {0, 0, 0};
  for (int i = 0; i < t->n; ++i) {
    const ptrdiff_t p = i * l->box.stride[axis];
    at[axis] = i;
    const double v = volume_at(l, at);
    t->y[i] = v * (double)b.at[p];
    t->s[i] = l->alpha;
    for (int a = 0; a < l->box.dim; ++a)
      for (int high = 0; high < 2; ++high)
        if (neighbour(&l->axis[a], at[a], high) < 0) t->s[i] += coefficient(l, a, at[a], high);
    t->s[i] *= v;
    t->next[i] = i + 1 < t->n ? v * coefficient(l, axis, i, 1) : 0;
    t->last[i] = i == 0 && neighbour(x, 0, 0) >= 0 ? v * coefficient(l, axis, 0, 0) : 0;
  }
}

/* Cell i leaves: the next cell takes over its coupling to the last. */
static void solve_ring(const line *t) {
  const int end = t->n - 1;
  for (int i = 0; i < end; ++i) {
    t->d[i] = t->s[i] + t->next[i] + t->last[i];
    if (t->d[i] == 0) continue;
    const double on = t->next[i] / t->d[i], over = t->last[i] / t->d[i];
    t->s[i + 1] += on * t->s[i];
    t->y[i + 1] += on * t->y[i];
    t->s[end] += over * t->s[i];
    t->y[end] += over * t->y[i];
    if (i + 1 < end) t->last[i + 1] += on * t->last[i];
  }
  t->d[end] = t->s[end];
  t->y[end] = t->d[end] > 0 ? t->y[end] / t->d[end] : 0;
  for (int i = end - 1; i >= 0; --i)
    t->y[i] = t->d[i] > 0 ? (t->y[i] + t->next[i] * t->y[i + 1] + t->last[i] * t->y[end]) / t->d[i] : 0;
}

void cf_level_solve_line(const cf_level *l, const cf_cell b, double *work, const cf_cell x) {
  const int axis = line_axis(l), n = l->box.n[axis];
  const line t = {n, work, work + n, work + 2 * n, work + 3 * n, work + 4 * n};
  gather_line(l, axis, b, &t);
  solve_ring(&t);
  for (int i = 0; i < n; ++i) x.at[i * l->box.stride[axis]] = (cf_real)t.y[i];
}
