/* SPDX-License-Identifier: MIT
 *
 * The lid-driven cavity at Reynolds number 100: walls that stick, viscosity, and the pressure together.
 */
#include "cavity.h"

static void cavity_at_100_is_as_published(void **state) {
  (void)state;
  const double off = cavity_off(48, 100, 12, "re100");
  print_message("largest difference: %.4f with 48 cells\n", off);
  BELOW(off, 0.01);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(cavity_at_100_is_as_published)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
