/* SPDX-License-Identifier: MIT
 *
 * A crystal in a stream: heat is kept to round-off by explicit and implicit steps, whatever the stream carries and
 * whatever comes in through walls.
 */
#include "scene_run.h"

static const char *const text =
    "cattaneo: 1\nmodel: phase\n"
    "domain:\n  size: [1.92, 1.44]\n  cells: [64, 48]\n  walls: {x-: {value: -0.8}}\n"
    "time: {end: 0.03}\n"
    "diffusion: {k: 1, tau: 1e-4}\n"
    "velocity: [\"3 + y\", -2]\n"
    "phase:\n  anisotropy: {folds: 4, strength: 0.05}\n  tau_1: %s\n"
    "  seeds: [{center: [0.9, 0.7], radius: 0.2}]\n"
    "  noise: {amplitude: 0.05}\n"
    "  carried: %s\n  scheme: %s\n";

static double error_of(const char *tau_1, const char *carried, const char *scheme) {
  char scene[1024];
  scene_run r;
  snprintf(scene, sizeof scene, text, tau_1, carried, scheme);
  scene_open(&r, "stream", scene, 1);
  const double solid = scene_metric(&r, "solid");
  OK(cf_sim_run(r.sim, 0.03, NULL, NULL));
  const double error = scene_metric(&r, "error_heat");
  printf("tau_1 = %s, %s carried, %s: solid %.4f -> %.4f, heat %.1e\n", tau_1, carried, scheme, solid,
         scene_metric(&r, "solid"), error);
  assert_true(scene_metric(&r, "solid") > 1.2 * solid);
  scene_close(&r);
  return fabs(error);
}

static void heat_is_kept_in_a_stream(void **state) {
  (void)state;
  static const char *const memory[] = {"0", "3e-4"}, *const carried[] = {"both", "heat"},
                           *const scheme[] = {"explicit", "implicit"};
  for (int c = 0; c < 8; ++c) BELOW(error_of(memory[c & 1], carried[c >> 1 & 1], scheme[c >> 2]), 1e-12);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(heat_is_kept_in_a_stream)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
