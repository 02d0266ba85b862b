/* SPDX-License-Identifier: MIT
 *
 * Values on a box: one a cell (cf_cell), or one a face and axis (cf_face, the MAC arrangement).
 * Both point at cell (0, 0, 0) of arrays shaped by the box they were made for, and are passed by value.
 * The memory is zero until written and is committed page by page.
 */
#ifndef CF_GRID_FIELD_H
#define CF_GRID_FIELD_H

#include <stdbool.h>

#include "grid/box.h"

typedef struct cf_cell {
  cf_real *at; /* value of cell p: at[p] */
} cf_cell;

typedef struct cf_face {
  cf_real *at[3]; /* value on the low face of axis a of cell p: at[a][p]; NULL for axes >= dim */
} cf_face;

cf_status cf_cell_create(cf_cell *f, const cf_box *b);
void cf_cell_destroy(cf_cell *f, const cf_box *b); /* a field never created is fine */

cf_status cf_face_create(cf_face *f, const cf_box *b);
void cf_face_destroy(cf_face *f, const cf_box *b);

/* Cells along an axis that a component has: n, and one more where it lies on that axis' faces. */
static inline int cf_box_extent(const cf_box *b, const int axis, const int component) {
  return b->n[axis] + (axis == component ? 1 : 0);
}

#endif
