/* SPDX-License-Identifier: MIT
 *
 * Viscosity, with whatever else accelerates the fluid meanwhile:
 *
 *     u_t = nu div grad u + a,      u = the walls' velocity on walls that stick
 *
 * component by component on the faces (for constant nu and a velocity free of divergence the components do not feel
 * each other). SDIRK2 as for diffusion (Alexander 1977): two implicit stages, second order, L-stable. `a` is part of
 * the stages and not of a step before them: at a wall that sticks a pressure gradient and friction balance, and each
 * alone would set the fluid there moving.
 *
 * Each stage is solved for its change, with the normal velocities on closed walls held.
 */
#ifndef CF_PHYSICS_VISCOSITY_H
#define CF_PHYSICS_VISCOSITY_H

#include "grid/field.h"
#include "grid/flow_walls.h"
#include "grid/region.h"
#include "solve/helmholtz.h"

typedef struct cf_viscosity cf_viscosity;

/* nu: m^2/s, > 0. `walls` must outlive it. CF_NO_MEMORY. */
cf_status cf_viscosity_create(cf_viscosity **v, const cf_flow_walls *walls, double nu,
                              const cf_solve_options *o, int levels);
void cf_viscosity_destroy(cf_viscosity *v); /* NULL is fine */

/* From now on only cells inside the region are fluid (NULL: all); others are solid: held, where the fluid sticks to them,
 * or wall, where it slips. Their faces have the velocity of the solid. The region must outlive its use; again whenever
 * it has changed. CF_NO_MEMORY. */
cf_status cf_viscosity_set_region(cf_viscosity *v, const cf_region *region);

/* u over dt with the acceleration a, m/s^2. u's ghosts are written. With a region, known velocities (of walls and solids)
 * must stand in u and do so afterwards. report sums over the solves. */
cf_status cf_viscosity_step(cf_viscosity *v, double dt, cf_face a, cf_face u, cf_solve_report *report);

#endif
