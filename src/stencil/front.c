/* SPDX-License-Identifier: MIT */
#include "stencil/front.h"

#include <stdbool.h>

#include "grid/halo.h"
#include "grid/sweep.h"
#include "stencil/limit.h"

/* change[i] (= or +=) J_{i+1/2} - J_{i-1/2} along the axis with the given stride; `within`: J = 0 on faces that are not
 * between two cells inside. */
CF_KERNEL void jumps_row(const bool within, const int n, const ptrdiff_t stride, const cf_real *f,
                         const unsigned char *kind, const bool adds, cf_real *change) {
  CF_ROW_LOOP
  for (int i = 0; i < n; ++i) {
    const cf_real f0 = f[i - 2 * stride], f1 = f[i - stride], f2 = f[i], f3 = f[i + stride],
                  f4 = f[i + 2 * stride];
    const cf_real d1 = cf_limit_mc(f1 - f0, f2 - f1) / 2, d2 = cf_limit_mc(f2 - f1, f3 - f2) / 2,
                  d3 = cf_limit_mc(f3 - f2, f4 - f3) / 2;
    cf_real high = (f3 - d3) - (f2 + d2), low = (f2 - d2) - (f1 + d1);
    if (within) {
      const bool here = kind[i] == CF_CELL_INSIDE;
      high = (here & (kind[i + stride] == CF_CELL_INSIDE)) ? high : 0;
      low = (here & (kind[i - stride] == CF_CELL_INSIDE)) ? low : 0;
    }
    change[i] = (adds ? change[i] : 0) + (high - low);
  }
}
CF_CLONES static void first_jumps_row(const int n, const ptrdiff_t stride, const cf_real *f,
                                      cf_real *change) {
  jumps_row(false, n, stride, f, NULL, false, change);
}
CF_CLONES static void more_jumps_row(const int n, const ptrdiff_t stride, const cf_real *f, cf_real *change) {
  jumps_row(false, n, stride, f, NULL, true, change);
}
CF_CLONES static void inside_jumps_row(const int n, const ptrdiff_t stride, const cf_real *f,
                                       const unsigned char *kind, const bool adds, cf_real *change) {
  jumps_row(true, n, stride, f, kind, adds, change);
}

CF_CLONES static void apply_row(const int n, const cf_real nu, const cf_real *change, cf_real *f) {
  CF_ROW_LOOP
  for (int i = 0; i < n; ++i) f[i] += nu * change[i];
}

double cf_front_strength(const int dim, const double courant, const double weight) {
  return weight * CF_MIN(1.0 / dim, courant) / 2;
}

static cf_halo halo_of(const cf_walls *walls) {
  cf_halo halo = {0};
  for (int a = 0; a < 3; ++a)
    for (int side = 0; side < 2; ++side)
      halo.rule[a][side] = walls->kind[a][side] == CF_WALL_PERIODIC ? CF_HALO_WRAP : CF_HALO_COPY;
  return halo;
}

/* Ghosts of component a beyond an insulated wall of its own axis: what lies inside, with the sign changed. */
static void fill_odd(const cf_box *b, const int a, const int side, cf_real *q) {
  int low[3] = {0, 0, 0}, high[3] = {b->n[0], b->n[1], b->n[2]};
  low[a] = side == 0 ? 0 : b->n[a];
  high[a] = low[a] + 1;
  const ptrdiff_t out = side == 0 ? -b->stride[a] : b->stride[a];
  const int far = CF_MIN(2, b->n[a]);
  for (int k = low[2]; k < high[2]; ++k)
    for (int j = low[1]; j < high[1]; ++j)
      for (int i = low[0]; i < high[0]; ++i) {
        cf_real *wall = q + cf_box_at(b, i, j, k);
        wall[out] = -wall[-out];
        wall[2 * out] = -wall[-far * out];
      }
}

/* Filters the values from `first` to before `stop` along each axis; kind: NULL, or of the cells. */
static void filter(const cf_grid *g, const int first[3], const int stop[3], const unsigned char *kind,
                   const double nu, cf_real *f, cf_real *change) {
  const cf_box *b = &g->box;
  const int n = stop[0] - first[0], ny = stop[1] - first[1], nz = stop[2] - first[2];
#pragma omp parallel num_threads(cf_sweep_threads(b, g->threads))
  {
#pragma omp for schedule(static)
    for (int r = 0; r < ny * nz; ++r) {
      const ptrdiff_t p = cf_box_at(b, first[0], first[1] + r % ny, first[2] + r / ny);
      for (int a = 0; a < b->dim; ++a)
        if (kind != NULL)
          inside_jumps_row(n, b->stride[a], f + p, kind + p, a > 0, change + p);
        else if (a == 0)
          first_jumps_row(n, 1, f + p, change + p);
        else
          more_jumps_row(n, b->stride[a], f + p, change + p);
    }
#pragma omp for schedule(static)
    for (int r = 0; r < ny * nz; ++r) {
      const ptrdiff_t p = cf_box_at(b, first[0], first[1] + r % ny, first[2] + r / ny);
      apply_row(n, (cf_real)nu, change + p, f + p);
    }
  }
}

void cf_front_cell(const cf_grid *g, const cf_walls *walls, const cf_region *region, const double nu,
                   const cf_cell phi, const cf_cell work) {
  const cf_halo halo = halo_of(walls);
  cf_halo_fill(&g->box, &halo, 2, CF_CENTRES, phi.at);
  filter(g, (int[3]){0, 0, 0}, g->box.n, region != NULL ? region->kind : NULL, nu, phi.at, work.at);
}

void cf_front_face(const cf_grid *g, const cf_walls *walls, const double nu, const cf_face q,
                   const cf_cell work) {
  const cf_box *b = &g->box;
  const cf_halo halo = halo_of(walls);
  for (int a = 0; a < b->dim; ++a) {
    int first[3] = {0, 0, 0}, stop[3] = {b->n[0], b->n[1], b->n[2]};
    cf_halo_fill(b, &halo, 2, a, q.at[a]);
    for (int side = 0; side < 2; ++side)
      if (walls->kind[a][side] == CF_WALL_INSULATED) fill_odd(b, a, side, q.at[a]);
    if (walls->kind[a][0] == CF_WALL_INSULATED) first[a] = 1;
    if (walls->kind[a][1] != CF_WALL_PERIODIC && walls->kind[a][1] != CF_WALL_INSULATED)
      stop[a] = b->n[a] + 1;
    if (stop[a] > first[a]) filter(g, first, stop, NULL, nu, q.at[a], work.at);
    if (walls->kind[a][0] != CF_WALL_PERIODIC) continue;
    cf_halo image = {0};
    image.rule[a][0] = image.rule[a][1] = CF_HALO_WRAP;
    cf_halo_fill(b, &image, 0, a, q.at[a]);
  }
}
