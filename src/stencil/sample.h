/* SPDX-License-Identifier: MIT
 *
 * Linear interpolation of a cell field or of one face component at any point of the box.
 *
 * A point on a wall lies half a cell outside the outermost cell centres, so one layer of ghosts is read and
 * must be filled (grid/halo.h: wrap or copy). Points outside the box count as the nearest point of the box:
 * nothing is ever read beyond that layer, whatever the point, NaN included.
 */
#ifndef CF_STENCIL_SAMPLE_H
#define CF_STENCIL_SAMPLE_H

#include "grid/field.h"
#include "grid/grid.h"

/* `at` counts cells from the box's lower corner. component: CF_CENTRES, or the axis on whose faces f lies. */
static inline cf_real cf_sample_in_cells(const cf_box *b, const int component, const cf_real *f,
                                         const double at[3]) {
  const int dim = b->dim;
  cf_real weight[3] = {0};
  ptrdiff_t p = 0;
  for (int a = 0; a < dim; ++a) {
    const double inside = at[a] > 0 ? (at[a] < b->n[a] ? at[a] : b->n[a]) : 0;
    const double place = inside + (a == component ? 0.0 : 0.5); /* from the outermost value, >= 0 */
    const int most = a == component ? b->n[a] - 1 : b->n[a];
    const int i = (int)place < most ? (int)place : most;
    weight[a] = (cf_real)(place - i);
    p += (a == component ? i : i - 1) * b->stride[a];
  }
  cf_real plane[2] = {0};
  for (int k = 0; k < dim - 1; ++k) { /* one plane in 2D, two in 3D */
    const cf_real *low = f + p + k * b->stride[2], *high = low + b->stride[1];
    const cf_real v0 = low[0] + weight[0] * (low[1] - low[0]);
    const cf_real v1 = high[0] + weight[0] * (high[1] - high[0]);
    plane[k] = v0 + weight[1] * (v1 - v0);
  }
  return dim == 3 ? plane[0] + weight[2] * (plane[1] - plane[0]) : plane[0];
}

/* The value at the place x (dim coordinates, m). */
cf_real cf_sample(const cf_grid *g, int component, const cf_real *f, const double *x);

/* The velocity, or any face field, at the place x: dim components, each from its own faces. */
void cf_sample_face(const cf_grid *g, cf_face u, const double *x, cf_real *v);

/* n values at the places (x[i], y[i], z[i]); z may be NULL in 2D. */
void cf_sample_row(const cf_grid *g, int component, const cf_real *f, int n, const double *const x[3],
                   cf_real *out);

#endif
