/* SPDX-License-Identifier: MIT
 *
 * The rim of a region: cells that are not inside but near cells that are, in layers by their distance in steps from cell
 * to cell. Stencils of several cells that reach across a closed face find there what the cells inside continue to: in
 * the first layer the mean of the neighbours inside, which is the mirror image at a straight wall; in each further one
 * the mean of the layer before. No flux passes the face, so what is there never gets in.
 */
#ifndef CF_GRID_RIM_H
#define CF_GRID_RIM_H

#include "grid/region.h"

#define CF_RIM_LAYERS 3

typedef struct cf_rim {
  cf_box box;
  unsigned char *layer;  /* at cell (0, 0, 0): 0 none, 1 inside, 2 ... the layers */
  ptrdiff_t *cell, room; /* those of all layers, one after the other */
  ptrdiff_t begin[CF_RIM_LAYERS + 1];
  ptrdiff_t *from; /* where the cells of every row begin, while a layer is found */
} cf_rim;

/* An empty one; cf_rim_destroy cleans up after a failure. CF_NO_MEMORY. */
cf_status cf_rim_create(cf_rim *rim, const cf_box *b);
void cf_rim_destroy(cf_rim *rim); /* a zeroed one is fine */

/* The rim of the region as it is now: a pass over all cells for each layer. CF_NO_MEMORY. */
cf_status cf_rim_find(cf_rim *rim, const cf_region *r);

/* Fills the rim of f from the cells inside. */
void cf_rim_fill(const cf_rim *rim, cf_cell f);

#endif
