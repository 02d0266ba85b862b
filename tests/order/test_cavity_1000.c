/* SPDX-License-Identifier: MIT
 *
 * The lid-driven cavity at Reynolds number 1000. Ghia's lines are 0.012 off the spectral solution that the extremes are from.
 */
/* takes long */
#include "cavity.h"

static void cavity_at_1000_is_as_published(void **state) {
  (void)state;
  const cavity coarse = cavity_steady(64, 1000), fine = cavity_steady(128, 1000);
  const double far = cavity_off_extremes(&coarse, "re1000"), near = cavity_off_extremes(&fine, "re1000");
  const double ghia = cavity_off_ghia(&fine, "re1000");
  print_message("extremes: %.5f with 64 cells, %.5f with 128; Ghia's lines: %.4f; steady at %g and %g\n", far,
                near, ghia, coarse.t, fine.t);
  BELOW(near, 0.007);
  BELOW(3.5, far / near);
  BELOW(ghia, 0.012);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(cavity_at_1000_is_as_published)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
