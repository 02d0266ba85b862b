/* SPDX-License-Identifier: MIT
 *
 * Values on a box: one a cell (cf_cell), or one a face and axis (cf_face, the MAC arrangement), as cattaneo.h
 * declares them. Both are passed by value.
 */
#ifndef CF_GRID_FIELD_H
#define CF_GRID_FIELD_H

#include "grid/box.h"

/* Cells along an axis that a component has: n, and one more where it lies on that axis' faces. */
static inline int cf_box_extent(const cf_box *b, const int axis, const int component) {
  return b->n[axis] + (axis == component ? 1 : 0);
}

#endif
