/* SPDX-License-Identifier: MIT */
#include "stencil/sample.h"

cf_real cf_sample(const cf_grid *g, const int component, const cf_real *f, const double *x) {
  double at[3] = {0};
  for (int a = 0; a < g->box.dim; ++a) at[a] = (x[a] - g->origin[a]) / g->h;
  return cf_sample_in_cells(&g->box, component, f, at);
}

void cf_sample_face(const cf_grid *g, const cf_face u, const double *x, cf_real *v) {
  for (int a = 0; a < g->box.dim; ++a) v[a] = cf_sample(g, a, u.at[a], x);
}

void cf_sample_row(const cf_grid *g, const int component, const cf_real *f, const int n,
                   const double *const x[3], cf_real *out) {
  for (int i = 0; i < n; ++i) {
    const double place[3] = {x[0][i], x[1][i], g->box.dim == 3 ? x[2][i] : 0};
    out[i] = cf_sample(g, component, f, place);
  }
}
