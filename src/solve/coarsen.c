/* SPDX-License-Identifier: MIT */
#include "solve/coarsen.h"

#include <string.h>

#include "solve/amend.h"
#include "solve/block.h"
#include "solve/odds.h"
#include "solve/open.h"

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
 * the low side before the face, that of the high side after it. Where no inner face leads on the way is shorter if a known
 * value is near; behind an insulated wall it is not, for what is smooth has a parabola there: in a cell of width 1, then 2,
 * 2, ..., the means of s^2 are 2 and 6 apart and their fluxes 2 and 6. */
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
    if (!(high > 0) && !(l->held[p] > 0)) high = face;
    if (!(low > 0) && !(l->held[below] > 0)) low = face;
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

/* The couplings of a coarse cell to its low neighbours, its diagonal, and the weights of its cells. What cells with another
 * parent add comes later. */
static void fill_cell(const cf_coupled *l, const cf_coupled *coarse, const int at[3],
                      const float held_share) {
  cf_block b;
  cf_block_find(&b, l, coarse, at);
  float free = 0, held = 0, c[3] = {0, 0, 0};
  series through = {0};
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

/* --- many at once ------------------------------------------------------------------------------------- */

/* Where no face is closed nor beyond a wall, coarse cells of a row are made together: [I, I + n) of row (J, K), from fine
 * cells that begin at p. All is added in the order of fill_cell, so that it does not matter which of them is met. */
enum { TOGETHER = 16 };

typedef struct together {
  const cf_coupled *l, *coarse;
  int n;
  ptrdiff_t p, parent;
  float held_share;
} together;

/* sum[I] += both fine values above it. */
CF_CLONES static void add_pairs(const int n, const float *fine, float *sum) {
  CF_ROW_LOOP
  for (int i = 0; i < n; ++i) sum[i] = sum[i] + fine[2 * i] + fine[2 * i + 1];
}

/* Faces of a row across it, with those below and above: the couplings in series, and the weights of the cells above the
 * faces and below them. */
CF_CLONES static void join_faces(const int n, const float *low, const float *face, const float *high,
                                 float *both, unsigned char *above, unsigned char *below) {
  CF_ROW_LOOP
  for (int i = 0; i < n; ++i) {
    const float before = 0.5f / low[i], after = 0.5f / high[i];
    both[i] = 1 / (1 / face[i] + before + after);
    const float over = 256 * (after * both[i]) + 0.5f, under = 256 * (before * both[i]) + 0.5f;
    above[i] = (unsigned char)(over < 255 ? over : 255);
    below[i] = (unsigned char)(under < 255 ? under : 255);
  }
}

/* Axes across the row: on the low side of the blocks the coupling and the weights of their low cells, on the high side the
 * weights of their high cells. */
static void fill_across(const together *t, const int a) {
  const cf_coupled *l = t->l;
  const ptrdiff_t s = l->box.stride[a], beside = l->dim == 3 ? l->box.stride[3 - a] : 0;
  float both[2 * TOGETHER], *sum = t->coarse->c[a] + t->parent;
  unsigned char unused[2 * TOGETHER];
  memset(sum, 0, (size_t)t->n * sizeof *sum);
  for (int line = 0; line < (l->dim == 3 ? 2 : 1); ++line) {
    const ptrdiff_t p = t->p + line * beside;
    const float *c = l->c[a] + p;
    unsigned char *w = l->weight[a] + p;
    join_faces(2 * t->n, c + s, c + 2 * s, c + 3 * s, both, unused, w + s);
    join_faces(2 * t->n, c - s, c, c + s, both, w, unused);
    add_pairs(t->n, both, sum);
  }
}

/* Faces along the row: every other one lies between coarse cells. */
static void fill_along(const together *t) {
  const cf_coupled *l = t->l;
  float part[3][TOGETHER + 1], both[TOGETHER + 1], *sum = t->coarse->c[0] + t->parent;
  unsigned char above[TOGETHER + 1], below[TOGETHER + 1];
  memset(sum, 0, (size_t)t->n * sizeof *sum);
  for (int line = 0; line < (l->dim == 3 ? 4 : 2); ++line) {
    const ptrdiff_t p =
        t->p + (line & 1) * l->box.stride[1] + (l->dim == 3 ? (line >> 1) * l->box.stride[2] : 0);
    const float *c = l->c[0] + p;
    unsigned char *w = l->weight[0] + p;
    for (int i = 0; i <= t->n; ++i)
      for (int v = 0; v < 3; ++v) part[v][i] = c[2 * i - 1 + v];
    join_faces(t->n + 1, part[0], part[1], part[2], both, above, below);
    for (int i = 0; i < t->n; ++i) {
      sum[i] += both[i];
      w[2 * i] = above[i];
      w[2 * i + 1] = below[i + 1];
    }
  }
}

static void fill_together(const together *t) {
  const cf_coupled *l = t->l;
  float *free = t->coarse->free + t->parent, *held = t->coarse->held + t->parent;
  memset(free, 0, (size_t)t->n * sizeof *free);
  memset(held, 0, (size_t)t->n * sizeof *held);
  for (int k = 0; k < (l->dim == 3 ? 2 : 1); ++k)
    for (int j = 0; j < 2; ++j) {
      const ptrdiff_t p = t->p + j * l->box.stride[1] + k * l->box.stride[2];
      add_pairs(t->n, l->free + p, free);
      add_pairs(t->n, l->held + p, held);
    }
  for (int i = 0; i < t->n; ++i) held[i] *= t->held_share;
  fill_along(t);
  for (int a = 1; a < l->dim; ++a) fill_across(t, a);
}

/* Whether the cells of the blocks and those beside them are within the box and bear no mark. */
static bool is_clean(const together *t, const int at[3]) {
  const cf_coupled *l = t->l;
  const int last[3] = {at[0] + t->n - 1, at[1], at[2]};
  for (int a = 0; a < l->dim; ++a)
    if (!l->coarsened[a] || at[a] < 1 || 2 * last[a] + 3 >= l->box.n[a]) return false;
  int marks = 0;
  for (int k = l->dim == 3 ? -1 : 0; k < (l->dim == 3 ? 3 : 1); ++k)
    for (int j = -1; j < 3; ++j) {
      if ((j < 0 || j > 1) && (k < 0 || k > 1)) continue; /* beside an edge of the blocks */
      const unsigned char *row = l->mark + t->p + j * l->box.stride[1] + k * l->box.stride[2];
      for (int i = -1; i < 2 * t->n + 1; ++i) marks |= row[i];
    }
  return marks == 0 && cf_coupled_has(l, t->p); /* all have an equation, or none: else there were edges */
}

static void fill_run(const cf_coupled *l, const cf_coupled *coarse, const cf_run *run, const int J,
                     const int K, const float held_share) {
  const int last = l->box.n[0] / 2 - 2; /* beyond it, and before 1, blocks are at a wall */
  for (int I = run->low, end; I < run->high; I = end) {
    const int at[3] = {I, J, K}, most = I < 1 || I > last ? 1 : CF_MIN(TOGETHER, last + 1 - I);
    end = CF_MIN(I + most, run->high);
    const together t = {.l = l,
                        .coarse = coarse,
                        .n = end - I,
                        .p = cf_box_at(&l->box, I << l->coarsened[0], J << l->coarsened[1],
                                       K << (l->dim == 3 && l->coarsened[2])),
                        .parent = cf_box_at(&coarse->box, I, J, K),
                        .held_share = held_share};
    if (is_clean(&t, at))
      fill_together(&t);
    else
      for (int i = I; i < end; ++i) fill_cell(l, coarse, (int[]){i, J, K}, held_share);
  }
}

/* --- a level ------------------------------------------------------------------------------------------ */

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
  if (cf_open_coarsen(l, coarse)) return CF_OK;
  CF_TRY(cf_odds_find(l, coarse, w));
  bool all = true;
  for (int a = 0; a < l->dim; ++a) all = all && (l->coarsened[a] || l->box.n[a] == 1);
  const float held_share = all ? 0.5f : 1; /* twice the distance to the wall */
  CF_PARALLEL_PART (coarse, w, v)
    CF_TILE_ROWS (w, v, J, K)
      CF_TILE_RUNS (w, v, run) fill_run(l, coarse, run, J, K, held_share);
  cf_odds_add(l, coarse, w, held_share);
  cf_amend(l, coarse, w);
  return cf_coupled_finish(coarse, w);
}
