/* SPDX-License-Identifier: MIT
 *
 * What has changed in a region since its levels were made, and which cells of each level are therefore made anew.
 *
 * The kinds of cells are kept as they were and compared, a byte a cell; what differs is held in boxes, at most one for a
 * few rows and CF_RENEWAL_CHUNK cells of them. Going down a level a box grows by CF_RENEWAL_REACH cells on every side, as
 * far as a change of a cell can be felt there (its faces, their neighbours' diagonals and bands, the pieces of blocks and
 * where pieces next to it join, coarsen.h), and is halved. Cells are made anew in tiles, everything else stays as it is:
 * the result has the bits of levels made as a whole.
 *
 * Boxes are not cut at seams: they may reach beyond the box, where a periodic axis goes on.
 */
#ifndef CF_SOLVE_RENEWAL_H
#define CF_SOLVE_RENEWAL_H

#include "grid/region.h"
#include "solve/coupled.h"
#include "solve/multigrid.h"

#define CF_RENEWAL_CHUNK 16
#define CF_RENEWAL_REACH 9

/* Cells low <= (i, j, k) < high. */
typedef struct cf_changed {
  int low[3], high[3];
} cf_changed;

typedef struct cf_renewal {
  unsigned char *taken; /* kinds, in the layout of a level's fields */
  int64_t followed;     /* the update of the tiles that they are right for */
  cf_tiles *anew[CF_LEVELS_MAX];
  cf_changed *box;
  ptrdiff_t boxes, room;
} cf_renewal;

/* Frees everything; l: the finest level. */
void cf_renewal_clear(cf_renewal *n, const cf_coupled *l);

/* Takes the kinds of a region on the finest level l, which follows its tiles already. CF_NO_MEMORY. */
cf_status cf_renewal_take(cf_renewal *n, const cf_coupled *l, const cf_region *r);

/* The same, and boxes around what differs from the kinds taken before; *all: no telling, the tiles have been updated more
 * than once. CF_NO_MEMORY: nothing can be told from what has been taken. */
cf_status cf_renewal_compare(cf_renewal *n, const cf_coupled *l, const cf_region *r, bool *all);

/* The part of level number `at` to be made anew for the present boxes. CF_NO_MEMORY. */
cf_status cf_renewal_part(cf_renewal *n, int at, const cf_coupled *l, cf_part *part);

/* The boxes on the level below l. */
void cf_renewal_descend(cf_renewal *n, const cf_coupled *l);

#endif
