/* SPDX-License-Identifier: MIT */
#include "solve/coupled.h"

#include <string.h>

#include "base/mem.h"

/* Rows of cells that a thread takes at once where there are no tiles. */
#define GROUP 4

/* --- making ------------------------------------------------------------------------------------------- */

/* Fields begin at different places within a page: a load from the place that another field has just been stored to,
 * but for the page, waits for the store. */
static size_t field_shift(const cf_coupled *l, const int number) {
  return l->tiles == NULL ? (size_t)number * 5 * CF_ALIGN : 0;
}

static cf_status field_create(const cf_coupled *l, const int number, void **at, const size_t element) {
  void *pages;
  const size_t shift = field_shift(l, number);
  CF_TRY(cf_pages_reserve(&pages, (size_t)l->box.size * element + shift, l->tiles == NULL));
  *at = (char *)pages + (size_t)l->box.first * element + shift;
  return CF_OK;
}

static void field_destroy(const cf_coupled *l, const int number, void *at, const size_t element) {
  const size_t shift = field_shift(l, number);
  if (at != NULL)
    cf_pages_release((char *)at - (size_t)l->box.first * element - shift,
                     (size_t)l->box.size * element + shift);
}

/* Every float field of a level, for what is done to all of them. */
#define FLOATS 9
static void float_fields(cf_coupled *l, float **field[FLOATS]) {
  float **list[FLOATS] = {&l->e,    &l->r,    &l->rest, &l->inverse, &l->free,
                          &l->held, &l->c[0], &l->c[1], &l->c[2]};
  memcpy(field, list, sizeof list);
}

static cf_status all_rows(cf_coupled *l) {
  const int groups = (l->box.n[1] + GROUP - 1) / GROUP;
  CF_TRY(CF_NEW(&l->all_rows, (ptrdiff_t)groups * l->box.n[2]));
  for (int k = 0; k < l->box.n[2]; ++k)
    for (int g = 0; g < groups; ++g)
      l->all_rows[l->rows++] = (cf_tile_row){g * GROUP, k, CF_MIN((g + 1) * GROUP, l->box.n[1]), k + 1, 0, 1};
  l->all[0] = (cf_run){0, l->box.n[0]};
  l->row = l->all_rows;
  l->run = l->all;
  for (int a = 0; a < 3; ++a) l->high[a] = l->box.n[a];
  return CF_OK;
}

cf_status cf_coupled_create(cf_coupled *l, const cf_box *b, const bool periodic[3], const int threads,
                            const cf_tiles *tiles) {
  *l = (cf_coupled){.dim = b->dim, .threads = threads, .box = *b, .tiles = tiles};
  for (int a = 0; a < b->dim; ++a) l->periodic[a] = periodic[a] && b->n[a] > 1;
  float **field[FLOATS];
  float_fields(l, field);
  for (int f = 0; f < FLOATS - (b->dim == 2); ++f)
    CF_TRY(field_create(l, f, (void **)field[f], sizeof(float)));
  for (int a = 0; a < b->dim; ++a) CF_TRY(field_create(l, FLOATS + a, (void **)&l->weight[a], 1));
  CF_TRY(field_create(l, 0, (void **)&l->mark, 1));
  CF_TRY(CF_NEW(&l->band, (ptrdiff_t)b->n[1] * b->n[2]));
  return tiles == NULL ? all_rows(l) : CF_NEW(&l->row_at, (ptrdiff_t)tiles->n[1] * tiles->n[2]);
}

void cf_coupled_destroy(cf_coupled *l) {
  float **field[FLOATS];
  float_fields(l, field);
  for (int f = 0; f < FLOATS; ++f) field_destroy(l, f, *field[f], sizeof(float));
  for (int a = 0; a < 3; ++a) field_destroy(l, FLOATS + a, l->weight[a], 1);
  field_destroy(l, 0, l->mark, 1);
  cf_free(l->all_rows);
  cf_free(l->row_at);
  cf_free(l->band);
  cf_free(l->span);
  cf_free(l->odd_cell);
  cf_free(l->odd_block);
  cf_free(l->odd_parent);
  cf_free(l->odd_value);
  cf_free(l->odd_island);
  cf_tiles_destroy(l->own_tiles);
  *l = (cf_coupled){0};
}

/* Where which row of tiles is, and what they all lie within. */
static void find_rows(cf_coupled *l) {
  const cf_tiles *t = l->tiles;
  memset(l->row_at, -1, (size_t)t->n[1] * (size_t)t->n[2] * sizeof *l->row_at);
  for (int a = 0; a < 3; ++a) l->low[a] = l->box.n[a], l->high[a] = 0;
  for (ptrdiff_t v = 0; v < l->rows; ++v) {
    const cf_tile_row *r = &l->row[v];
    const int low[3] = {l->run[r->run].low, r->j, r->k};
    const int high[3] = {l->run[r->run_end - 1].high, r->j_end, r->k_end};
    l->row_at[(r->k >> t->shift[2]) * (ptrdiff_t)t->n[1] + (r->j >> t->shift[1])] = (int32_t)v;
    for (int a = 0; a < 3; ++a) {
      l->low[a] = CF_MIN(l->low[a], low[a]);
      l->high[a] = CF_MAX(l->high[a], high[a]);
    }
  }
}

void cf_coupled_follow_tiles(cf_coupled *l) {
  float **field[FLOATS];
  float_fields(l, field);
  for (int f = 0; f < FLOATS - (l->dim == 2); ++f)
    cf_tiles_follow_bytes(l->tiles, l->followed, *field[f], sizeof(float));
  for (int a = 0; a < l->dim; ++a) cf_tiles_follow_bytes(l->tiles, l->followed, l->weight[a], 1);
  cf_tiles_follow_bytes(l->tiles, l->followed, l->mark, 1);
  l->followed = l->tiles->updates;
  l->row = l->tiles->row;
  l->run = l->tiles->run;
  l->rows = l->tiles->rows;
  find_rows(l);
}

ptrdiff_t cf_part_cells(const cf_part *w) {
  ptrdiff_t cells = 0;
  for (ptrdiff_t v = 0; v < w->rows; ++v)
    CF_TILE_RUNS (w, v, run)
      cells += (ptrdiff_t)(w->row[v].j_end - w->row[v].j) * (w->row[v].k_end - w->row[v].k) *
               (run->high - run->low);
  return cells;
}

void cf_coupled_place(const cf_box *b, ptrdiff_t p, int at[3]) {
  at[2] = b->dim == 3 ? (int)(p / b->stride[2]) : 0;
  p -= at[2] * b->stride[2];
  at[1] = (int)(p / b->stride[1]);
  at[0] = (int)(p - at[1] * b->stride[1]);
}

/* --- from couplings to what the sweeps need ----------------------------------------------------------- */

/* The cells of a row that are looked at in one go. */
#define PIECE 256

/* 1/diagonal, and which cells have a closed or held face: on the low side of axis a if low[a] says that one counts there,
 * on the high side if high[a] does. Returns whether alpha holds any cell much. */
CF_CLONES static bool invert_piece(const cf_coupled *l, const int n, const ptrdiff_t p, const int low[3],
                                   const int high[3], unsigned char edge[PIECE]) {
  const float *free = l->free + p, *held = l->held + p;
  float *inverse = l->inverse + p, sum[PIECE];
  int closed[PIECE], heavy = 0;
  for (int i = 0; i < n; ++i) sum[i] = free[i] + held[i], closed[i] = 0;
  for (int a = 0; a < l->dim; ++a) {
    const float *below = l->c[a] + p, *above = l->c[a] + p + l->box.stride[a];
    const int under = low[a], over = high[a];
    CF_ROW_LOOP
    for (int i = 0; i < n; ++i) {
      sum[i] += below[i] + above[i];
      closed[i] |= (below[i] > 0 ? 0 : under) | (above[i] > 0 ? 0 : over);
    }
  }
  CF_ROW_LOOP
  for (int i = 0; i < n; ++i) {
    const float d = sum[i];
    inverse[i] = d > 0 ? 1 / d : 0;
    edge[i] = d > 0 && closed[i] != 0;
    heavy |= free[i] * inverse[i] > 0.3f;
  }
  return heavy != 0;
}

/* The walls of the box are smooth and do not count as edges: their faces lie at the ends of rows along x. */
static void pardon_ends(const cf_coupled *l, const int from, const int n, const int at[3],
                        unsigned char edge[PIECE]) {
  for (int end = 0; end < 2; ++end) {
    const int i = end ? l->box.n[0] - 1 : 0;
    if (l->periodic[0] || i < from || i >= from + n || !edge[i - from]) continue;
    const ptrdiff_t p = cf_box_at(&l->box, i, at[1], at[2]);
    bool closed = false;
    for (int a = 0; a < l->dim; ++a) {
      const int place = a == 0 ? i : at[a];
      const bool low = l->periodic[a] || place > 0, high = l->periodic[a] || place < l->box.n[a] - 1;
      closed = closed || (low && l->c[a][p] == 0) || (high && l->c[a][p + l->box.stride[a]] == 0);
    }
    edge[i - from] = closed;
  }
}

/* Marks of the cells [low, high) of row (j, k); whether alpha holds any of them much. */
static bool finish_run(const cf_coupled *l, const cf_run *run, const int j, const int k) {
  const int at[3] = {0, j, k};
  int low[3] = {1, 1, 1}, high[3] = {1, 1, 1};
  unsigned char edge[PIECE];
  bool heavy = false;
  for (int a = 1; a < l->dim; ++a) {
    low[a] = l->periodic[a] || at[a] > 0;
    high[a] = l->periodic[a] || at[a] < l->box.n[a] - 1;
  }
  for (int from = run->low; from < run->high; from += PIECE) {
    const int n = CF_MIN(PIECE, run->high - from);
    const ptrdiff_t p = cf_box_at(&l->box, from, j, k);
    heavy |= invert_piece(l, n, p, low, high, edge);
    pardon_ends(l, from, n, at, edge);
    for (int i = 0; i < n; ++i)
      if (edge[i] != (l->mark[p + i] & CF_MARK_EDGE)) l->mark[p + i] ^= CF_MARK_EDGE;
  }
  return heavy;
}

/* Whether alpha holds any cell of the level much. */
static bool is_any_heavy(const cf_coupled *l) {
  int heavy = 0;
#pragma omp parallel for schedule(static) num_threads(cf_coupled_threads(l)) reduction(| : heavy)
  for (ptrdiff_t v = 0; v < l->rows; ++v)
    CF_TILE_ROWS (l, v, j, k)
      CF_TILE_RUNS (l, v, run)
        for (int i = run->low; i < run->high; ++i) {
          const ptrdiff_t p = cf_box_at(&l->box, i, j, k);
          heavy |= l->free[p] * l->inverse[p] > 0.3f;
        }
  return heavy;
}

/* --- the band ----------------------------------------------------------------------------------------- */

CF_CLONES static bool is_any_edge(const int n, const unsigned char *mark) {
  int any = 0;
  CF_ROW_LOOP
  for (int i = 0; i < n; ++i) any |= mark[i] & CF_MARK_EDGE;
  return any != 0;
}

/* Cell at[a] - 1 or + 1 of axis a, across a seam too, as a step from p. */
static ptrdiff_t step_to(const cf_coupled *l, const int a, const int i, const int side) {
  const int n = l->box.n[a], next = side ? i + 1 : i - 1;
  return ((l->periodic[a] ? (next + n) % n : CF_MAX(0, CF_MIN(next, n - 1))) - i) * l->box.stride[a];
}

/* Whether any cell of a run or beside it is at an edge. (Marks of odds are those of an earlier equation still.) */
static bool is_near_edges(const cf_coupled *l, const cf_run *run, const int j, const int k) {
  const int at[3] = {0, j, k}, n = run->high - run->low, last = l->box.n[0] - 1;
  const ptrdiff_t row = cf_box_at(&l->box, 0, j, k), p = row + run->low;
  const unsigned char *mark = l->mark + row;
  if (is_any_edge(n, l->mark + p)) return true;
  int beside = mark[CF_MAX(run->low - 1, 0)] | mark[CF_MIN(run->high, last)];
  if (l->periodic[0]) beside |= mark[0] | mark[last];
  if (beside & CF_MARK_EDGE) return true;
  for (int a = 1; a < l->dim; ++a)
    for (int side = 0; side < 2; ++side)
      if (is_any_edge(n, l->mark + p + step_to(l, a, at[a], side))) return true;
  return false;
}

/* Of the rows of a part, as far as the level has them; what is outside the part stays. */
static void find_band(const cf_coupled *l, const cf_part *w) {
  CF_PARALLEL_PART (l, w, v)
    CF_TILE_ROWS (w, v, j, k) {
      const cf_tile_row *row = cf_coupled_row_at(l, j, k);
      bool any = false;
      for (ptrdiff_t q = row != NULL ? row->run : 0; row != NULL && q < row->run_end && !any; ++q)
        any = is_near_edges(l, &l->run[q], j, k);
      l->band[j + (ptrdiff_t)l->box.n[1] * k] = any;
    }
}

static bool is_any_row_in_band(const cf_coupled *l) {
  for (ptrdiff_t v = 0; v < l->rows; ++v)
    CF_TILE_ROWS (l, v, j, k)
      if (l->band[j + (ptrdiff_t)l->box.n[1] * k]) return true;
  return false;
}

cf_status cf_coupled_finish(cf_coupled *l, const cf_part *w) {
  for (int a = 0; a < l->dim; ++a) cf_coupled_wrap_axis(l, a, l->c[a]);
  int heavy = 0;
#pragma omp parallel for schedule(static) num_threads(cf_coupled_threads(l)) reduction(| : heavy)
  for (ptrdiff_t v = 0; v < w->rows; ++v)
    CF_TILE_ROWS (w, v, j, k)
      CF_TILE_RUNS (w, v, run) heavy |= finish_run(l, run, j, k);
  l->is_gentle = heavy || (w->tiles != NULL && l->is_gentle && is_any_heavy(l));
  find_band(l, w);
  l->has_band = is_any_row_in_band(l);
  return CF_OK;
}
