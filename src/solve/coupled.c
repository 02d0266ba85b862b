/* SPDX-License-Identifier: MIT */
#include "solve/coupled.h"

#include <string.h>

#include "base/mem.h"

/* Rows of cells that a thread takes at once where there are no tiles. */
#define GROUP 4

/* --- making ------------------------------------------------------------------------------------------- */

static cf_status field_create(const cf_coupled *l, void **at, const size_t element) {
  void *pages;
  CF_TRY(cf_pages_reserve(&pages, (size_t)l->box.size * element, l->tiles == NULL));
  *at = (char *)pages + (size_t)l->box.first * element;
  return CF_OK;
}

static void field_destroy(const cf_coupled *l, void *at, const size_t element) {
  if (at != NULL)
    cf_pages_release((char *)at - (size_t)l->box.first * element, (size_t)l->box.size * element);
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
  return CF_OK;
}

cf_status cf_coupled_create(cf_coupled *l, const cf_box *b, const bool periodic[3], const int threads,
                            const cf_tiles *tiles) {
  *l = (cf_coupled){.dim = b->dim, .threads = threads, .box = *b, .tiles = tiles};
  for (int a = 0; a < b->dim; ++a) l->periodic[a] = periodic[a] && b->n[a] > 1;
  float **field[FLOATS];
  float_fields(l, field);
  for (int f = 0; f < FLOATS - (b->dim == 2); ++f) CF_TRY(field_create(l, (void **)field[f], sizeof(float)));
  for (int a = 0; a < b->dim; ++a) CF_TRY(field_create(l, (void **)&l->weight[a], 1));
  return tiles == NULL ? all_rows(l) : CF_OK;
}

void cf_coupled_destroy(cf_coupled *l) {
  float **field[FLOATS];
  float_fields(l, field);
  for (int f = 0; f < FLOATS; ++f) field_destroy(l, *field[f], sizeof(float));
  for (int a = 0; a < 3; ++a) field_destroy(l, l->weight[a], 1);
  cf_free(l->all_rows);
  cf_free(l->odd_cell);
  cf_free(l->odd_parent);
  cf_free(l->odd_value);
  cf_free(l->odd_island);
  cf_free(l->band[0]);
  cf_free(l->band[1]);
  cf_tiles_destroy(l->own_tiles);
  *l = (cf_coupled){0};
}

void cf_coupled_follow_tiles(cf_coupled *l) {
  float **field[FLOATS];
  float_fields(l, field);
  for (int f = 0; f < FLOATS - (l->dim == 2); ++f)
    cf_tiles_follow_bytes(l->tiles, l->followed, *field[f], sizeof(float));
  for (int a = 0; a < l->dim; ++a) cf_tiles_follow_bytes(l->tiles, l->followed, l->weight[a], 1);
  l->followed = l->tiles->updates;
  l->row = l->tiles->row;
  l->run = l->tiles->run;
  l->rows = l->tiles->rows;
}

/* --- from couplings to what the sweeps need ----------------------------------------------------------- */

static void invert_row(const cf_coupled *l, const cf_run *run, const int j, const int k) {
  for (int i = run->low; i < run->high; ++i) {
    const ptrdiff_t p = cf_box_at(&l->box, i, j, k);
    float d = l->free[p] + l->held[p];
    for (int a = 0; a < l->dim; ++a) d += l->c[a][p] + l->c[a][p + l->box.stride[a]];
    l->inverse[p] = d > 0 ? 1 / d : 0;
  }
}

/* Whether a face of the cell is closed or held; the walls of the box are smooth and do not count. */
static bool is_at_edge(const cf_coupled *l, const int at[3], const ptrdiff_t p) {
  for (int a = 0; a < l->dim; ++a) {
    const ptrdiff_t s = l->box.stride[a];
    if ((at[a] > 0 || l->periodic[a]) && l->c[a][p] == 0) return true;
    if ((at[a] < l->box.n[a] - 1 || l->periodic[a]) && l->c[a][p + s] == 0) return true;
  }
  return false;
}

/* The cells at an edge and their neighbours. `rest` serves as the mark. */
static bool is_in_band(const cf_coupled *l, const ptrdiff_t p) {
  if (l->rest[p] > 0) return true;
  for (int a = 0; a < l->dim; ++a) {
    const ptrdiff_t s = l->box.stride[a];
    if ((l->c[a][p] > 0 && l->rest[p - s] > 0) || (l->c[a][p + s] > 0 && l->rest[p + s] > 0)) return true;
  }
  return false;
}

static cf_status grow(ptrdiff_t **list, ptrdiff_t *room, const ptrdiff_t count) {
  if (count < *room) return CF_OK;
  ptrdiff_t *more;
  CF_TRY(CF_NEW(&more, 2 * *room + 1024));
  if (*list != NULL) memcpy(more, *list, (size_t)count * sizeof *more);
  cf_free(*list);
  *list = more;
  *room = 2 * *room + 1024;
  return CF_OK;
}

static cf_status collect_band(cf_coupled *l) {
  l->bands[0] = l->bands[1] = 0;
  for (ptrdiff_t v = 0; v < l->rows; ++v)
    CF_TILE_ROWS (l, v, j, k)
      CF_TILE_RUNS (l, v, run)
        for (int i = run->low; i < run->high; ++i) {
          const ptrdiff_t p = cf_box_at(&l->box, i, j, k);
          if (!cf_coupled_has(l, p) || !is_in_band(l, p)) continue;
          const int colour = (i + j + k) & 1;
          CF_TRY(grow(&l->band[colour], &l->band_room[colour], l->bands[colour]));
          l->band[colour][l->bands[colour]++] = p;
        }
  return CF_OK;
}

cf_status cf_coupled_finish(cf_coupled *l) {
  for (int a = 0; a < l->dim; ++a) cf_coupled_wrap_axis(l, a, l->c[a]);
  int edges = 0, heavy = 0;
#pragma omp parallel for schedule(static) num_threads(cf_coupled_threads(l)) reduction(| : edges, heavy)
  for (ptrdiff_t v = 0; v < l->rows; ++v)
    CF_TILE_ROWS (l, v, j, k)
      CF_TILE_RUNS (l, v, run) {
        invert_row(l, run, j, k);
        for (int i = run->low; i < run->high; ++i) {
          const ptrdiff_t p = cf_box_at(&l->box, i, j, k);
          const bool edge = cf_coupled_has(l, p) && is_at_edge(l, (int[]){i, j, k}, p);
          l->rest[p] = edge ? 1 : 0;
          edges |= edge;
          heavy |= l->free[p] * l->inverse[p] > 0.3f;
        }
      }
  l->is_gentle = heavy;
  l->bands[0] = l->bands[1] = 0;
  if (!edges) return CF_OK;
  cf_coupled_wrap(l, l->rest);
  CF_TRY(collect_band(l));
  for (int a = 0; a < l->dim; ++a) /* what the wrap has left in ghosts */
    if (l->periodic[a]) {
      CF_PARALLEL_COUPLED (l, v)
        CF_TILE_ROWS (l, v, j, k)
          CF_TILE_RUNS (l, v, run)
            memset(l->rest + cf_box_at(&l->box, run->low, j, k), 0,
                   (size_t)(run->high - run->low) * sizeof(float));
      cf_coupled_wrap(l, l->rest);
      break;
    }
  return CF_OK;
}
