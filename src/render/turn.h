/* SPDX-License-Identifier: MIT
 *
 * Studios have z upwards; scenes may have y or x upwards. Here is what they show turned so that it stands upright: the
 * axes change places in a circle, (x, y, z) becomes (z, x, y) where y is up and (y, z, x) where x is.
 */
#ifndef CF_RENDER_TURN_H
#define CF_RENDER_TURN_H

#include <stdint.h>

#include "grid/mesh.h"

/* Which axis of the scene becomes axis a, where `up` (0, 1, 2) is upwards. */
static inline int cf_turn_axis(const int up, const int a) { return (a + up + 1) % 3; }

/* A place or direction, in place. */
void cf_turn_vector(int up, double v[3]);
void cf_turn_vectors(int up, int64_t count, float (*v)[3]);
void cf_turn_mesh(int up, cf_mesh *mesh);

/* The grid without ghosts, and a field of it. */
cf_status cf_turn_grid(int up, const cf_grid *g, cf_grid *turned);
void cf_turn_field(int up, const cf_grid *g, const cf_real *f, const cf_grid *turned, cf_real *out);

#endif
