/* SPDX-License-Identifier: MIT
 *
 * What a moving medium carries along: cf_advect_* of cattaneo.h, with the equations and what each scheme
 * promises; and the move of a velocity by itself, for models.
 */
#ifndef CF_PHYSICS_ADVECT_H
#define CF_PHYSICS_ADVECT_H

#include "base/walls.h"
#include "grid/field.h"
#include "grid/flow_walls.h"
#include "grid/grid.h"

/* A field in cells that is carried: what cf_advect_cell takes. */
typedef struct cf_carried {
  const cf_walls *walls;
  cf_cell phi;
  cf_through *through; /* NULL: nobody asks */
} cf_carried;

/* cf_advect_cell of one field or of two, with the same bits: two cost less than twice one, since what the velocity
 * does is worked out once. */
cf_status cf_advect_cells(cf_advect *a, const cf_carried *f, int count);

/* The same in a part of the box alone: `part` is a grid with the strides of the whole one whose cell (0, 0, 0) is
 * `corner` elements further; the velocity stays that of the whole box. phi are fields of the whole box. */
cf_status cf_advect_cells_in(cf_advect *a, const cf_grid *part, ptrdiff_t corner, const cf_carried *f,
                             int count);

/* u_t + div(v u) = 0, component by component on the volumes around their faces, over the step begun; v is the
 * velocity that was set, and u another field. The normal velocity of closed walls must be put right afterwards
 * (cf_flow_walls_hold). The sum of every component changes by what passes walls alone (CF_ADVECT_PPM, _WENO5). */
void cf_advect_velocity(cf_advect *a, const cf_flow_walls *walls, cf_face u);

#endif
