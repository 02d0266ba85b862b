/* SPDX-License-Identifier: MIT
 *
 * The six walls of a box (four in 2D): what holds on each, for one scalar.
 *
 *   insulated  no flux passes
 *   open       the scalar is 0 on the wall face (and what the flow brings in is 0)
 *   value      the scalar is a given function of place and time on the wall face
 *   radiate    the flux is c (phi - phi_inf): waves leave
 *   periodic   the opposite wall is the neighbour; given for both sides of an axis
 */
#ifndef CF_BASE_WALLS_H
#define CF_BASE_WALLS_H

#include "base/fn.h"

/* name as a scene writes it; the order is that of enum cf_wall */
#define CF_WALL_LIST(W) \
  W(INSULATED, insulated) W(OPEN, open) W(VALUE, value) W(RADIATE, radiate) W(PERIODIC, periodic)

typedef enum cf_wall {
#define CF_WALL_ENUM(upper, lower) CF_WALL_##upper,
  CF_WALL_LIST(CF_WALL_ENUM)
#undef CF_WALL_ENUM
} cf_wall;

typedef struct cf_walls {
  cf_wall kind[3][2]; /* [axis][0: low side, 1: high side] */
  cf_fn value[3][2];  /* read for CF_WALL_VALUE and CF_WALL_RADIATE */
} cf_walls;

static inline bool cf_wall_is_held(const cf_wall kind) {
  return kind == CF_WALL_OPEN || kind == CF_WALL_VALUE;
}

#endif
