/* SPDX-License-Identifier: MIT */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "stencil/regime.h"

#define PI 3.14159265358979323846

static int near(const double a, const double b) { return fabs(a - b) <= 1e-12 * fabs(b); }

static void regime_of_the_cone_at_thirty_degrees(void **state) {
  (void)state;
  const double c = cf_regime_speed(0.25, 4, 0), h_c = cf_regime_number(-0.5, c);
  assert_true(near(c, 0.25));
  assert_true(near(h_c, 2));
  assert_true(near(cf_regime_cone_angle(h_c), PI / 6));
  assert_true(near(cf_regime_cone_length(0.5, 4, h_c), 2 * 4 * 0.5 * 0.75));
  assert_string_equal(cf_regime_word(cf_regime_of(0.25, 4, 0, 0.5)), "super-critical");
  assert_string_equal(cf_regime_word(cf_regime_of(0.25, 4, 0, 0.25)), "critical");
  assert_string_equal(cf_regime_word(cf_regime_of(0.25, 4, 0, 0.2)), "sub-critical");
  assert_string_equal(cf_regime_word(cf_regime_of(0.25, 4, 0, 0)), "sub-critical");
}

static void regime_without_memory_has_no_fronts(void **state) {
  (void)state;
  assert_true(isinf(cf_regime_speed(0.1, 0, 0)));
  assert_true(cf_regime_speed(0.1, 2, 1) == 0);
  assert_true(cf_regime_speed(0.1, 0, 1) == 0);
  assert_true(cf_regime_speed(0, 0, 0) == 0);
  assert_true(cf_regime_number(3, INFINITY) == 0);
  assert_true(cf_regime_number(0, 0) == 0);
  assert_true(isinf(cf_regime_number(3, 0)));
  assert_true(cf_regime_cone_angle(INFINITY) == 0);
  assert_true(isnan(cf_regime_cone_angle(0.5)));
  assert_true(cf_regime_cone_length(3, 1, 0.5) == 0);
  assert_int_equal(cf_regime_of(0.1, 0, 0.3, 5), CF_REGIME_FOURIER);
  assert_int_equal(cf_regime_of(0.1, 1, 1, 5), CF_REGIME_FOURIER);
  assert_int_equal(cf_regime_of(0, 1, 0, 5), CF_REGIME_STILL);
  assert_true(isinf(cf_regime_wave_band(0.1, 0, 0.5).low));
  assert_true(isinf(cf_regime_wave_band(0.1, 1, 1).low));
  assert_true(isinf(cf_regime_wave_band(0.1, 1, 0).high));
  assert_true(near(cf_regime_wave_band(0.04, 0.25, 0).low, 5)); /* 1/(2 sqrt(tau k)) */
}

/* k = 0.02, tau = 0.5; each line F, K_low, K_high, K_star, phase speed there, c, ... */
static void regime_wave_band_is_that_of_the_reference(void **state) {
  (void)state;
  const double k = 0.02, tau = 0.5;
  FILE *f = fopen(CF_SOURCE_DIR "/tests/reference/jeffreys_wave_band.csv", "r");
  assert_non_null(f);
  char line[512];
  int rows = 0;
  while (fgets(line, sizeof line, f) != NULL) {
    double v[6];
    if (sscanf(line, "%lf,%lf,%lf,%lf,%lf,%lf", &v[0], &v[1], &v[2], &v[3], &v[4], &v[5]) < 6) continue;
    const cf_wave_band band = cf_regime_wave_band(k, tau, v[0]);
    assert_true(fabs(band.low / v[1] - 1) < 1e-9);
    assert_true(fabs(band.high / v[2] - 1) < 1e-9);
    assert_true(fabs(band.peak / v[3] - 1) < 1e-9);
    assert_true(fabs(cf_regime_speed(k, tau, v[0]) / v[4] - 1) < 1e-9);
    assert_true(near(cf_regime_blur(k, tau, v[0]), 1 / band.peak));
    ++rows;
  }
  fclose(f);
  assert_int_equal(rows, 5);
}

static void regime_stage_lies_between_wave_and_fourier(void **state) {
  (void)state;
  assert_true(near(cf_regime_stage(0.1, 0, 0.3), 0.1));
  assert_true(near(cf_regime_stage(0.1, 5, 1), 0.1));
  assert_true(near(cf_regime_stage(0.1, 5, 0), 0.01 / 5.1));
  assert_true(near(cf_regime_stage(0.1, INFINITY, 0.25), 0.025));
  assert_true(cf_regime_stage(0, 0, 0) == 0);
  assert_true(near(cf_regime_sigma(cf_regime_stage(0.1, 0, 0), 2, 0.5), 0.8));
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(regime_of_the_cone_at_thirty_degrees),
      cmocka_unit_test(regime_without_memory_has_no_fronts),
      cmocka_unit_test(regime_wave_band_is_that_of_the_reference),
      cmocka_unit_test(regime_stage_lies_between_wave_and_fourier),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
