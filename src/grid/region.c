/* SPDX-License-Identifier: MIT */
#include "grid/region.h"

#include <stdatomic.h>
#include <string.h>

#include "base/mem.h"
#include "grid/sweep.h"
#include "grid/wall.h"

cf_status cf_region_create(cf_region **r, const cf_grid *g) { return cf_region_create_on(r, g, NULL); }

cf_status cf_region_create_on(cf_region **region, const cf_grid *g, const cf_tiles *tiles) {
  *region = NULL;
  cf_region *r;
  void *pages = NULL;
  CF_TRY(CF_NEW(&r, 1));
  r->grid = *g;
  r->tiles = tiles;
  cf_status s = cf_pages_reserve(&pages, (size_t)g->box.size, tiles == NULL);
  if (s == CF_OK) {
    r->kind = (unsigned char *)pages + g->box.first;
    s = tiles != NULL ? cf_tiles_cell_create(tiles, &r->value) : cf_cell_create(&r->value, &g->box);
  }
  if (s != CF_OK) {
    cf_region_destroy(r);
    return s;
  }
  if (tiles == NULL) cf_region_fill(r, CF_CELL_INSIDE);
  *region = r;
  return cf_region_update(r);
}

void cf_region_destroy(cf_region *r) {
  if (r == NULL) return;
  const cf_box *b = &r->grid.box;
  if (r->kind != NULL) cf_pages_release(r->kind - b->first, (size_t)b->size);
  cf_cell_destroy(&r->value, b);
  cf_free(r);
}

unsigned char *cf_region_kinds(cf_region *r) { return r->kind; }

cf_cell cf_region_values(cf_region *r) { return r->value; }

ptrdiff_t cf_region_inside(const cf_region *r) { return r->inside; }

/* --- writing ------------------------------------------------------------------------------------------ */

/* What is done to cells [low, high) of row (j, k). */
typedef struct row_of_cells {
  cf_region *region;
  int low, high, j, k;
} row_of_cells;

typedef void row_action(const row_of_cells *row, void *context);

/* All rows of a window of cells, or what of it is in active tiles; one after the other. */
static void for_rows(cf_region *r, const int low[3], const int high[3], row_action *act, void *context) {
  if (r->tiles == NULL) {
    for (int k = low[2]; k < high[2]; ++k)
      for (int j = low[1]; j < high[1]; ++j) act(&(row_of_cells){r, low[0], high[0], j, k}, context);
    return;
  }
  const cf_tiles *t = r->tiles;
  for (ptrdiff_t v = 0; v < t->rows; ++v)
    CF_TILE_ROWS (t, v, j, k) {
      if (j < low[1] || j >= high[1] || k < low[2] || k >= high[2]) continue;
      CF_TILE_RUNS (t, v, run) {
        const int from = CF_MAX(run->low, low[0]), to = CF_MIN(run->high, high[0]);
        if (from < to) act(&(row_of_cells){r, from, to, j, k}, context);
      }
    }
}

static void for_all_rows(cf_region *r, row_action *act, void *context) {
  for_rows(r, (int[]){0, 0, 0}, r->grid.box.n, act, context);
}

static void fill_row(const row_of_cells *w, void *kind) {
  unsigned char *row = w->region->kind + cf_box_at(&w->region->grid.box, 0, w->j, w->k);
  memset(row + w->low, *(const int *)kind, (size_t)(w->high - w->low));
}

void cf_region_fill(cf_region *r, const cf_cell_kind kind) {
  int byte = (int)kind;
  for_all_rows(r, fill_row, &byte);
}

typedef struct adding {
  const cf_shape *shape;
  const cf_pose *pose;
  double t;
  cf_cell_kind kind;
  const cf_fn *value;
  double *x, *y, *z, *out;
} adding;

static void add_row(const row_of_cells *w, void *context) {
  const adding *c = context;
  const cf_region *r = w->region;
  const cf_grid *g = &r->grid;
  const int n = w->high - w->low;
  const ptrdiff_t at = cf_box_at(&g->box, w->low, w->j, w->k);
  for (int i = 0; i < n; ++i) {
    c->x[i] = cf_grid_place(g, 0, w->low + i, 0);
    c->y[i] = cf_grid_place(g, 1, w->j, 0);
    c->z[i] = g->box.dim == 3 ? cf_grid_place(g, 2, w->k, 0) : 0;
  }
  cf_shape_distance_row(c->shape, c->pose, c->t, n, c->x, c->y, c->z, c->out);
  bool any = false;
  for (int i = 0; i < n; ++i) {
    if (!(c->out[i] <= 0)) continue;
    r->kind[at + i] = (unsigned char)c->kind;
    any = true;
  }
  if (!any || c->kind != CF_CELL_HELD) return;
  for (int i = 0; i < n; ++i)
    if (c->out[i] <= 0)
      r->value.at[at + i] =
          c->value != NULL ? (cf_real)cf_fn_at(c->value, c->x[i], c->y[i], c->z[i], c->t) : 0;
}

cf_status cf_region_add(cf_region *r, const cf_shape *s, const cf_pose *pose, const double t,
                        const cf_cell_kind kind, const cf_fn *value) {
  const ptrdiff_t n = r->grid.box.n[0];
  int low[3], high[3];
  double *x;
  CF_TRY(CF_NEW(&x, 4 * n));
  cf_shape_cells(s, pose, &r->grid, 0, low, high);
  adding c = {s, pose, t, kind, value, x, x + n, x + 2 * n, x + 3 * n};
  for_rows(r, low, high, add_row, &c);
  cf_free(x);
  return CF_OK;
}

void cf_region_retire(cf_region *r) {
  if (r->tiles == NULL) return;
  cf_tiles_retire_bytes(r->tiles, r->kind, 1);
  cf_tiles_retire_cell(r->tiles, r->value);
}

void cf_region_ghosts(cf_region *r, const bool wraps[3]) {
  const cf_box *b = &r->grid.box;
  for (int a = 0; a < b->dim; ++a)
    for (int side = 0; side < 2; ++side) {
      const cf_wall_side w = cf_wall_side_of(b, a, side);
      const ptrdiff_t across = wraps[a] ? (b->n[a] - 1) * b->stride[a] * (side == 0 ? 1 : -1) : 0;
      for (int i_c = 0; i_c < w.n_c; ++i_c)
        for (int i_b = 0; i_b < w.n_b; ++i_b) {
          const ptrdiff_t cell = cf_wall_cell(b, &w, i_b, i_c);
          r->kind[cell + w.outward] = r->kind[cell + across];
        }
    }
}

/* --- taking what was written -------------------------------------------------------------------------- */

typedef struct taking {
  ptrdiff_t inside;
  int low[3], high[3]; /* of the cells inside */
  bool bad;
  int where[3], byte;
} taking;

/* What bytes of a row are: how many say inside, and whether one says nothing. */
typedef struct tally {
  int inside, bad;
} tally;

CF_CLONES static tally tally_of(const int n, const unsigned char *kind) {
  int inside = 0, bad = 0;
  CF_ROW_LOOP
  for (int i = 0; i < n; ++i) {
    inside += kind[i] == CF_CELL_INSIDE;
    bad += kind[i] > CF_CELL_OUTSIDE;
  }
  return (tally){inside, bad};
}

static void take_row(const row_of_cells *w, void *context) {
  taking *c = context;
  const unsigned char *kind = w->region->kind + cf_box_at(&w->region->grid.box, 0, w->j, w->k);
  const tally row = tally_of(w->high - w->low, kind + w->low);
  int low = w->low, high = w->high;
  if (row.bad > 0 && !c->bad) {
    while (kind[low] <= CF_CELL_OUTSIDE) ++low;
    *c = (taking){.bad = true, .where = {low, w->j, w->k}, .byte = kind[low]};
    return;
  }
  if (row.inside == 0) return;
  while (kind[low] != CF_CELL_INSIDE) ++low;
  while (kind[high - 1] != CF_CELL_INSIDE) --high;
  const int first[3] = {low, w->j, w->k}, end[3] = {high, w->j + 1, w->k + 1};
  for (int a = 0; a < 3; ++a) {
    c->low[a] = c->inside > 0 ? CF_MIN(c->low[a], first[a]) : first[a];
    c->high[a] = c->inside > 0 ? CF_MAX(c->high[a], end[a]) : end[a];
  }
  c->inside += row.inside;
}

static atomic_uint_least64_t updates;

cf_status cf_region_update(cf_region *r) {
  taking c = {0};
  for_all_rows(r, take_row, &c);
  if (c.bad)
    return cf_fail(CF_BAD_ARGUMENT, "cell (%d, %d, %d) has kind %d: must be 0 (wall) to 3 (outside)",
                   c.where[0], c.where[1], c.where[2], c.byte);
  r->inside = c.inside;
  memcpy(r->low, c.low, sizeof r->low);
  memcpy(r->high, c.high, sizeof r->high);
  r->stamp = (uint64_t)atomic_fetch_add(&updates, 1) + 1;
  return CF_OK;
}

void cf_region_look(cf_region *r, const cf_region *from, const int low[3]) {
  const cf_box *b = &r->grid.box, *there = &from->grid.box;
  CF_PARALLEL_ROWS (b, r->grid.threads, row) {
    const int j = (int)(row % b->n[1]), k = (int)(row / b->n[1]);
    memcpy(r->kind + cf_box_row(b, row), from->kind + cf_box_at(there, low[0], low[1] + j, low[2] + k),
           (size_t)b->n[0]);
  }
  r->inside = from->inside;
  for (int a = 0; a < 3; ++a) {
    r->low[a] = from->low[a] - low[a];
    r->high[a] = from->high[a] - low[a];
  }
  r->stamp = from->stamp;
}
