/* SPDX-License-Identifier: MIT
 *
 * How a pass runs its stages over a level: all in one sweep through memory.
 *
 * A stage on a row needs the stage before it done on the neighbouring rows, and the stage after it not yet. So
 * while the first stage works on plane K of the level, stage s works on plane K - s, and in the same way it trails by s rows:
 *
 *     for each plane K            stage 0        . . . . . . . #     stage s is at row j - s of plane K - s:
 *       for each row j            stage 1        . . . . . . #       what it reads was written just before and
 *         for each stage s        stage 2        . . . . . #         is still in the cache
 *           stage s on row j - s of plane K - s
 *
 * In 2D columns of a fixed width stand for planes. Rows are cut into tiles, so that the planes between first
 * and last stage fit a core's cache. A tile leans: its rows shift down by one with every stage (the
 * index j - s above), hence tile J needs nothing of tile J + 1, and threads take the tiles in turn, each
 * following the tile before it at a distance of one plane. Counters are all the synchronization there is.
 *
 * Half sweeps of one colour do not depend on the order of rows, and sums have a place for every row: the bits of the
 * result depend neither on the threads nor on the tiles.
 *
 * On a periodic axis of an even number of cells every stage begins a row, or a plane, further than the stage before it, goes
 * around, and ends where it began:
 *
 *     rows      0 1 2 3 4 5 6 7     stage 2 finds stage 1 done on 1, 2 and 3 when it begins on 2; when it comes to 0,
 *     stage 0   0 1 2 3 4 5 6 7     stage 1 has been there, and nothing that stage 2 reads has changed since:
 *     stage 1   7 0 1 2 3 4 5 6     half sweeps read the other colour
 *     stage 2   6 7 0 1 2 3 4 5     (numbers: the order)
 *
 * so that the last tile, which holds the rows around the seam, waits for the others as for its neighbour. Between y and z nothing
 * is copied (cf_step_down); in x the end cells of a half row have ghosts (cf_half_join).
 *
 * Levels on which neighbours across a seam share a colour, and small ones, go stage by stage instead, and so do segments
 * in a box with seams.
 */
#ifndef CF_SOLVE_WAVE_H
#define CF_SOLVE_WAVE_H

#include "solve/stages.h"

/* One a hierarchy: what runs need, made for its finest level. */
typedef struct cf_wave {
  int threads, tiles; /* at most */
  bool plain;         /* stage by stage: what all at once must agree with to the bit */
  size_t scratch_size;
  char *scratch;             /* a piece for each thread */
  struct cf_wave_mark *done; /* planes finished, a tile */
} cf_wave;

cf_status cf_wave_create(cf_wave *w, const cf_split *finest);
void cf_wave_destroy(cf_wave *w);

/* Elements of a half row that a column has in 2D. */
#define CF_WAVE_COLUMN 256

/* Pieces that a row is cut into, hence sums in cf_pass.rows that a row takes. */
int cf_wave_pieces(const cf_split *s);

void cf_wave_run(const cf_wave *w, const cf_pass *p);

#endif
