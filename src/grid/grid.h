/* SPDX-License-Identifier: MIT
 *
 * Places on a cf_grid (cattaneo.h: a box of cells in space), and functions sampled there.
 */
#ifndef CF_GRID_GRID_H
#define CF_GRID_GRID_H

#include "base/fn.h"
#include "grid/box.h"

/* Ghost cells that every field of a model carries: what the widest stencil (PPM, WENO5) reaches. */
#define CF_HALO 3

/* The volume of a cell, h^dim. */
double cf_grid_volume(const cf_grid *g);

/* The area of a face, h^(dim-1). */
double cf_grid_area(const cf_grid *g);

/* The place of point `i` along axis a: a cell's centre (staggered = 0) or its low face (staggered = 1). */
static inline double cf_grid_place(const cf_grid *g, const int a, const int i, const int staggered) {
  return g->origin[a] + (i + (staggered ? 0.0 : 0.5)) * g->h;
}

/* f[p] = W(centre of cell p, t) for every cell; with axis 0..2 the low faces of that axis, the high wall's
 * faces included. CF_NO_MEMORY: the row buffers could not be had. Not for concurrent use on one expression. */
cf_status cf_grid_sample(const cf_grid *g, const cf_fn *w, int axis, double t, cf_real *f);
#define CF_CENTRES (-1)

#endif
