/* SPDX-License-Identifier: MIT
 *
 * A crystal in the air: it reaches the terminal speed of the formula, glides when tilted, comes back to lying flat,
 * keeps its spin about the normal where nothing turns it, rocks where vortices do.
 */
#include <math.h>

#include "physics/flake.h"
#include "testing.h"

static const cf_air air = {.gravity = 9.81, .density = 1.29, .viscosity = 1.72e-5, .flutter = 0};

/* A plate of 3 mm, .03 mm thick, full silhouette. */
static cf_flake plate(const double diameter) {
  cf_flake f = {.diameter = diameter, .area = 0.6 * diameter * diameter};
  f.mass = 917 * f.area * 0.01 * diameter;
  f.inertia[1] = f.mass * f.area / (2 * 3.14159265358979);
  f.inertia[0] = f.inertia[1] / 2;
  cf_flake_settle_speed(&f, &air);
  return f;
}

static void flake_falls_flat_at_its_terminal_speed(void **state) {
  (void)state;
  for (double D = 1e-3; D < 6e-3; D *= 1.7) {
    const cf_flake f = plate(D);
    const double still[3] = {0, 0, 0};
    cf_flake_state s = {.turn = {1, 0, 0, 0}};
    for (int i = 0; i < 300; ++i) cf_flake_step(&f, &air, 0.01 * i, 0.01, still, &s);
    assert_true(fabs(s.v[2] + f.terminal_speed) < 1e-9 * f.terminal_speed);
    /* what Re is defined by, and where crystals are found: .1 to 2 m/s */
    assert_true(fabs(f.reynolds - air.density * D * f.terminal_speed / air.viscosity) < 1e-9 * f.reynolds);
    assert_true(f.terminal_speed > 0.1 && f.terminal_speed < 2.5);
  }
}

/* Locatelli and Hobbs 1974: unrimed dendrites and plates of a few mm fall at a third of a metre to a metre a second. */
static void flake_of_two_milligrams_per_square_centimetre_falls_as_measured(void **state) {
  (void)state;
  cf_flake f = {.diameter = 3e-3, .area = 0.3 * 9e-6, .mass = 5e-8};
  cf_flake_settle_speed(&f, &air);
  assert_true(f.terminal_speed > 0.25 && f.terminal_speed < 0.6);
}

static void flake_tilted_glides_to_its_lower_side_and_comes_to_lie_flat(void **state) {
  (void)state;
  const cf_flake f = plate(2e-3);
  const double still[3] = {0, 0, 0}, up[3] = {0, 0, 1};
  cf_flake_state s = {.turn = {cos(0.25), 0, sin(0.25), 0}, .v = {0, 0, -f.terminal_speed}};
  double n[3];
  cf_flake_turn(s.turn, up, n);
  assert_true(n[0] > 0.4); /* the side towards +x is the lower one */
  for (int i = 0; i < 10; ++i) cf_flake_step(&f, &air, 0, 0.001, still, &s);
  assert_true(s.v[0] > 0.01 * f.terminal_speed);
  for (int i = 0; i < 500; ++i) cf_flake_step(&f, &air, 0, 0.01, still, &s);
  cf_flake_turn(s.turn, up, n);
  assert_true(n[2] > 1 - 1e-6);
  assert_true(fabs(s.v[0]) < 1e-6);
}

static void flake_follows_a_steady_wind(void **state) {
  (void)state;
  const cf_flake f = plate(2e-3);
  const double wind[3] = {1.2, -0.4, 0.1};
  cf_flake_state s = {.turn = {1, 0, 0, 0}};
  for (int i = 0; i < 1000; ++i) cf_flake_step(&f, &air, 0, 0.01, wind, &s);
  assert_true(fabs(s.v[0] - 1.2) < 1e-3 && fabs(s.v[1] + 0.4) < 1e-3);
  assert_true(fabs(s.v[2] - 0.1 + f.terminal_speed) < 1e-3);
}

static void flake_does_not_care_which_way_x_points(void **state) {
  (void)state;
  cf_flake f = plate(3e-3);
  f.offset[0] = 2e-5;
  const double wind[3] = {0.3, 0, 0}, turned[3] = {0, 0.3, 0};
  const double c = cos(0.1), d = sin(0.1), h = sqrt(0.5);
  cf_flake_state a = {.turn = {c, 0, d, 0}, .spin = {1, 2, 3}};
  /* a quarter turn about z before: (h, 0, 0, h) (c, 0, d, 0) */
  cf_flake_state b = {.turn = {h * c, -h * d, h * d, h * c}, .spin = {1, 2, 3}};
  for (int i = 0; i < 20; ++i) {
    cf_flake_step(&f, &air, 0, 0.01, wind, &a);
    cf_flake_step(&f, &air, 0, 0.01, turned, &b);
  }
  assert_true(fabs(b.x[1] - a.x[0]) < 1e-12 && fabs(b.x[0] + a.x[1]) < 1e-12 &&
              fabs(b.x[2] - a.x[2]) < 1e-12);
}

static void flake_large_enough_rocks_and_a_small_one_does_not(void **state) {
  (void)state;
  cf_air rocking = air;
  rocking.flutter = 1;
  for (int large = 0; large < 2; ++large) {
    const cf_flake f = plate(large ? 8e-3 : 1e-3);
    const double still[3] = {0, 0, 0}, up[3] = {0, 0, 1};
    cf_flake_state s = {.turn = {1, 0, 0, 0}};
    double most = 0, n[3];
    for (int i = 0; i < 400; ++i) {
      cf_flake_step(&f, &rocking, 0.005 * i, 0.005, still, &s);
      cf_flake_turn(s.turn, up, n);
      most = fmax(most, acos(fmin(n[2], 1)));
    }
    assert_true(large ? f.reynolds > 200 && most > 0.02 && most < 1.2 : f.reynolds < 100 && most < 1e-6);
  }
}

static void flake_off_its_centre_spirals(void **state) {
  (void)state;
  cf_flake f = plate(4e-3);
  f.offset[0] = 0.02 * f.diameter;
  const double still[3] = {0, 0, 0};
  cf_flake_state s = {.turn = {1, 0, 0, 0}};
  double away = 0;
  for (int i = 0; i < 500; ++i) {
    cf_flake_step(&f, &air, 0, 0.01, still, &s);
    away = fmax(away, hypot(s.x[0], s.x[1]));
  }
  assert_true(away > 0.002);
  assert_true(hypot(s.v[0], s.v[1]) > 0.005 && isfinite(s.spin[2]));
}

/* First order in substeps: half the substep, half the error. */
static void flake_step_length_matters_little(void **state) {
  (void)state;
  cf_flake f = plate(4e-3);
  const double wind[3] = {0.5, 0, 0};
  cf_flake_state end[3];
  for (int fine = 0; fine < 3; ++fine) {
    const int steps = 256 << (2 * fine);
    cf_flake_state s = {.turn = {cos(0.2), sin(0.2), 0, 0}};
    for (int i = 0; i < steps; ++i) cf_flake_step(&f, &air, 0.2 * i / steps, 0.2 / steps, wind, &s);
    end[fine] = s;
  }
  const double coarse = fabs(end[0].x[0] - end[1].x[0]), less = fabs(end[1].x[0] - end[2].x[0]);
  assert_true(coarse < 2e-3 && coarse / less > 3 && coarse / less < 6);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(flake_falls_flat_at_its_terminal_speed),
      cmocka_unit_test(flake_of_two_milligrams_per_square_centimetre_falls_as_measured),
      cmocka_unit_test(flake_tilted_glides_to_its_lower_side_and_comes_to_lie_flat),
      cmocka_unit_test(flake_follows_a_steady_wind),
      cmocka_unit_test(flake_does_not_care_which_way_x_points),
      cmocka_unit_test(flake_large_enough_rocks_and_a_small_one_does_not),
      cmocka_unit_test(flake_off_its_centre_spirals),
      cmocka_unit_test(flake_step_length_matters_little)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
