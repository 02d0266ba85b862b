/* SPDX-License-Identifier: MIT
 *
 * Water in bodies of material points: the uptake of a slab against its exact solution for Fick, Jeffreys and Cattaneo,
 * the ledger, the filter, carried saturation, and that the size of the lattice does not matter.
 */
#include "base/real.h"
#include "gel_case.h"
#include "physics/poro.h"
#include "reference.h"

typedef struct wet_case {
  gel_case gel;
  cf_poro *poro;
  double first, gained;
  cf_solve_report report;
} wet_case;

/* A step of the water alone, or with the body moving. */
static void wet_step(wet_case *c, const double t, const double dt) {
  double gained;
  cf_mpm *m = c->gel.mpm;
  cf_mpm_scatter(m, dt);
  OK(cf_mpm_move_nodes(m, t, dt, &c->report));
  OK(cf_poro_step(c->poro, m->nodes, t, dt, &gained, &c->report));
  cf_mpm_gather(m, dt);
  c->gained += gained - m->returned;
}

static void wet_end(wet_case *c) {
  cf_poro_destroy(c->poro);
  gel_end(&c->gel);
}

static double mean_saturation(const wet_case *c) {
  const cf_mpm_sums s = cf_mpm_sums_of(c->gel.mpm);
  return s.water / s.capacity;
}

static double ledger_error(const wet_case *c) {
  const cf_mpm_sums s = cf_mpm_sums_of(c->gel.mpm);
  return fabs(s.water - c->first - c->gained) / (fabs(c->first) + fabs(c->gained));
}

/* A slab of thickness 1, wet at x = low; its sides along x are insulated. `shift`: of the surface in its cell. */
static void make_slab(wet_case *c, const int n, const double shift, const double jitter,
                      const cf_poro_params *p) {
  const double h = 1.0 / n, low[3] = {8.3 * h + shift * h, 8 * h, 0}, high[3] = {low[0] + 1, 40 * h, 0};
  static cf_shape side;
  static cf_poro_source bath;
  *c = (wet_case){.gel.material = {{.density = 1, .water = 0.7, GEL_ELASTIC}}};
  OK(cf_grid_init(&c->gel.grid, 2, (int[]){n + 24, 56, 1}, h, NULL));
  gel_fill(&c->gel, low, high, 2, jitter);
  gel_start(&c->gel, &(cf_mpm_params){.flip = -1});
  side = cf_shape_box(2, (double[]){low[0], 0, 0}, (double[]){0.6 * h, INFINITY, INFINITY});
  bath = (cf_poro_source){
      .kind = CF_PORO_BATH, .shape = &side, .value = {.value = 1}, .to = INFINITY, .amount = INFINITY};
  cf_poro_params own = *p;
  own.sources = 1, own.source = &bath;
  own.two_stages = true;
  own.solver = (cf_solve_options){1e-8, 100};
  OK(cf_poro_create(&c->poro, &c->gel.grid, &own));
}

static void slabs_take_up_water_as_the_exact_solution(void **state) {
  (void)state;
  table t = table_read("slab_mean.csv");
  for (double f_t = 0; f_t <= 1; f_t += 1) {
    wet_case c;
    double now = 0;
    make_slab(&c, 24, 0.4, 0.3, &(cf_poro_params){.k = 0.05, .tau = 1, .f_t = f_t});
    for (int r = 0; r < t.rows; ++r) {
      if (table_at(&t, r, "F") != f_t) continue;
      if (table_at(&t, r, "t") > 4) continue;
      const double until = table_at(&t, r, "t"), exact = table_at(&t, r, "mean_S");
      const int steps = (int)lround((until - now) / 0.02);
      for (int s = 0; s < steps; ++s) wet_step(&c, now + s * 0.02, 0.02);
      now = until;
      BELOW(fabs(mean_saturation(&c) / exact - 1), 0.05);
    }
    BELOW(ledger_error(&c), 1e-12);
    wet_end(&c);
  }
  table_free(&t);
}

/* A disc, 2D, on a lattice of n cells (more around it at will), moving. */
static void make_disc(wet_case *c, const int n, const int more, const cf_mpm_material *material,
                      const cf_poro_params *p, const double damping) {
  const double h = 1.0 / n, low[3] = {0.3, 0.3, 0}, high[3] = {0.7, 0.7, 0};
  *c = (wet_case){.gel.material = {*material}};
  OK(cf_grid_init(&c->gel.grid, 2, (int[]){n + more, n + more, 1}, h, NULL));
  gel_fill(&c->gel, low, high, 2, 0.3);
  gel_start(&c->gel, &(cf_mpm_params){.flip = -1, .damping = damping});
  OK(cf_poro_create(&c->poro, &c->gel.grid, p));
}

static void fill_with_water(const wet_case *c) {
  uint64_t seed = 3;
  for (int64_t i = 0; i < c->gel.set->count; ++i)
    gel_at(&c->gel, c->gel.at.water, 0)[i] =
        (cf_real)(0.7 * test_random(&seed) * (double)gel_at(&c->gel, c->gel.at.volume, 0)[i]);
}

static void moving_alone_changes_no_saturation(void **state) {
  (void)state;
  const cf_mpm_material soft = {.density = 1, .water = 0.7, .mu = 1, .lambda = 1, GEL_ELASTIC};
  wet_case c;
  make_disc(&c, 32, 0, &soft, &(cf_poro_params){.k = 0, .tau = 1, .solver = {1e-8, 100}}, 0);
  fill_with_water(&c);
  for (int64_t i = 0; i < c.gel.set->count; ++i) gel_at(&c.gel, c.gel.at.velocity, 0)[i] = 1;
  cf_particles *set = c.gel.set;
  double before = 0, after = 0;
  for (int64_t i = 0; i < set->count; ++i)
    before += (double)set->id[i] * (double)gel_at(&c.gel, c.gel.at.water, 0)[i] /
              (double)gel_at(&c.gel, c.gel.at.volume, 0)[i];
  for (int s = 0; s < 40; ++s) wet_step(&c, 0, 5e-3);
  for (int64_t i = 0; i < set->count; ++i)
    after += (double)set->id[i] * (double)gel_at(&c.gel, c.gel.at.water, 0)[i] /
             (double)gel_at(&c.gel, c.gel.at.volume, 0)[i];
  CLOSE(after / before, 1, 1e-14);
  wet_end(&c);
}

/* From dry, all around wet, for Fick and for Cattaneo: full in the end, and as large as the closed form says. */
static void dry_gel_in_a_bath_swells_to_the_closed_form(void **state) {
  (void)state;
  const cf_mpm_material soft = {
      .density = 1, .water = 0.7, .mu = 16, .lambda = 24, .swelling = 4, GEL_ELASTIC};
  const cf_poro_source bath = {
      .kind = CF_PORO_BATH, .value = {.value = 1}, .to = INFINITY, .amount = INFINITY};
  for (int f_t = 0; f_t < 2; ++f_t) {
    const cf_poro_params p = {
        .k = 0.2, .tau = 0.05, .f_t = f_t, .solver = {1e-8, 100}, .sources = 1, .source = &bath};
    wet_case c;
    make_disc(&c, 24, 0, &soft, &p, 15);
    double due = 0;
    const double dt = 0.4 / 24 / sqrt(60);
    for (int s = 0; s < 900; ++s) {
      wet_step(&c, s * dt, dt);
      due += dt * cf_poro_filter_rate(&p, 1.0 / 24);
      if (due > 0.02) {
        cf_mpm_filter(c.gel.mpm, -expm1(-due));
        due = 0;
      }
    }
    const cf_mpm_sums sums = cf_mpm_sums_of(c.gel.mpm);
    CLOSE(mean_saturation(&c), 1, 3e-3);
    const double V0 = (double)gel_at(&c.gel, c.gel.at.volume, 0)[0] * (double)c.gel.set->count;
    CLOSE(sums.volume / V0, 1.09387086349355, 1e-3);
    BELOW(ledger_error(&c), 1e-12);
    wet_end(&c);
  }
}

/* What is far away does not matter: the same bits on a lattice sixteen times as large. */
static void sparse_lattice_gives_the_bits_of_a_dense_one(void **state) {
  (void)state;
  const cf_mpm_material soft = {
      .density = 1, .water = 0.7, .mu = 16, .lambda = 24, .swelling = 4, GEL_ELASTIC};
  const cf_poro_source bath = {
      .kind = CF_PORO_BATH, .value = {.value = 1}, .to = INFINITY, .amount = INFINITY};
  const cf_poro_params p = {.k = 0.05, .tau = 1, .solver = {1e-6, 100}, .sources = 1, .source = &bath};
  wet_case c[2];
  for (int i = 0; i < 2; ++i) {
    make_disc(&c[i], 32, i * 96, &soft, &p, 0);
    for (int s = 0; s < 6; ++s) wet_step(&c[i], 0, 2e-3);
    cf_mpm_filter(c[i].gel.mpm, 0.2);
  }
  double worst = 0;
  for (int64_t i = 0; i < c[0].gel.set->count; ++i) {
    assert_int_equal(c[0].gel.set->id[i], c[1].gel.set->id[i]);
    for (int a = 0; a < 2; ++a)
      worst = CF_MAX(worst, fabs((double)gel_at(&c[0].gel, 0, a)[i] - (double)gel_at(&c[1].gel, 0, a)[i]));
  }
  BELOW(worst, 1e-12);
  for (int i = 0; i < 2; ++i) wet_end(&c[i]);
}

static void filter_keeps_water_and_what_the_grid_sees(void **state) {
  (void)state;
  const cf_mpm_material soft = {.density = 1, .water = 0.7, .mu = 16, .lambda = 24, GEL_ELASTIC};
  wet_case c;
  make_disc(&c, 32, 0, &soft, &(cf_poro_params){.k = 1, .tau = 1, .solver = {1e-6, 100}}, 0);
  fill_with_water(&c);
  const cf_mpm_sums before = cf_mpm_sums_of(c.gel.mpm);
  for (int s = 0; s < 50; ++s) cf_mpm_filter(c.gel.mpm, 0.5);
  const cf_mpm_sums after = cf_mpm_sums_of(c.gel.mpm);
  CLOSE(after.water / before.water, 1, 1e-13);
  assert_true(after.saturation_max - after.saturation_min <
              0.9 * (before.saturation_max - before.saturation_min));
  wet_end(&c);
}

static void fill_gives_the_distance(void **state) {
  (void)state;
  for (double z = -1.45; z < 1.5; z += 0.1) {
    const double a = fabs(z), far = a < 0.5 ? 0.5 + 0.75 * a - a * a * a / 3 : 1 - pow(1.5 - a, 3) / 6;
    CLOSE(cf_poro_distance(z < 0 ? 1 - far : far), z, 1e-12);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(slabs_take_up_water_as_the_exact_solution),
      cmocka_unit_test(moving_alone_changes_no_saturation),
      cmocka_unit_test(dry_gel_in_a_bath_swells_to_the_closed_form),
      cmocka_unit_test(sparse_lattice_gives_the_bits_of_a_dense_one),
      cmocka_unit_test(filter_keeps_water_and_what_the_grid_sees),
      cmocka_unit_test(fill_gives_the_distance),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
