/* SPDX-License-Identifier: MIT */
#include "model/detour.h"

#include <math.h>

#include "grid/halo.h"
#include "grid/sweep.h"

#define TOLERANCE (CF_REAL_EPSILON < 1e-10 ? 1e-10 : 1e-6)
#define CYCLES    200

cf_status cf_detour_create(cf_detour *d, const cf_obstacles *o, const cf_walls *walls, cf_region *solid) {
  const cf_box *box = &o->grid->box;
  *d = (cf_detour){.obstacles = o, .grid = o->grid, .solid = solid};
  cf_walls own = {0};
  for (int a = 0; a < box->dim; ++a) {
    d->wraps[a] = walls->kind[a][0] == CF_WALL_PERIODIC;
    if (d->wraps[a]) own.kind[a][0] = own.kind[a][1] = CF_WALL_PERIODIC;
  }
  CF_TRY(cf_cell_create(&d->p, box));
  CF_TRY(cf_cell_create(&d->b, box));
  return cf_helmholtz_create(&d->A, d->grid, &own, 0);
}

void cf_detour_destroy(cf_detour *d) {
  if (d->grid == NULL) return;
  cf_cell_destroy(&d->p, &d->grid->box);
  cf_cell_destroy(&d->b, &d->grid->box);
  cf_helmholtz_destroy(d->A);
  *d = (cf_detour){0};
}

static double divergence(const cf_box *box, const cf_face u, const double h, const ptrdiff_t p) {
  double div = 0;
  for (int a = 0; a < box->dim; ++a) div += (double)u.at[a][p + box->stride[a]] - (double)u.at[a][p];
  return div / h;
}

/* b (= or +=) sign div u in free cells. */
static void add_divergence(const cf_detour *d, const cf_face u, const double sign, const bool adds) {
  const cf_box *box = &d->grid->box;
  CF_PARALLEL_ROWS (box, d->grid->threads, r)
    for (int i = 0; i < box->n[0]; ++i) {
      const ptrdiff_t p = cf_box_row(box, r) + i;
      const double div = cf_obstacles_has(d->obstacles, p) ? 0 : divergence(box, u, d->grid->h, p);
      d->b.at[p] = (cf_real)((adds ? (double)d->b.at[p] : 0) + sign * div);
    }
}

/* The last layer of faces of a periodic axis is the first. */
static void join(const cf_detour *d, const cf_face u) {
  for (int a = 0; a < d->grid->box.dim; ++a)
    if (d->wraps[a]) cf_obstacles_join(d->obstacles, a, u);
}

/* u -= grad p on faces between free cells. */
static void take_gradient(const cf_detour *d, const cf_face u) {
  const cf_box *box = &d->grid->box;
  cf_halo halo = {0};
  for (int a = 0; a < 3; ++a)
    for (int side = 0; side < 2; ++side) halo.rule[a][side] = d->wraps[a] ? CF_HALO_WRAP : CF_HALO_COPY;
  cf_halo_fill(box, &halo, 1, CF_CENTRES, d->p.at);
  cf_region_ghosts(d->solid, d->wraps);
  CF_PARALLEL_ROWS (box, d->grid->threads, r)
    for (int i = 0; i < box->n[0]; ++i)
      for (int a = 0; a < box->dim; ++a) {
        const ptrdiff_t p = cf_box_row(box, r) + i, o = p - box->stride[a];
        if (d->solid->kind[p] != CF_CELL_INSIDE || d->solid->kind[o] != CF_CELL_INSIDE) continue;
        u.at[a][p] -= (cf_real)(((double)d->p.at[p] - (double)d->p.at[o]) / d->grid->h);
      }
  join(d, u);
}

/* Of all that must be led around, the share that has no way out. */
static double share_stuck(const cf_detour *d) {
  const cf_box *box = &d->grid->box;
  double sum = 0, size = 0;
  for (ptrdiff_t r = 0; r < cf_box_rows(box); ++r)
    for (int i = 0; i < box->n[0]; ++i) {
      const double b = (double)d->b.at[cf_box_row(box, r) + i];
      sum += b;
      size += fabs(b);
    }
  return size > 0 ? fabs(sum) / size : 0;
}

cf_status cf_detour_make(cf_detour *d, const cf_face u, cf_solve_report *report) {
  const cf_box *box = &d->grid->box;
  if (!d->set) CF_TRY(cf_helmholtz_set(d->A, &(cf_coefficients){.beta = 1, .region = d->solid}));
  d->set = true;
  join(d, u);
  add_divergence(d, u, 1, false);
  cf_obstacles_push(d->obstacles, u);
  join(d, u);
  add_divergence(d, u, -1, true);
  CF_PARALLEL_ROWS (box, d->grid->threads, r)
    for (int i = 0; i < box->n[0]; ++i) d->p.at[cf_box_row(box, r) + i] = 0;
  d->stuck = share_stuck(d);
  CF_TRY(cf_helmholtz_solve(d->A, d->b, &(cf_solve_options){TOLERANCE, CYCLES}, d->p, report));
  take_gradient(d, u);
  return CF_OK;
}
