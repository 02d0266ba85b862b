/* SPDX-License-Identifier: MIT */
#include "solve/renewal.h"

#include <string.h>

#include "base/mem.h"

void cf_renewal_clear(cf_renewal *n, const cf_coupled *l) {
  if (n->taken != NULL) cf_pages_release(n->taken - l->box.first, (size_t)l->box.size);
  for (int at = 0; at < CF_LEVELS_MAX; ++at) cf_tiles_destroy(n->anew[at]);
  cf_free(n->box);
  *n = (cf_renewal){0};
}

/* --- what differs ------------------------------------------------------------------------------------- */

static cf_status add(cf_renewal *n, const cf_changed *box) {
  if (n->boxes == n->room) {
    const ptrdiff_t room = 2 * n->room + 64;
    cf_changed *more;
    CF_TRY(CF_NEW(&more, room));
    if (n->boxes > 0) memcpy(more, n->box, (size_t)n->boxes * sizeof *more);
    cf_free(n->box);
    n->box = more;
    n->room = room;
  }
  n->box[n->boxes++] = *box;
  return CF_OK;
}

/* Tiles that have left: what was in them is no longer there. */
static cf_status add_left(cf_renewal *n, const cf_tiles *t) {
  for (ptrdiff_t c = 0; c < t->changes; ++c) {
    const ptrdiff_t row = t->changed[c];
    const int j = (int)(row % t->n[1]) << t->shift[1], k = (int)(row / t->n[1]) << t->shift[2];
    for (int word = 0; word < t->words; ++word)
      for (uint64_t bits = t->left[row * t->words + word]; bits != 0; bits &= bits - 1) {
        const int i = (64 * word + __builtin_ctzll(bits)) << t->shift[0];
        CF_TRY(add(n, &(cf_changed){{i, j, k}, {i + t->edge[0], j + t->edge[1], k + t->edge[2]}}));
      }
  }
  return CF_OK;
}

/* Whether any cell of a group of rows is of another kind than taken. */
static bool differs(const cf_renewal *n, const cf_coupled *l, const cf_region *r, const cf_tile_row *row) {
  for (int k = row->k; k < row->k_end; ++k)
    for (int j = row->j; j < row->j_end; ++j)
      for (ptrdiff_t v = row->run; v < row->run_end; ++v) {
        const cf_run *run = &l->run[v];
        const ptrdiff_t p = cf_box_at(&l->box, run->low, j, k);
        if (memcmp(n->taken + p, r->kind + p, (size_t)(run->high - run->low)) != 0) return true;
      }
  return false;
}

/* The box around what differs in [low, high) of these rows, which is taken. */
static cf_status add_chunk(cf_renewal *n, const cf_coupled *l, const cf_region *r, const cf_tile_row *row,
                           const int low, const int high) {
  cf_changed box = {{high, row->j_end, row->k_end}, {low, row->j, row->k}};
  for (int k = row->k; k < row->k_end; ++k)
    for (int j = row->j; j < row->j_end; ++j) {
      const ptrdiff_t p = cf_box_at(&l->box, 0, j, k);
      for (int i = low; i < high; ++i) {
        if (n->taken[p + i] == r->kind[p + i]) continue;
        n->taken[p + i] = r->kind[p + i];
        const int at[3] = {i, j, k};
        for (int a = 0; a < 3; ++a) {
          box.low[a] = CF_MIN(box.low[a], at[a]);
          box.high[a] = CF_MAX(box.high[a], at[a] + 1);
        }
      }
    }
  return box.low[0] < box.high[0] ? add(n, &box) : CF_OK;
}

static cf_status prepare(cf_renewal *n, const cf_coupled *l) {
  n->boxes = 0;
  if (n->taken == NULL) {
    void *pages;
    CF_TRY(cf_pages_reserve(&pages, (size_t)l->box.size, l->tiles == NULL));
    n->taken = (unsigned char *)pages + l->box.first;
  } else if (l->tiles != NULL) {
    cf_tiles_follow_bytes(l->tiles, n->followed, n->taken, 1);
  }
  n->followed = l->tiles != NULL ? l->tiles->updates : 0;
  return CF_OK;
}

cf_status cf_renewal_take(cf_renewal *n, const cf_coupled *l, const cf_region *r) {
  CF_TRY(prepare(n, l));
  CF_PARALLEL_COUPLED (l, v)
    CF_TILE_ROWS (l, v, j, k)
      CF_TILE_RUNS (l, v, run) {
        const ptrdiff_t p = cf_box_at(&l->box, run->low, j, k);
        memcpy(n->taken + p, r->kind + p, (size_t)(run->high - run->low));
      }
  return CF_OK;
}

/* `other` has room for a flag for each of l's groups of rows. */
static cf_status compare(cf_renewal *n, const cf_coupled *l, const cf_region *r, bool *other) {
#pragma omp parallel for schedule(static) num_threads(cf_coupled_threads(l))
  for (ptrdiff_t v = 0; v < l->rows; ++v) other[v] = differs(n, l, r, &l->row[v]);
  for (ptrdiff_t v = 0; v < l->rows; ++v) {
    if (!other[v]) continue;
    CF_TILE_RUNS (l, v, run)
      for (int i = run->low; i < run->high; i += CF_RENEWAL_CHUNK)
        CF_TRY(add_chunk(n, l, r, &l->row[v], i, CF_MIN(i + CF_RENEWAL_CHUNK, run->high)));
  }
  return CF_OK;
}

cf_status cf_renewal_compare(cf_renewal *n, const cf_coupled *l, const cf_region *r, bool *all) {
  const int64_t since = n->followed;
  CF_TRY(prepare(n, l));
  *all = l->tiles != NULL && n->followed - since > 1;
  if (*all) return cf_renewal_take(n, l, r);
  if (l->tiles != NULL && n->followed != since) CF_TRY(add_left(n, l->tiles));
  bool *other;
  CF_TRY(CF_NEW(&other, l->rows));
  const cf_status s = compare(n, l, r, other);
  cf_free(other);
  return s;
}

/* --- what is made anew -------------------------------------------------------------------------------- */

/* Every tile of t that meets low <= (i, j, k) < high and is one that l visits. */
static void add_tiles(cf_tiles *t, const cf_coupled *l, const int low[3], const int high[3]) {
  if (l->tiles == NULL) {
    cf_tiles_add_box(t, low, high);
    return;
  }
  int from[3], to[3];
  for (int a = 0; a < 3; ++a) {
    from[a] = low[a] >> t->shift[a];
    to[a] = (high[a] - 1) >> t->shift[a];
  }
  for (int tk = from[2]; tk <= to[2]; ++tk)
    for (int tj = from[1]; tj <= to[1]; ++tj)
      for (int ti = from[0]; ti <= to[0]; ++ti)
        if (cf_tiles_has(l->tiles, ti, tj, tk)) cf_tiles_add(t, ti, tj, tk);
}

/* What of a box is within the level's, from axis a on: around seams, or cut at walls. */
static void add_around(cf_tiles *t, const cf_coupled *l, cf_changed c, const int a) {
  if (a == 3) {
    add_tiles(t, l, c.low, c.high);
    return;
  }
  const int n = l->box.n[a], low = c.low[a], high = c.high[a];
  const bool turns = l->periodic[a];
  if (turns && high - low >= n) {
    c.low[a] = 0, c.high[a] = n;
    add_around(t, l, c, a + 1);
    return;
  }
  for (int shift = turns ? -n : 0; shift <= (turns ? n : 0); shift += n) {
    c.low[a] = CF_MAX(low + shift, 0), c.high[a] = CF_MIN(high + shift, n);
    if (c.low[a] < c.high[a]) add_around(t, l, c, a + 1);
  }
}

cf_status cf_renewal_part(cf_renewal *n, const int at, const cf_coupled *l, cf_part *part) {
  static const int edge[2][3] = {{8, 8, 1}, {8, 4, 4}};
  if (n->anew[at] == NULL)
    CF_TRY(cf_tiles_create(&n->anew[at], &l->box, l->tiles != NULL ? l->tiles->edge : edge[l->dim - 2]));
  cf_tiles *t = n->anew[at];
  cf_tiles_drop_all(t);
  for (ptrdiff_t v = 0; v < n->boxes; ++v) {
    cf_changed c = n->box[v];
    for (int a = 0; a < l->dim; ++a) c.low[a] -= 2, c.high[a] += 2; /* faces, and the band beyond them */
    add_around(t, l, c, 0);
  }
  CF_TRY(cf_tiles_update(t));
  *part = (cf_part){t->row, t->run, t->rows, t};
  return CF_OK;
}

static int half_down(const int i) { return i >= 0 ? i / 2 : -((1 - i) / 2); }

void cf_renewal_descend(cf_renewal *n, const cf_coupled *l) {
  for (ptrdiff_t v = 0; v < n->boxes; ++v)
    for (int a = 0; a < l->dim; ++a) {
      cf_changed *c = &n->box[v];
      c->low[a] -= CF_RENEWAL_REACH;
      c->high[a] += CF_RENEWAL_REACH;
      if (!l->coarsened[a]) continue;
      c->low[a] = half_down(c->low[a]);
      c->high[a] = half_down(c->high[a] + 1);
    }
}
