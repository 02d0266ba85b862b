/* SPDX-License-Identifier: MIT
 *
 * examples/dendrite, with its own numbers: how fast a flat front runs, and that four arms grow along the crystal's axes
 * whatever their angle to the grid, and give off as much heat as they freeze.
 */
#include "outline.h"

/* A strip of the scene's cells, solid at its left end, with T left at -1 (no latent heat). */
#define STRIP                                                                         \
  "domain={size: [6, 0.12], cells: [300, 6], origin: [-3, -0.06]}", "phase.latent=0", \
      "phase.noise.amplitude=0", "phase.seeds=[{shape: box, center: [-3, 0], half: [1, 1]}]"

static double speed_in(const char *const *set) {
  example e = example_open("dendrite/scene.yaml", set);
  example_run(&e, 0.06);
  const double first = example_metric(&e, "tip_x");
  example_run(&e, 0.16);
  const double last = example_metric(&e, "tip_x");
  example_close(&e);
  return (last - first) / 0.1;
}

static void flat_front_runs_at_its_speed(void **state) {
  (void)state;
  const double psi = 0.9 / acos(-1) * atan(10), unit = 0.01 / 3e-4;
  const double stable = speed_in((const char *const[]){STRIP, NULL});
  CLOSE(stable / (unit * sqrt(2) * psi / sqrt(1 + 2 * psi * psi)), 1, 0.03);
  table t = table_read("front_speed.csv");
  for (int r = 0; r < t.rows; ++r) {
    char gamma[64];
    if (table_at(&t, r, "psi") != 0.4 || table_at(&t, r, "theta") != 1) continue;
    snprintf(gamma, sizeof gamma, "phase.gamma=%.17g", tan(0.4 * acos(-1) / 0.9));
    const double paper = speed_in((const char *const[]){STRIP, "phase.form=paper", gamma, NULL});
    CLOSE(paper / (unit * table_at(&t, r, "v_exact")), 1, 0.03);
    print_message("stable form %.2f m/s, paper's %.2f\n", stable, paper);
  }
  table_free(&t);
}

/* Without noise: that of a turned crystal is read between the places of its lattice, and weaker. */
static void four_arms_grow_along_the_axes_of_the_crystal(void **state) {
  (void)state;
  static const char *const angles[2] = {"phase.anisotropy.angle=0", "phase.anisotropy.angle=15"};
  double four[2], phase[2];
  for (int i = 0; i < 2; ++i) {
    example e = example_open("dendrite/scene.yaml",
                             (const char *const[]){angles[i], "phase.noise.amplitude=0", NULL});
    example_run(&e, 0.06);
    four[i] = outline_harmonic(&e, 4, &phase[i]);
    print_message("four folds %.3f at %.2f degrees, heat %.1e\n", four[i], phase[i],
                  example_metric(&e, "error_heat"));
    BELOW(fabs(example_metric(&e, "error_heat")), 1e-12);
    example_close(&e);
  }
  assert_true(four[0] > 0.1);
  CLOSE(four[1] / four[0], 1, 0.1);
  CLOSE(phase[0], 0, 0.5);
  CLOSE(phase[1], 15, 1);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(flat_front_runs_at_its_speed),
      cmocka_unit_test(four_arms_grow_along_the_axes_of_the_crystal),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
