/* SPDX-License-Identifier: MIT */
#include "solve/coarsen.h"

#include "solve/block.h"
#include "solve/odds.h"

cf_status cf_coarsen_create(const cf_coupled *l, cf_coupled *coarse) {
  int n[3];
  cf_box box;
  cf_tiles *tiles = NULL;
  for (int a = 0; a < 3; ++a) n[a] = l->coarsened[a] ? (l->box.n[a] + 1) / 2 : l->box.n[a];
  CF_TRY(cf_box_init(&box, l->dim, n, 1));
  if (l->tiles != NULL) CF_TRY(cf_tiles_create(&tiles, &box, NULL));
  const cf_status s = cf_coupled_create(coarse, &box, l->periodic, l->threads, tiles);
  coarse->own_tiles = tiles;
  return s;
}

/* --- the coarse equation ------------------------------------------------------------------------------ */

/* The coupling through a face with halves of what lies behind it on both sides, and the resistance of these halves: that of
 * the low side before the face, that of the high side after it. Where the inner face is closed or there is none the way
 * is shorter. */
typedef struct series {
  float low, face, high; /* couplings; of the inner faces: 0 where there is none */
  float both, before, after;
} series;

/* Through the low face of cell p along axis a. *s is the one met before: most are alike, and divisions cost much. */
static void find_series(const cf_coupled *l, const int a, const ptrdiff_t p, const int i, series *s) {
  const ptrdiff_t step = l->box.stride[a];
  const float face = l->c[a][p];
  float low = 0, high = 0;
  if (l->coarsened[a]) {
    const ptrdiff_t below = i > 0 ? p - step : p + (l->box.n[a] - 1) * step; /* across a seam */
    high = i + 1 < l->box.n[a] ? l->c[a][p + step] : 0;
    low = i > 0 || l->box.n[a] % 2 == 0 ? l->c[a][below] : 0;
  }
  if (s->face == face && s->low == low && s->high == high) return;
  const float before = low > 0 ? 0.5f / low : 0, after = high > 0 ? 0.5f / high : 0;
  *s = (series){low, face, high, 1 / (1 / face + before + after), before, after};
}

static unsigned char as_byte(const float weight) {
  const float w = 256 * weight + 0.5f;
  return (unsigned char)(w < 255 ? w : 255);
}

/* Axis a of cell v of a block: adds to *c what its low face is to the coarse cells; the weight of the cell. */
static unsigned char fill_axis(const cf_coupled *l, const cf_block *b, const int v, const int a, float *c,
                               series *through) {
  const ptrdiff_t p = b->p[v], s = l->box.stride[a], across = (l->box.n[a] - 1) * s;
  const int i = b->at[v][a], last = l->box.n[a] - 1;
  if (cf_block_is_inner(l, a, i)) { /* the high face is an outer one: that of the block above */
    if (i == last && !l->periodic[a]) return 0;
    const ptrdiff_t u = i < last ? p + s : p - across;
    if (!(l->c[a][u] > 0) || cf_odds_has(l, u)) return 0;
    find_series(l, a, u, i < last ? i + 1 : 0, through);
    return as_byte(through->before * through->both);
  }
  if (i == 0 && !l->periodic[a]) return 0;
  const ptrdiff_t q = i > 0 ? p - s : p + across;
  if (!(l->c[a][p] > 0) || cf_odds_has(l, q)) return 0;
  find_series(l, a, p, i, through);
  *c += through->both;
  return l->coarsened[a] ? as_byte(through->after * through->both) : 0;
}

/* Whether, away from the walls of the box, the cells of a block and those beside it have no closed face, and all faces that
 * count have one coupling along each axis: nearly always so. */
static bool is_plain(const cf_coupled *l, const cf_block *b) {
  if (b->count != 8 || !cf_coupled_has(l, b->p[0])) return false;
  for (int a = 0; a < 3; ++a)
    if (b->at[0][a] < 1 || b->at[0][a] + 3 >= l->box.n[a]) return false;
  for (int a = 0; a < 3; ++a) {
    const ptrdiff_t s = l->box.stride[a];
    const float c0 = l->c[a][b->p[0]];
    int marks = 0, other = 0;
    for (int v = 0; v < 8; ++v) {
      if (v >> a & 1) continue; /* the lines through the block */
      const unsigned char *mark = l->mark + b->p[v];
      const float *c = l->c[a] + b->p[v];
      marks |= mark[-s] | mark[0] | mark[s] | mark[2 * s];
      other |= c[-s] != c0 || c[0] != c0 || c[s] != c0 || c[2 * s] != c0 || c[3 * s] != c0;
    }
    if (marks != 0 || other) return false;
  }
  return true;
}

/* What fill_cell does there. */
static void fill_plain(const cf_coupled *l, const cf_coupled *coarse, const cf_block *b,
                       const float held_share) {
  float free = 0, held = 0;
  for (int v = 0; v < 8; ++v) free += l->free[b->p[v]], held += l->held[b->p[v]];
  coarse->free[b->parent] = free;
  coarse->held[b->parent] = held_share * held;
  for (int a = 0; a < 3; ++a) {
    const float face = l->c[a][b->p[0]], half = 0.5f / face, both = 1 / (1 / face + half + half);
    const unsigned char weight = as_byte(half * both);
    coarse->c[a][b->parent] = both + both + both + both;
    for (int v = 0; v < 8; ++v)
      if (l->weight[a][b->p[v]] != weight) l->weight[a][b->p[v]] = weight;
  }
}

/* The couplings of a coarse cell to its low neighbours, its diagonal, and the weights of its cells. What cells with another
 * parent add comes later. */
static void fill_cell(const cf_coupled *l, const cf_coupled *coarse, const int at[3],
                      const float held_share) {
  cf_block b;
  cf_block_find(&b, l, coarse, at);
  float free = 0, held = 0, c[3] = {0, 0, 0};
  series through = {0};
  if (is_plain(l, &b)) {
    fill_plain(l, coarse, &b, held_share);
    return;
  }
  for (int v = 0; v < 8 && v < b.count; ++v) {
    const ptrdiff_t p = b.p[v];
    const bool takes_part = cf_coupled_has(l, p) && !cf_odds_has(l, p);
    if (takes_part) free += l->free[p], held += l->held[p];
    for (int a = 0; a < l->dim; ++a) {
      const unsigned char weight =
          takes_part && coarse->box.n[a] > 1 ? fill_axis(l, &b, v, a, &c[a], &through) : 0;
      if (l->weight[a][p] != weight) l->weight[a][p] = weight; /* others' pages are not touched */
    }
  }
  coarse->free[b.parent] = free;
  coarse->held[b.parent] = held_share * held;
  for (int a = 0; a < l->dim; ++a) coarse->c[a][b.parent] = c[a];
}

cf_status cf_coarsen_follow(const cf_coupled *l, cf_coupled *coarse) {
  if (l->tiles == NULL) return CF_OK;
  cf_tiles *t = coarse->own_tiles;
  cf_tiles_drop_all(t);
  for (ptrdiff_t v = 0; v < l->rows; ++v)
    CF_TILE_RUNS (l, v, run) {
      const cf_tile_row *row = &l->row[v];
      int low[3] = {run->low, row->j, row->k}, high[3] = {run->high, row->j_end, row->k_end};
      for (int a = 0; a < 3; ++a) {
        if (!l->coarsened[a]) continue;
        low[a] /= 2;
        high[a] = (high[a] + 1) / 2;
      }
      cf_tiles_add_box(t, low, high);
    }
  CF_TRY(cf_tiles_update(t));
  cf_coupled_follow_tiles(coarse);
  return CF_OK;
}

cf_status cf_coarsen(cf_coupled *l, cf_coupled *coarse, const cf_part *w) {
  CF_TRY(cf_odds_find(l, coarse, w));
  bool all = true;
  for (int a = 0; a < l->dim; ++a) all = all && (l->coarsened[a] || l->box.n[a] == 1);
  const float held_share = all ? 0.5f : 1; /* twice the distance to the wall */
  CF_PARALLEL_PART (coarse, w, v)
    CF_TILE_ROWS (w, v, J, K)
      CF_TILE_RUNS (w, v, run)
        for (int I = run->low; I < run->high; ++I) fill_cell(l, coarse, (int[]){I, J, K}, held_share);
  cf_odds_add(l, coarse, w, held_share);
  return cf_coupled_finish(coarse, w);
}
