/* SPDX-License-Identifier: MIT */
#define _GNU_SOURCE
#include "solve/wave.h"

#include <omp.h>
#include <sched.h>
#include <stdatomic.h>

#include "base/mem.h"
#include "grid/sweep.h"

/* Elements of a half row that a column has in 2D. */
#define COLUMN 256
/* What the planes between the first and the last stage may take: half of a small second-level cache. */
#define WINDOW_BYTES  (768 * 1024)
#define TILE_ROWS_MIN 8
/* Rows that go through all stages together. */
#ifndef BLOCK_ROWS
#define BLOCK_ROWS 8
#endif
/* Levels smaller than this are not worth a second thread. */
#define SERIAL_CELLS 32768

struct cf_wave_mark {
  atomic_int planes;
  char apart[CF_ALIGN - sizeof(atomic_int)];
};

int cf_wave_pieces(const cf_split *s) { return s->dim == 3 ? 1 : CF_MAX(1, s->width / COLUMN); }

cf_status cf_wave_create(cf_wave *w, const cf_split *finest) {
  *w = (cf_wave){.threads = finest->threads, .tiles = finest->n[1]};
  w->scratch_size = (cf_stage_scratch(finest) + 2 * CF_ALIGN) / CF_ALIGN * CF_ALIGN;
  CF_TRY(CF_NEW(&w->scratch, w->scratch_size * (size_t)w->threads));
  return CF_NEW(&w->done, w->tiles);
}

void cf_wave_destroy(cf_wave *w) {
  cf_free(w->scratch);
  cf_free(w->done);
  *w = (cf_wave){0};
}

static void *scratch_of(const cf_wave *w) {
  return w->scratch + (size_t)omp_get_thread_num() * w->scratch_size;
}

/* Piece number `piece` of rows [j, end); in 2D the last piece takes what is left over. */
static cf_strip strip_of(const cf_wave *w, const cf_split *s, const int j, const int end, const int k,
                         const int piece) {
  const int pieces = cf_wave_pieces(s);
  const ptrdiff_t row = (ptrdiff_t)k * s->n[1] + j;
  cf_strip t = {.j = j,
                .end = end,
                .k = k,
                .to = s->width,
                .next_k = -1,
                .sum = row * pieces + piece,
                .sum_step = pieces,
                .scratch = scratch_of(w)};
  if (pieces > 1) {
    t.from = piece * COLUMN;
    if (piece + 1 < pieces) t.to = t.from + COLUMN;
  }
  return t;
}

/* --- stage by stage ----------------------------------------------------------------------------------- */

/* Rows of a plane that go together: many, but enough strips for all threads. */
static int strip_height(const cf_split *s, const int threads) {
  if (threads == 1 || s->n[2] >= 4 * threads) return s->n[1];
  return CF_MAX(1, s->n[1] / (4 * threads));
}

static void run_stages(const cf_wave *w, const cf_pass *p) {
  const cf_split *s = p->at;
  const ptrdiff_t cells = (ptrdiff_t)s->n[0] * s->n[1] * s->n[2];
  const int pieces = cf_wave_pieces(s), threads = cells < SERIAL_CELLS ? 1 : w->threads;
  const int height = strip_height(s, threads), strips = (s->n[1] + height - 1) / height;
  for (int v = 0; v < p->count; ++v) {
    if (s->has_seam && cf_stage_reads_around(p->stage[v])) cf_split_fill_seams(s, s->e);
#pragma omp parallel for schedule(static) num_threads(threads)
    for (int q = 0; q < strips * s->n[2]; ++q)
      for (int piece = 0; piece < pieces; ++piece) {
        const int j = q % strips * height, end = CF_MIN(j + height, s->n[1]);
        const cf_strip t = strip_of(w, s, j, end, q / strips, piece);
        cf_stage_run(p, v, &t);
      }
  }
}

/* --- all stages at once ------------------------------------------------------------------------------- */

static void wait_for(const struct cf_wave_mark *mark, const int planes) {
  for (int spins = 0; atomic_load_explicit(&mark->planes, memory_order_acquire) < planes; ++spins)
    if (spins > 2000) sched_yield();
}

/* The strip that follows in rows [low, end) of the tile, in this plane or the next. */
static void set_next(const cf_split *s, const int low, const int end, cf_strip *t) {
  t->next_j = t->end;
  t->next_k = t->k;
  if (t->end + (t->end - t->j) <= end) return;
  t->next_j = CF_MAX(low, 0);
  t->next_k = t->k + 1 < s->n[2] && t->next_j + t->end - t->j <= s->n[1] ? t->k + 1 : -1;
}

/* All stages on rows [j, end), each a row lower than the one before. */
static void run_block(const cf_wave *w, const cf_pass *p, const int j, const int end, const int step,
                      const int planes, const int tile_low, const int tile_end) {
  const cf_split *s = p->at;
  for (int v = 0; v < p->count; ++v) {
    const int low = CF_MAX(j - v, 0), high = CF_MIN(end - v, s->n[1]), plane = step - v;
    if (low >= high || plane < 0 || plane >= planes) continue;
    cf_strip t = strip_of(w, s, low, high, s->dim == 3 ? plane : 0, s->dim == 3 ? 0 : plane);
    set_next(s, tile_low - v, CF_MIN(tile_end - v, s->n[1]), &t);
    cf_stage_run(p, v, &t);
  }
}

static void run_tile(const cf_wave *w, const cf_pass *p, const int tile, const int height, const int tiles) {
  const cf_split *s = p->at;
  const int planes = s->dim == 3 ? s->n[2] : cf_wave_pieces(s), steps = planes + p->count - 1;
  const int end = tile + 1 < tiles ? (tile + 1) * height : s->n[1] + p->count - 1;
  for (int step = 0; step < steps; ++step) {
    if (tile > 0) wait_for(&w->done[tile - 1], step + 1);
    for (int j = tile * height; j < end; j += BLOCK_ROWS)
      run_block(w, p, j, CF_MIN(j + BLOCK_ROWS, end), step, planes, tile * height, end);
    atomic_store_explicit(&w->done[tile].planes, step + 1, memory_order_release);
  }
}

/* Rows of a tile, so that its window fits the cache and all threads get as many tiles. */
static int tile_height(const cf_split *s, const int stages, const int threads) {
  const ptrdiff_t row = s->dim == 3 ? s->row : 2 * COLUMN;
  const ptrdiff_t fits = WINDOW_BYTES / ((stages + 2) * row * 2 * (ptrdiff_t)sizeof(float));
  const int high = (int)CF_MIN(CF_MAX(fits, TILE_ROWS_MIN), s->n[1]);
  int tiles = (s->n[1] + high - 1) / high;
  tiles = (tiles + threads - 1) / threads * threads;
  return CF_MAX((s->n[1] + tiles - 1) / tiles, CF_MIN(TILE_ROWS_MIN, s->n[1]));
}

void cf_wave_run(const cf_wave *w, const cf_pass *p) {
  const cf_split *s = p->at;
  const ptrdiff_t cells = (ptrdiff_t)s->n[0] * s->n[1] * s->n[2];
  if (s->has_seam || cells < SERIAL_CELLS) {
    run_stages(w, p);
    return;
  }
  const int height = tile_height(s, p->count, w->threads), tiles = (s->n[1] + height - 1) / height;
  for (int v = 0; v < tiles; ++v) atomic_store_explicit(&w->done[v].planes, 0, memory_order_relaxed);
#pragma omp parallel num_threads(w->threads)
  for (int v = omp_get_thread_num(); v < tiles; v += omp_get_num_threads()) run_tile(w, p, v, height, tiles);
}
