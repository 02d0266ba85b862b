/* SPDX-License-Identifier: MIT
 *
 * The index space of a box of cells, and where its cells lie in an array.
 *
 * Cell (i, j, k) is element i + j stride[1] + k stride[2]; a field points at cell (0, 0, 0), so ghost
 * cells have negative indices. A cell and its low faces share an index: face p of axis a lies between
 * cells p - stride[a] and p, and the high wall of axis a is the low face of the first ghost cell. One
 * set of strides therefore serves cells and faces, and no array has n + 1 entries.
 *
 * In 2D n[2] = 1 and there are no ghosts in z. Rows (runs in x) start on a boundary of CF_ALIGN bytes.
 */
#ifndef CF_GRID_BOX_H
#define CF_GRID_BOX_H

#include <stddef.h>

#include "base/real.h"
#include "base/status.h"

typedef struct cf_box {
  int dim;             /* 2 or 3 */
  int n[3];            /* cells an axis */
  int halo;            /* ghost cells on every side of the axes below dim */
  ptrdiff_t stride[3]; /* elements to the next cell of an axis; stride[0] = 1 */
  ptrdiff_t first;     /* elements before cell (0, 0, 0) */
  ptrdiff_t size;      /* elements of the array */
} cf_box;

/* CF_BAD_ARGUMENT where an extent is below 1 or the array could not be addressed. */
cf_status cf_box_init(cf_box *b, int dim, const int n[3], int halo);

static inline ptrdiff_t cf_box_cells(const cf_box *b) { return (ptrdiff_t)b->n[0] * b->n[1] * b->n[2]; }

static inline ptrdiff_t cf_box_rows(const cf_box *b) { return (ptrdiff_t)b->n[1] * b->n[2]; }

static inline ptrdiff_t cf_box_at(const cf_box *b, const int i, const int j, const int k) {
  return i + j * b->stride[1] + k * b->stride[2];
}

/* The first cell of row r, where rows are counted y first, then z. */
static inline ptrdiff_t cf_box_row(const cf_box *b, const ptrdiff_t r) {
  return (r % b->n[1]) * b->stride[1] + (r / b->n[1]) * b->stride[2];
}

#endif
