/* SPDX-License-Identifier: MIT
 *
 * Cubic interpolation of a cell field or of one face component at any point of the box: Lagrange's polynomial
 * through the four nearest values of each axis, exact for cubics. It overshoots at jumps by some per cent.
 *
 * As with linear interpolation (stencil/sample.h) points outside the box count as the nearest point of the box.
 * Two layers of ghosts are read and must be filled, corners included.
 */
#ifndef CF_STENCIL_CUBIC_H
#define CF_STENCIL_CUBIC_H

#include "grid/box.h"

/* Weights of the values at -1, 0, 1, 2 for the place 0 <= x <= 1. */
static inline void cf_cubic_weights(const double x, double w[4]) {
  w[0] = -x * (x - 1) * (x - 2) / 6;
  w[1] = (x + 1) * (x - 1) * (x - 2) / 2;
  w[2] = -(x + 1) * x * (x - 2) / 2;
  w[3] = (x + 1) * x * (x - 1) / 6;
}

/* `at` counts cells from the box's lower corner. component: CF_CENTRES, or the axis on whose faces f lies. */
static inline cf_real cf_cubic_in_cells(const cf_box *b, const int component, const cf_real *f,
                                        const double at[3]) {
  double w[3][4] = {{0}};
  ptrdiff_t p = 0;
  for (int a = 0; a < b->dim; ++a) {
    const double inside = at[a] > 0 ? (at[a] < b->n[a] ? at[a] : b->n[a]) : 0;
    const double place = inside + (a == component ? 0.0 : 0.5); /* from the outermost value, >= 0 */
    const int most = a == component ? b->n[a] - 1 : b->n[a];
    const int i = (int)place < most ? (int)place : most;
    cf_cubic_weights(place - i, w[a]);
    p += ((a == component ? i : i - 1) - 1) * b->stride[a];
  }
  double sum = 0;
  for (int k = 0; k < (b->dim == 3 ? 4 : 1); ++k) {
    double plane = 0;
    for (int j = 0; j < 4; ++j) {
      const cf_real *row = f + p + j * b->stride[1] + k * b->stride[2];
      double line = 0;
      for (int i = 0; i < 4; ++i) line += w[0][i] * (double)row[i];
      plane += w[1][j] * line;
    }
    sum += b->dim == 3 ? w[2][k] * plane : plane;
  }
  return (cf_real)sum;
}

#endif
