/* SPDX-License-Identifier: MIT
 *
 * PFHub's benchmark 3 (Karma and Rappel's model, four folds): a quarter of the crystal up to t = 250, where it has not
 * felt the walls yet. With five-point differences and Euler's steps it is, cell by cell, what an independent program
 * finds at the same spacing; the isotropic flux is nearer to the limit that three grids of that program extrapolate to.
 */
#include "pfhub3.h"

/* Benchmarks have their own numbers at every spacing, and these are of the same scheme: .1 %, where 2 % would do. */
static void five_points_give_the_numbers_of_an_independent_program_at_the_same_spacing(void **state) {
  (void)state;
  table t = table_read("pfhub3_summary.csv");
  const dendrite found =
      dendrite_grown(&(dendrite_case){.h = 1.2, .dt = 0.03, .end = 250, .side = 180, .plain = true});
  dendrite_print(&found);
  CLOSE(found.tip / table_at(&t, 0, "tip_1.2"), 1, 1e-3);
  CLOSE(found.solid / table_at(&t, 0, "sf_1.2"), 1, 1e-3);
  CLOSE((DENDRITE_ENERGY - found.energy) / (DENDRITE_ENERGY - table_at(&t, 0, "F_1.2")), 1, 2e-3);
  table_free(&t);
}

static void coarse_dendrite_is_nearer_to_the_limit_than_five_points_make_it(void **state) {
  (void)state;
  table t = table_read("pfhub3_summary.csv");
  const dendrite found = dendrite_grown(&(dendrite_case){.h = 1.2, .dt = 0.036, .end = 250, .side = 180});
  const double tip = table_at(&t, 0, "tip_rich"), solid = table_at(&t, 0, "sf_rich");
  dendrite_print(&found);
  CLOSE(found.tip / tip, 1, 0.06);
  CLOSE(found.solid / solid, 1, 0.03);
  assert_true(fabs(found.tip - tip) < fabs(table_at(&t, 0, "tip_1.2") - tip) / 2);
  table_free(&t);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(five_points_give_the_numbers_of_an_independent_program_at_the_same_spacing),
      cmocka_unit_test(coarse_dendrite_is_nearer_to_the_limit_than_five_points_make_it),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
