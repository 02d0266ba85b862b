/* SPDX-License-Identifier: MIT */
#include "solve/coarsen.h"

#include <stdlib.h>
#include <string.h>

#include "base/mem.h"

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

/* --- blocks ------------------------------------------------------------------------------------------- */

/* The cells of a coarse cell. */
typedef struct block {
  int count;
  int at[8][3];
  ptrdiff_t p[8], parent;
} block;

static void find_block(block *b, const cf_coupled *l, const cf_coupled *coarse, const int at[3]) {
  int low[3], pair[3]; /* 1: two cells along this axis */
  for (int a = 0; a < 3; ++a) {
    low[a] = l->coarsened[a] ? 2 * at[a] : at[a];
    pair[a] = l->coarsened[a] && low[a] + 1 < l->box.n[a];
  }
  b->parent = cf_box_at(&coarse->box, at[0], at[1], at[2]);
  b->count = 1 << (pair[0] + pair[1] + pair[2]);
  for (int v = 0; v < 8; ++v) {
    int *cell = b->at[v];
    cell[0] = low[0] + (v & pair[0]);
    cell[1] = low[1] + (v >> pair[0] & pair[1]);
    cell[2] = low[2] + (v >> (pair[0] + pair[1]) & pair[2]);
    b->p[v] = cf_box_at(&l->box, cell[0], cell[1], cell[2]);
  }
}

static ptrdiff_t parent_of(const cf_coupled *l, const cf_coupled *coarse, const int at[3]) {
  int c[3];
  for (int a = 0; a < 3; ++a) c[a] = l->coarsened[a] ? at[a] / 2 : at[a];
  return cf_box_at(&coarse->box, c[0], c[1], c[2]);
}

/* Whether the low face of axis a of a cell lies within a block. */
static bool is_inner(const cf_coupled *l, const int a, const int i) { return l->coarsened[a] && i % 2 == 1; }

/* The usual case: all cells have an equation and no inner face is closed. */
static bool is_whole(const cf_coupled *l, const block *b) {
  for (int v = 0; v < b->count; ++v) {
    if (!cf_coupled_has(l, b->p[v])) return false;
    for (int a = 0; a < l->dim; ++a)
      if (is_inner(l, a, b->at[v][a]) && !(l->c[a][b->p[v]] > 0)) return false;
  }
  return true;
}

/* Labels the pieces of a block: label[v] is the first cell of v's piece, -1 without an equation. Returns the main one, or
 * -1 where there is none; *pieces: how many. */
static int label_pieces(const cf_coupled *l, const block *b, int label[8], int *pieces) {
  for (int v = 0; v < b->count; ++v) label[v] = cf_coupled_has(l, b->p[v]) ? v : -1;
  for (int round = 0; round < 3; ++round) /* as many as a path through a block has turns */
    for (int v = 0; v < b->count; ++v)
      for (int u = 0; u < v; ++u) {
        if (label[u] < 0 || label[v] < 0 || label[u] == label[v]) continue;
        for (int a = 0; a < l->dim; ++a)
          if (b->p[v] - b->p[u] == l->box.stride[a] && b->at[v][a] == b->at[u][a] + 1 && l->c[a][b->p[v]] > 0)
            label[u] = label[v] = CF_MIN(label[u], label[v]);
      }
  int main_piece = -1;
  float largest = -1;
  *pieces = 0;
  for (int w = 0; w < b->count; ++w) {
    float size = 0;
    for (int v = 0; v < b->count; ++v)
      if (label[v] == w) size += 1 / l->inverse[b->p[v]];
    *pieces += size > 0;
    if (size > largest * 1.001f) largest = size, main_piece = w;
  }
  return *pieces > 0 ? main_piece : -1;
}

/* --- cells with another parent ------------------------------------------------------------------------ */

/* One of them, while they are found: its block, and its number in the order they are met in. */
typedef struct odd {
  ptrdiff_t cell, block, number;
  int32_t island;
} odd;

typedef struct odd_list {
  odd *at;
  ptrdiff_t count, room;
} odd_list;

static cf_status odd_add(odd_list *o, const ptrdiff_t cell, const ptrdiff_t around, const int32_t island) {
  if (o->count == o->room) {
    const ptrdiff_t room = 2 * o->room + 256;
    odd *more;
    CF_TRY(CF_NEW(&more, room));
    if (o->count > 0) memcpy(more, o->at, (size_t)o->count * sizeof *more);
    cf_free(o->at);
    o->at = more;
    o->room = room;
  }
  o->at[o->count] = (odd){cell, around, o->count, island};
  ++o->count;
  return CF_OK;
}

static bool is_odd(const cf_coupled *l, const ptrdiff_t p) { return l->mark[p] & CF_MARK_ODD; }

/* The number of an odd cell among the odds lies in `rest` while levels are made, as bits, for a float cannot count far. */
static void set_number(const cf_coupled *l, const ptrdiff_t p, const int32_t number) {
  memcpy(&l->rest[p], &number, 4);
}

static int32_t number_of(const cf_coupled *l, const ptrdiff_t p) {
  int32_t number;
  memcpy(&number, &l->rest[p], 4);
  return number;
}

/* Whether no open face leads out of a piece. */
static bool is_island(const cf_coupled *l, const block *b, const int label[8], const int piece) {
  for (int v = 0; v < b->count; ++v) {
    if (label[v] != piece) continue;
    for (int a = 0; a < l->dim; ++a) {
      const ptrdiff_t p = b->p[v], s = l->box.stride[a];
      if (l->c[a][p] > 0 && !is_inner(l, a, b->at[v][a])) return false;
      if (l->c[a][p + s] > 0 && !is_inner(l, a, b->at[v][a] + 1)) return false;
    }
  }
  return true;
}

static cf_status add_piece(odd_list *o, const cf_coupled *l, const block *b, const int label[8],
                           const int piece) {
  /* where the pieces of a block are islands they are told apart by number */
  const int32_t island = is_island(l, b, label, piece) ? 1 + piece : 0;
  for (int v = 0; v < b->count; ++v)
    if (label[v] == piece) CF_TRY(odd_add(o, b->p[v], b->parent, island));
  return CF_OK;
}

/* Notes in the rest of coarse cells, which nobody needs now, those whose block has several pieces: nearly none, and to
 * look costs more than all else here. */
static void find_pieces(const cf_coupled *l, const cf_coupled *coarse, const cf_part *w) {
  CF_PARALLEL_PART (coarse, w, v)
    CF_TILE_ROWS (w, v, J, K)
      CF_TILE_RUNS (w, v, run)
        for (int I = run->low; I < run->high; ++I) {
          block b;
          find_block(&b, l, coarse, (int[]){I, J, K});
          int label[8], pieces = 1;
          if (!is_whole(l, &b)) label_pieces(l, &b, label, &pieces);
          coarse->rest[b.parent] = pieces < 2 ? 0 : 1;
        }
}

/* Those of blocks that stay as they are; all others are forgotten. */
static cf_status keep_odds(odd_list *o, const cf_coupled *l, const cf_coupled *coarse, const cf_part *w) {
  for (ptrdiff_t v = 0; v < l->odds; ++v) {
    int at[3];
    cf_coupled_place(&coarse->box, l->odd_block[v], at);
    const ptrdiff_t p = l->odd_cell[v];
    if (cf_coupled_has(l, p) && !cf_part_has(w, at))
      CF_TRY(odd_add(o, p, l->odd_block[v], l->odd_island[v]));
    else if (is_odd(l, p))
      l->mark[p] ^= CF_MARK_ODD;
  }
  return CF_OK;
}

static cf_status add_odds_of(odd_list *o, const cf_coupled *l, const cf_coupled *coarse, const cf_part *w) {
  if (l->bands[0] + l->bands[1] == 0) return CF_OK; /* nothing is closed */
  find_pieces(l, coarse, w);
  for (ptrdiff_t v = 0; v < w->rows; ++v)
    CF_TILE_ROWS (w, v, J, K)
      CF_TILE_RUNS (w, v, run)
        for (int I = run->low; I < run->high; ++I) {
          if (!(coarse->rest[cf_box_at(&coarse->box, I, J, K)] > 0)) continue;
          block b;
          find_block(&b, l, coarse, (int[]){I, J, K});
          int label[8], pieces;
          const int main_piece = label_pieces(l, &b, label, &pieces);
          for (int piece = 0; piece < b.count; ++piece)
            if (label[piece] == piece && piece != main_piece) CF_TRY(add_piece(o, l, &b, label, piece));
        }
  return CF_OK;
}

static int in_order(const void *a, const void *b) {
  const odd *x = a, *y = b;
  if (x->block != y->block) return x->block < y->block ? -1 : 1;
  return (x->number > y->number) - (x->number < y->number);
}

static cf_status replace(void **list, const ptrdiff_t room, const size_t size) {
  void *more;
  CF_TRY(cf_new_array(&more, (size_t)room, size));
  cf_free(*list);
  *list = more;
  return CF_OK;
}

/* What the lists hold is lost, but if there is no memory the cells are still known: they bear marks. */
static cf_status odds_room(cf_coupled *l, const ptrdiff_t count) {
  if (count <= l->odd_room) return CF_OK;
  const ptrdiff_t room = count + count / 2;
  CF_TRY(replace((void **)&l->odd_block, room, sizeof *l->odd_block));
  CF_TRY(replace((void **)&l->odd_parent, room, sizeof *l->odd_parent));
  CF_TRY(replace((void **)&l->odd_value, room, sizeof *l->odd_value));
  CF_TRY(replace((void **)&l->odd_island, room, sizeof *l->odd_island));
  CF_TRY(replace((void **)&l->odd_cell, room, sizeof *l->odd_cell));
  l->odd_room = room;
  return CF_OK;
}

/* What was found, in the order of blocks: it must not depend on what was made anew, for sums follow it. */
static cf_status take_odds(cf_coupled *l, odd_list *o) {
  qsort(o->at, (size_t)o->count, sizeof *o->at, in_order);
  CF_TRY(odds_room(l, o->count));
  l->odds = o->count;
  int32_t islands = 0;
  for (ptrdiff_t v = 0; v < o->count; ++v) {
    const odd *q = &o->at[v];
    islands += q->island > 0 && (v == 0 || q->block != q[-1].block || q->island != q[-1].island);
    l->odd_cell[v] = q->cell;
    l->odd_block[v] = q->block;
    l->odd_parent[v] = CF_NO_PARENT;
    l->odd_island[v] = q->island > 0 ? islands : 0;
    if (!is_odd(l, q->cell)) l->mark[q->cell] |= CF_MARK_ODD;
    set_number(l, q->cell, (int32_t)v);
  }
  return CF_OK;
}

static cf_status find_odds(cf_coupled *l, const cf_coupled *coarse, const cf_part *w) {
  odd_list o = {NULL, 0, 0};
  cf_status s = keep_odds(&o, l, coarse, w);
  if (s == CF_OK) s = add_odds_of(&o, l, coarse, w);
  if (s == CF_OK) s = take_odds(l, &o);
  cf_free(o.at);
  return s;
}

/* The cell beyond a face, across a seam too; false: there is none. */
static bool neighbour(const cf_coupled *l, const int at[3], const int a, const int high, int other[3]) {
  memcpy(other, at, 3 * sizeof *other);
  other[a] += high ? 1 : -1;
  if (other[a] < 0 || other[a] >= l->box.n[a]) {
    if (!l->periodic[a]) return false;
    other[a] = high ? 0 : l->box.n[a] - 1;
  }
  return true;
}

/* Whether two coarse cells share a face (or are one): *axis, and which is the high one. */
static bool are_neighbours(const cf_coupled *coarse, const ptrdiff_t p, const ptrdiff_t q, int *axis,
                           ptrdiff_t *high) {
  int at[3], to[3], apart = 0;
  cf_coupled_place(&coarse->box, p, at);
  cf_coupled_place(&coarse->box, q, to);
  *axis = -1;
  for (int a = 0; a < coarse->dim; ++a) {
    if (at[a] == to[a]) continue;
    const int step = to[a] - at[a], n = coarse->box.n[a];
    const bool seam = coarse->periodic[a] && (step == n - 1 || step == 1 - n);
    if (step != 1 && step != -1 && !seam) return false;
    ++apart;
    *axis = a;
    *high = (step == 1 || (seam && step != -1 && step < 0)) ? q : p;
  }
  return apart <= 1;
}

/* The coarse cell that the cell at a place belongs to. */
static ptrdiff_t parent_at(const cf_coupled *l, const cf_coupled *coarse, const int at[3]) {
  const ptrdiff_t p = cf_box_at(&l->box, at[0], at[1], at[2]);
  return is_odd(l, p) ? l->odd_parent[number_of(l, p)] : parent_of(l, coarse, at);
}

/* Where a cell may join: the parent of the cell beyond its strongest face, if that is next to its own block. `settled`:
 * cells outside the main pieces count too, once they have a parent. */
static ptrdiff_t join(const cf_coupled *l, const cf_coupled *coarse, const ptrdiff_t p, const bool settled) {
  int at[3], other[3], axis;
  ptrdiff_t best = CF_NO_PARENT, high;
  float strongest = 0;
  cf_coupled_place(&l->box, p, at);
  const ptrdiff_t own = parent_of(l, coarse, at);
  for (int a = 0; a < l->dim; ++a)
    for (int side = 0; side < 2; ++side) {
      const float c = l->c[a][side ? p + l->box.stride[a] : p];
      if (!(c > strongest * 1.001f) || !neighbour(l, at, a, side, other)) continue;
      const ptrdiff_t q = cf_box_at(&l->box, other[0], other[1], other[2]);
      if (is_odd(l, q) && !settled) continue;
      const ptrdiff_t to = parent_at(l, coarse, other);
      if (to == CF_NO_PARENT || to == own || !are_neighbours(coarse, own, to, &axis, &high)) continue;
      strongest = c;
      best = to;
    }
  return best;
}

/* Round by round, each seeing what the one before has settled. */
static cf_status settle_odds(cf_coupled *l, const cf_coupled *coarse) {
  if (l->odds == 0) return CF_OK;
  ptrdiff_t *next;
  CF_TRY(CF_NEW(&next, l->odds));
  for (int round = 0; round < 3; ++round) {
    for (ptrdiff_t v = 0; v < l->odds; ++v) {
      const bool open = l->odd_island[v] == 0 && l->odd_parent[v] == CF_NO_PARENT;
      next[v] = open ? join(l, coarse, l->odd_cell[v], round > 0) : l->odd_parent[v];
    }
    memcpy(l->odd_parent, next, (size_t)l->odds * sizeof *next);
  }
  for (ptrdiff_t v = 0; v < l->odds; ++v)
    if (l->odd_island[v] == 0 && l->odd_parent[v] == CF_NO_PARENT) l->odd_parent[v] = l->odd_block[v];
  cf_free(next);
  return CF_OK;
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
static unsigned char fill_axis(const cf_coupled *l, const block *b, const int v, const int a, float *c,
                               series *through) {
  const ptrdiff_t p = b->p[v], s = l->box.stride[a], across = (l->box.n[a] - 1) * s;
  const int i = b->at[v][a], last = l->box.n[a] - 1;
  if (is_inner(l, a, i)) { /* the high face is an outer one: that of the block above */
    if (i == last && !l->periodic[a]) return 0;
    const ptrdiff_t u = i < last ? p + s : p - across;
    if (!(l->c[a][u] > 0) || is_odd(l, u)) return 0;
    find_series(l, a, u, i < last ? i + 1 : 0, through);
    return as_byte(through->before * through->both);
  }
  if (i == 0 && !l->periodic[a]) return 0;
  const ptrdiff_t q = i > 0 ? p - s : p + across;
  if (!(l->c[a][p] > 0) || is_odd(l, q)) return 0;
  find_series(l, a, p, i, through);
  *c += through->both;
  return l->coarsened[a] ? as_byte(through->after * through->both) : 0;
}

/* The couplings of a coarse cell to its low neighbours, its diagonal, and the weights of its cells. What cells with another
 * parent add comes later. */
static void fill_cell(const cf_coupled *l, const cf_coupled *coarse, const int at[3],
                      const float held_share) {
  block b;
  find_block(&b, l, coarse, at);
  float free = 0, held = 0, c[3] = {0, 0, 0};
  series through = {0};
  for (int v = 0; v < 8 && v < b.count; ++v) {
    const ptrdiff_t p = b.p[v];
    const bool takes_part = cf_coupled_has(l, p) && !is_odd(l, p);
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

/* Whether coarse cell p is one that is made anew. */
static bool is_anew(const cf_coupled *coarse, const cf_part *w, const ptrdiff_t p) {
  int at[3];
  if (w->tiles == NULL) return true;
  cf_coupled_place(&coarse->box, p, at);
  return cf_part_has(w, at);
}

static void add_odds(const cf_coupled *l, const cf_coupled *coarse, const cf_part *w,
                     const float held_share) {
  for (ptrdiff_t v = 0; v < l->odds; ++v) {
    const ptrdiff_t p = l->odd_cell[v], own = l->odd_parent[v];
    if (own == CF_NO_PARENT) continue;
    int at[3], other[3], axis;
    cf_coupled_place(&l->box, p, at);
    if (is_anew(coarse, w, own)) {
      coarse->free[own] += l->free[p];
      coarse->held[own] += held_share * l->held[p];
    }
    for (int a = 0; a < l->dim; ++a)
      for (int side = 0; side < 2; ++side) {
        const float c = l->c[a][side ? p + l->box.stride[a] : p];
        if (!(c > 0) || !neighbour(l, at, a, side, other)) continue;
        const ptrdiff_t q = cf_box_at(&l->box, other[0], other[1], other[2]);
        if (side == 0 && is_odd(l, q)) continue; /* that one sees this face too */
        const ptrdiff_t to = parent_at(l, coarse, other);
        ptrdiff_t high;
        if (to == own || !are_neighbours(coarse, own, to, &axis, &high)) continue;
        if (is_anew(coarse, w, high)) coarse->c[axis][high] += 0.5f * c;
      }
  }
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
  CF_TRY(find_odds(l, coarse, w));
  CF_TRY(settle_odds(l, coarse));
  bool all = true;
  for (int a = 0; a < l->dim; ++a) all = all && (l->coarsened[a] || l->box.n[a] == 1);
  const float held_share = all ? 0.5f : 1; /* twice the distance to the wall */
  CF_PARALLEL_PART (coarse, w, v)
    CF_TILE_ROWS (w, v, J, K)
      CF_TILE_RUNS (w, v, run)
        for (int I = run->low; I < run->high; ++I) fill_cell(l, coarse, (int[]){I, J, K}, held_share);
  add_odds(l, coarse, w, held_share);
  return cf_coupled_finish(coarse, w);
}
