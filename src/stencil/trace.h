/* SPDX-License-Identifier: MIT
 *
 * Semi-Lagrangian moves: what is at a point after dt was at x0 = x - dt u(x - dt/2 u(x)), and is interpolated
 * there: linearly (Courant, Isaacson, Rees 1952; Stam 1999), bounded for any dt and smearing, or cubically,
 * much sharper and with overshoots at jumps. Neither keeps a sum.
 *
 * A path that leaves the box through a wall finds there the value that flows in, if the wall has one, and
 * else the field's own value at the wall.
 */
#ifndef CF_STENCIL_TRACE_H
#define CF_STENCIL_TRACE_H

#include <stdbool.h>

#include "grid/field.h"
#include "grid/grid.h"

typedef struct cf_trace {
  const cf_grid *grid;
  int component; /* CF_CENTRES, or the axis on whose faces the field lies */
  int count[3];  /* volumes an axis */
  double dt;
  cf_face u;    /* with one layer of ghosts, corners included */
  bool wrap[3]; /* axes that are periodic */
  const double
      *inflow[3][2]; /* values of the walls' cells, the lower of the other axes fastest; NULL: none */
  bool cubic;
  const cf_real *from; /* with one layer of ghosts, two if cubic */
  cf_real *to;         /* another field */
} cf_trace;

void cf_trace_run(const cf_trace *t);

#endif
