/* SPDX-License-Identifier: MIT
 *
 * What advection promises for one step: constants, sums, bounds, linearity, walls.
 */
/* also in single precision */
#include "advect_flows.h"

#define EPS ((double)CF_REAL_EPSILON)

static const int flat[3] = {48, 40, 1}, solid[3] = {20, 18, 16};

static double one(const double x[3]) {
  (void)x;
  return 0.7;
}

static void set_noise(scene *s, const int64_t stream, const int bits) {
  const cf_box *b = &s->grid.box;
  for (int k = 0; k < b->n[2]; ++k)
    for (int j = 0; j < b->n[1]; ++j)
      for (int i = 0; i < b->n[0]; ++i) {
        const double v = noise((k * 1009 + j) * 1009 + i, stream);
        s->phi.at[cf_box_at(b, i, j, k)] = (cf_real)(bits ? (v < 0.5 ? 0 : 1) : v);
      }
}

static void constants_stay(const int dim, const int *cells, const cf_wall kind) {
  scene s;
  scene_open(&s, dim, cells, walls_all(kind));
  set_cells(&s, one);
  for (int step = 0; step < 20; ++step) {
    set_random_flow(&s, step, kind == CF_WALL_INSULATED);
    OK(cf_advect_set_velocity(s.advect, s.u, &s.walls));
    move_cells(&s, 0, step_of(&s, 0.9), NULL);
  }
  const cf_range r = range_of(&s);
  assert_true(fabs(r.min - 0.7) < 40 * EPS);
  assert_true(fabs(r.max - 0.7) < 40 * EPS);
  scene_close(&s);
}

static void advect_keeps_constants(void **state) {
  (void)state;
  constants_stay(2, flat, CF_WALL_PERIODIC);
  constants_stay(2, flat, CF_WALL_INSULATED);
  constants_stay(3, solid, CF_WALL_PERIODIC);
  constants_stay(3, solid, CF_WALL_INSULATED);
}

static void bounds_hold(const int dim, const int *cells, const cf_wall kind, const double k) {
  scene s;
  scene_open(&s, dim, cells, walls_all(kind));
  for (int step = 0; step < 40; ++step) {
    set_random_flow(&s, 100 + step, kind == CF_WALL_INSULATED);
    if (step % 8 == 0) set_noise(&s, step, 1);
    const double before = range_of(&s).sum;
    OK(cf_advect_set_velocity(s.advect, s.u, &s.walls));
    move_cells(&s, 0, step_of(&s, k), NULL);
    const cf_range r = range_of(&s);
    assert_true(r.min > -8 * EPS);
    assert_true(r.max < 1 + 8 * EPS);
    if (kind != CF_WALL_OPEN) assert_true(fabs(r.sum - before) < 4 * EPS * before);
  }
  scene_close(&s);
}

static void advect_keeps_bounds_and_the_sum_of_random_bits(void **state) {
  (void)state;
  const double ks[3] = {0.25, 0.5, 0.9};
  for (int i = 0; i < 3; ++i) {
    bounds_hold(2, flat, CF_WALL_PERIODIC, ks[i]);
    bounds_hold(2, flat, CF_WALL_INSULATED, ks[i]);
    bounds_hold(2, flat, CF_WALL_OPEN, ks[i]);
    bounds_hold(3, solid, CF_WALL_PERIODIC, ks[i]);
    bounds_hold(3, solid, CF_WALL_INSULATED, ks[i]);
    bounds_hold(3, solid, CF_WALL_OPEN, ks[i]);
  }
}

static void advect_divides_long_steps(void **state) {
  (void)state;
  bounds_hold(2, flat, CF_WALL_PERIODIC, 3.3);
  scene s;
  scene_open(&s, 2, flat, walls_all(CF_WALL_PERIODIC));
  set_random_flow(&s, 1, 0);
  OK(cf_advect_set_velocity(s.advect, s.u, &s.walls));
  assert_true(cf_advect_substeps(s.advect, step_of(&s, 0.899)) == 1);
  assert_true(cf_advect_substeps(s.advect, step_of(&s, 0.91)) == 2);
  OK(cf_advect_begin(s.advect, 0, step_of(&s, 2.5)));
  assert_int_equal(*cf_advect_parity(s.advect), 3);
  assert_int_equal(cf_advect_begin(s.advect, 0, step_of(&s, 1e7)), CF_OVER_LIMIT);
  assert_int_equal(cf_advect_begin(s.advect, 0, -1), CF_BAD_ARGUMENT);
  assert_int_equal(cf_advect_begin(s.advect, 0, NAN), CF_BAD_ARGUMENT);
  scene_close(&s);
}

static void linear(const int dim, const int *cells) {
  scene s;
  cf_cell f;
  scene_open(&s, dim, cells, walls_all(CF_WALL_PERIODIC));
  const cf_box *b = &s.grid.box;
  OK(cf_cell_create(&f, b));
  set_random_flow(&s, 7, 0);
  OK(cf_advect_set_velocity(s.advect, s.u, &s.walls));
  set_noise(&s, 3, 0);
  const cf_real a = (cf_real)-2.5, c = (cf_real)0.375;
  for (ptrdiff_t r = 0; r < cf_box_rows(b); ++r)
    for (int i = 0; i < b->n[0]; ++i) f.at[cf_box_row(b, r) + i] = a * s.phi.at[cf_box_row(b, r) + i] + c;
  OK(cf_advect_begin(s.advect, 0, step_of(&s, 0.9)));
  OK(cf_advect_cell(s.advect, &s.walls, s.phi, NULL));
  OK(cf_advect_cell(s.advect, &s.walls, f, NULL));
  for (ptrdiff_t r = 0; r < cf_box_rows(b); ++r)
    for (int i = 0; i < b->n[0]; ++i) {
      const ptrdiff_t p = cf_box_row(b, r) + i;
      assert_true(fabs((double)(f.at[p] - (a * s.phi.at[p] + c))) < 40 * EPS);
    }
  cf_cell_destroy(&f, b);
  scene_close(&s);
}

static void advect_is_linear_in_a_f_plus_b(void **state) {
  (void)state;
  linear(2, flat);
  linear(3, solid);
}

static void through_walls(const int dim, const int *cells, const cf_wall kind) {
  scene s;
  scene_open(&s, dim, cells, walls_all(kind));
  for (int a = 0; a < 3; ++a)
    for (int side = 0; side < 2; ++side) s.walls.value[a][side] = cf_fn_constant(0.5 + 0.1 * a + 0.05 * side);
  set_noise(&s, 5, 1);
  const double first = range_of(&s).sum * cf_grid_volume(&s.grid);
  cf_through through = {0, 0};
  for (int step = 0; step < 30; ++step) {
    set_random_flow(&s, 200 + step, 0);
    OK(cf_advect_set_velocity(s.advect, s.u, &s.walls));
    move_cells(&s, 0, step_of(&s, 1.7), &through);
  }
  const double last = range_of(&s).sum * cf_grid_volume(&s.grid);
  assert_true(through.left > 0.1 * first);
  assert_true(kind == CF_WALL_OPEN ? through.entered == 0 : through.entered > 0.1 * first);
  const double all = fabs(first) + through.entered + through.left;
  assert_true(fabs(last + through.left - through.entered - first) < 50 * EPS * all);
  const cf_range r = range_of(&s);
  assert_true(r.min > -8 * EPS && r.max < 1 + 8 * EPS);
  scene_close(&s);
}

static void advect_balances_what_passes_through_walls(void **state) {
  (void)state;
  through_walls(2, flat, CF_WALL_OPEN);
  through_walls(2, flat, CF_WALL_VALUE);
  through_walls(3, solid, CF_WALL_OPEN);
  through_walls(3, solid, CF_WALL_VALUE);
  through_walls(3, solid, CF_WALL_RADIATE);
}

/* A second field, other walls and other values: moved beside phi, and by itself. */
static void together(const int dim, const int *cells, const cf_advect_scheme scheme) {
  scene s[2];
  cf_cell other[2];
  cf_through passed[2][2] = {{{0, 0}, {0, 0}}, {{0, 0}, {0, 0}}};
  cf_walls walls = walls_all(CF_WALL_VALUE);
  for (int a = 0; a < 3; ++a) walls.value[a][0] = walls.value[a][1] = cf_fn_constant(0.3 + a);
  for (int way = 0; way < 2; ++way) {
    scene_open_scheme(&s[way], dim, cells, walls_all(CF_WALL_OPEN), scheme);
    OK(cf_cell_create(&other[way], &s[way].grid.box));
    set_random_flow(&s[way], 11, 0);
    OK(cf_advect_set_velocity(s[way].advect, s[way].u, &s[way].walls));
    const cf_cell phi = s[way].phi;
    s[way].phi = other[way];
    set_noise(&s[way], 6, 0);
    s[way].phi = phi;
    set_noise(&s[way], 5, 0);
    OK(cf_advect_begin(s[way].advect, 0, step_of(&s[way], 1.7)));
    const cf_carried both[2] = {{&s[way].walls, s[way].phi, &passed[way][0]},
                                {&walls, other[way], &passed[way][1]}};
    if (way == 0) OK(cf_advect_cells(s[way].advect, both, 2));
    for (int f = 0; f < 2 && way == 1; ++f) OK(cf_advect_cells(s[way].advect, &both[f], 1));
  }
  const cf_box *b = &s[0].grid.box;
  const size_t row = (size_t)b->n[0] * sizeof(cf_real);
  for (ptrdiff_t r = 0; r < cf_box_rows(b); ++r) {
    assert_memory_equal(s[0].phi.at + cf_box_row(b, r), s[1].phi.at + cf_box_row(b, r), row);
    assert_memory_equal(other[0].at + cf_box_row(b, r), other[1].at + cf_box_row(b, r), row);
  }
  assert_memory_equal(passed[0], passed[1], sizeof passed[0]);
  for (int way = 0; way < 2; ++way) {
    cf_cell_destroy(&other[way], b);
    scene_close(&s[way]);
  }
}

static void two_fields_together_move_as_each_alone(void **state) {
  (void)state;
  static const cf_advect_scheme schemes[] = {CF_ADVECT_PPM, CF_ADVECT_WENO5, CF_ADVECT_LINEAR,
                                             CF_ADVECT_CUBIC};
  for (int i = 0; i < 4; ++i) {
    together(2, flat, schemes[i]);
    together(3, solid, schemes[i]);
  }
}

/* A velocity that varies across its own axis only, along the axes whose bit is in `moving`; elsewhere `rest`. */
static void move_along(scene *s, const int moving, const double rest, cf_through *through) {
  const cf_box *b = &s->grid.box;
  for (int a = 0; a < b->dim; ++a)
    for (int k = 0; k < cf_box_extent(b, 2, a); ++k)
      for (int j = 0; j < cf_box_extent(b, 1, a); ++j)
        for (int i = 0; i < cf_box_extent(b, 0, a); ++i) {
          const int at[3] = {i, j, k};
          const double v = noise(at[(a + 1) % b->dim], 20 + a) - 0.5;
          s->u.at[a][cf_box_at(b, i, j, k)] = (cf_real)((moving & (1 << a)) != 0 ? v : rest);
        }
  OK(cf_advect_set_velocity(s->advect, s->u, &s->walls));
  set_noise(s, 6, 0);
  for (int step = 0; step < 3; ++step) move_cells(s, 0, 0.7 * s->grid.h, through);
}

/* 1e-30 m/s carries nothing anywhere, but is not 0. */
static void still(const int dim, const int *cells, const int moving, const cf_wall kind) {
  scene s[2];
  cf_through through[2] = {{0, 0}, {0, 0}};
  for (int way = 0; way < 2; ++way) {
    scene_open(&s[way], dim, cells, walls_all(kind));
    move_along(&s[way], moving, way == 0 ? 0 : 1e-30, &through[way]);
  }
  const cf_box *b = &s[0].grid.box;
  for (ptrdiff_t r = 0; r < cf_box_rows(b); ++r)
    for (int i = 0; i < b->n[0]; ++i) {
      const ptrdiff_t p = cf_box_row(b, r) + i;
      assert_true(fabs((double)(s[0].phi.at[p] - s[1].phi.at[p])) < 8 * EPS);
    }
  assert_true(fabs(through[0].left - through[1].left) <= 8 * EPS * through[1].left + 1e-20);
  for (int way = 0; way < 2; ++way) scene_close(&s[way]);
}

static void advect_leaves_out_axes_along_which_nothing_moves(void **state) {
  (void)state;
  for (int moving = 0; moving < 8; ++moving) {
    still(3, solid, moving, CF_WALL_OPEN);
    still(3, solid, moving, CF_WALL_PERIODIC);
    if (moving < 4) still(2, flat, moving, CF_WALL_OPEN);
  }
}

static void wave(const void *context, const int n, const double *x, const double *y, const double *z,
                 const double t, double *out) {
  (void)context, (void)x, (void)z;
  for (int i = 0; i < n; ++i) out[i] = 2 + sin(6 * t) + y[i];
}

static double incoming(const double x[3]) { return 2 + sin(6 * (0.8 - x[0])) + x[1]; }

/* With u = (1, 0) what stands at x at t = 0.8 came in at t - x. */
static double inflow_error(const int n) {
  const int cells[2] = {n, n};
  scene s;
  scene_open(&s, 2, cells, walls_all(CF_WALL_INSULATED));
  s.walls.kind[0][0] = CF_WALL_VALUE;
  s.walls.value[0][0] = (cf_fn){.eval = wave, .in_time = true};
  s.walls.kind[0][1] = CF_WALL_OPEN;
  const cf_box *b = &s.grid.box;
  for (int j = 0; j < n; ++j)
    for (int i = 0; i <= n; ++i) s.u.at[0][cf_box_at(b, i, j, 0)] = 1;
  set_cells(&s, incoming); /* right at once where the wave is not yet due */
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < n; ++i)
      s.phi.at[cf_box_at(b, i, j, 0)] = (cf_real)(2 + sin(-6 * (i + 0.5) * s.grid.h) + (j + 0.5) * s.grid.h);
  OK(cf_advect_set_velocity(s.advect, s.u, &s.walls));
  const int steps = n; /* K = 0.8 */
  for (int step = 0; step < steps; ++step) move_cells(&s, step * 0.8 / steps, 0.8 / steps, NULL);
  const double error = error_against(&s, incoming);
  scene_close(&s);
  return error;
}

static void advect_lets_in_what_the_wall_says_at_the_time(void **state) {
  (void)state;
  const double coarse = inflow_error(32), fine = inflow_error(64);
  print_message("inflow: %.2e %.2e\n", coarse, fine);
  assert_true(fine < 2e-3);
  assert_true(coarse / fine > 2.8);
}

/* Traced over a step in which half the box is replaced: what came in is the wall's value, the rest has moved. */
static void linear_tracing_lets_in_what_the_wall_says(void **state) {
  (void)state;
  const int cells[2] = {16, 8};
  scene s;
  scene_open_scheme(&s, 2, cells, walls_all(CF_WALL_INSULATED), CF_ADVECT_LINEAR);
  const cf_box *b = &s.grid.box;
  for (int kind = 0; kind < 2; ++kind) {
    s.walls.kind[0][0] = kind == 0 ? CF_WALL_VALUE : CF_WALL_OPEN;
    s.walls.kind[0][1] = CF_WALL_OPEN;
    s.walls.value[0][0] = cf_fn_constant(3);
    for (int j = 0; j < 8; ++j)
      for (int i = 0; i <= 16; ++i) {
        s.u.at[0][cf_box_at(b, i, j, 0)] = 1;
        if (i < 16) s.phi.at[cf_box_at(b, i, j, 0)] = (cf_real)i;
      }
    OK(cf_advect_set_velocity(s.advect, s.u, &s.walls));
    move_cells(&s, 0, 0.5, NULL);
    for (int i = 0; i < 16; ++i) {
      const double wanted = i < 8 ? (kind == 0 ? 3 : 0) : i - 8;
      assert_true(fabs((double)s.phi.at[cf_box_at(b, i, 3, 0)] - wanted) < 20 * EPS);
    }
  }
  scene_close(&s);
}

static void advect_refuses_what_it_cannot_do(void **state) {
  (void)state;
  scene s;
  scene_open(&s, 2, flat, walls_all(CF_WALL_PERIODIC));
  set_random_flow(&s, 7, 0);
  s.u.at[1][cf_box_at(&s.grid.box, 3, 4, 0)] = (cf_real)NAN;
  assert_int_equal(cf_advect_set_velocity(s.advect, s.u, &s.walls), CF_NOT_FINITE);
  assert_non_null(strstr(cf_status_sentence(), "along y"));
  assert_non_null(strstr(cf_status_sentence(), "(3, 4, 0)"));
  set_random_flow(&s, 7, 0);
  OK(cf_advect_set_velocity(s.advect, s.u, &s.walls));
  OK(cf_advect_begin(s.advect, 0, 1e-3));
  const cf_walls closed = walls_all(CF_WALL_INSULATED);
  assert_int_equal(cf_advect_cell(s.advect, &closed, s.phi, NULL), CF_BAD_ARGUMENT);
  scene_close(&s);
}

static void advect_frees_what_it_took_when_memory_runs_out(void **state) {
  (void)state;
  cf_grid g;
  OK(cf_grid_init(&g, 3, solid, 0.1, NULL));
  int tries = 0;
  for (long n = 1;; ++n, ++tries) {
    cf_advect *a;
    cf_mem_fail_at(n);
    const cf_status s = cf_advect_create(&a, &g, CF_ADVECT_PPM);
    cf_mem_fail_at(0);
    if (s == CF_OK) {
      cf_advect_destroy(a);
      break;
    }
    assert_int_equal(s, CF_NO_MEMORY);
    assert_null(a);
  }
  assert_true(tries >= 13);
  cf_advect_destroy(NULL);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(advect_keeps_constants),
      cmocka_unit_test(advect_keeps_bounds_and_the_sum_of_random_bits),
      cmocka_unit_test(advect_divides_long_steps),
      cmocka_unit_test(advect_is_linear_in_a_f_plus_b),
      cmocka_unit_test(advect_balances_what_passes_through_walls),
      cmocka_unit_test(two_fields_together_move_as_each_alone),
      cmocka_unit_test(advect_leaves_out_axes_along_which_nothing_moves),
      cmocka_unit_test(advect_lets_in_what_the_wall_says_at_the_time),
      cmocka_unit_test(linear_tracing_lets_in_what_the_wall_says),
      cmocka_unit_test(advect_refuses_what_it_cannot_do),
      cmocka_unit_test(advect_frees_what_it_took_when_memory_runs_out),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
