/* SPDX-License-Identifier: MIT
 *
 * Pressure: what makes a velocity free of divergence,
 *
 *     div grad p' = div u/dt,     u <- u - dt grad p',     p <- p + p',
 *
 * with the project's one operator (alpha = 0, beta = 1). p is the kinematic pressure p/rho, m^2/s^2.
 *
 * A step that has already accelerated u by -grad p with the p of the step before asks for the change p' alone, which
 * is small: that makes the step second order in time, and the solve short. The tolerance of the solver is still
 * meant for the whole: |residual| <= tolerance |div u/dt - div grad p|, so a flow that changes slowly
 * needs few cycles. What a solve leaves of the divergence is in the next step's right side: nothing adds up.
 */
#ifndef CF_PHYSICS_PROJECT_H
#define CF_PHYSICS_PROJECT_H

#include "grid/field.h"
#include "grid/flow_walls.h"
#include "grid/region.h"
#include "solve/helmholtz.h"

typedef struct cf_project cf_project;

/* `walls` must outlive it. levels: of multigrid, 0: as needed. spare: a field that it may scribble over during a step, so
 * that it needs none of its own; NULL: there is none. CF_NO_MEMORY. */
cf_status cf_project_create(cf_project **p, const cf_flow_walls *walls, const cf_solve_options *o, int levels,
                            const cf_face *spare);
void cf_project_destroy(cf_project *p); /* NULL is fine */

/* From now on the fluid is in the cells inside this region (NULL: everywhere); others are solid and walls in it. Their
 * faces keep the velocity they have, which must be that of the solid. The region must outlive its use; again whenever
 * it has changed. CF_NO_MEMORY. */
cf_status cf_project_set_region(cf_project *p, cf_region *region);

/* Gives solid cells beside the fluid the mean pressure of their neighbours in it: where a solid moves on, the pressure
 * of what it leaves is not far off. */
void cf_project_fill(const cf_project *p, cf_cell pressure);

/* u += -dt grad p on all faces but those of closed walls and solids. p's ghosts are written. */
void cf_project_push(const cf_project *p, double dt, cf_cell pressure, cf_face u);

/* Makes u free of divergence and adds the pressure that did it. Normal velocities on closed walls stay as they are;
 * where no wall is open they must let out what they let in. report->residual is relative to the whole pressure. */
cf_status cf_project_step(cf_project *p, double dt, cf_cell pressure, cf_face u, cf_solve_report *report);

/* The largest |div u| in the fluid, 1/s. */
double cf_project_divergence(const cf_project *p, cf_face u);

#endif
