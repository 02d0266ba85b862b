/* SPDX-License-Identifier: MIT
 *
 * PFHub's benchmark 3 (Karma and Rappel's model, four folds): a quarter of the crystal up to t = 250, where it has not
 * felt the walls yet, against values extrapolated from three grids of an independent program. The isotropic flux is
 * nearer to them on a coarse grid than the usual five-point one, whose values stand in the table as well.
 */
#include "crystal.h"
#include "reference.h"

typedef struct tip_and_solid {
  double tip, solid;
} tip_and_solid;

static tip_and_solid grown(const double h, const double dt) {
  const cf_phase_params q = {.width = 1,
                             .tau_eta = 1,
                             .f_eta = 1,
                             .karma_rappel = true,
                             .coupling = 10 / 0.6267,
                             .latent = 1,
                             .D = 10,
                             .f_t = 1,
                             .star = 1,
                             .anisotropy = {.n = 4, .strength = 0.05},
                             .solver = {1e-6, 100}};
  const int n = (int)(180 / h);
  crystal c;
  double where[3];
  crystal_make(&c, 2, (int[3]){n, n, 1}, h, &q, NULL, false, 1);
  const double corner[3] = {c.g.origin[0], c.g.origin[1], 0};
  CRYSTAL_CELLS(&c, i, j, k, p) {
    const double r = hypot((i + 0.5) * h, (j + 0.5) * h);
    c.y.eta.at[p] = (cf_real)((1 - tanh((r - 8) / sqrt(2))) / 2);
    c.y.T.at[p] = (cf_real)-0.3;
  }
  const int steps = (int)ceil(250 / dt);
  crystal_grow(&c, 250.0 / steps, steps);
  const tip_and_solid found = {cf_phase_tip(c.p, c.y.eta, corner, 0, where),
                               cf_phase_solid(c.p, c.y.eta) / (960.0 * 960)};
  crystal_free(&c);
  return found;
}

static void coarse_dendrite_is_nearer_to_the_limit_than_five_points_make_it(void **state) {
  (void)state;
  table t = table_read("pfhub3_summary.csv");
  const tip_and_solid found = grown(1.2, 0.036);
  const double tip = table_at(&t, 0, "tip_rich"), solid = table_at(&t, 0, "sf_rich");
  print_message("tip %.3f (%.3f), solid %.6f (%.6f)\n", found.tip, tip, found.solid, solid);
  CLOSE(found.tip / tip, 1, 0.06);
  CLOSE(found.solid / solid, 1, 0.03);
  assert_true(fabs(found.tip - tip) < fabs(table_at(&t, 0, "tip_1.2") - tip) / 2);
  table_free(&t);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(coarse_dendrite_is_nearer_to_the_limit_than_five_points_make_it),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
