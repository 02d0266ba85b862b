/* SPDX-License-Identifier: MIT
 *
 * examples/snowflake, with its own numbers: six arms along the crystal's axes whatever their angle to the grid, and not
 * the grid's four; heat given off as ice freezes; and energy that never rises where there is only the phase.
 */
#include "outline.h"

static void six_arms_grow_along_the_axes_of_the_crystal(void **state) {
  (void)state;
  static const char *const angles[2] = {"phase.anisotropy.angle=0", "phase.anisotropy.angle=15"};
  double six[2], phase[2];
  for (int i = 0; i < 2; ++i) {
    example e = example_open("snowflake/scene.yaml", (const char *const[]){angles[i], NULL});
    example_run(&e, 0.1);
    const double four = outline_harmonic(&e, 4, NULL);
    six[i] = outline_harmonic(&e, 6, &phase[i]);
    print_message("six folds %.3f at %.2f degrees, four folds %.4f, heat %.1e\n", six[i], phase[i], four,
                  example_metric(&e, "error_heat"));
    BELOW(four, 0.03);
    BELOW(fabs(example_metric(&e, "error_heat")), 1e-12);
    example_close(&e);
  }
  assert_true(six[0] > 0.2);
  CLOSE(six[1] / six[0], 1, 0.06);
  CLOSE(phase[0], 0, 0.5);
  CLOSE(phase[1], 15, 0.5);
}

static void energy_never_rises_where_heat_stands_still(void **state) {
  (void)state;
  example e = example_open("snowflake/scene.yaml",
                           (const char *const[]){"phase.latent=0", "phase.anisotropy.law=none",
                                                 "phase.noise.amplitude=0", "diffusion.k=0", NULL});
  double before = example_metric(&e, "energy");
  for (int s = 0; s < 150; ++s) {
    OK(cf_sim_step(e.sim, NULL));
    const double now = example_metric(&e, "energy");
    BELOW(now, before + 1e-12 * fabs(before));
    before = now;
  }
  example_close(&e);
}

/* What `symmetric: 6` noise begins is the same on both sides of an arm and on all arms. */
static void flake_is_like_its_mirror_images(void **state) {
  (void)state;
  example e = example_open("snowflake/scene.yaml", NULL);
  example_run(&e, 0.1);
  const cf_view v = example_field(&e, "eta", 0);
  double unlike = 0, ice = 0;
  for (int j = 0; j < v.shape[1]; ++j)
    for (int i = 0; i < v.shape[0]; ++i) {
      const double here = view_at(&v, i, j, 0);
      unlike += fabs(here - view_at(&v, v.shape[0] - 1 - i, j, 0));
      unlike += fabs(here - view_at(&v, i, v.shape[1] - 1 - j, 0));
      ice += here;
    }
  print_message("unlike its mirror images: %.1e of its ice\n", unlike / ice);
  BELOW(unlike / ice, 1e-6);
  example_close(&e);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(six_arms_grow_along_the_axes_of_the_crystal),
      cmocka_unit_test(energy_never_rises_where_heat_stands_still),
      cmocka_unit_test(flake_is_like_its_mirror_images),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
