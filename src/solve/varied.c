/* SPDX-License-Identifier: MIT
 *
 * Taking coefficients and making levels.
 */
#include "solve/varied.h"

#include <math.h>

#include "base/mem.h"
#include "grid/halo.h"
#include "solve/amend.h"
#include "solve/held.h"
#include "solve/open.h"
#include "solve/setting.h"
#include "solve/varied_part.h"

/* Elimination may take so much for every cell of the finest level, and so much at all. */
#define WORK_PER_CELL 100.0
#define WORK_MOST     3e7
#define WORK_ASKED    1e9 /* where the caller limits the levels */

/* --- memory ------------------------------------------------------------------------------------------- */

cf_status cf_varied_create(cf_varied **v, const cf_helmholtz *A) {
  CF_TRY(CF_NEW(v, 1));
  (*v)->A = A;
  return CF_OK;
}

static void release(cf_varied *v) {
  const cf_box *b = &v->A->grid.box;
  if (v->levels > 0) {
    cf_pockets_clear(&v->pockets, &v->level[0]);
    cf_pockets_clear(&v->loose, &v->level[0]);
    cf_renewal_clear(&v->renewal, &v->level[0]);
  }
  for (int l = 0; l < v->levels; ++l) cf_coupled_destroy(&v->level[l]);
  cf_fields_destroy(&v->fields);
  v->levels = 0;
  v->loose_stamp = 0;
  cf_band_destroy(&v->band);
  cf_clusters_clear(&v->clusters);
  cf_cell_destroy(&v->own_alpha, b);
  cf_face_destroy(&v->own_beta, b);
  cf_cell_destroy(&v->r, b);
  cf_cell_destroy(&v->p, b);
  cf_cell_destroy(&v->Ap, b);
  cf_cell_destroy(&v->best, b);
  for (int a = 0; a < 3; ++a) {
    cf_free(v->lo[a]);
    cf_free(v->hi[a]);
    v->lo[a] = v->hi[a] = NULL;
  }
  for (int i = 0; i < 2; ++i) {
    cf_free(v->busy[i]);
    v->busy[i] = NULL;
  }
  cf_free(v->sums);
  v->sums = NULL;
}

void cf_varied_destroy(cf_varied *v) {
  if (v == NULL) return;
  release(v);
  cf_free(v);
}

/* The axes that still have the smallest cells and more than one of them. */
static bool axes_to_coarsen(cf_coupled *l, double width[3]) {
  double smallest = INFINITY;
  for (int a = 0; a < l->dim; ++a)
    if (l->box.n[a] > 1) smallest = CF_MIN(smallest, width[a]);
  for (int a = 0; a < l->dim; ++a) {
    l->coarsened[a] = l->box.n[a] > 1 && width[a] <= 1.5 * smallest;
    if (l->coarsened[a]) width[a] *= 2;
  }
  return smallest < INFINITY;
}

static cf_status levels_create(cf_varied *v) {
  const cf_helmholtz *A = v->A;
  bool periodic[3] = {false, false, false};
  double width[3] = {1, 1, 1};
  for (int a = 0; a < A->grid.box.dim; ++a) periodic[a] = A->walls.kind[a][0] == CF_WALL_PERIODIC;
  const double most = CF_MIN(WORK_PER_CELL * (double)cf_box_cells(&A->grid.box), WORK_MOST);
  v->levels = 1; /* counted first, so that a failure within frees it */
  CF_TRY(cf_coupled_create(&v->level[0], &A->grid.box, periodic, A->grid.threads, v->tiles));
  while (v->levels < CF_LEVELS_MAX && (A->wanted == 0 || v->levels < A->wanted)) {
    cf_coupled *l = &v->level[v->levels - 1];
    if (cf_band_work(&l->box, l->periodic) <= most || !axes_to_coarsen(l, width)) break;
    ++v->levels;
    CF_TRY(cf_coarsen_create(l, &v->level[v->levels - 1]));
  }
  return CF_OK;
}

static cf_status cell_create(const cf_varied *v, cf_cell *f) {
  if (f->at != NULL) return CF_OK;
  return v->tiles != NULL ? cf_tiles_cell_create(v->tiles, f) : cf_cell_create(f, &v->A->grid.box);
}

static cf_status face_create(const cf_varied *v, cf_face *f) {
  if (f->at[0] != NULL) return CF_OK;
  return v->tiles != NULL ? cf_tiles_face_create(v->tiles, f) : cf_face_create(f, &v->A->grid.box);
}

static cf_status make(cf_varied *v) {
  CF_TRY(levels_create(v));
  CF_TRY(cell_create(v, &v->r));
  CF_TRY(cell_create(v, &v->p));
  CF_TRY(cell_create(v, &v->Ap));
  CF_TRY(cell_create(v, &v->best));
  for (int a = 0; a < v->A->grid.box.dim; ++a) {
    const cf_axis *axis = &v->A->level[0].axis[a];
    CF_TRY(CF_NEW(&v->lo[a], axis->n));
    CF_TRY(CF_NEW(&v->hi[a], axis->n));
    for (int i = 0; i < axis->n; ++i) {
      v->lo[a][i] = (cf_real)axis->lo1[i];
      v->hi[a][i] = (cf_real)axis->hi1[i];
    }
  }
  for (int i = 0; i < 2; ++i) CF_TRY(CF_NEW(&v->busy[i], cf_box_rows(&v->A->grid.box)));
  return CF_NEW(&v->sums, 3 * cf_box_rows(&v->A->grid.box));
}

/* Levels and fields for this region's tiles. */
static cf_status prepare(cf_varied *v, const cf_region *region) {
  const cf_tiles *tiles = region != NULL ? region->tiles : NULL;
  if (v->levels > 0 && v->tiles != tiles) release(v);
  v->tiles = tiles;
  v->region = region;
  if (v->levels == 0) {
    const cf_status s = make(v);
    if (s != CF_OK) {
      release(v);
      return s;
    }
  }
  if (tiles == NULL) return CF_OK;
  const cf_cell *cells[] = {&v->r, &v->p, &v->Ap, &v->best, &v->own_alpha};
  for (int f = 0; f < 5; ++f)
    if (cells[f]->at != NULL)
      cf_tiles_follow_bytes(tiles, v->level[0].followed, cells[f]->at, sizeof(cf_real));
  for (int a = 0; a < 3; ++a)
    if (v->own_beta.at[a] != NULL)
      cf_tiles_follow_bytes(tiles, v->level[0].followed, v->own_beta.at[a], sizeof(cf_real));
  cf_coupled_follow_tiles(&v->level[0]);
  return CF_OK;
}

/* --- coefficients ------------------------------------------------------------------------------------- */

static cf_status choose_fields(cf_varied *v, const cf_coefficients *c) {
  v->alpha = (cf_cell){NULL};
  v->alpha_number = c->alpha;
  v->beta_number = c->beta;
  v->given_beta = c->beta_at != NULL ? *c->beta_at : (cf_face){{NULL, NULL, NULL}};
  if (c->region != NULL) {
    CF_TRY(cell_create(v, &v->own_alpha));
    v->alpha = v->own_alpha;
  } else if (c->alpha_at != NULL) {
    v->alpha = *c->alpha_at;
  }
  if (c->beta_at != NULL)
    for (int a = 0; a < v->A->grid.box.dim; ++a)
      cf_halo_fill(&v->A->grid.box, &v->A->level[0].wrap, 0, a, c->beta_at->at[a]);
  if (c->region == NULL) {
    cf_face_destroy(&v->own_beta, &v->A->grid.box);
    v->beta = v->given_beta;
    return CF_OK;
  }
  CF_TRY(face_create(v, &v->own_beta));
  v->beta = v->own_beta;
  return CF_OK;
}

/* Below the stiffness of 3 sweeps alone do; every level has a quarter of the one before. */
static int depth_for(const cf_varied *v, const double stiffness) {
  int depth = 1;
  for (double s = stiffness; depth < v->levels && s > CF_STIFF_ENOUGH; s /= 4) ++depth;
  return depth;
}

bool cf_varied_eliminates(const cf_varied *v) {
  const cf_coupled *l = &v->level[v->depth - 1];
  const double most = v->A->wanted > 0 ? WORK_ASKED : WORK_MOST;
  return v->depth == v->levels && cf_band_work(&l->box, l->periodic) <= most;
}

static bool are_numbers_in_region(const cf_coefficients *c) {
  return c->region != NULL && c->alpha_at == NULL && c->beta_at == NULL;
}

bool cf_varied_has(const cf_varied *v, const cf_coefficients *c) {
  return are_numbers_in_region(c) && v->stamp == c->region->stamp && v->region == c->region &&
         v->alpha_number == c->alpha && v->beta_number == c->beta &&
         (c->region->tiles == NULL || v->level[0].followed == c->region->tiles->updates);
}

/* The part of level `at` that is made: all of it, or where its cells can feel what has changed. */
static cf_status next_part(cf_varied *v, const int at, const bool all, cf_part *w) {
  if (all)
    *w = cf_coupled_all(&v->level[at]);
  else
    CF_TRY(cf_renewal_part(&v->renewal, at, &v->level[at], w));
  v->renewed += cf_part_cells(w);
  return CF_OK;
}

static cf_status make_levels(cf_varied *v, const cf_coefficients *c, const bool all) {
  cf_part w;
  v->renewed = 0;
  if (!v->apart) {
    CF_TRY(next_part(v, 0, all, &w));
    CF_TRY(cf_varied_fill(v, c, &w));
  }
  for (int at = v->apart ? 2 : 1; at < v->depth; ++at) {
    cf_coupled *l = &v->level[at - 1], *coarse = &v->level[at];
    CF_TRY(cf_coarsen_follow(l, coarse));
    if (!all) cf_renewal_descend(&v->renewal, l);
    CF_TRY(next_part(v, at, all, &w));
    coarse->excess[0] = at == 1 ? v->excess[0] : 0;
    coarse->excess[1] = at == 1 ? v->excess[1] : 0;
    coarse->excess[2] = at == 1 ? CF_CORNER_FIRST : CF_CORNER_BELOW;
    CF_TRY(cf_coarsen(l, coarse, &w));
    CF_TRY(cf_coupled_find_spans(coarse));
  }
  return cf_varied_eliminates(v) ? cf_band_factor(&v->band, &v->level[v->depth - 1]) : CF_OK;
}

/* What make_levels would have made without this way of its own: level[0], and what is below it again. */
cf_status cf_varied_make_plain(cf_varied *v) {
  const cf_coefficients c = {.alpha = v->alpha_number,
                             .beta = v->beta_number,
                             .alpha_at = v->alpha.at != NULL ? &v->alpha : NULL,
                             .beta_at = v->given_beta.at[0] != NULL ? &v->given_beta : NULL};
  const cf_part all = cf_coupled_all(&v->level[0]), coarse = cf_coupled_all(&v->level[1]);
  CF_TRY(cf_varied_fill(v, &c, &all));
  return v->depth == 1 ? CF_OK : cf_coarsen(&v->level[0], &v->level[1], &coarse);
}

static cf_status find_pockets(cf_varied *v) {
  const cf_coupled *l = &v->level[0];
  if (!l->is_open) return cf_pockets_find(&v->pockets, l, false);
  return l->is_fixed ? CF_OK : cf_pockets_take_all(&v->pockets, l);
}

/* Diagonals of up to so much are scaled to 1; the stiffness that goes with it. */
typedef struct reach {
  double diagonal, stiffness;
} reach;

static reach reach_of(const cf_varied *v, const double alpha, const double least, const double beta) {
  const double couplings = 2 * v->A->grid.box.dim * beta / (v->A->grid.h * v->A->grid.h);
  return (reach){alpha + couplings, least > 0 ? couplings / least : INFINITY};
}

static void set_scale(cf_varied *v, const reach *r) {
  v->scale = r->diagonal > 0 ? 1 / CF_MAX(r->diagonal, 1e-300) : 1;
}

/* The finest level apart by colour and what is below it, if that can be done: v->apart. */
static cf_status set_fields(cf_varied *v, const cf_coefficients *c, const reach *r) {
  cf_coupled *l = &v->level[0];
  v->apart = false;
  if (c->region != NULL || v->levels < 2 || !cf_fields_suit(l) || !cf_open_is_bare(&v->level[1]))
    return CF_OK;
  if (v->fields.of == NULL) CF_TRY(cf_fields_create(&v->fields, v, &v->A->level[0]));
  set_scale(v, r);
  if (!cf_fields_fill(v, c)) return CF_OK;
  cf_fields *f = &v->fields;
  v->apart = true;
  v->sweeps = false;
  f->alone = f->radius <= CF_FIELDS_ALONE;
  f->is_gentle = l->is_gentle && !f->alone;
  v->depth = f->alone ? 1 : depth_for(v, f->jacobi / CF_MAX(1 - f->jacobi, 1e-300));
  v->excess[0] = v->excess[1] = 0;
  v->pockets.count = 0;
  if (!f->alone) {
    cf_fields_coarsen(v);
    CF_TRY(make_levels(v, c, true));
  }
  return find_pockets(v);
}

cf_status cf_varied_set(cf_varied *v, const cf_helmholtz *A, const cf_coefficients *c) {
  /* the levels stand, but for what has changed in the region */
  const bool stands = are_numbers_in_region(c) && v->stamp != 0 && v->region == c->region &&
                      v->tiles == c->region->tiles && v->alpha_number == c->alpha &&
                      v->beta_number == c->beta;
  v->stamp = 0;
  v->clustered = false;
  cf_clusters_clear(&v->clusters);
  if (c->region != NULL)
    for (int a = 0; a < 3; ++a)
      if (c->region->grid.box.n[a] != A->grid.box.n[a] ||
          c->region->grid.box.stride[a] != A->grid.box.stride[a])
        return cf_fail(CF_BAD_ARGUMENT, "a region of %d x %d x %d cells for a solver of %d x %d x %d",
                       c->region->grid.box.n[0], c->region->grid.box.n[1], c->region->grid.box.n[2],
                       A->grid.box.n[0], A->grid.box.n[1], A->grid.box.n[2]);
  v->A = A;
  CF_TRY(prepare(v, c->region));
  CF_TRY(choose_fields(v, c));
  double alpha, least, beta;
  reach r = {0, 0};
  v->apart = false;
  if (c->region == NULL) {
    cf_varied_find_range(v, c, true, &alpha, &least, &beta);
    r = reach_of(v, alpha, least, beta);
  }
  if (r.stiffness > CF_SWEEPS_ENOUGH) CF_TRY(set_fields(v, c, &r));
  if (v->apart) return CF_OK;
  cf_varied_find_range(v, c, false, &alpha, &least, &beta);
  r = reach_of(v, alpha, least, beta);
  set_scale(v, &r);
  const double stiffness = r.stiffness;
  v->sweeps = cf_varied_set_sweeps(v, least, stiffness);
  if (v->sweeps) {
    v->depth = 1;
    v->pockets.count = 0;
    return CF_OK;
  }
  v->depth = depth_for(v, stiffness);
  const cf_setting on =
      are_numbers_in_region(c) ? cf_setting_for(A->grid.box.dim, stiffness) : (cf_setting){0};
  v->excess[0] = (float)on.alpha;
  v->excess[1] = (float)on.beta;
  bool all = true;
  if (stands)
    CF_TRY(cf_renewal_compare(&v->renewal, &v->level[0], c->region, &all));
  else if (are_numbers_in_region(c))
    CF_TRY(cf_renewal_take(&v->renewal, &v->level[0], c->region));
  CF_TRY(make_levels(v, c, all));
  v->pockets.count = 0;
  if (!(least > 0)) CF_TRY(find_pockets(v));
  v->stamp = are_numbers_in_region(c) ? c->region->stamp : 0;
  return CF_OK;
}

bool cf_varied_stood(const cf_varied *v) { return v->stamp != 0 && v->renewed == 0 && v->tiles == NULL; }

int cf_varied_depth(const cf_varied *v) { return v->depth; }

const char *cf_varied_method(const cf_varied *v) {
  return v->sweeps || (v->apart && v->fields.alone) ? "sor" : v->depth == 1 ? "pcg" : "multigrid-pcg";
}

double cf_varied_wall_beta(const cf_varied *v, const int axis, const ptrdiff_t face) {
  return v->beta.at[0] != NULL ? (double)v->beta.at[axis][face] : v->beta_number;
}

void cf_varied_add_held(const cf_varied *v, const cf_cell b) {
  if (v->region == NULL) return;
  const cf_coupled *l = &v->level[0];
  const cf_held held = {
      v->region, {l->periodic[0], l->periodic[1], l->periodic[2]}, v->given_beta, v->beta_number};
  CF_PARALLEL_COUPLED (l, r)
    CF_TILE_ROWS (l, r, j, k)
      CF_TILE_RUNS (l, r, run)
        for (int i = run->low; i < run->high; ++i) {
          const ptrdiff_t p = cf_box_at(&l->box, i, j, k);
          b.at[p] += (cf_real)cf_held_beside(&held, (int[]){i, j, k}, p);
        }
}
