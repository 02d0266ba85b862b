/* SPDX-License-Identifier: MIT
 *
 * The values that a scene holds on walls, sampled at the centres of the wall faces at one time, and the ghost
 * layer that puts them there: with ghost = 2 phi_wall - phi the mean of the two cells is the wall's value and
 * their difference over h its gradient, so the faces of a wall need no kernel of their own.
 */
#ifndef CF_GRID_WALL_H
#define CF_GRID_WALL_H

#include "base/walls.h"
#include "grid/field.h"
#include "grid/grid.h"

typedef struct cf_wall_values {
  const cf_grid *grid;
  cf_walls walls;
  double *at[3][2]; /* [axis][side]: n_b * n_c values, b and c the other axes, b fastest; NULL: not held */
  bool known;       /* sampled at least once; again only where the functions depend on t */
} cf_wall_values;

/* CF_NO_MEMORY. */
cf_status cf_wall_values_create(cf_wall_values *v, const cf_grid *g, const cf_walls *walls);
void cf_wall_values_destroy(cf_wall_values *v); /* a zeroed one is fine */

/* Not for concurrent use on one expression. */
void cf_wall_values_sample(cf_wall_values *v, double t);

/* One cell layer along the wall: index of the cell of wall face (b, c), and of its ghost. */
typedef struct cf_wall_side {
  int axis, side, b, c, n_b, n_c;
  ptrdiff_t outward; /* from the cell to its ghost */
} cf_wall_side;
cf_wall_side cf_wall_side_of(const cf_box *box, int axis, int side);
static inline ptrdiff_t cf_wall_cell(const cf_box *box, const cf_wall_side *w, const int i_b, const int i_c) {
  return i_b * box->stride[w->b] + i_c * box->stride[w->c] +
         (w->side == 0 ? 0 : (box->n[w->axis] - 1) * box->stride[w->axis]);
}

/* Fills one layer of ghosts of a scalar: wrapped on periodic walls, mirrored on insulated ones, 2 phi_wall - phi
 * on held ones. Corners are not filled. */
void cf_wall_ghosts(const cf_wall_values *v, cf_cell phi);

#endif
