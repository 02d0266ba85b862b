/* SPDX-License-Identifier: MIT
 *
 * examples/snowfall: what falls, drifts and lies is what the scene says; all mass is accounted for; flakes flutter, so
 * that their faces are seen; those that lie do so flat, on the layer.
 */
#include "example.h"

/* How much of a flake's normal is vertical, from its quaternion (w, x, y, z). */
static double upright(const cf_particle_view *turn, const int64_t i) {
  const double x = (double)turn->at[1][i], y = (double)turn->at[2][i];
  return fabs(1 - 2 * (x * x + y * y));
}

static void flakes_fall_flutter_and_drift(const example *e) {
  cf_particle_view v, turn;
  double drift = 0, fall = 0, tilted = 0;
  OK(cf_sim_particles(e->sim, "flakes", "velocity", &v));
  OK(cf_sim_particles(e->sim, "flakes", "orientation", &turn));
  assert_true(v.count == 12000);
  for (int64_t i = 0; i < v.count; ++i) {
    drift += (double)v.at[0][i] / (double)v.count;
    fall -= (double)v.at[2][i] / (double)v.count;
    tilted += (upright(&turn, i) < cos(0.35) ? 1.0 : 0.0) / (double)v.count;
  }
  printf("mean drift %.3f m/s, fall %.3f m/s; %.0f %% tilted by more than 20 degrees\n", drift, fall,
         100 * tilted);
  CLOSE(drift, 0.25, 0.06); /* the wind is slower near the ground */
  assert_true(fall > 0.15 && fall < 0.56);
  assert_true(tilted > 0.25 && tilted < 0.9);
}

static void those_that_lie_do_so_on_the_layer(const example *e) {
  cf_particle_view x, turn;
  const double depth = example_metric(e, "max_depth");
  double flat = 0;
  OK(cf_sim_particles(e->sim, "settled", "position", &x));
  OK(cf_sim_particles(e->sim, "settled", "orientation", &turn));
  assert_true(x.count > 500);
  for (int64_t i = 0; i < x.count; ++i) {
    assert_true((double)x.at[2][i] >= 0 && (double)x.at[2][i] <= depth);
    flat += upright(&turn, i) / (double)x.count;
  }
  assert_true(flat > 0.9);
  assert_true(example_metric(e, "mean_depth") > 1e-3 && depth < 4 * example_metric(e, "mean_depth"));
}

static void snow_falls_as_its_scene_says(void **state) {
  (void)state;
  example e = example_open("snowfall/scene.yaml", NULL);
  example_run(&e, 0.3);
  flakes_fall_flutter_and_drift(&e);
  those_that_lie_do_so_on_the_layer(&e);
  BELOW(fabs(example_metric(&e, "error_snow")), 1e-13);
  example_close(&e);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(snow_falls_as_its_scene_says)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
