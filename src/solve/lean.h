/* SPDX-License-Identifier: MIT
 *
 * Stages over the rows of planes, all in one sweep through memory: for stages that read rows around their own which the stage
 * before has done, and of which each changes only what the one before it does not read of the rows around.
 *
 * While the first stage works on plane K, stage s works on plane K - s, and in the same way it trails by s rows, so that
 * what it reads was written just before and is still in the cache:
 *
 *     for each plane K
 *       for each row j
 *         for each stage s
 *           stage s on row j - s of plane K - s
 *
 * Rows are cut into tiles, so that the planes between first and last stage fit a core's cache. A tile leans: its rows shift
 * down by one with every stage (the index j - s above), hence tile J needs nothing of tile J + 1, and threads take the
 * tiles in turn, each following the tile before it at a distance of one plane. Counters are all the synchronization
 * there is.
 */
#ifndef CF_SOLVE_LEAN_H
#define CF_SOLVE_LEAN_H

#include <stddef.h>

/* Rows of a tile: fewer are not worth a tile of their own; and most tiles. */
#define CF_LEAN_ROWS_MIN  8
#define CF_LEAN_TILES_MAX 128

typedef struct cf_lean {
  int j, j_end, k, k_end; /* rows [j, j_end) of planes [k, k_end) */
  int stages, height;     /* height: rows of a tile */
  int threads;
  /* Stage number `stage` on rows [j, end) of plane k. */
  void (*rows)(const void *of, int stage, int j, int end, int k);
  const void *of;
} cf_lean;

/* Rows of a tile of which a row and stage take so many bytes. */
int cf_lean_height(int rows, int stages, ptrdiff_t row_bytes, int threads);

void cf_lean_run(const cf_lean *w);

#endif
