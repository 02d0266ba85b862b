/* SPDX-License-Identifier: MIT */
#include "stencil/trace.h"

#include <math.h>

#include "grid/sweep.h"
#include "stencil/cubic.h"
#include "stencil/sample.h"

/* x + dt u(at), in cells; brought back into the box where the axis wraps. */
static void follow(const cf_trace *t, const double x[3], const double at[3], const double dt, double to[3]) {
  const cf_box *b = &t->grid->box;
  for (int a = 0; a < b->dim; ++a) {
    const double u = (double)cf_sample_in_cells(b, a, t->u.at[a], at);
    to[a] = x[a] + dt * u / t->grid->h;
    if (t->wrap[a]) to[a] -= b->n[a] * floor(to[a] / b->n[a]);
  }
}

static int cell_of(const double at, const int n) { return at > 0 ? (at < n ? (int)at : n - 1) : 0; }

/* The value that flows in where `at` lies beyond a wall that has one; false: no such wall. */
static bool comes_in(const cf_trace *t, const double at[3], cf_real *value) {
  const cf_box *b = &t->grid->box;
  for (int a = 0; a < b->dim; ++a) {
    const int side = at[a] < 0 ? 0 : at[a] > b->n[a] ? 1 : -1;
    if (side < 0 || t->inflow[a][side] == NULL) continue;
    const int low = a == 0 ? 1 : 0, high = a == 2 ? 1 : 2;
    const ptrdiff_t at_wall =
        cell_of(at[low], b->n[low]) + (ptrdiff_t)b->n[low] * cell_of(at[high], b->n[high]);
    *value = (cf_real)t->inflow[a][side][at_wall];
    return true;
  }
  return false;
}

static void trace_row(const cf_trace *t, const int j, const int k) {
  const cf_box *b = &t->grid->box;
  cf_real *to = t->to + cf_box_at(b, 0, j, k);
  for (int i = 0; i < t->count[0]; ++i) {
    const int index[3] = {i, j, k};
    double x[3] = {0}, middle[3] = {0}, start[3] = {0};
    for (int a = 0; a < b->dim; ++a) x[a] = index[a] + (a == t->component ? 0.0 : 0.5);
    follow(t, x, x, -t->dt / 2, middle);
    follow(t, x, middle, -t->dt, start);
    if (comes_in(t, start, &to[i])) continue;
    to[i] = t->cubic ? cf_cubic_in_cells(b, t->component, t->from, start)
                     : cf_sample_in_cells(b, t->component, t->from, start);
  }
}

void cf_trace_run(const cf_trace *t) {
  const ptrdiff_t rows = (ptrdiff_t)t->count[1] * t->count[2];
#pragma omp parallel for schedule(static) num_threads(cf_sweep_threads(&t->grid->box, t->grid->threads))
  for (ptrdiff_t r = 0; r < rows; ++r) trace_row(t, (int)(r % t->count[1]), (int)(r / t->count[1]));
}
