/* SPDX-License-Identifier: MIT
 *
 * How values are handed to a file and taken from it: C order, the components of a place side by side, without ghosts
 * or padding, in pieces of some rows so that the buffer stays small whatever the field.
 *
 *   cf_slabs_of_cell       n[2] x n[1] x n[0] values
 *   cf_slabs_of_face       the faces of one axis, the high wall's included: one more along that axis
 *   cf_slabs_of_vectors    three components a cell, each the mean of the cell's two faces (0 beyond dim)
 *   cf_slabs_of_attribute  the components of every particle; a row is a particle
 */
#ifndef CF_IO_SLABS_H
#define CF_IO_SLABS_H

#include <stdbool.h>
#include <stdint.h>

#include "grid/field.h"
#include "grid/particles.h"

#define CF_SLAB_COMPONENTS CF_PARTICLE_COMPONENTS

typedef struct cf_slabs {
  int n[3]; /* values along x, y, z */
  ptrdiff_t stride[3];
  int components;
  cf_real *at[CF_SLAB_COMPONENTS]; /* of each component; NULL: 0 */
  bool means;                      /* of a value and the next one along the component's axis */
  int axes; /* of the array in a file, besides the components: 3 for fields, 1 for particles */
  int rows; /* rows (of n[0] values) in a whole piece */
} cf_slabs;

/* One piece: rows j .. j + rows - 1 of plane k. */
typedef struct cf_slab {
  int k, j, rows;
} cf_slab;

cf_slabs cf_slabs_of_cell(const cf_box *b, cf_cell f);
cf_slabs cf_slabs_of_face(const cf_box *b, const cf_face *f, int axis);
cf_slabs cf_slabs_of_vectors(const cf_box *b, const cf_face *f);
cf_slabs cf_slabs_of_attribute(const cf_particles *set, int attribute);
cf_slabs cf_slabs_of_list(int count, int components, cf_real *const *at);

/* Values in the largest piece: the buffer's size. */
size_t cf_slabs_room(const cf_slabs *s);

/* Values in this piece. */
static inline size_t cf_slab_size(const cf_slabs *s, const cf_slab p) {
  return (size_t)p.rows * (size_t)s->n[0] * (size_t)s->components;
}

/* Piece number `i`, counted from 0; false past the last. */
bool cf_slabs_piece(const cf_slabs *s, int64_t i, cf_slab *p);

void cf_slab_gather(const cf_slabs *s, cf_slab p, cf_real *values);        /* from the field */
void cf_slab_scatter(const cf_slabs *s, cf_slab p, const cf_real *values); /* into it; not for means */

/* --- arrays as files have them ------------------------------------------------------------------------- */

typedef enum cf_element {
  CF_ELEMENT_REAL,
  CF_ELEMENT_NUMBER,
  CF_ELEMENT_INTEGER,
  CF_ELEMENT_BYTE
} cf_element;

typedef struct cf_array {
  cf_element element;
  int rank; /* 1 to 4 */
  int64_t n[4];
} cf_array;

size_t cf_element_size(cf_element e);
uint64_t cf_array_bytes(const cf_array *a);

/* The array that slabs are in a file, and where in it a piece begins and how far it goes. */
cf_array cf_slabs_array(const cf_slabs *s);
void cf_slab_window(const cf_slabs *s, cf_slab p, uint64_t start[4], uint64_t count[4]);

#endif
