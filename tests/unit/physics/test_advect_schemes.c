/* SPDX-License-Identifier: MIT
 *
 * The other schemes of advection beside the table of known results: relative L1 errors at 128 cells.
 *
 *                              rotation Gauss   slotted disk   swirl Gauss   swirl disk
 *     WENO5-Z, Runge-Kutta          .0007           .194          .0147         .303      no bounds
 *     traced back, cubic, CFL 2     .0074           .212          .064          .332      no bounds, no mass
 *
 * and what WENO5 promises: sums, constants, Taylor and Green's vortices, fifth order in a uniform flow, the sum
 * balanced with what passes through walls.
 */
#include "advect_shapes.h"

static void weno5_carries_shapes_as_well_as_the_table_says(void **state) {
  (void)state;
  const double g = one_turn(128, 0.45, gauss, CF_ADVECT_WENO5);
  const double d = one_turn(128, 0.45, slotted_share, CF_ADVECT_WENO5);
  const double sg = one_swirl_by(128, 0.45, gauss, 0, CF_ADVECT_WENO5);
  const double sd = one_swirl_by(128, 0.45, slotted_share, 0, CF_ADVECT_WENO5);
  print_message("weno5: rotation %.4f %.3f, swirl %.4f %.3f\n", g, d, sg, sd);
  assert_true(g < 0.0010);
  assert_true(fabs(d - 0.194) < 0.01);
  assert_true(fabs(sg - 0.0147) < 0.002);
  assert_true(fabs(sd - 0.303) < 0.01);
}

static void cubic_tracing_carries_shapes_as_well_as_the_table_says(void **state) {
  (void)state;
  const double g = one_turn(128, 2, gauss, CF_ADVECT_CUBIC);
  const double d = one_turn(128, 2, slotted_share, CF_ADVECT_CUBIC);
  const double sg = one_swirl_by(128, 2, gauss, 0, CF_ADVECT_CUBIC);
  const double sd = one_swirl_by(128, 2, slotted_share, 0, CF_ADVECT_CUBIC);
  print_message("cubic: rotation %.4f %.3f, swirl %.4f %.3f\n", g, d, sg, sd);
  assert_true(fabs(g - 0.0074) < 0.001);
  assert_true(fabs(d - 0.212) < 0.01);
  assert_true(fabs(sg - 0.064) < 0.004);
  assert_true(fabs(sd - 0.332) < 0.01);
}

/* The mean of sin over a cell is sin of its middle times sin(K h/2)/(K h/2): a mode stays a mode. */
static double wave(const double x[3]) { return sin(2 * PI * x[0]) * cos(2 * PI * x[1]); }

static double carried_wave(const int n) {
  const int cells[2] = {n, n};
  scene s;
  scene_open_scheme(&s, 2, cells, walls_all(CF_WALL_PERIODIC), CF_ADVECT_WENO5);
  const cf_box *b = &s.grid.box;
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < n; ++i) {
      s.u.at[0][cf_box_at(b, i, j, 0)] = 1;
      s.u.at[1][cf_box_at(b, i, j, 0)] = (cf_real)-1;
    }
  set_cells(&s, wave);
  OK(cf_advect_set_velocity(s.advect, s.u, &s.walls));
  const int steps = 40 * n; /* so short that the third order in time does not show */
  for (int step = 0; step < steps; ++step) move_cells(&s, 0, 1.0 / steps, NULL);
  const double error = error_against(&s, wave);
  scene_close(&s);
  return error;
}

static void weno5_is_of_fifth_order_in_a_uniform_flow(void **state) {
  (void)state;
  const double coarse = carried_wave(32), fine = carried_wave(64);
  print_message("uniform flow: %.2e %.2e, order %.2f\n", coarse, fine, log2(coarse / fine));
  assert_true(log2(coarse / fine) > 4.7);
}

/* psi = sin x sin y on corners: what it carries along streamlines stays; psi itself at centres is one such. */
static double vortices(const int axis, const int i[3], const double x[3], const void *context) {
  (void)axis, (void)i, (void)context;
  return sin(2 * PI * x[0]) * sin(2 * PI * x[1]) / (2 * PI);
}
static double stream_function(const double x[3]) { return sin(2 * PI * x[0]) * sin(2 * PI * x[1]); }

static double carried_stream(const int n, const cf_advect_scheme scheme) {
  const int cells[2] = {n, n};
  scene s;
  scene_open_scheme(&s, 2, cells, walls_all(CF_WALL_PERIODIC), scheme);
  set_curl(&s, vortices, NULL);
  set_cells(&s, stream_function);
  OK(cf_advect_set_velocity(s.advect, s.u, &s.walls));
  for (int step = 0; step < 2 * n; ++step) move_cells(&s, 0, 0.5 / n, NULL);
  const double error = error_against(&s, stream_function);
  scene_close(&s);
  return error;
}

static void what_is_constant_on_streamlines_stays_in_taylor_green_vortices(void **state) {
  (void)state;
  const double coarse = carried_stream(32, CF_ADVECT_WENO5), fine = carried_stream(64, CF_ADVECT_WENO5);
  const double ppm = carried_stream(64, CF_ADVECT_PPM), cubic = carried_stream(64, CF_ADVECT_CUBIC);
  print_message("vortices: weno5 %.2e %.2e, order %.2f; ppm %.2e, cubic %.2e\n", coarse, fine,
                log2(coarse / fine), ppm, cubic);
  assert_true(log2(coarse / fine) > 1.9);
  assert_true(fine < ppm);
}

static double one(const double x[3]) {
  (void)x;
  return 1;
}

static void weno5_keeps_constants_and_sums_in_any_flow(void **state) {
  (void)state;
  const int cells[2][3] = {{24, 20, 1}, {12, 10, 14}};
  for (int dim = 2; dim <= 3; ++dim)
    for (int closed = 0; closed < 2; ++closed) {
      scene s;
      scene_open_scheme(&s, dim, cells[dim - 2], walls_all(closed ? CF_WALL_INSULATED : CF_WALL_PERIODIC),
                        CF_ADVECT_WENO5);
      cf_cell phi = s.phi, constant;
      OK(cf_cell_create(&constant, &s.grid.box));
      set_cells(&s, gauss);
      s.phi = constant;
      set_cells(&s, one);
      s.phi = phi;
      const double first = range_of(&s).sum;
      for (int step = 0; step < 10; ++step) {
        set_random_flow(&s, 40 + step, closed);
        OK(cf_advect_set_velocity(s.advect, s.u, &s.walls));
        OK(cf_advect_begin(s.advect, 0, step_of(&s, 0.7)));
        OK(cf_advect_cell(s.advect, &s.walls, s.phi, NULL));
        OK(cf_advect_cell(s.advect, &s.walls, constant, NULL));
      }
      assert_true(fabs(range_of(&s).sum / first - 1) < 1e-13);
      s.phi = constant;
      assert_true(error_against(&s, one) < 1e-13);
      s.phi = phi;
      cf_cell_destroy(&constant, &s.grid.box);
      scene_close(&s);
    }
}

static void weno5_tells_what_passed_through_walls(void **state) {
  (void)state;
  const int cells[3] = {16, 12, 10};
  for (int dim = 2; dim <= 3; ++dim) {
    scene s;
    cf_walls walls = walls_all(CF_WALL_OPEN);
    walls.kind[0][0] = walls.kind[1][1] = CF_WALL_VALUE;
    walls.value[0][0] = (cf_fn){.value = 0.7};
    walls.value[1][1] = (cf_fn){.value = -0.4};
    scene_open_scheme(&s, dim, cells, walls, CF_ADVECT_WENO5);
    set_cells(&s, gauss);
    const double volume = cf_grid_volume(&s.grid), first = range_of(&s).sum * volume;
    cf_through through = {0, 0};
    for (int step = 0; step < 8; ++step) {
      set_random_flow(&s, 90 + step, 0);
      OK(cf_advect_set_velocity(s.advect, s.u, &s.walls));
      OK(cf_advect_begin(s.advect, 0, step_of(&s, 0.7)));
      OK(cf_advect_cell(s.advect, &s.walls, s.phi, &through));
    }
    const double inside = range_of(&s).sum * volume;
    assert_true(fabs(through.entered) > 1e-3 && fabs(through.left) > 1e-3);
    assert_true(fabs(inside - first - through.entered + through.left) <
                1e-13 * (fabs(first) + fabs(through.entered) + fabs(through.left)));
    scene_close(&s);
  }
}

/* A row of the field and of its flux, carried alike, for one and several threads. */
static void the_bits_do_not_depend_on_the_threads(void **state) {
  (void)state;
  static const cf_advect_scheme schemes[] = {CF_ADVECT_WENO5, CF_ADVECT_CUBIC};
  const int cells[2] = {128, 130};
  for (int k = 0; k < 2; ++k) {
    cf_cell first = {NULL};
    for (int threads = 1; threads <= 3; ++threads) {
      scene s;
      OK(cf_grid_init(&s.grid, 2, cells, 1.0 / cells[0], NULL));
      s.grid.threads = threads;
      s.walls = walls_all(CF_WALL_INSULATED);
      OK(cf_advect_create(&s.advect, &s.grid, schemes[k]));
      OK(cf_face_create(&s.u, &s.grid.box));
      OK(cf_cell_create(&s.phi, &s.grid.box));
      set_random_flow(&s, 7, 1);
      set_cells(&s, gauss);
      OK(cf_advect_set_velocity(s.advect, s.u, &s.walls));
      OK(cf_advect_begin(s.advect, 0, step_of(&s, 0.7)));
      OK(cf_advect_cell(s.advect, &s.walls, s.phi, NULL));
      const cf_box *b = &s.grid.box;
      if (threads == 1) {
        first = s.phi;
        s.phi = (cf_cell){NULL};
      } else {
        for (ptrdiff_t r = 0; r < cf_box_rows(b); ++r)
          assert_memory_equal(first.at + cf_box_row(b, r), s.phi.at + cf_box_row(b, r),
                              (size_t)b->n[0] * sizeof(cf_real));
      }
      if (threads == 3) cf_cell_destroy(&first, b);
      scene_close(&s);
    }
  }
}

/* A flux in a uniform periodic flow moves like a scalar, to the bit. */
static void components_move_like_scalars_to_the_bit(void **state) {
  (void)state;
  const int cells[3] = {14, 12, 16};
  for (int dim = 2; dim <= 3; ++dim) {
    scene s;
    cf_face q;
    scene_open_scheme(&s, dim, cells, walls_all(CF_WALL_PERIODIC), CF_ADVECT_WENO5);
    const cf_box *b = &s.grid.box;
    const double u[3] = {0.7, -0.4, 0.3};
    OK(cf_face_create(&q, b));
    for (ptrdiff_t r = 0; r < cf_box_rows(b); ++r)
      for (int i = 0; i < b->n[0]; ++i) {
        const ptrdiff_t p = cf_box_row(b, r) + i;
        s.phi.at[p] = (cf_real)noise(p, 1);
        for (int a = 0; a < dim; ++a) q.at[a][p] = s.phi.at[p], s.u.at[a][p] = (cf_real)u[a];
      }
    OK(cf_advect_set_velocity(s.advect, s.u, &s.walls));
    OK(cf_advect_begin(s.advect, 0, step_of(&s, 1.3)));
    OK(cf_advect_cell(s.advect, &s.walls, s.phi, NULL));
    OK(cf_advect_face(s.advect, &s.walls, CF_RATE_CONSERVATIVE, q));
    for (ptrdiff_t r = 0; r < cf_box_rows(b); ++r)
      for (int a = 0; a < dim; ++a)
        assert_memory_equal(q.at[a] + cf_box_row(b, r), s.phi.at + cf_box_row(b, r),
                            (size_t)b->n[0] * sizeof(cf_real));
    cf_face_destroy(&q, b);
    scene_close(&s);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(weno5_carries_shapes_as_well_as_the_table_says),
      cmocka_unit_test(cubic_tracing_carries_shapes_as_well_as_the_table_says),
      cmocka_unit_test(weno5_is_of_fifth_order_in_a_uniform_flow),
      cmocka_unit_test(what_is_constant_on_streamlines_stays_in_taylor_green_vortices),
      cmocka_unit_test(weno5_keeps_constants_and_sums_in_any_flow),
      cmocka_unit_test(weno5_tells_what_passed_through_walls),
      cmocka_unit_test(the_bits_do_not_depend_on_the_threads),
      cmocka_unit_test(components_move_like_scalars_to_the_bit),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
