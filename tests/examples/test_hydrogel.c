/* SPDX-License-Identifier: MIT
 *
 * Example hydrogel: the strip of strip.yaml curls away from the water, equally on both sides, by Cattaneo's law and by
 * Fick's; the ledger of water closes; Fick's law takes up water sooner. Curvature: that of the parabola through all particles.
 */
#include "example.h"

typedef struct bend {
  double slope, curvature;
} bend;

/* y = a + b x + c x^2/2 by least squares, x from the middle of the strip. */
static bend bend_of(const example *e) {
  cf_particle_view v;
  OK(cf_sim_particles(e->sim, "gel", "position", &v));
  double m[3][4] = {{0}};
  for (int64_t i = 0; i < v.count; ++i) {
    const double x = (double)v.at[0][i] - 1, basis[4] = {1, x, x * x / 2, (double)v.at[1][i]};
    for (int r = 0; r < 3; ++r)
      for (int c = 0; c < 4; ++c) m[r][c] += basis[r] * basis[c];
  }
  for (int p = 0; p < 3; ++p)
    for (int r = 0; r < 3; ++r) {
      const double factor = m[r][p] / m[p][p];
      for (int c = 0; c < 4 && r != p; ++c) m[r][c] -= factor * m[p][c];
    }
  return (bend){m[1][3] / m[1][1], m[2][3] / m[2][2]};
}

static void strip_on_water_curls_upwards(void **state) {
  (void)state;
  const char *const laws[2][2] = {{NULL}, {"diffusion.tau=0", NULL}};
  double uptake[2];
  for (int law = 0; law < 2; ++law) {
    example e = example_open("hydrogel/strip.yaml", laws[law]);
    example_run(&e, 0.2);
    uptake[law] = example_metric(&e, "uptake");
    example_run(&e, 0.7);
    const bend b = bend_of(&e);
    printf("%s: curvature %.3f 1/m at 0.7 s, uptake %.4f kg at 0.2 s\n", law ? "Fick" : "Cattaneo",
           b.curvature, uptake[law]);
    assert_true(b.curvature > 0.3);
    BELOW(fabs(b.slope), 0.02);
    BELOW(fabs(example_metric(&e, "error_water")), 1e-12);
    BELOW(example_metric(&e, "mean_saturation"), 1.1);
    example_close(&e);
  }
  assert_true(uptake[1] > uptake[0]);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(strip_on_water_curls_upwards)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
