/* SPDX-License-Identifier: MIT
 *
 * Ghost cells. Each side of each axis is filled by one rule, axes in order x, y, z, each over the ghosts of
 * the axes before it, so that corners come out right as well.
 *
 * A face component has one more layer on its own axis: there, under `wrap`, the last layer is the image of
 * the first, and the ghosts continue from it.
 */
#ifndef CF_GRID_HALO_H
#define CF_GRID_HALO_H

#include "grid/box.h"

typedef enum cf_halo_rule {
  CF_HALO_NONE, /* left alone */
  CF_HALO_WRAP, /* the other side's cells */
  CF_HALO_COPY, /* the nearest cell's value */
  CF_HALO_ZERO,
} cf_halo_rule;

typedef struct cf_halo {
  cf_halo_rule rule[3][2];
  int threads; /* that share a layer of thousands of cells; 0: one */
} cf_halo;

/* Fills `width` (at most the box's halo) layers around f. component: CF_CENTRES, or the axis on whose faces
 * f lies. */
void cf_halo_fill(const cf_box *b, const cf_halo *halo, int width, int component, cf_real *f);

#endif
