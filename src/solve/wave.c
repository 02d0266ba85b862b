/* SPDX-License-Identifier: MIT */
#define _GNU_SOURCE
#include "solve/wave.h"

#include <omp.h>
#include <sched.h>
#include <stdatomic.h>

#include "base/mem.h"
#include "grid/sweep.h"
#include "solve/segments.h"

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

int cf_wave_pieces(const cf_split *s) { return s->dim == 3 ? 1 : CF_MAX(1, s->width / CF_WAVE_COLUMN); }

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

/* Rows [j, j_end) of planes [k, k_end): all, or those that have segments. */
typedef struct window {
  int j, j_end, k, k_end;
} window;

static window window_of(const cf_split *s) {
  const cf_segments *g = s->segments;
  return g == NULL ? (window){0, s->n[1], 0, s->n[2]}
                   : (window){g->low[1], g->high[1], g->low[2], g->high[2]};
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
    t.from = piece * CF_WAVE_COLUMN;
    if (piece + 1 < pieces) t.to = t.from + CF_WAVE_COLUMN;
  }
  return t;
}

/* --- stage by stage ----------------------------------------------------------------------------------- */

/* Rows of a plane that go together: many, but enough strips for all threads. */
static int strip_height(const window *win, const int threads) {
  const int rows = win->j_end - win->j;
  if (threads == 1 || win->k_end - win->k >= 4 * threads) return rows;
  return CF_MAX(1, rows / (4 * threads));
}

static void run_stages(const cf_wave *w, const cf_pass *p, const window *win) {
  const cf_split *s = p->at;
  const ptrdiff_t cells = (ptrdiff_t)s->n[0] * s->n[1] * s->n[2];
  const int pieces = cf_wave_pieces(s), threads = cells < SERIAL_CELLS ? 1 : w->threads;
  const int rows = win->j_end - win->j, height = strip_height(win, threads),
            strips = (rows + height - 1) / height;
  for (int v = 0; v < p->count; ++v) {
    if (cf_split_needs_ghosts(s) && cf_stage_reads_around(p->stage[v])) cf_split_fill_seams(s, s->e);
#pragma omp parallel for schedule(static) num_threads(threads)
    for (int q = 0; q < strips * (win->k_end - win->k); ++q)
      for (int piece = 0; piece < pieces; ++piece) {
        const int j = win->j + q % strips * height, end = CF_MIN(j + height, win->j_end);
        const cf_strip t = strip_of(w, s, j, end, win->k + q / strips, piece);
        cf_stage_run(p, v, &t);
      }
  }
}

/* --- all stages at once ------------------------------------------------------------------------------- */

static void wait_for(const struct cf_wave_mark *mark, const int planes) {
  for (int spins = 0; atomic_load_explicit(&mark->planes, memory_order_acquire) < planes; ++spins)
    if (spins > 2000) sched_yield();
}

/* Places [begin, end) along an axis of `count`; those from `count` on are counted around the seam. */
typedef struct range {
  int begin, end, count;
} range;

/* Those of a stage. On an axis that wraps it begins a place after the stage before it, so that it finds that one done on
 * either side, and goes around to where it began. Restriction, which takes cells in pairs, begins with a whole one. */
static range range_of(const cf_pass *p, const int stage, const bool wraps, const int begin, const int end) {
  const bool pairs = p->stage[stage] == CF_PASS_RESTRICT || p->stage[stage] == CF_PASS_RESTRICT_RED;
  const int late = !wraps ? 0 : pairs ? stage + stage % 2 : stage;
  return (range){begin + late, end + late, end};
}

static int place(const range *r, const int i) { return i % r->count; }

/* What a pass does, over how many planes (in 2D: pieces), and rows [j, end) of a tile. */
typedef struct tile {
  range rows[CF_PASS_STAGES], planes[CF_PASS_STAGES];
  int j, end, steps;
} tile;

/* The strip that the same stage, number v, will have next: further up in the tile, or in the next plane. `plane` is the one it
 * has. */
static void set_next(const cf_split *s, const tile *at, const int v, const int plane, cf_strip *t) {
  const range *rows = &at->rows[v], *planes = &at->planes[v];
  const int end = CF_MIN(at->end - v, rows->end), height = t->end - t->j;
  t->next_j = t->end;
  t->next_k = t->k;
  if (t->end + height <= CF_MIN(end, rows->count)) return;
  t->next_j = CF_MAX(at->j - v, rows->begin);
  const bool is_there = s->dim == 3 && plane + 1 < planes->end && t->next_j + height <= rows->count;
  t->next_k = is_there ? place(planes, plane + 1) : -1;
}

/* Stage v on rows [j, end) of a plane. */
static void run_stage(const cf_wave *w, const cf_pass *p, const tile *at, const int v, const int j,
                      const int end, const int plane) {
  const cf_split *s = p->at;
  const int here = place(&at->planes[v], plane);
  cf_strip t = strip_of(w, s, j, end, s->dim == 3 ? here : 0, s->dim == 3 ? 0 : here);
  set_next(s, at, v, plane, &t);
  cf_stage_run(p, v, &t);
}

/* All stages on rows [j, end), each a row lower than the one before. */
static void run_block(const cf_wave *w, const cf_pass *p, const tile *at, const int j, const int end,
                      const int step) {
  for (int v = 0; v < p->count; ++v) {
    const range *rows = &at->rows[v], *planes = &at->planes[v];
    const int low = CF_MAX(j - v, rows->begin), high = CF_MIN(end - v, rows->end), plane = step - v;
    if (low >= high || plane < planes->begin || plane >= planes->end) continue;
    for (int from = low, to; from < high; from = to) { /* on either side of the seam */
      const int here = place(rows, from);
      to = CF_MIN(high, from + rows->count - here);
      run_stage(w, p, at, v, here, here + to - from, plane);
    }
  }
}

static tile tile_of(const cf_pass *p, const window *win) {
  const cf_split *s = p->at;
  const bool deep = s->dim == 3;
  const int k = deep ? win->k : 0, k_end = deep ? win->k_end : cf_wave_pieces(s);
  tile at = {.j = win->j};
  for (int v = 0; v < p->count; ++v) {
    at.rows[v] = range_of(p, v, s->wraps[1], win->j, win->j_end);
    at.planes[v] = range_of(p, v, s->wraps[deep ? 2 : 0], k, k_end);
    at.end = CF_MAX(at.end, at.rows[v].end + v);
    at.steps = CF_MAX(at.steps, at.planes[v].end + v - k);
  }
  return at;
}

static void run_tile(const cf_wave *w, const cf_pass *p, const window *win, const int number,
                     const int height, const int tiles) {
  tile at = tile_of(p, win);
  const int first = p->at->dim == 3 ? win->k : 0;
  /* A leaning tile at the low wall has less to do than its height tells, the one at the high wall more: half the lean makes up
   * for both. */
  const int low = win->j + (at.end - win->j_end) / 2 + number * height;
  if (number > 0) at.j = low;
  if (number + 1 < tiles) at.end = low + height;
  for (int step = 0; step < at.steps; ++step) {
    if (number > 0) wait_for(&w->done[number - 1], step + 1);
    for (int j = at.j; j < at.end; j += BLOCK_ROWS)
      run_block(w, p, &at, j, CF_MIN(j + BLOCK_ROWS, at.end), first + step);
    atomic_store_explicit(&w->done[number].planes, step + 1, memory_order_release);
  }
}

/* Rows of a tile, so that its window fits the cache and all threads get as many tiles. */
static int tile_height(const cf_split *s, const int rows, const int stages, const int threads) {
  const ptrdiff_t row = s->dim == 3 ? s->row : 2 * CF_WAVE_COLUMN;
  const int floats = s->fields == NULL ? 2 : 3 + s->dim; /* e, r; 1/diagonal, couplings */
  const ptrdiff_t fits = WINDOW_BYTES / ((stages + 2) * row * floats * (ptrdiff_t)sizeof(float));
  const int high = (int)CF_MIN(CF_MAX(fits, TILE_ROWS_MIN), rows);
  int tiles = (rows + high - 1) / high;
  tiles = (tiles + threads - 1) / threads * threads;
  return CF_MAX((rows + tiles - 1) / tiles, CF_MIN(TILE_ROWS_MIN, rows));
}

void cf_wave_run(const cf_wave *w, const cf_pass *p) {
  const cf_split *s = p->at;
  const ptrdiff_t cells = (ptrdiff_t)s->n[0] * s->n[1] * s->n[2];
  const window win = window_of(s);
  if (win.j >= win.j_end) return;
  if (w->plain || cf_split_needs_ghosts(s) || cells < SERIAL_CELLS) {
    run_stages(w, p, &win);
    return;
  }
  const int rows = win.j_end - win.j, height = tile_height(s, rows, p->count, w->threads);
  const int tiles = (rows + height - 1) / height;
  for (int v = 0; v < tiles; ++v) atomic_store_explicit(&w->done[v].planes, 0, memory_order_relaxed);
#pragma omp parallel num_threads(w->threads)
  for (int v = omp_get_thread_num(); v < tiles; v += omp_get_num_threads())
    run_tile(w, p, &win, v, height, tiles);
}
