/* SPDX-License-Identifier: MIT
 *
 * Vorticity confinement (Steinhoff, Underhill 1994; Fedkiw, Stam, Jensen 2001): where numbers smear whirls of a few
 * cells, an acceleration spins them up again,
 *
 *     a = strength h N x w,     w = curl u,     N = grad |w| / |grad |w||
 *
 * It vanishes with h and is no physics: it adds energy, and is for pictures.
 */
#ifndef CF_PHYSICS_CONFINE_H
#define CF_PHYSICS_CONFINE_H

#include "grid/field.h"
#include "grid/flow_walls.h"

typedef struct cf_confine cf_confine;

/* `walls` must outlive it. CF_NO_MEMORY. */
cf_status cf_confine_create(cf_confine **c, const cf_flow_walls *walls, double strength);
void cf_confine_destroy(cf_confine *c); /* NULL is fine */

/* to += dt a(u), on faces; `to` may be u. u's ghosts are written. */
void cf_confine_push(const cf_confine *c, double dt, cf_face u, cf_face to);

/* |curl u| at cells, 1/s. u's ghosts are written. */
void cf_confine_vorticity(const cf_flow_walls *walls, cf_face u, cf_cell out);

#endif
