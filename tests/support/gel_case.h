/* SPDX-License-Identifier: MIT
 *
 * A block of material points for tests: a box of cells filled with particles on a lattice, regular or displaced at
 * random, all of one material.
 */
#ifndef CF_TESTS_GEL_CASE_H
#define CF_TESTS_GEL_CASE_H

#include <math.h>
#include <string.h>

#include "physics/mpm.h"
#include "testing.h"

typedef struct gel_case {
  cf_grid grid;
  cf_particles *set;
  cf_mpm_attributes at;
  cf_mpm_material material[2];
  cf_mpm *mpm;
} gel_case;

/* Particles in low <= x < high, `per` of them an axis and cell; jitter in spacings. F = I, v = 0, no water. */
static inline void gel_fill(gel_case *g, const double low[3], const double high[3], const int per,
                            const double jitter) {
  const int dim = g->grid.box.dim;
  const double s = g->grid.h / per;
  int n[3] = {1, 1, 1};
  int64_t all = 1, q = 0;
  uint64_t seed = 7;
  for (int a = 0; a < dim; ++a) all *= n[a] = (int)lround((high[a] - low[a]) / s);
  OK(cf_particles_create(&g->set, "gel", dim, all));
  OK(cf_mpm_attributes_add(g->set, &g->at));
  OK(cf_particles_append(g->set, all, NULL));
  for (int k = 0; k < n[2]; ++k)
    for (int j = 0; j < n[1]; ++j)
      for (int i = 0; i < n[0]; ++i, ++q) {
        const int at[3] = {i, j, k};
        for (int a = 0; a < dim; ++a) {
          const double x = low[a] + (at[a] + 0.5 + 2 * jitter * (test_random(&seed) - 0.5)) * s;
          g->set->attribute[g->at.position].at[a][q] = (cf_real)x;
          g->set->attribute[g->at.deformation].at[a * dim + a][q] = 1;
        }
        g->set->attribute[g->at.volume].at[0][q] = (cf_real)pow(s, dim);
        g->set->attribute[g->at.plastic].at[0][q] = 1;
      }
}

static inline void gel_start(gel_case *g, const cf_mpm_params *p) {
  cf_mpm_params own = *p;
  own.material = g->material;
  if (own.materials == 0) own.materials = 1;
  OK(cf_mpm_create(&g->mpm, &g->grid, g->set, &g->at, &own));
}

static inline void gel_end(gel_case *g) {
  cf_mpm_destroy(g->mpm);
  cf_particles_destroy(g->set);
}

static inline cf_real *gel_at(const gel_case *g, const int attribute, const int c) {
  return g->set->attribute[attribute].at[c];
}

/* Nodes on which no water moves. */
static inline void gel_still_water(const gel_case *g) {
  for (ptrdiff_t n = 0; n < (ptrdiff_t)g->mpm->nodes->count * CF_BLOCK_NODES; ++n)
    for (int c = CF_NODE_CAPACITY; c <= CF_NODE_FILL; ++c) g->mpm->nodes->at[n][c] = 0;
}

static inline void gel_step(const gel_case *g, const double t, const double dt) {
  cf_solve_report report;
  cf_mpm_scatter(g->mpm, dt);
  OK(cf_mpm_move_nodes(g->mpm, t, dt, &report));
  gel_still_water(g);
  cf_mpm_gather(g->mpm, dt);
}

#define GEL_ELASTIC .stretch = INFINITY, .compression = INFINITY

#endif
