/* SPDX-License-Identifier: MIT
 *
 * What a moving medium carries along: scalars in cells, phi_t + div(u phi) = 0, and fluxes on faces.
 *
 * The default scheme goes one axis at a time with a piecewise parabola a cell (Colella, Woodward 1984) on a
 * pseudo-density: rho is 1 before the first sweep and loses div(u) axis by axis, so each new value is an
 * average of old ones. That gives, for one step: mass       exact to round-off, through walls as well
 * (cf_through) bounds     no new extrema beyond those of the 3^dim block around, for any u that is discretely
 * free of divergence constants  stay constant, for such a u linearity  A(a f + b) = a A(f) + b to round-off
 *   order      2 and a bit on smooth fields; extrema are clipped
 * The three last as well as dt div(u). It needs K <= 1, where with c = u dt/h on the faces of a cell
 *   K = max over cells and d of max(c_d+, 0) + max(-c_d-, 0) + sum over e != d of max(c_e+ - c_e-, 0)
 * and takes as many substeps as keep K <= 0.9. The order of the axes is reversed every substep: with a fixed
 * order the scheme is of first order. Which order comes next is state (cf_advect_parity).
 *
 * The other scheme, CF_ADVECT_LINEAR, is the paper's: trace back over dt with a midpoint step, interpolate
 * linearly. One step for any dt, bounded, strongly smearing, no promise about mass.
 *
 * How to use it:
 *
 *     cf_advect_set_velocity(a, u, walls);          // whenever u has changed
 *     cf_advect_begin(a, t, dt);                    // once a step (or half step)
 *     cf_advect_cell(a, walls, phi, &through);      // any number of fields over that same step
 *     cf_advect_face(a, walls, rate, q);
 */
#ifndef CF_PHYSICS_ADVECT_H
#define CF_PHYSICS_ADVECT_H

#include <stdint.h>

#include "base/walls.h"
#include "grid/field.h"
#include "grid/grid.h"

typedef enum cf_advect_scheme { CF_ADVECT_PPM, CF_ADVECT_LINEAR } cf_advect_scheme;

/* What the time derivative of a flux means in a moving medium:
 *   objective     q_t + div(u q) - q.grad u = 0: the flux turns and stretches with the medium (upper
 * convected) conservative  q_t + div(u q) = 0, eq. (9) material      q_t + u.grad q = 0, eq. (10) */
typedef enum cf_flux_rate { CF_RATE_OBJECTIVE, CF_RATE_CONSERVATIVE, CF_RATE_MATERIAL } cf_flux_rate;

/* Amounts (integrals over wall faces and time, in units of phi times a volume) that the flow brought in and
 * carried out; both are >= 0 where phi is. Inside changes by entered - left to round-off. */
typedef struct cf_through {
  double entered, left;
} cf_through;

typedef struct cf_advect cf_advect;

/* Allocates all scratch; nothing below allocates. `g` must outlive the object. CF_NO_MEMORY. */
cf_status cf_advect_create(cf_advect **a, const cf_grid *g, cf_advect_scheme scheme);
void cf_advect_destroy(cf_advect *a); /* NULL is fine */

/* The velocity of the medium, m/s on faces; kept by reference, and its first layer of ghosts is written. Of
 * `walls` only the periodic axes are read: a velocity through an insulated wall must already be 0.
 * CF_NOT_FINITE: some velocity is not. */
cf_status cf_advect_set_velocity(cf_advect *a, cf_face u, const cf_walls *walls);

/* K of the velocity for dt = 1, in 1/s: dt = cfl / rate moves things by cfl. 0 where nothing moves. */
double cf_advect_rate(const cf_advect *a);

/* Substeps that a step of dt takes; 1 with CF_ADVECT_LINEAR. */
double cf_advect_substeps(const cf_advect *a, double dt);

/* Fixes time, length and substeps of the moves that follow, and their order of axes.
 * CF_BAD_ARGUMENT: dt < 0. CF_OVER_LIMIT: the step would need more than CF_ADVECT_SUBSTEPS_MAX substeps. */
#define CF_ADVECT_SUBSTEPS_MAX 100000
cf_status cf_advect_begin(cf_advect *a, double t, double dt);

/* Counts substeps; its parity sets the order of the axes. State: goes into the registry. */
int64_t *cf_advect_parity(cf_advect *a);

/* Moves phi over the step begun. Walls of phi: insulated mirrors; open lets 0 in; value and radiate let their
 * function (at the wall's face centres, at the middle of each substep) in; what flows out is phi itself.
 * Amounts are added to `through` (NULL is fine; with CF_ADVECT_LINEAR it stays as it is). */
cf_status cf_advect_cell(cf_advect *a, const cf_walls *walls, cf_cell phi, cf_through *through);

/* Moves the components of q over the step begun, each on volumes around its own faces. q.n on insulated walls
 * is 0; through all other walls the nearest q flows in. q must not be the velocity itself (move a copy). With
 * CF_ADVECT_LINEAR conservative and material are the same. */
cf_status cf_advect_face(cf_advect *a, const cf_walls *walls, cf_flux_rate rate, cf_face q);

#endif
