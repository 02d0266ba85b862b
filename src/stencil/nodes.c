/* SPDX-License-Identifier: MIT
 *
 * Finding the blocks, and windows. A block's place in the lattice is its key, x fastest; blocks with particles come
 * out of the sorted set, and every one brings those around it.
 */
#include "stencil/nodes.h"

#include <stdlib.h>

#include "base/mem.h"

/* --- memory ------------------------------------------------------------------------------------------------ */

static size_t table_bytes(const cf_nodes *n) {
  return sizeof *n->table * (size_t)n->lattice[0] * (size_t)n->lattice[1] * (size_t)n->lattice[2];
}

static size_t at_bytes(const int32_t room) { return sizeof(cf_lanes) * CF_BLOCK_NODES * (size_t)room; }

static cf_status reserve(cf_nodes *n) {
  CF_TRY(cf_pages_reserve((void **)&n->table, table_bytes(n), false));
  CF_TRY(cf_pages_reserve((void **)&n->block, sizeof *n->block * (size_t)n->room, false));
  CF_TRY(cf_pages_reserve((void **)&n->key, sizeof *n->key * (size_t)n->room, false));
  CF_TRY(cf_pages_reserve((void **)&n->visit, sizeof *n->visit * (size_t)n->room, false));
  CF_TRY(cf_pages_reserve((void **)&n->partial, sizeof *n->partial * (size_t)n->room, false));
  return cf_pages_reserve((void **)&n->at, at_bytes(n->room), false);
}

cf_status cf_nodes_create(cf_nodes **nodes, const cf_grid *g, const int64_t particles) {
  *nodes = NULL;
  cf_nodes *n;
  CF_TRY(CF_NEW(&n, 1));
  n->grid = g;
  n->dim = g->box.dim;
  double all = 1;
  for (int a = 0; a < 3; ++a) {
    const int edge = a < n->dim ? CF_BLOCK_EDGE(n->dim) : 1;
    n->lattice[a] = (g->box.n[a] + edge - 1) / edge;
    all *= n->lattice[a];
  }
  const double most = CF_MIN(all, (n->dim == 3 ? 27.0 : 9.0) * (double)particles);
  cf_status s = CF_OK;
  if (all >= (double)UINT32_MAX || most >= (double)INT32_MAX)
    s = cf_fail(CF_OVER_LIMIT, "a lattice of %d x %d x %d cells is too large for particles: use fewer cells",
                g->box.n[0], g->box.n[1], g->box.n[2]);
  n->room = s == CF_OK ? (int32_t)CF_MAX(most, 1) : 1;
  if (s == CF_OK) s = reserve(n);
  if (s != CF_OK) {
    cf_nodes_destroy(n);
    return s;
  }
  *nodes = n;
  return CF_OK;
}

void cf_nodes_destroy(cf_nodes *n) {
  if (n == NULL) return;
  cf_pages_release(n->table, table_bytes(n));
  cf_pages_release(n->block, sizeof *n->block * (size_t)n->room);
  cf_pages_release(n->key, sizeof *n->key * (size_t)n->room);
  cf_pages_release(n->visit, sizeof *n->visit * (size_t)n->room);
  cf_pages_release(n->partial, sizeof *n->partial * (size_t)n->room);
  cf_pages_release(n->at, at_bytes(n->room));
  cf_free(n);
}

/* --- blocks ------------------------------------------------------------------------------------------------ */

static uint32_t key_of(const cf_nodes *n, const int at[3]) {
  return ((uint32_t)at[2] * (uint32_t)n->lattice[1] + (uint32_t)at[1]) * (uint32_t)n->lattice[0] +
         (uint32_t)at[0];
}

static void place_of(const cf_nodes *n, const uint32_t key, int at[3]) {
  at[0] = (int)(key % (uint32_t)n->lattice[0]);
  at[1] = (int)(key / (uint32_t)n->lattice[0] % (uint32_t)n->lattice[1]);
  at[2] = (int)(key / (uint32_t)n->lattice[0] / (uint32_t)n->lattice[1]);
}

static void set_keys(const cf_nodes *n, cf_particles *set, const int threads) {
  const cf_grid *g = n->grid;
  cf_real *const *x = set->attribute[CF_PARTICLE_POSITION].at;
  const int shift = n->dim == 3 ? 2 : 3;
#pragma omp parallel for schedule(static) num_threads(threads)
  for (int64_t i = 0; i < set->count; ++i) {
    int at[3] = {0, 0, 0};
    /* The same arithmetic as cf_reach_set's: both must see a particle in the same cell. */
    for (int a = 0; a < n->dim; ++a)
      at[a] = (int)((x[a][i] - (cf_real)g->origin[a]) * (cf_real)(1 / g->h)) >> shift;
    set->key[i] = key_of(n, at);
  }
}

/* The block at a place, entered if it is new; -1 outside the lattice. */
static void enter(cf_nodes *n, const int at[3]) {
  for (int a = 0; a < 3; ++a)
    if (at[a] < 0 || at[a] >= n->lattice[a]) return;
  const uint32_t key = key_of(n, at);
  if (n->table[key] != 0) return;
  n->table[key] = 1;
  n->key[n->count++] = key;
}

static void enter_around(cf_nodes *n, const uint32_t key) {
  int at[3];
  place_of(n, key, at);
  for (int dz = n->dim == 3 ? -1 : 0; dz <= (n->dim == 3 ? 1 : 0); ++dz)
    for (int dy = -1; dy <= 1; ++dy)
      for (int dx = -1; dx <= 1; ++dx) enter(n, (int[3]){at[0] + dx, at[1] + dy, at[2] + dz});
}

static int by_key(const void *a, const void *b) {
  const uint32_t x = *(const uint32_t *)a, y = *(const uint32_t *)b;
  return (x > y) - (x < y);
}

static void link_block(cf_nodes *n, const int32_t rank) {
  cf_block *b = &n->block[rank];
  int at[3];
  place_of(n, n->key[rank], at);
  b->first = b->count = 0;
  for (int a = 0; a < 3; ++a) b->cell[a] = at[a] * (a < n->dim ? CF_BLOCK_EDGE(n->dim) : 1);
  for (int dz = -1; dz <= 1; ++dz)
    for (int dy = -1; dy <= 1; ++dy)
      for (int dx = -1; dx <= 1; ++dx) {
        const int to[3] = {at[0] + dx, at[1] + dy, at[2] + dz};
        bool inside = true;
        for (int a = 0; a < 3; ++a) inside = inside && to[a] >= 0 && to[a] < n->lattice[a];
        b->around[CF_NODES_AT(dx, dy, dz)] = inside ? n->table[key_of(n, to)] - 1 : -1;
      }
}

/* Blocks with particles by colour, each colour in the order of places. */
static void make_visits(cf_nodes *n) {
  int32_t count = 0;
  for (int c = 0; c < 8; ++c) {
    n->colour[c] = count;
    for (int32_t r = 0; r < n->count; ++r) {
      if (n->block[r].count == 0) continue;
      int at[3];
      place_of(n, n->key[r], at);
      if ((at[0] & 1) + 2 * (at[1] & 1) + 4 * (at[2] & 1) == c) n->visit[count++] = r;
    }
  }
  n->colour[8] = count;
}

void cf_nodes_update(cf_nodes *n, cf_particles *set, const int threads) {
  set_keys(n, set, threads);
  cf_particles_sort(set, threads);
  for (int32_t r = 0; r < n->count; ++r) n->table[n->key[r]] = 0;
  n->count = 0;
  for (int64_t i = 0; i < set->count; ++i)
    if (i == 0 || set->key[i] != set->key[i - 1]) enter_around(n, set->key[i]);
  qsort(n->key, (size_t)n->count, sizeof *n->key, by_key);
  for (int32_t r = 0; r < n->count; ++r) n->table[n->key[r]] = r + 1;
#pragma omp parallel for schedule(static) num_threads(threads)
  for (int32_t r = 0; r < n->count; ++r) link_block(n, r);
  for (int64_t i = 0; i < set->count;) {
    const uint32_t key = set->key[i];
    cf_block *b = &n->block[n->table[key] - 1];
    b->first = i;
    while (i < set->count && set->key[i] == key) ++i;
    b->count = i - b->first;
  }
  make_visits(n);
}

void cf_nodes_clear(cf_nodes *n, cf_lanes *at, const int threads) {
  CF_PARALLEL_BLOCKS(n, threads, b)
  memset(at + (ptrdiff_t)b * CF_BLOCK_NODES, 0, sizeof *at * CF_BLOCK_NODES);
}

/* --- windows ----------------------------------------------------------------------------------------------- */

/* Calls `body` with a run of `length` vectors: `node` in the blocks, `w` in the window. */
#define FOR_RUNS(n, b, window, body)                                                                    \
  do {                                                                                                  \
    const int edge = CF_BLOCK_EDGE((n)->dim), wide = edge + 2, high = (n)->dim == 3 ? wide : 1;         \
    for (int k = 0; k < high; ++k)                                                                      \
      for (int j = 0; j < wide; ++j)                                                                    \
        for (int side = -1; side <= 1; ++side) {                                                        \
          const int dy = j == 0 ? -1 : j == wide - 1, dz = high == 1 ? 0 : k == 0 ? -1 : k == wide - 1; \
          const int32_t rank = (b)->around[CF_NODES_AT(side, dy, dz)];                                  \
          const int row = (((high == 1 ? 0 : k - 1 - dz * edge) * edge) + j - 1 - dy * edge) * edge;    \
          const int length = side == 0 ? edge : 1;                                                      \
          const ptrdiff_t w = (k * wide + j) * wide + (side == 0 ? 1 : side < 0 ? 0 : wide - 1);        \
          const ptrdiff_t node = (ptrdiff_t)rank * CF_BLOCK_NODES + row + (side < 0 ? edge - 1 : 0);    \
          body                                                                                          \
        }                                                                                               \
  } while (0)

CF_CLONES void cf_nodes_load(const cf_nodes *n, const cf_block *b, const cf_lanes *at, cf_lanes *window) {
  FOR_RUNS(n, b, window, {
    for (int i = 0; i < length; ++i)
      if (rank < 0)
        memset(&window[w + i], 0, sizeof *window);
      else
        window[w + i] = at[node + i];
  });
}

CF_CLONES void cf_nodes_add(const cf_nodes *n, const cf_block *b, cf_lanes *at, const cf_lanes *window) {
  FOR_RUNS(n, b, window, {
    if (rank >= 0)
      for (int i = 0; i < length; ++i) at[node + i] += window[w + i];
  });
}
