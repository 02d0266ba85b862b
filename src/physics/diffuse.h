/* SPDX-License-Identifier: MIT
 *
 * Cattaneo-Fourier diffusion of one scalar in a medium at rest: cf_diffuse_* and the ledger of cattaneo.h, with
 * the equations and schemes; and what models use beside that. (What moves is physics/advect.h's.)
 */
#ifndef CF_PHYSICS_DIFFUSE_H
#define CF_PHYSICS_DIFFUSE_H

#include "base/fn.h"
#include "base/walls.h"
#include "grid/field.h"
#include "grid/grid.h"
#include "solve/helmholtz.h"

/* As cf_diffuse_step with s = div q_C in cells in place of q: the same phi to round-off with one array of memory
 * in place of dim. s belongs to the walls that the object was made with (their faces are part of the divergence).
 * CF_BAD_ARGUMENT: a source acts on q, a wall radiates, `positive`, or the scheme is CF_DIFFUSE_WAVE: these need
 * q. What passes through walls is counted as one amount. */
cf_status cf_diffuse_step_scalar(cf_diffuse *d, double t, double dt, cf_cell phi, cf_cell s,
                                 cf_ledger *ledger, cf_solve_report *report);

/* The medium carries s out through walls that are insulated for diffusion: then its integral is not 0, and is what
 * leaves; the ledger counts it. */
void cf_diffuse_let_through(cf_diffuse *d);

/* With a region: phi in cells that are not inside as a step leaves it (walls 0, held cells their value), q = 0 on closed
 * faces; for whoever has moved them. Without one nothing is done. */
void cf_diffuse_set_outside(const cf_diffuse *d, cf_cell phi);
void cf_diffuse_close_faces(const cf_diffuse *d, cf_face q);

/* Integral of C phi over the cells that are not inside. */
double cf_diffuse_sum_outside(const cf_diffuse *d, cf_cell phi);

/* Explicit substeps that a step of dt takes; 1 for implicit schemes. */
double cf_diffuse_substeps(const cf_diffuse *d, double dt);

#endif
