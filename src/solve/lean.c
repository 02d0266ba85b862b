/* SPDX-License-Identifier: MIT */
#define _GNU_SOURCE
#include "solve/lean.h"

#include <omp.h>
#include <sched.h>
#include <stdatomic.h>

#include "base/real.h"

/* What the planes between the first and the last stage may take: three quarters of a small second-level cache. */
#define WINDOW_BYTES (768 * 1024)
/* Rows that go through all stages together. */
#define BLOCK_ROWS 8

typedef struct mark {
  atomic_int planes; /* of a tile, done */
  char apart[CF_ALIGN - sizeof(atomic_int)];
} mark;

int cf_lean_height(const int rows, const int stages, const ptrdiff_t row_bytes, const int threads) {
  const ptrdiff_t fits = WINDOW_BYTES / ((stages + 2) * CF_MAX(row_bytes, 1));
  const int high = (int)CF_MIN(CF_MAX(fits, CF_LEAN_ROWS_MIN), CF_MAX(rows, 1));
  int tiles = (rows + high - 1) / high;
  tiles = (tiles + threads - 1) / threads * threads;
  const int least = CF_MAX(CF_MIN(CF_LEAN_ROWS_MIN, rows), rows / CF_LEAN_TILES_MAX + 1);
  return CF_MAX((rows + tiles - 1) / CF_MAX(tiles, 1), least);
}

static void wait_for(const mark *done, const int planes) {
  for (int spins = 0; atomic_load_explicit(&done->planes, memory_order_acquire) < planes; ++spins)
    if (spins > 2000) sched_yield();
}

/* All stages on rows [j, end), each a row lower than the one before. */
static void run_block(const cf_lean *w, const int j, const int end, const int step) {
  for (int v = 0; v < w->stages; ++v) {
    const int low = CF_MAX(j - v, w->j), high = CF_MIN(end - v, w->j_end), k = w->k + step - v;
    if (low < high && k >= w->k && k < w->k_end) w->rows(w->of, v, low, high, k);
  }
}

static void run_tile(const cf_lean *w, const int number, const int tiles, mark *done) {
  const int from = w->j + number * w->height;
  const int to = number + 1 < tiles ? from + w->height : w->j_end + w->stages - 1;
  for (int step = 0; step < w->k_end - w->k + w->stages - 1; ++step) {
    if (number > 0) wait_for(&done[number - 1], step + 1);
    for (int j = from; j < to; j += BLOCK_ROWS) run_block(w, j, CF_MIN(j + BLOCK_ROWS, to), step);
    atomic_store_explicit(&done[number].planes, step + 1, memory_order_release);
  }
}

void cf_lean_run(const cf_lean *w) {
  mark done[CF_LEAN_TILES_MAX];
  const int rows = w->j_end - w->j, tiles = rows > 0 ? (rows + w->height - 1) / w->height : 0;
  for (int v = 0; v < tiles; ++v) atomic_init(&done[v].planes, 0);
#pragma omp parallel num_threads(w->threads)
  for (int v = omp_get_thread_num(); v < tiles; v += omp_get_num_threads()) run_tile(w, v, tiles, done);
}
