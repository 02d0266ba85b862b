/* SPDX-License-Identifier: MIT
 *
 * How the values of a field are handed to a file: C order, x fastest, without ghosts or padding, in pieces of
 * some rows so that the buffer stays small whatever the field.
 *
 *   cf_slabs_of_cell     n[2] x n[1] x n[0] values
 *   cf_slabs_of_face     the faces of one axis, the high wall's included: one more along that axis
 *   cf_slabs_of_vectors  three components a cell side by side, each the mean of the cell's two faces (0
 * beyond dim)
 */
#ifndef CF_IO_SLABS_H
#define CF_IO_SLABS_H

#include <stdbool.h>
#include <stdint.h>

#include "grid/field.h"

typedef struct cf_slabs {
  const cf_box *box;
  int n[3];       /* values along x, y, z */
  int components; /* 1 or 3 */
  cf_real *at[3]; /* of each component; NULL: 0 */
  int rows;       /* rows (of n[0] values) in a whole piece */
} cf_slabs;

/* One piece: rows j .. j + rows - 1 of plane k. */
typedef struct cf_slab {
  int k, j, rows;
} cf_slab;

cf_slabs cf_slabs_of_cell(const cf_box *b, cf_cell f);
cf_slabs cf_slabs_of_face(const cf_box *b, const cf_face *f, int axis);
cf_slabs cf_slabs_of_vectors(const cf_box *b, const cf_face *f);

/* Values in the largest piece: the buffer's size. */
size_t cf_slabs_room(const cf_slabs *s);

/* Values in this piece. */
static inline size_t cf_slab_size(const cf_slabs *s, const cf_slab p) {
  return (size_t)p.rows * (size_t)s->n[0] * (size_t)s->components;
}

/* Piece number `i`, counted from 0; false past the last. */
bool cf_slabs_piece(const cf_slabs *s, int64_t i, cf_slab *p);

void cf_slab_gather(const cf_slabs *s, cf_slab p, cf_real *values);        /* from the field */
void cf_slab_scatter(const cf_slabs *s, cf_slab p, const cf_real *values); /* into it; not for vectors */

#endif
