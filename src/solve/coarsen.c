/* SPDX-License-Identifier: MIT */
#include "solve/coarsen.h"

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
  int count, axis_count[3];
  int at[8][3];
  ptrdiff_t p[8], parent;
} block;

static block block_of(const cf_coupled *l, const cf_coupled *coarse, const int at[3]) {
  block b = {.parent = cf_box_at(&coarse->box, at[0], at[1], at[2])};
  int low[3];
  for (int a = 0; a < 3; ++a) {
    low[a] = l->coarsened[a] ? 2 * at[a] : at[a];
    b.axis_count[a] = l->coarsened[a] && low[a] + 1 < l->box.n[a] ? 2 : 1;
  }
  for (int k = 0; k < b.axis_count[2]; ++k)
    for (int j = 0; j < b.axis_count[1]; ++j)
      for (int i = 0; i < b.axis_count[0]; ++i) {
        int *cell = b.at[b.count];
        cell[0] = low[0] + i, cell[1] = low[1] + j, cell[2] = low[2] + k;
        b.p[b.count++] = cf_box_at(&l->box, cell[0], cell[1], cell[2]);
      }
  return b;
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

static cf_status enlarge(void **list, const ptrdiff_t used, const ptrdiff_t room, const size_t size) {
  void *more;
  CF_TRY(cf_new_array(&more, (size_t)room, size));
  if (*list != NULL) memcpy(more, *list, (size_t)used * size);
  cf_free(*list);
  *list = more;
  return CF_OK;
}

static cf_status odd_add(cf_coupled *l, const ptrdiff_t p, const int32_t island) {
  if (l->odds == l->odd_room) {
    const ptrdiff_t room = 2 * l->odd_room + 256;
    CF_TRY(enlarge((void **)&l->odd_cell, l->odds, room, sizeof *l->odd_cell));
    CF_TRY(enlarge((void **)&l->odd_parent, l->odds, room, sizeof *l->odd_parent));
    CF_TRY(enlarge((void **)&l->odd_value, l->odds, room, sizeof *l->odd_value));
    CF_TRY(enlarge((void **)&l->odd_island, l->odds, room, sizeof *l->odd_island));
    l->odd_room = room;
  }
  l->odd_cell[l->odds] = p;
  l->odd_island[l->odds] = island;
  l->odd_parent[l->odds++] = CF_NO_PARENT;
  return CF_OK;
}

/* A cell outside the main piece of its block is marked in `rest` with its number among them, counted from 1; others have
 * 0. The number is kept as bits, for a float cannot count far. */
static void mark(const cf_coupled *l, const ptrdiff_t p, const int32_t number) {
  memcpy(&l->rest[p], &number, 4);
}

static int32_t mark_of(const cf_coupled *l, const ptrdiff_t p) {
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

static cf_status add_piece(cf_coupled *l, const block *b, const int label[8], const int piece,
                           const int32_t island) {
  for (int v = 0; v < b->count; ++v) {
    if (label[v] != piece) continue;
    CF_TRY(odd_add(l, b->p[v], island));
    mark(l, b->p[v], (int32_t)l->odds);
  }
  return CF_OK;
}

/* Marks in the rest of coarse cells, which nobody needs now, those whose block has several pieces: nearly none, and to
 * look costs more than all else here. */
static void find_pieces(const cf_coupled *l, const cf_coupled *coarse) {
  CF_PARALLEL_COUPLED (coarse, v)
    CF_TILE_ROWS (coarse, v, J, K)
      CF_TILE_RUNS (coarse, v, run)
        for (int I = run->low; I < run->high; ++I) {
          const block b = block_of(l, coarse, (int[]){I, J, K});
          int label[8], pieces = 1;
          if (!is_whole(l, &b)) label_pieces(l, &b, label, &pieces);
          coarse->rest[b.parent] = pieces < 2 ? 0 : 1;
        }
}

static cf_status find_odds(cf_coupled *l, const cf_coupled *coarse) {
  l->odds = 0;
  CF_PARALLEL_COUPLED (l, v)
    CF_TILE_ROWS (l, v, j, k)
      CF_TILE_RUNS (l, v, run)
        memset(l->rest + cf_box_at(&l->box, run->low, j, k), 0,
               (size_t)(run->high - run->low) * sizeof(float));
  if (l->bands[0] + l->bands[1] == 0) return CF_OK; /* nothing is closed */
  find_pieces(l, coarse);
  int32_t islands = 0;
  for (ptrdiff_t v = 0; v < coarse->rows; ++v)
    CF_TILE_ROWS (coarse, v, J, K)
      CF_TILE_RUNS (coarse, v, run)
        for (int I = run->low; I < run->high; ++I) {
          if (!(coarse->rest[cf_box_at(&coarse->box, I, J, K)] > 0)) continue;
          const block b = block_of(l, coarse, (int[]){I, J, K});
          int label[8], pieces;
          const int main_piece = label_pieces(l, &b, label, &pieces);
          for (int piece = 0; piece < b.count; ++piece)
            if (label[piece] == piece && piece != main_piece)
              CF_TRY(add_piece(l, &b, label, piece, is_island(l, &b, label, piece) ? ++islands : 0));
        }
  return CF_OK;
}

static void place_of(const cf_box *b, ptrdiff_t p, int at[3]) {
  at[2] = b->dim == 3 ? (int)(p / b->stride[2]) : 0;
  p -= at[2] * b->stride[2];
  at[1] = (int)(p / b->stride[1]);
  at[0] = (int)(p - at[1] * b->stride[1]);
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
  place_of(&coarse->box, p, at);
  place_of(&coarse->box, q, to);
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

/* Where a cell may join: the parent of the cell beyond its strongest face, if that is next to its own block. `settled`:
 * cells outside the main pieces count too, once they have a parent. */
static ptrdiff_t join(const cf_coupled *l, const cf_coupled *coarse, const ptrdiff_t p, const bool settled) {
  int at[3], other[3], axis;
  ptrdiff_t best = CF_NO_PARENT, high;
  float strongest = 0;
  place_of(&l->box, p, at);
  const ptrdiff_t own = parent_of(l, coarse, at);
  for (int a = 0; a < l->dim; ++a)
    for (int side = 0; side < 2; ++side) {
      const float c = l->c[a][side ? p + l->box.stride[a] : p];
      if (!(c > strongest * 1.001f) || !neighbour(l, at, a, side, other)) continue;
      const ptrdiff_t q = cf_box_at(&l->box, other[0], other[1], other[2]);
      const int32_t number = mark_of(l, q);
      if (number > 0 && !settled) continue;
      const ptrdiff_t to = number > 0 ? l->odd_parent[number - 1] : parent_of(l, coarse, other);
      if (to == CF_NO_PARENT || to == own || !are_neighbours(coarse, own, to, &axis, &high)) continue;
      strongest = c;
      best = to;
    }
  return best;
}

static void settle_odds(cf_coupled *l, const cf_coupled *coarse) {
  for (int round = 0; round < 3; ++round)
    for (ptrdiff_t v = 0; v < l->odds; ++v)
      if (l->odd_island[v] == 0 && l->odd_parent[v] == CF_NO_PARENT)
        l->odd_parent[v] = join(l, coarse, l->odd_cell[v], round > 0);
  for (ptrdiff_t v = 0; v < l->odds; ++v) {
    int at[3];
    place_of(&l->box, l->odd_cell[v], at);
    if (l->odd_island[v] == 0 && l->odd_parent[v] == CF_NO_PARENT)
      l->odd_parent[v] = parent_of(l, coarse, at);
  }
}

/* --- the coarse equation ------------------------------------------------------------------------------ */

/* The coupling through the low face of cell p along axis a with halves of what lies behind it on both sides; *before: the
 * resistance of the low side's half, *after that of the high side's. Where the inner face is closed or there is none the
 * way is shorter. */
static float in_series(const cf_coupled *l, const int a, const ptrdiff_t p, const int i, float *before,
                       float *after) {
  const ptrdiff_t s = l->box.stride[a];
  const float face = l->c[a][p];
  *before = *after = 0;
  if (!l->coarsened[a]) return face;
  const float high = i + 1 < l->box.n[a] ? l->c[a][p + s] : 0;
  const ptrdiff_t below = i > 0 ? p - s : p + (l->box.n[a] - 1) * s; /* across a seam */
  const float low = i > 0 || l->box.n[a] % 2 == 0 ? l->c[a][below] : 0;
  if (low > 0) *before = 0.5f / low;
  if (high > 0) *after = 0.5f / high;
  return 1 / (1 / face + *before + *after);
}

static unsigned char as_byte(const float weight) {
  const float w = 256 * weight + 0.5f;
  return (unsigned char)(w < 255 ? w : 255);
}

/* The couplings of a coarse cell to its low neighbours, its diagonal, and the weights on both sides of those faces. Faces
 * of cells with another parent come later. */
static void fill_cell(const cf_coupled *l, const cf_coupled *coarse, const block *b, const float held_share) {
  float free = 0, held = 0, c[3] = {0, 0, 0};
  for (int v = 0; v < b->count; ++v) {
    const ptrdiff_t p = b->p[v];
    if (!cf_coupled_has(l, p) || mark_of(l, p) > 0) continue;
    free += l->free[p];
    held += l->held[p];
    for (int a = 0; a < l->dim; ++a) {
      const ptrdiff_t s = l->box.stride[a];
      const int i = b->at[v][a];
      if (is_inner(l, a, i) || (i == 0 && !l->periodic[a]) || coarse->box.n[a] == 1) continue;
      const ptrdiff_t q = i > 0 ? p - s : p + (l->box.n[a] - 1) * s;
      if (!(l->c[a][p] > 0) || mark_of(l, q) > 0) continue;
      float before, after;
      const float both = in_series(l, a, p, i, &before, &after);
      c[a] += both;
      if (!l->coarsened[a]) continue;
      l->weight[a][p] = as_byte(after * both);
      if (i > 0 || l->box.n[a] % 2 == 0) l->weight[a][q] = as_byte(before * both);
    }
  }
  coarse->free[b->parent] = free;
  coarse->held[b->parent] = held_share * held;
  for (int a = 0; a < l->dim; ++a) coarse->c[a][b->parent] = c[a];
}

static ptrdiff_t parent_at(const cf_coupled *l, const cf_coupled *coarse, const int at[3]) {
  const int32_t number = mark_of(l, cf_box_at(&l->box, at[0], at[1], at[2]));
  return number > 0 ? l->odd_parent[number - 1] : parent_of(l, coarse, at);
}

static void add_odds(const cf_coupled *l, const cf_coupled *coarse, const float held_share) {
  for (ptrdiff_t v = 0; v < l->odds; ++v) {
    const ptrdiff_t p = l->odd_cell[v], own = l->odd_parent[v];
    if (own == CF_NO_PARENT) continue;
    int at[3], other[3], axis;
    place_of(&l->box, p, at);
    coarse->free[own] += l->free[p];
    coarse->held[own] += held_share * l->held[p];
    for (int a = 0; a < l->dim; ++a)
      for (int side = 0; side < 2; ++side) {
        const float c = l->c[a][side ? p + l->box.stride[a] : p];
        if (!(c > 0) || !neighbour(l, at, a, side, other)) continue;
        const ptrdiff_t q = cf_box_at(&l->box, other[0], other[1], other[2]);
        if (side == 0 && mark_of(l, q) > 0) continue; /* that one sees this face too */
        const ptrdiff_t to = parent_at(l, coarse, other);
        ptrdiff_t high;
        if (to == own || !are_neighbours(coarse, own, to, &axis, &high)) continue;
        coarse->c[axis][high] += 0.5f * c;
      }
  }
}

static void clear_weights(const cf_coupled *l) {
  CF_PARALLEL_COUPLED (l, v)
    CF_TILE_ROWS (l, v, j, k)
      CF_TILE_RUNS (l, v, run)
        for (int a = 0; a < l->dim; ++a)
          memset(l->weight[a] + cf_box_at(&l->box, run->low, j, k), 0, (size_t)(run->high - run->low));
}

/* Tiles over those of the finer level. */
static cf_status follow(const cf_coupled *l, cf_coupled *coarse) {
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

cf_status cf_coarsen(cf_coupled *l, cf_coupled *coarse) {
  CF_TRY(follow(l, coarse));
  CF_TRY(find_odds(l, coarse));
  settle_odds(l, coarse);
  clear_weights(l);
  bool all = true;
  for (int a = 0; a < l->dim; ++a) all = all && (l->coarsened[a] || l->box.n[a] == 1);
  const float held_share = all ? 0.5f : 1; /* twice the distance to the wall */
  /* Weights are written on both sides of a coarse face: by the cell above it alone. */
  CF_PARALLEL_COUPLED (coarse, v)
    CF_TILE_ROWS (coarse, v, J, K)
      CF_TILE_RUNS (coarse, v, run)
        for (int I = run->low; I < run->high; ++I) {
          const block b = block_of(l, coarse, (int[]){I, J, K});
          fill_cell(l, coarse, &b, held_share);
        }
  add_odds(l, coarse, held_share);
  for (ptrdiff_t v = 0; v < l->odds; ++v) mark(l, l->odd_cell[v], 0);
  return cf_coupled_finish(coarse);
}
