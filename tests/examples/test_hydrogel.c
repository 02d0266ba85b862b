/* SPDX-License-Identifier: MIT
 *
 * Example hydrogel. The strip of strip.yaml curls away from the water, equally on both sides, by Cattaneo's law and by
 * Fick's; the ledger of water closes; Fick's law takes up water sooner. Curvature: that of the parabola through all particles.
 * The slab of scene.yaml is wet no deeper than the front, and keeps its momenta.
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
    const double x = (double)v.at[0][i] - 0.75, basis[4] = {1, x, x * x / 2, (double)v.at[1][i]};
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
    example_run(&e, 0.15);
    uptake[law] = example_metric(&e, "uptake");
    example_run(&e, 0.5);
    const bend b = bend_of(&e);
    printf("%s: curvature %.3f 1/m at 0.5 s, uptake %.4f kg at 0.15 s\n", law ? "Fick" : "Cattaneo",
           b.curvature, uptake[law]);
    assert_true(b.curvature > 0.7);
    BELOW(fabs(b.slope), 0.02);
    CLOSE(example_metric(&e, "curvature"), b.curvature, 0.02 * b.curvature);
    BELOW(fabs(example_metric(&e, "error_water")), 1e-12);
    BELOW(example_metric(&e, "mean_saturation"), 1.1);
    example_close(&e);
  }
  assert_true(uptake[1] > uptake[0]);
}

/* The slab of scene.yaml as it begins: what it takes up through its rim, kept to round-off with its momentum. What came
 * in reaches no deeper than the front of Cattaneo's law and the layer that was in the bath. */
static void slab_is_wet_from_its_rim_no_deeper_than_the_front(void **state) {
  (void)state;
  example e = example_open("hydrogel/scene.yaml", NULL);
  const double t = 0.06, speed = sqrt(0.1 / 0.5), rim = 0.45, h = 0.02;
  example_run(&e, t);
  BELOW(fabs(example_metric(&e, "error_water")), 1e-12);
  assert_true(example_metric(&e, "uptake") > 0);
  const double pace = sqrt(example_metric(&e, "kinetic"));
  const char *const names[] = {"momentum_x", "momentum_y", "momentum_z",
                               "angular_x",  "angular_y",  "angular_z"};
  for (int i = 0; i < 6; ++i) BELOW(fabs(example_metric(&e, names[i])), 1e-12 * pace);
  cf_particle_view place, water;
  OK(cf_sim_particles(e.sim, "gel", "position", &place));
  OK(cf_sim_particles(e.sim, "gel", "water", &water));
  double inside = 0, all = 0;
  for (int64_t i = 0; i < place.count; ++i) {
    const double r = hypot((double)place.at[0][i] - 0.96, (double)place.at[1][i] - 0.96);
    all += (double)water.at[0][i];
    if (r < rim - speed * t - 3 * h) inside += (double)water.at[0][i];
  }
  printf("beyond the front: %.3g of the water\n", inside / all);
  BELOW(inside, 5e-3 * all);
  example_close(&e);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(strip_on_water_curls_upwards),
                                     cmocka_unit_test(slab_is_wet_from_its_rim_no_deeper_than_the_front)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
