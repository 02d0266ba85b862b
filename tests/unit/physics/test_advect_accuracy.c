/* SPDX-License-Identifier: MIT
 *
 * How well advection carries shapes about: one turn of a rigid rotation, one period of a swirl that deforms and
 * undoes itself (LeVeque 1996), and the order of the error on smooth fields. In the tables of known results, at
 * 128 cells and a Courant number of 0.45, the relative L1 errors of this scheme are .0105 (Gauss) and .173
 * (slotted disk, Zalesak 1979) for the rotation and .063 (Gauss) and .299 (slotted disk) for the swirl; at .9 the
 * rotation has .0074 and .160. Tracing back with linear interpolation has .880 and .415 (at 2) for the Gauss.
 */
#include "advect_shapes.h"

static void advect_turns_shapes_as_well_as_the_table_says(void **state) {
  (void)state;
  const double g = one_turn(128, 0.45, gauss, CF_ADVECT_PPM), g9 = one_turn(128, 0.9, gauss, CF_ADVECT_PPM);
  const double d = one_turn(128, 0.45, slotted_share, CF_ADVECT_PPM),
               d9 = one_turn(128, 0.9, slotted_share, CF_ADVECT_PPM);
  print_message("rotation at .45 / .9: gauss %.4f / %.4f, slotted disk %.3f / %.3f\n", g, g9, d, d9);
  assert_true(fabs(g - 0.0105) < 0.001 && fabs(g9 - 0.0074) < 0.001);
  assert_true(fabs(d - 0.173) < 0.004 && fabs(d9 - 0.160) < 0.004);
}

static void advect_swirls_shapes_as_well_as_the_table_says(void **state) {
  (void)state;
  const double g = one_swirl(128, 0.45, gauss, 0), d = one_swirl(128, 0.45, slotted_share, 0);
  print_message("swirl at .45: gauss %.4f, slotted disk %.3f\n", g, d);
  assert_true(fabs(g - 0.063) < 0.002);
  assert_true(fabs(d - 0.299) < 0.004);
}

static void linear_tracing_smears_as_the_paper_does(void **state) {
  (void)state;
  const double slow = one_turn(128, 0.45, gauss, CF_ADVECT_LINEAR),
               fast = one_turn(128, 2, gauss, CF_ADVECT_LINEAR);
  print_message("traced rotation at .45 / 2: gauss %.3f / %.3f\n", slow, fast);
  assert_true(fabs(slow - 0.880) < 0.03);
  assert_true(fabs(fast - 0.415) < 0.03);
}

static double smooth(const double x[3]) {
  const double c = cos(PI * x[0]) * cos(PI * x[1]);
  return 1 + 0.5 * c + 0.3 * sin(PI * x[0]) * sin(PI * x[0]) * x[1];
}

static void advect_is_second_order_because_the_axes_take_turns(void **state) {
  (void)state;
  const double e32 = one_swirl(32, 0.45, smooth, 0), e64 = one_swirl(64, 0.45, smooth, 0),
               e128 = one_swirl(128, 0.45, smooth, 0);
  const double f64 = one_swirl(64, 0.45, smooth, 1), f128 = one_swirl(128, 0.45, smooth, 1);
  print_message("smooth swirl: %.2e %.2e %.2e, orders %.2f %.2f; fixed axes %.2e %.2e, order %.2f\n", e32,
                e64, e128, log2(e32 / e64), log2(e64 / e128), f64, f128, log2(f64 / f128));
  assert_true(log2(e64 / e128) > 2);
  assert_true(log2(f64 / f128) < 1.3);
  assert_true(f128 > 5 * e128);
}

/* A flow that turns in all three planes, carried there and back. */
static double swirl_3d(const int axis, const int i[3], const double x[3], const void *context) {
  (void)i, (void)context;
  const double sx = sin(PI * x[0]), sy = sin(PI * x[1]), sz = sin(PI * x[2]);
  const double part[3] = {sy * sy * sz * sz * sin(2 * PI * x[0] + 1), 0.7 * sx * sx * sz * sz,
                          sx * sx * sy * sy};
  return 0.3 * part[axis];
}

static double smooth_3d(const double x[3]) {
  return 1 + 0.5 * cos(PI * x[0]) * cos(PI * x[1]) * cos(PI * x[2]);
}

static double one_swirl_3d(const int n) {
  const int cells[3] = {n, n, n};
  scene s;
  scene_open(&s, 3, cells, walls_all(CF_WALL_INSULATED));
  cf_face full;
  take_flow(&s, &full, swirl_3d);
  set_cells(&s, smooth_3d);
  const int steps = n * 2;
  for (int step = 0; step < steps; ++step) {
    set_phase(&s, full, step, steps);
    move_cells(&s, 0, 1.0 / steps, NULL);
  }
  const double error = error_against(&s, smooth_3d);
  cf_face_destroy(&full, &s.grid.box);
  scene_close(&s);
  return error;
}

static void advect_is_second_order_in_space_of_three_dimensions(void **state) {
  (void)state;
  const double coarse = one_swirl_3d(24), fine = one_swirl_3d(48);
  print_message("smooth swirl in 3D: %.2e %.2e, order %.2f\n", coarse, fine, log2(coarse / fine));
  assert_true(log2(coarse / fine) > 1.9);
}

static void advect_carries_shapes_along_a_uniform_flow(void **state) {
  (void)state;
  const int cells[2] = {64, 64};
  scene s;
  scene_open(&s, 2, cells, walls_all(CF_WALL_PERIODIC));
  const cf_box *b = &s.grid.box;
  for (int j = 0; j < 64; ++j)
    for (int i = 0; i < 64; ++i) {
      s.u.at[0][cf_box_at(b, i, j, 0)] = 1;
      s.u.at[1][cf_box_at(b, i, j, 0)] = (cf_real)-0.5;
    }
  set_cells(&s, gauss);
  OK(cf_advect_set_velocity(s.advect, s.u, &s.walls));
  assert_true(fabs(cf_advect_rate(s.advect) - 64) < 1e-9);
  for (int step = 0; step < 256; ++step) move_cells(&s, 0, 2.0 / 256, NULL);
  const double error = error_against(&s, gauss);
  print_message("carried twice through the box: %.4f\n", error);
  assert_true(error < 0.11);
  scene_close(&s);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(advect_turns_shapes_as_well_as_the_table_says),
      cmocka_unit_test(advect_swirls_shapes_as_well_as_the_table_says),
      cmocka_unit_test(linear_tracing_smears_as_the_paper_does),
      cmocka_unit_test(advect_is_second_order_because_the_axes_take_turns),
      cmocka_unit_test(advect_is_second_order_in_space_of_three_dimensions),
      cmocka_unit_test(advect_carries_shapes_along_a_uniform_flow),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
