/* SPDX-License-Identifier: MIT
 *
 * The anisotropy of surfaces against values in 30 digits, and the arc tangent.
 */
/* also in single precision */
#include <math.h>

#include "base/real.h"
#include "reference.h"
#include "stencil/anisotropy.h"
#include "stencil/arctan.h"
#include "testing.h"

#ifdef CF_SINGLE
#define EXACT 3e-6
#else
#define EXACT 1e-10
#endif

static void anisotropy_flux_agrees_with_derivatives_in_many_digits(void **state) {
  (void)state;
  table t = table_read("anisotropic_flux.csv");
  assert_true(t.rows >= 20);
  for (int r = 0; r < t.rows; ++r) {
    const cf_anisotropy_params p = {.n = (int)table_at(&t, r, "omega"),
                                    .strength = table_at(&t, r, "eps_p"),
                                    .polar_n = (int)table_at(&t, r, "zeta"),
                                    .polar_strength = table_at(&t, r, "eps_a"),
                                    .printed = true};
    cf_anisotropy a;
    OK(cf_anisotropy_init(&a, &p));
    const cf_vec q = {(cf_real)table_at(&t, r, "px"), (cf_real)table_at(&t, r, "py"),
                      (cf_real)table_at(&t, r, "pz")};
    const cf_facing f = {(cf_real)a.strength, (cf_real)a.C, (cf_real)a.S};
    const double size = 1 + fabs((double)q.x) + fabs((double)q.y) + fabs((double)q.z);
    const cf_vec J = cf_anisotropy_flux(3, (int)a.facets, &a, f, q, 1, 1);
    CLOSE(J.x, table_at(&t, r, "Jx"), EXACT * size);
    CLOSE(J.y, table_at(&t, r, "Jy"), EXACT * size);
    CLOSE(J.z, table_at(&t, r, "Jz"), EXACT * size);
    if (q.z != 0 || p.polar_strength != 0) continue;
    const cf_vec flat = cf_anisotropy_flux(2, (int)a.facets, &a, f, q, 1, 1);
    CLOSE(flat.x, table_at(&t, r, "Jx"), EXACT * size);
    CLOSE(flat.y, table_at(&t, r, "Jy"), EXACT * size);
  }
  table_free(&t);
}

static double energy(const cf_anisotropy *a, const cf_facing f, const double p[3]) {
  cf_vec B;
  const cf_vec q = {(cf_real)p[0], (cf_real)p[1], (cf_real)p[2]};
  const double A = (double)cf_anisotropy_at(3, (int)a->facets, a, f, q, &B);
  return A * A * (p[0] * p[0] + p[1] * p[1] + p[2] * p[2]) / 2;
}

/* J is the gradient of A^2 |p|^2/2 for every law, turned and not. */
static void anisotropy_flux_is_the_gradient_of_the_energy(void **state) {
  static const cf_anisotropy_params laws[] = {
      {.n = 4, .strength = 0.05},
      {.n = 6, .strength = 0.02, .angle = 0.3},
      {.n = 8, .strength = 0.01, .polar_n = 2, .polar_strength = 0.1},
      {.n = 12, .strength = 0.005, .angle = 1, .polar_n = 4, .polar_strength = -.05},
      {.n = 2, .strength = 0.1, .polar_n = 6, .polar_strength = 0.02},
      {.cubic = true, .strength = 0.04, .angle = 0.7}};
  uint64_t seed = 5;
  (void)state;
#ifdef CF_SINGLE
  skip(); /* differences of single precision say nothing */
#endif
  for (size_t l = 0; l < sizeof laws / sizeof *laws; ++l)
    for (int i = 0; i < 50; ++i) {
      cf_anisotropy a;
      OK(cf_anisotropy_init(&a, &laws[l]));
      const cf_facing f = {(cf_real)a.strength, (cf_real)a.C, (cf_real)a.S};
      double p[3];
      for (int b = 0; b < 3; ++b) p[b] = 2 * test_random(&seed) - 1;
      const cf_vec J = cf_anisotropy_flux(3, (int)a.facets, &a, f,
                                          (cf_vec){(cf_real)p[0], (cf_real)p[1], (cf_real)p[2]}, 1, 1);
      const double found[3] = {(double)J.x, (double)J.y, (double)J.z};
      for (int b = 0; b < 3; ++b) {
        double low[3] = {p[0], p[1], p[2]}, high[3] = {p[0], p[1], p[2]};
        low[b] -= 1e-5, high[b] += 1e-5;
        CLOSE(found[b], (energy(&a, f, high) - energy(&a, f, low)) / 2e-5, 2e-7);
      }
    }
}

static void anisotropy_flux_is_zero_at_zero_and_odd(void **state) {
  cf_anisotropy a;
  (void)state;
  OK(cf_anisotropy_init(
      &a, &(cf_anisotropy_params){.n = 6, .strength = 0.02, .polar_n = 2, .polar_strength = 0.1}));
  const cf_facing f = {(cf_real)a.strength, 1, 0};
  const cf_vec zero = cf_anisotropy_flux(3, (int)a.facets, &a, f, (cf_vec){0, 0, 0}, 1, 1);
  assert_true(zero.x == 0 && zero.y == 0 && zero.z == 0);
  const cf_vec one =
      cf_anisotropy_flux(3, (int)a.facets, &a, f, (cf_vec){(cf_real)0.3, (cf_real)-0.2, (cf_real)0.9}, 1, 1);
  const cf_vec other =
      cf_anisotropy_flux(3, (int)a.facets, &a, f, (cf_vec){(cf_real)-0.3, (cf_real)0.2, (cf_real)-0.9}, 1, 1);
  assert_true(one.x == -other.x && one.y == -other.y && one.z == -other.z);
}

/* In the plane the stiffest direction has (1 - e)(1 + (n^2 - 1) e), and beyond e = 1/(n^2 - 1) the law is not convex. */
static void anisotropy_bounds_are_those_of_the_plane(void **state) {
  (void)state;
  for (int n = 4; n <= 8; n += 2) {
    cf_anisotropy a;
    const double least = 1.0 / (n * n - 1), e = 0.7 * least;
    OK(cf_anisotropy_init(&a, &(cf_anisotropy_params){.n = n, .strength = e}));
    const cf_anisotropy_bounds b = cf_anisotropy_range(&a, 2, e);
    CLOSE(b.stiff_max, (1 - e) * (1 + (n * n - 1) * e), 3e-3);
    CLOSE(b.a_max, 1 + e, 1e-6);
    CLOSE(b.a_min, 1 - e, 1e-6);
    assert_true(b.stiff_min > 0);
    assert_true(cf_anisotropy_range(&a, 2, 1.05 * least).stiff_min < 0);
  }
}

static void anisotropy_with_odd_folds_is_refused(void **state) {
  cf_anisotropy a;
  (void)state;
  assert_int_equal(cf_anisotropy_init(&a, &(cf_anisotropy_params){.n = 5, .strength = 0.01}),
                   CF_BAD_ARGUMENT);
  assert_int_equal(cf_anisotropy_init(&a, &(cf_anisotropy_params){.n = 6, .polar_n = 3}), CF_BAD_ARGUMENT);
}

static void arctan_is_good_to_a_few_units(void **state) {
  (void)state;
  for (int i = -4000; i <= 4000; ++i) {
    const double x = i / 1000.0 * fabs(i / 400.0), y = (double)(cf_real)x;
    CLOSE(cf_arctan((cf_real)x), atan(y), 3 * (double)CF_REAL_EPSILON);
  }
  CLOSE(cf_arctan((cf_real)1e30), acos(-1) / 2, 2 * (double)CF_REAL_EPSILON);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(anisotropy_flux_agrees_with_derivatives_in_many_digits),
      cmocka_unit_test(anisotropy_flux_is_the_gradient_of_the_energy),
      cmocka_unit_test(anisotropy_flux_is_zero_at_zero_and_odd),
      cmocka_unit_test(anisotropy_bounds_are_those_of_the_plane),
      cmocka_unit_test(anisotropy_with_odd_folds_is_refused),
      cmocka_unit_test(arctan_is_good_to_a_few_units),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
