/* SPDX-License-Identifier: MIT
 *
 * The region of a box where an equation holds: a kind for every cell (cattaneo.h: inside, wall, held, outside), and
 * what follows from it for a face between two cells:
 *
 *     inside | inside     the equation's own coefficient
 *     inside | wall       closed: no flux passes
 *     inside | held       the value is known on the face (half a cell away from the centre)
 *     inside | outside    the same with the value 0, like an open wall of the box
 *     anything else       has no part in the equation
 *
 * so that obstacles and walls of the box mean the same things: wall ~ insulated, held ~ value, outside ~ open.
 *
 * Kinds are bytes in the layout of a cell field, in pages that are committed when touched; 0 is wall, so on a
 * large box only what is made something else costs memory. (The word `mask` is the renderer's.)
 */
#ifndef CF_GRID_REGION_H
#define CF_GRID_REGION_H

#include <stdbool.h>

#include "base/walls.h"
#include "grid/shape.h"
#include "grid/tiles.h"

struct cf_region {
  cf_grid grid;
  unsigned char *kind;   /* at cell (0, 0, 0); ghosts are never read */
  cf_cell value;         /* of held cells */
  const cf_tiles *tiles; /* NULL: every cell of the box is looked at */
  ptrdiff_t inside;      /* cells, as of the latest update, */
  int low[3], high[3];   /* and within which ends they lie: low <= (i, j, k) < high */
  uint64_t stamp;        /* of the latest update: no two updates of any regions have the same */
};

/* All cells inside; with tiles (which must outlive it) none is, and cells in tiles that leave must be made walls again
 * (cf_region_retire). CF_NO_MEMORY. */
cf_status cf_region_create_on(cf_region **r, const cf_grid *g, const cf_tiles *tiles);

/* Cells (of active tiles, if there are any) whose centres are inside the shape become `kind`; value: of held ones, at
 * time t; NULL: 0. CF_NO_MEMORY. */
cf_status cf_region_add(cf_region *r, const cf_shape *s, const cf_pose *pose, double t, cf_cell_kind kind,
                        const cf_fn *value);

/* All cells (of active tiles). */
void cf_region_fill(cf_region *r, cf_cell_kind kind);

/* After the tiles have changed: cells that left are walls, and their pages are given back. */
void cf_region_retire(cf_region *r);

/* Makes r, which has no tiles, what the region `from` is in the cells from `low` on, as of its latest update; the cells inside
 * must all be among them. Values are left alone. */
void cf_region_look(cf_region *r, const cf_region *from, const int low[3]);

/* One layer of ghosts: beyond a wall of the box a cell is of the kind of the one beside it, or of the one it wraps to.
 * For those who read kinds across faces; solvers do not. */
void cf_region_ghosts(cf_region *r, const bool wraps[3]);

static inline cf_cell_kind cf_region_kind(const cf_region *r, const ptrdiff_t p) {
  return (cf_cell_kind)r->kind[p];
}

/* Whether the low face of axis a of cell p carries a flux of the equation inside: 0 no, 1 between two cells inside,
 * 2 with a known value on it. Not for faces on the walls of the box. */
static inline int cf_region_face(const cf_region *r, const int a, const ptrdiff_t p) {
  const int here = r->kind[p], below = r->kind[p - r->grid.box.stride[a]];
  if (here == CF_CELL_INSIDE && below == CF_CELL_INSIDE) return 1;
  if (here == CF_CELL_INSIDE) return below == CF_CELL_WALL ? 0 : 2;
  if (below == CF_CELL_INSIDE) return here == CF_CELL_WALL ? 0 : 2;
  return 0;
}

#endif
