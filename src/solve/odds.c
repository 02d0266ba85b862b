/* SPDX-License-Identifier: MIT */
#include "solve/odds.h"

#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "solve/block.h"

/* --- pieces of blocks --------------------------------------------------------------------------------- */

/* The usual case: no cell has a closed face, so all belong together, or none has an equation. */
static bool is_whole(const cf_coupled *l, const cf_block *b) {
  int marks = 0;
  for (int v = 0; v < 8; ++v) marks |= v < b->count ? l->mark[b->p[v]] : 0;
  return !(marks & CF_MARK_EDGE);
}

/* Labels the pieces of a block: label[v] is the first cell of v's piece, -1 without an equation. Returns the main one, or
 * -1 where there is none; *pieces: how many. */
static int label_pieces(const cf_coupled *l, const cf_block *b, int label[8], int *pieces) {
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
static bool is_island(const cf_coupled *l, const cf_block *b, const int label[8], const int piece) {
  for (int v = 0; v < b->count; ++v) {
    if (label[v] != piece) continue;
    for (int a = 0; a < l->dim; ++a) {
      const ptrdiff_t p = b->p[v], s = l->box.stride[a];
      if (l->c[a][p] > 0 && !cf_block_is_inner(l, a, b->at[v][a])) return false;
      if (l->c[a][p + s] > 0 && !cf_block_is_inner(l, a, b->at[v][a] + 1)) return false;
    }
  }
  return true;
}

static cf_status add_piece(odd_list *o, const cf_coupled *l, const cf_block *b, const int label[8],
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
          cf_block b;
          cf_block_find(&b, l, coarse, (int[]){I, J, K});
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
    else if (cf_odds_has(l, p))
      l->mark[p] ^= CF_MARK_ODD;
  }
  return CF_OK;
}

static cf_status add_odds_of(odd_list *o, const cf_coupled *l, const cf_coupled *coarse, const cf_part *w) {
  if (!l->has_band) return CF_OK; /* nothing is closed */
  find_pieces(l, coarse, w);
  for (ptrdiff_t v = 0; v < w->rows; ++v)
    CF_TILE_ROWS (w, v, J, K)
      CF_TILE_RUNS (w, v, run)
        for (int I = run->low; I < run->high; ++I) {
          if (!(coarse->rest[cf_box_at(&coarse->box, I, J, K)] > 0)) continue;
          cf_block b;
          cf_block_find(&b, l, coarse, (int[]){I, J, K});
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
  if (o->count > 0) qsort(o->at, (size_t)o->count, sizeof *o->at, in_order);
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
    if (!cf_odds_has(l, q->cell)) l->mark[q->cell] |= CF_MARK_ODD;
    set_number(l, q->cell, (int32_t)v);
  }
  return CF_OK;
}

static cf_status find(cf_coupled *l, const cf_coupled *coarse, const cf_part *w) {
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
  return cf_odds_has(l, p) ? l->odd_parent[number_of(l, p)] : cf_block_parent_of(l, coarse, at);
}

/* Where a cell may join: the parent of the cell beyond its strongest face, if that is next to its own block. `settled`:
 * cells outside the main pieces count too, once they have a parent. */
static ptrdiff_t join(const cf_coupled *l, const cf_coupled *coarse, const ptrdiff_t p, const bool settled) {
  int at[3], other[3], axis;
  ptrdiff_t best = CF_NO_PARENT, high;
  float strongest = 0;
  cf_coupled_place(&l->box, p, at);
  const ptrdiff_t own = cf_block_parent_of(l, coarse, at);
  for (int a = 0; a < l->dim; ++a)
    for (int side = 0; side < 2; ++side) {
      const float c = l->c[a][side ? p + l->box.stride[a] : p];
      if (!(c > strongest * 1.001f) || !neighbour(l, at, a, side, other)) continue;
      const ptrdiff_t q = cf_box_at(&l->box, other[0], other[1], other[2]);
      if (cf_odds_has(l, q) && !settled) continue;
      const ptrdiff_t to = parent_at(l, coarse, other);
      if (to == CF_NO_PARENT || to == own || !are_neighbours(coarse, own, to, &axis, &high)) continue;
      strongest = c;
      best = to;
    }
  return best;
}

/* Round by round, each seeing what the one before has settled. */
static cf_status settle(cf_coupled *l, const cf_coupled *coarse) {
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

cf_status cf_odds_find(cf_coupled *l, const cf_coupled *coarse, const cf_part *w) {
  CF_TRY(find(l, coarse, w));
  return settle(l, coarse);
}

/* --- what they bring ---------------------------------------------------------------------------------- */

/* Whether coarse cell p is one that is made anew. */
static bool is_anew(const cf_coupled *coarse, const cf_part *w, const ptrdiff_t p) {
  int at[3];
  if (w->tiles == NULL) return true;
  cf_coupled_place(&coarse->box, p, at);
  return cf_part_has(w, at);
}

void cf_odds_add(const cf_coupled *l, const cf_coupled *coarse, const cf_part *w, const float held_share) {
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
        if (side == 0 && cf_odds_has(l, q)) continue; /* that one sees this face too */
        const ptrdiff_t to = parent_at(l, coarse, other);
        ptrdiff_t high;
        if (to == own || !are_neighbours(coarse, own, to, &axis, &high)) continue;
        if (is_anew(coarse, w, high)) coarse->c[axis][high] += 0.5f * c;
      }
  }
}
