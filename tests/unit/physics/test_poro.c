/* SPDX-License-Identifier: MIT
 *
 * Water in bodies of material points: the uptake of a slab against its exact solution for Fick, Jeffreys and Cattaneo,
 * the ledger, the filter, carried saturation, and that the size of the lattice does not matter.
 */
#include "base/real.h"
#include "reference.h"
#include "wet_case.h"

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

/* S on the plane a depth x below the wet surface: the mean over the particles within half a cell. */
static double saturation_at(const wet_case *c, const double surface, const double x) {
  const gel_case *g = &c->gel;
  double water = 0, room = 0;
  for (int64_t i = 0; i < g->set->count; ++i) {
    if (fabs((double)gel_at(g, 0, 0)[i] - surface - x) > 0.5 * g->grid.h) continue;
    water += (double)gel_at(g, g->at.water, 0)[i];
    room += 0.7 * (double)gel_at(g, g->at.volume, 0)[i];
  }
  return water / room;
}

/* The mean of |S - exact| over the depths of the table, without those at the ends and next to a jump. */
static double profile_error(const wet_case *c, const double surface, const double f_t, const double t) {
  table profile = table_read("slab_saturation.csv");
  double sum = 0;
  int depths = 0;
  for (int r = 0; r < profile.rows; ++r) {
    const double x = table_at(&profile, r, "x"), front = table_at(&profile, r, "front_travel_ct");
    if (table_at(&profile, r, "F") != f_t || table_at(&profile, r, "t") != t) continue;
    if (x < 0.05 || x > 0.95 || (f_t == 0 && fabs(x - front) < 0.15)) continue;
    sum += fabs(saturation_at(c, surface, x) - table_at(&profile, r, "S"));
    ++depths;
  }
  table_free(&profile);
  assert_true(depths >= 5);
  return sum / depths;
}

static void slabs_take_up_water_as_the_exact_solution(void **state) {
  (void)state;
  table t = table_read("slab_mean.csv");
  const double laws[] = {0, 0.3, 1};
  for (int law = 0; law < 3; ++law) {
    wet_case c;
    double now = 0;
    make_slab(&c, 24, 0.4, 0.3, &(cf_poro_params){.k = 0.05, .tau = 1, .f_t = laws[law]});
    for (int r = 0; r < t.rows; ++r) {
      if (table_at(&t, r, "F") != laws[law] || table_at(&t, r, "t") > 4) continue;
      const double until = table_at(&t, r, "t"), exact = table_at(&t, r, "mean_S");
      const int steps = (int)lround((until - now) / 0.02);
      for (int s = 0; s < steps; ++s) wet_step(&c, now + s * 0.02, 0.02);
      now = until;
      const double mean = fabs(mean_saturation(&c) / exact - 1),
                   profile = profile_error(&c, 8.7 * c.gel.grid.h, laws[law], until);
      print_message("F_T %g, t = %g: mean off by %.4f, profile by %.4f\n", laws[law], until, mean, profile);
      BELOW(mean, 0.05);
      BELOW(profile, 0.03);
    }
    BELOW(ledger_error(&c), 1e-12);
    wet_end(&c);
  }
  table_free(&t);
}

static void moving_alone_changes_no_saturation(void **state) {
  (void)state;
  const cf_mpm_material soft = {.density = 1, .water = 0.7, .mu = 1, .lambda = 1, GEL_ELASTIC};
  wet_case c;
  make_block(&c, 2, 32, 0, &soft, &(cf_poro_params){.k = 0, .tau = 1, .solver = {1e-8, 100}}, 0);
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
    make_block(&c, 2, 24, 0, &soft, &p, 15);
    double due = 0;
    const double dt = 0.4 / 24 / sqrt(60);
    for (int s = 0; s < 900; ++s) {
      wet_step(&c, s * dt, dt);
      due += dt * cf_poro_filter_rate(p.k, p.tau, p.f_t, 1.0 / 24);
      if (due > 0.02) {
        cf_mpm_filter(c.gel.mpm, &(double){-expm1(-due)});
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

/* All that particles carry. */
static void assert_same_bits(const gel_case *a, const gel_case *b) {
  assert_int_equal(a->set->count, b->set->count);
  assert_memory_equal(a->set->id, b->set->id, sizeof *a->set->id * (size_t)a->set->count);
  for (int k = 0; k < a->set->attributes; ++k)
    for (int v = 0; v < a->set->attribute[k].components; ++v)
      assert_memory_equal(gel_at(a, k, v), gel_at(b, k, v), sizeof(cf_real) * (size_t)a->set->count);
}

static void run_dense_and_sparse(const int dim, const int more) {
  const cf_mpm_material soft = {
      .density = 1, .water = 0.7, .mu = 16, .lambda = 24, .swelling = 4, GEL_ELASTIC};
  const cf_poro_source bath = {
      .kind = CF_PORO_BATH, .value = {.value = 1}, .to = INFINITY, .amount = INFINITY};
  wet_case c[2];
  for (int i = 0; i < 2; ++i) {
    const cf_poro_params p = {.k = 0.05,
                              .tau = 1,
                              .solver = {1e-6, 100},
                              .sources = 1,
                              .source = &bath,
                              .two_stages = true,
                              .dense = i == 1};
    make_block(&c[i], dim, 32, more, &soft, &p, 0);
    for (int64_t v = 0; v < c[i].gel.set->count; ++v) gel_at(&c[i].gel, c[i].gel.at.velocity, 0)[v] = 2;
    for (int s = 0; s < 12; ++s) wet_step(&c[i], 0, 2e-3); /* through more than a cell */
    cf_mpm_filter(c[i].gel.mpm, &(double){0.2});
  }
  assert_same_bits(&c[0].gel, &c[1].gel);
  assert_true(c[0].gained == c[1].gained && c[0].gained > 0);
  assert_true(c[0].poro->tiles->count < c[1].poro->tiles->count);
  for (int i = 0; i < 2; ++i) wet_end(&c[i]);
}

/* Visiting only tiles with a body in them gives what visiting every cell of the lattice gives. */
static void sparse_lattice_has_the_bits_of_a_dense_one(void **state) {
  (void)state;
  run_dense_and_sparse(2, 96);
  run_dense_and_sparse(3, 0);
}

/* What is far away does not matter, but for the tree of the sums and what it does to round-off. */
static void larger_lattice_changes_nothing(void **state) {
  (void)state;
  const cf_mpm_material soft = {
      .density = 1, .water = 0.7, .mu = 16, .lambda = 24, .swelling = 4, GEL_ELASTIC};
  const cf_poro_source bath = {
      .kind = CF_PORO_BATH, .value = {.value = 1}, .to = INFINITY, .amount = INFINITY};
  const cf_poro_params p = {.k = 0.05, .tau = 1, .solver = {1e-6, 100}, .sources = 1, .source = &bath};
  wet_case c[2];
  for (int i = 0; i < 2; ++i) {
    make_block(&c[i], 2, 32, i * 96, &soft, &p, 0);
    for (int s = 0; s < 6; ++s) wet_step(&c[i], 0, 2e-3);
    cf_mpm_filter(c[i].gel.mpm, &(double){0.2});
  }
  for (int64_t i = 0; i < c[0].gel.set->count; ++i) {
    assert_int_equal(c[0].gel.set->id[i], c[1].gel.set->id[i]);
    for (int a = 0; a < 2; ++a) CLOSE(gel_at(&c[0].gel, 0, a)[i], gel_at(&c[1].gel, 0, a)[i], 1e-12);
  }
  for (int i = 0; i < 2; ++i) wet_end(&c[i]);
}

static void filter_keeps_water_and_what_the_grid_sees(void **state) {
  (void)state;
  const cf_mpm_material soft = {.density = 1, .water = 0.7, .mu = 16, .lambda = 24, GEL_ELASTIC};
  wet_case c;
  make_block(&c, 2, 32, 0, &soft, &(cf_poro_params){.k = 1, .tau = 1, .solver = {1e-6, 100}}, 0);
  fill_with_water(&c);
  const cf_mpm_sums before = cf_mpm_sums_of(c.gel.mpm);
  for (int s = 0; s < 50; ++s) cf_mpm_filter(c.gel.mpm, &(double){0.5});
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
      cmocka_unit_test(sparse_lattice_has_the_bits_of_a_dense_one),
      cmocka_unit_test(larger_lattice_changes_nothing),
      cmocka_unit_test(filter_keeps_water_and_what_the_grid_sees),
      cmocka_unit_test(fill_gives_the_distance),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
