/* SPDX-License-Identifier: MIT
 *
 * Blocks of material points with water in them, stepped as model gel steps them, for tests.
 */
#ifndef CF_TESTS_WET_CASE_H
#define CF_TESTS_WET_CASE_H

#include "gel_case.h"
#include "physics/poro.h"

typedef struct wet_case {
  gel_case gel;
  cf_poro *poro;
  double first, gained;
  cf_solve_report report;
} wet_case;

/* A step of the water alone, or with the body moving. */
static inline void wet_step(wet_case *c, const double t, const double dt) {
  double gained;
  cf_mpm *m = c->gel.mpm;
  cf_mpm_scatter(m, dt);
  OK(cf_mpm_move_nodes(m, t, dt, &c->report));
  OK(cf_poro_step(c->poro, m->nodes, t, dt, &gained, &c->report));
  cf_mpm_gather(m, dt);
  c->gained += gained - m->returned;
}

static inline void wet_end(wet_case *c) {
  cf_poro_destroy(c->poro);
  gel_end(&c->gel);
}

static inline double mean_saturation(const wet_case *c) {
  const cf_mpm_sums s = cf_mpm_sums_of(c->gel.mpm);
  return s.water / s.capacity;
}

static inline double ledger_error(const wet_case *c) {
  const cf_mpm_sums s = cf_mpm_sums_of(c->gel.mpm);
  return fabs(s.water - c->first - c->gained) / (fabs(c->first) + fabs(c->gained));
}

/* A square block of 0.4 (in 3D a cube of 0.2), its particles displaced at random, on a lattice of n cells a metre and
 * `more` beyond it. */
static inline void make_block(wet_case *c, const int dim, const int n, const int more,
                              const cf_mpm_material *material, const cf_poro_params *p,
                              const double damping) {
  const double h = 1.0 / n, from = dim == 3 ? 0.4 : 0.3, to = 1 - from;
  const double low[3] = {from, from, from}, high[3] = {to, to, to};
  *c = (wet_case){.gel.material = {*material}};
  OK(cf_grid_init(&c->gel.grid, dim, (int[]){n + more, n + more, n + more}, h, NULL));
  gel_fill(&c->gel, low, high, 2, 0.3);
  gel_start(&c->gel, &(cf_mpm_params){.flip = -1, .damping = damping});
  OK(cf_poro_create(&c->poro, &c->gel.grid, p));
}

static inline void fill_with_water(const wet_case *c) {
  uint64_t seed = 3;
  for (int64_t i = 0; i < c->gel.set->count; ++i)
    gel_at(&c->gel, c->gel.at.water, 0)[i] =
        (cf_real)(0.7 * test_random(&seed) * (double)gel_at(&c->gel, c->gel.at.volume, 0)[i]);
}

#endif
