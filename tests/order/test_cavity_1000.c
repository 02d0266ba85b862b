/* SPDX-License-Identifier: MIT
 *
 * The lid-driven cavity at Reynolds number 1000.
 */
/* takes long */
#include "cavity.h"

static void cavity_at_1000_is_as_published(void **state) {
  (void)state;
  const double off = cavity_off(96, 1000, 45, "re1000");
  print_message("largest difference: %.4f with 96 cells\n", off);
  BELOW(off, 0.02);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(cavity_at_1000_is_as_published)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
