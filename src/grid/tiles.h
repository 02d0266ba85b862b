/* SPDX-License-Identifier: MIT
 *
 * Which cells of a large box are worth visiting. The box is cut into tiles, each active or not; sweeps visit
 * the runs of active tiles, and fields have memory only under those.
 *
 *     cf_tiles *t;
 *     cf_tiles_create(&t, &grid.box, NULL);
 *     cf_tiles_add_cell(t, i, j, k, 2);                 // every tile within 2 cells of this one
 *     cf_tiles_drop(t, ti, tj, tk);                     // tiles that have become idle
 *     cf_tiles_update(t);                               // makes runs; then, for every field on the box:
 *     cf_tiles_retire_cell(t, phi);                     // what has left becomes 0, its pages are given back
 *
 *     CF_PARALLEL_TILES (t, threads, r)                 // r: rows of tiles
 *       CF_TILE_ROWS (t, r, j, k)                       // their rows of cells
 *         CF_TILE_RUNS (t, r, run)                      // runs [run->low, run->high) of cells in x
 *           some_row(run->high - run->low, ... + cf_box_at(b, run->low, j, k));
 *
 * Rows of tiles are independent of each other: each is done by one thread, so partial sums that have a place for every
 * row of cells, as in dense sweeps, are added to in the same order whatever the threads; and since runs start at
 * multiples of the tile's edge, a sum over lanes (CF_SUM_LANES) has the bits of the dense sweep over the same values with
 * zeros elsewhere.
 *
 * Fields stay arrays over the whole box (a neighbour is an add) in address space of which only the pages touched are
 * committed. A cell that is not active reads as 0 in a field that is retired after every update, and must not be
 * written. Changing the set costs what changes; cf_tiles_update costs a pass over the bits, one a tile.
 *
 * Tiles are 16 x 8 x 8 cells (16 x 16 in 2D) if nothing else is asked for: a ball of 2 % of 512^3 is covered
 * with one third more cells than it has.
 */
#ifndef CF_GRID_TILES_H
#define CF_GRID_TILES_H

#include <stdbool.h>
#include <stdint.h>

#include "grid/field.h"
#include "grid/sweep.h"

/* Active cells [low, high) of a row. */
typedef struct cf_run {
  int low, high;
} cf_run;

/* A row of tiles (all i of one tj, tk) that has active ones. */
typedef struct cf_tile_row {
  int j, k, j_end, k_end; /* its rows of cells */
  ptrdiff_t run, run_end; /* entries of cf_tiles.run */
} cf_tile_row;

typedef struct cf_tiles {
  cf_box box;
  int edge[3], shift[3]; /* cells of a tile: powers of two, 1 << shift */
  int n[3];              /* tiles an axis */
  int words;             /* 64-bit words of a row of tiles */
  uint64_t *active;      /* a bit a tile: word (tk n[1] + tj) words + ti/64 */
  uint64_t *seen;        /* the same at the latest update: what sweeps visit */
  uint64_t *left;        /* those that left in it */
  ptrdiff_t count;       /* active tiles at the latest update */
  int64_t updates;       /* so far */
  cf_tile_row *row;
  cf_run *run;
  ptrdiff_t rows, runs, room;
  bool *asked; /* rows of tiles that have been written since the update: */
  ptrdiff_t *pending, pendings;
  ptrdiff_t *changed, changes; /* rows of tiles that changed in the latest update */
  uint16_t *users[4]; /* rows of cells that use a page, in fields of 1, 2, 4 and 8 bytes an element */
} cf_tiles;

/* edge: cells a tile has, powers of two, x at least 8; NULL: see above. No tile is active. CF_BAD_ARGUMENT,
 * CF_NO_MEMORY. */
cf_status cf_tiles_create(cf_tiles **t, const cf_box *b, const int edge[3]);
void cf_tiles_destroy(cf_tiles *t); /* NULL is fine */

/* --- the set: what is said here holds from the next update on -------------------------------------------- */

static inline bool cf_tiles_has(const cf_tiles *t, const int ti, const int tj, const int tk) {
  return t->active[((ptrdiff_t)tk * t->n[1] + tj) * t->words + ti / 64] >> (ti % 64) & 1;
}
static inline bool cf_tiles_has_cell(const cf_tiles *t, const int i, const int j, const int k) {
  return cf_tiles_has(t, i >> t->shift[0], j >> t->shift[1], k >> t->shift[2]);
}

void cf_tiles_add(cf_tiles *t, int ti, int tj, int tk);
void cf_tiles_drop(cf_tiles *t, int ti, int tj, int tk);

/* Every tile that has a cell within `margin` cells (in each axis) of cell (i, j, k). Cells beyond the box are fine. */
void cf_tiles_add_cell(cf_tiles *t, int i, int j, int k, int margin);

/* All tiles that meet the cells low <= (i, j, k) < high. */
void cf_tiles_add_box(cf_tiles *t, const int low[3], const int high[3]);
void cf_tiles_drop_all(cf_tiles *t);

/* --- the update ----------------------------------------------------------------------------------------- */

/* Makes rows and runs, and the list of what has changed since the update before. CF_NO_MEMORY: the set is as it was
 * asked for, the runs are as before. */
cf_status cf_tiles_update(cf_tiles *t);

/* In a field on the box: cells of tiles that left in the latest update become 0, and pages under no active tile are
 * given back. At a cost proportional to what left. */
void cf_tiles_retire_cell(const cf_tiles *t, cf_cell f);
void cf_tiles_retire_face(const cf_tiles *t, cf_face f);
void cf_tiles_retire_bytes(const cf_tiles *t, void *at, size_t element); /* the same for other elements */

/* For a field that was right for update number `since`: retired if one update has passed since; given back as a whole
 * if more have, so it is all 0; otherwise left alone. */
void cf_tiles_follow_bytes(const cf_tiles *t, int64_t since, void *at, size_t element);

/* Zeroed fields on the box whose pages are small, so that single ones can be given back. cf_cell_destroy frees
 * them. CF_NO_MEMORY. */
cf_status cf_tiles_cell_create(const cf_tiles *t, cf_cell *f);
cf_status cf_tiles_face_create(const cf_tiles *t, cf_face *f);

/* Cells in active tiles. */
ptrdiff_t cf_tiles_cells(const cf_tiles *t);

/* The sum of one number for every row of cells of the box, v[j + n[1] k], with the bits of cf_sum_ordered: rows without
 * active tiles count as 0 and are not read, so it costs what the tiles do. */
double cf_tiles_sum_rows(const cf_tiles *t, const double *v);

/* --- sweeps --------------------------------------------------------------------------------------------- */

static inline int cf_tiles_threads(const cf_tiles *t, const int threads) {
  return t->count << (t->shift[0] + t->shift[1] + t->shift[2]) < CF_SERIAL_CELLS ? 1 : threads;
}

#define CF_PARALLEL_TILES(t, threads, r)                                                     \
  CF_PRAGMA(omp parallel for schedule(dynamic, 4) num_threads(cf_tiles_threads(t, threads))) \
  for (ptrdiff_t r = 0; r < (t)->rows; ++r)

#define CF_TILE_ROWS(t, r, j_, k_)                           \
  for (int k_ = (t)->row[r].k; k_ < (t)->row[r].k_end; ++k_) \
    for (int j_ = (t)->row[r].j; j_ < (t)->row[r].j_end; ++j_)

#define CF_TILE_RUNS(t, r, run_) \
  for (const cf_run *run_ = (t)->run + (t)->row[r].run; run_ < (t)->run + (t)->row[r].run_end; ++run_)

#endif
