/* SPDX-License-Identifier: MIT
 *
 * PFHub's benchmark 3 at equal spacing, up to t = 500 with spacings 1.2 and .8.
 */
/* takes long */
#include "pfhub3.h"

static void compare(const dendrite_case *of, const char *spacing) {
  table t = table_read("pfhub3_summary.csv");
  char tip[16], solid[16], energy[16];
  crystal c;
  snprintf(tip, sizeof tip, "tip_%s", spacing);
  snprintf(solid, sizeof solid, "sf_%s", spacing);
  snprintf(energy, sizeof energy, "F_%s", spacing);
  dendrite_make(&c, of, 1);
  for (int i = 0; i < 2; ++i) {
    dendrite_grow(&c, of, table_at(&t, i, "t") - 250, table_at(&t, i, "t"));
    const dendrite found = dendrite_measured(&c);
    print_message("t = %4.0f: ", table_at(&t, i, "t"));
    dendrite_print(&found);
    CLOSE(found.tip / table_at(&t, i, tip), 1, 5e-3);
    CLOSE(found.solid / table_at(&t, i, solid), 1, 5e-3);
    CLOSE((DENDRITE_ENERGY - found.energy) / (DENDRITE_ENERGY - table_at(&t, i, energy)), 1, 5e-3);
  }
  crystal_free(&c);
  table_free(&t);
}

static void dendrite_at_spacing_12_is_that_of_an_independent_program(void **state) {
  (void)state;
  compare(&(dendrite_case){.h = 1.2, .dt = 0.03, .side = 480, .plain = true}, "1.2");
}

static void dendrite_at_spacing_08_is_that_of_an_independent_program(void **state) {
  (void)state;
  compare(&(dendrite_case){.h = 0.8, .dt = 0.0133, .side = 480, .plain = true}, "0.8");
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(dendrite_at_spacing_12_is_that_of_an_independent_program),
      cmocka_unit_test(dendrite_at_spacing_08_is_that_of_an_independent_program),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
