/* SPDX-License-Identifier: MIT
 *
 * The gusty wind: free of divergence, still on the ground, periodic sideways, as strong as asked.
 *
 * also in single precision
 */
#include <math.h>

#include "physics/gust.h"
#include "testing.h"

static void make(cf_gust *g) {
  const cf_gust_params p = {
      .wind = {1.5, -0.5, 0}, .strength = 0.8, .length = 1, .ground = 0.25, .period = {3, 2}, .seed = 7};
  cf_gust_create(g, &p);
}

static void gust_is_free_of_divergence(void **state) {
  (void)state;
  cf_gust g;
  make(&g);
  const double e = 1e-5;
  for (int i = 0; i < 200; ++i) {
    const double at[3] = {0.13 * i, 0.29 * i, 0.25 + 0.011 * i};
    double sum = 0, size = 0;
    for (int a = 0; a < 3; ++a) {
      double low[3] = {at[0], at[1], at[2]}, high[3] = {at[0], at[1], at[2]}, u[3], v[3];
      low[a] -= e;
      high[a] += e;
      cf_gust_at(&g, low, 0.3, u);
      cf_gust_at(&g, high, 0.3, v);
      sum += (v[a] - u[a]) / (2 * e);
      size += fabs(v[a] - u[a]) / (2 * e);
    }
    assert_true(fabs(sum) <= 1e-5 * (size + 1));
  }
}

static void gust_is_still_on_the_ground_and_periodic(void **state) {
  (void)state;
  cf_gust g;
  make(&g);
  for (int i = 0; i < 50; ++i) {
    const double ground[3] = {0.31 * i, 0.17 * i, 0.25}, at[3] = {0.31 * i, 0.17 * i, 1},
                 far[3] = {at[0] + 3, at[1] - 2, 1};
    double u[3], v[3];
    cf_gust_at(&g, ground, 0.1 * i, u);
    for (int a = 0; a < 3; ++a) assert_true(u[a] == 0);
    cf_gust_at(&g, at, 0.1 * i, u);
    cf_gust_at(&g, far, 0.1 * i, v);
    for (int a = 0; a < 3; ++a) assert_true(fabs(u[a] - v[a]) < 1e-9);
  }
}

static void gust_is_as_strong_as_asked(void **state) {
  (void)state;
  double square = 0, mean[3] = {0, 0, 0};
  int count = 0;
  for (uint64_t seed = 0; seed < 40; ++seed) {
    cf_gust g;
    cf_gust_params p = {.strength = 0.8, .length = 0.5, .period = {3, 3}, .seed = seed};
    cf_gust_create(&g, &p);
    for (int i = 0; i < 500; ++i, ++count) {
      const double at[3] = {0.173 * i, 0.619 * i, 1 + 0.003 * i};
      double u[3];
      cf_gust_at(&g, at, 0, u);
      for (int a = 0; a < 3; ++a) square += u[a] * u[a] / 3, mean[a] += u[a];
    }
  }
  assert_true(fabs(sqrt(square / count) - 0.8) < 0.04);
  for (int a = 0; a < 3; ++a) assert_true(fabs(mean[a] / count) < 0.08);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(gust_is_free_of_divergence),
                                     cmocka_unit_test(gust_is_still_on_the_ground_and_periodic),
                                     cmocka_unit_test(gust_is_as_strong_as_asked)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
