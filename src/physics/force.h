/* SPDX-License-Identifier: MIT
 *
 * What pushes a fluid whose density differs a little from place to place (Boussinesq): the acceleration
 *
 *     a = -(sum over the scalars of lift phi) g
 *
 * on faces, phi there the mean of the two cells. lift is the share of its weight that one unit of the scalar takes off the
 * fluid: smoke rises with lift > 0, heavy ink sinks with lift < 0.
 *
 * A layered fluid at rest must stay at rest, and the pressure that does it is known: on an axis whose other axes have no
 * open walls, what the layers have in common is taken off, for it is the gradient of a function of one coordinate
 * (where fluid can pass through both ends of the axis, all but its mean). That part of the pressure, the hydrostatic one,
 * is not in the pressure field then, and round-off in it moves nothing.
 */
#ifndef CF_PHYSICS_FORCE_H
#define CF_PHYSICS_FORCE_H

#include "grid/field.h"
#include "grid/flow_walls.h"
#include "grid/region.h"

typedef struct cf_force cf_force;

/* gravity: g, m/s^2. `walls` must outlive it. CF_NO_MEMORY. */
cf_status cf_force_create(cf_force **f, const cf_flow_walls *walls, const double gravity[3]);
void cf_force_destroy(cf_force *f); /* NULL is fine */

/* Only cells inside it are fluid (NULL: all): others do not count in the layers. It must outlive its use. */
void cf_force_set_region(cf_force *f, const cf_region *region);

/* u += dt a of one scalar. phi's ghosts are written. */
void cf_force_lift(const cf_force *f, double dt, double lift, cf_cell phi, cf_face u);

#endif
