/* SPDX-License-Identifier: MIT
 *
 * The walls of a box: what holds on each, for one scalar. The kinds, and what they mean, are in cattaneo.h.
 */
#ifndef CF_BASE_WALLS_H
#define CF_BASE_WALLS_H

#include "base/fn.h"
#include "cattaneo.h"

/* Whether the scalar is known on the wall face. */
static inline bool cf_wall_is_held(const cf_wall kind) {
  return kind == CF_WALL_OPEN || kind == CF_WALL_VALUE;
}

#endif
