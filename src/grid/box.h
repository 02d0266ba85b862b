/* SPDX-License-Identifier: MIT
 *
 * Walking through a cf_box (cattaneo.h: which element a cell is, and that it shares its index with its low
 * faces). A field points at cell (0, 0, 0), so ghost cells have negative indices. Rows, runs in x, start on a
 * boundary of CF_ALIGN bytes.
 */
#ifndef CF_GRID_BOX_H
#define CF_GRID_BOX_H

#include <stddef.h>

#include "base/real.h"
#include "base/status.h"

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
