/* SPDX-License-Identifier: MIT
 *
 * The lid-driven cavity at Reynolds number 100: walls that stick, viscosity, and the pressure together. The extremes of the
 * velocity close in on those of a much finer solution with order 2; Ghia's lines are themselves 0.009 off it.
 */
#include "cavity.h"

static void cavity_at_100_is_as_published(void **state) {
  (void)state;
  const cavity coarse = cavity_steady(32, 100), fine = cavity_steady(64, 100);
  const double far = cavity_off_extremes(&coarse, "re100"), near = cavity_off_extremes(&fine, "re100");
  const double ghia = cavity_off_ghia(&fine, "re100");
  print_message("extremes: %.5f with 32 cells, %.5f with 64; Ghia's lines: %.4f; steady at %g and %g\n", far,
                near, ghia, coarse.t, fine.t);
  BELOW(near, 0.0012);
  BELOW(3.5, far / near);
  BELOW(ghia, 0.009);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(cavity_at_100_is_as_published)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
