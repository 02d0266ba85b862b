/* SPDX-License-Identifier: MIT
 *
 * How a medium that shears and turns changes a flux it carries: (q.grad u)_a = sum over e of q_e d_e u_a, on
 * the faces of each axis a, to second order.
 *
 *   e = a   q_a (u_a[p + s_a] - u_a[p - s_a])/(2h)
 *   e /= a  the product lives on the edges between faces a and e: the mean of q_e over the two cells beside
 * the face times the difference of u_a across the edge, averaged over the two edges of the face
 *
 * On an edge of a wall that is neither periodic nor insulated u_a has no neighbour; the face's inner edge
 * alone is taken there. Insulated walls need nothing: q_e is 0 on them.
 */
#ifndef CF_STENCIL_STRETCH_H
#define CF_STENCIL_STRETCH_H

#include "base/walls.h"
#include "grid/field.h"
#include "grid/grid.h"

/* to = base + dt (from.grad u) on every face, the high walls' included; faces of insulated walls get 0. u has
 * one layer of ghosts; that of `from` is written. `to` may be `base`, not `from`. */
void cf_stretch(const cf_grid *g, const cf_walls *walls, cf_face u, double dt, cf_face from, cf_face base,
                cf_face to);

/* q.n = 0 on the faces of insulated walls. */
void cf_stretch_close(const cf_grid *g, const cf_walls *walls, cf_face q);

#endif
