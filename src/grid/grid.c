/* SPDX-License-Identifier: MIT */
#include "grid/grid.h"

#include <math.h>

#include "base/mem.h"

cf_status cf_grid_init(cf_grid *g, const int dim, const int *cells, const double h, const double *origin) {
  *g = (cf_grid){.h = h, .threads = 1};
  if (!(h > 0) || !isfinite(h)) return cf_fail(CF_BAD_ARGUMENT, "cell width h = %g m: must be positive", h);
  const int n[3] = {cells[0], cells[1], dim == 3 ? cells[2] : 1};
  for (int a = 0; a < CF_MIN(dim, 3); ++a) g->origin[a] = origin != NULL ? origin[a] : 0;
  return cf_box_init(&g->box, dim, n, CF_HALO);
}

double cf_grid_volume(const cf_grid *g) { return g->box.dim == 3 ? g->h * g->h * g->h : g->h * g->h; }

double cf_grid_area(const cf_grid *g) { return g->box.dim == 3 ? g->h * g->h : g->h; }

cf_status cf_grid_sample(const cf_grid *g, const cf_fn *w, const int axis, const double t, cf_real *f) {
  const cf_box *b = &g->box;
  int count[3];
  for (int a = 0; a < 3; ++a) count[a] = b->n[a] + (a == axis ? 1 : 0);
  const int n = count[0];
  double *x, *y, *z, *value;
  CF_TRY(CF_NEW(&x, 4 * (size_t)n));
  y = x + n, z = y + n, value = z + n;
  for (int i = 0; i < n; ++i) x[i] = cf_grid_place(g, 0, i, axis == 0);
  for (int k = 0; k < count[2]; ++k)
    for (int j = 0; j < count[1]; ++j) {
      for (int i = 0; i < n; ++i) {
        y[i] = cf_grid_place(g, 1, j, axis == 1);
        z[i] = b->dim == 3 ? cf_grid_place(g, 2, k, axis == 2) : 0;
      }
      cf_fn_row(w, n, x, y, z, t, value);
      cf_real *row = f + cf_box_at(b, 0, j, k);
      for (int i = 0; i < n; ++i) row[i] = (cf_real)value[i];
    }
  cf_free(x);
  return CF_OK;
}
