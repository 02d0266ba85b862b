/* SPDX-License-Identifier: MIT
 *
 * A given velocity led around obstacles. A scene may say `velocity: [1, 0]` and put a sphere into it; what passes the
 * sphere's surface then is taken out by the gradient of a potential,
 *
 *     u = u_given - grad p,    div grad p = div u_there - div u_given in all free cells,
 *
 * where u_there is u_given with the obstacles' own velocities on their faces. What u_given gains or loses in a free cell
 * stays as it is; around a sphere in a uniform wind this is potential flow. On the walls of the box u stays as given.
 */
#ifndef CF_MODEL_DETOUR_H
#define CF_MODEL_DETOUR_H

#include "model/obstacles.h"
#include "solve/helmholtz.h"

typedef struct cf_detour {
  const cf_obstacles *obstacles;
  const cf_grid *grid;
  bool wraps[3];
  cf_region *solid; /* the owner's: every obstacle a wall */
  cf_helmholtz *A;
  cf_cell p, b;
  bool set;     /* the operator is that of the region */
  double stuck; /* of what had to be led around, the share that had no way out: it piles up */
} cf_detour;

/* `walls` are the domain's; the region must be kept up to date (and `set` cleared when it changes). CF_NO_MEMORY. */
cf_status cf_detour_create(cf_detour *d, const cf_obstacles *o, const cf_walls *walls, cf_region *solid);
void cf_detour_destroy(cf_detour *d); /* a zeroed one is fine */

/* u: given, on faces; closed on insulated walls already. CF_NOT_FINITE. */
cf_status cf_detour_make(cf_detour *d, cf_face u, cf_solve_report *report);

#endif
