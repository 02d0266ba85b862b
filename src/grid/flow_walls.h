/* SPDX-License-Identifier: MIT
 *
 * What the walls of a box do to a velocity on its faces:
 *
 *     closed    the normal velocity is given, 0 where nothing else is said (an inlet is a closed wall with a normal
 *               velocity); along the wall the fluid slips, or, where the wall `sticks`, has the given velocity too
 *     open      pressure 0; the fluid comes and goes, and what comes is at rest outside
 *     periodic  the opposite wall is the neighbour
 *
 * For the pressure a closed wall is an insulated one, an open one holds it at 0.
 */
#ifndef CF_GRID_FLOW_WALLS_H
#define CF_GRID_FLOW_WALLS_H

#include <stdbool.h>

#include "base/walls.h"
#include "grid/field.h"
#include "grid/grid.h"

typedef enum cf_flow_wall { CF_FLOW_CLOSED, CF_FLOW_OPEN, CF_FLOW_PERIODIC } cf_flow_wall;

typedef struct cf_flow_walls {
  const cf_grid *grid;
  cf_flow_wall kind[3][2];
  bool sticks[3][2];
  bool lets_in[3][2]; /* closed, with a normal velocity that is not 0 everywhere */
  /* [axis][side][component]: velocities, one for each volume of the component that lies at the wall (its faces), the
   * lower of the other axes fastest; zero at first. Normal ones count on closed walls, tangential ones where they
   * stick or let in. */
  double *value[3][2][3];
} cf_flow_walls;

/* Walls of the kinds given, all velocities 0. CF_NO_MEMORY. */
cf_status cf_flow_walls_create(cf_flow_walls *w, const cf_grid *g, cf_flow_wall kind[3][2]);
void cf_flow_walls_destroy(cf_flow_walls *w); /* a zeroed one is fine */

/* Volumes of component c (CF_CENTRES: cells) along the axis: cells, and one more on its own axis unless that wraps. */
static inline int cf_flow_count(const cf_flow_walls *w, const int axis, const int c) {
  return w->grid->box.n[axis] + (axis == c && w->kind[axis][0] != CF_FLOW_PERIODIC ? 1 : 0);
}

/* What the pressure meets. */
cf_walls cf_flow_walls_of_pressure(const cf_flow_walls *w);

/* The given normal velocity on the faces of closed walls; the last faces of periodic axes become the first. */
void cf_flow_walls_hold(const cf_flow_walls *w, cf_face u);

/* One layer of ghosts of component c, edges not filled: what a stencil needs for the given velocity on walls that
 * stick, mirrored on those that slip, copied on open ones. */
void cf_flow_walls_ghosts(const cf_flow_walls *w, int c, cf_real *u);

/* What the normal velocities of closed walls carry in, m^dim/s, and the same with all amounts positive. */
double cf_flow_walls_inflow(const cf_flow_walls *w, double *gross);

#endif
