/* SPDX-License-Identifier: MIT
 *
 * Fluxes on faces in a moving medium: the same kernel as cells, and the three meanings of the time derivative.
 */
/* also in single precision */
#include "advect_flows.h"

#define EPS ((double)CF_REAL_EPSILON)

static const int flat[3] = {40, 36, 1}, solid[3] = {14, 12, 16};

typedef struct flux_scene {
  scene s;
  cf_face q;
} flux_scene;

static void flux_open(flux_scene *f, const int dim, const int *cells, const cf_walls walls,
                      const cf_advect_scheme scheme) {
  scene_open_scheme(&f->s, dim, cells, walls, scheme);
  OK(cf_face_create(&f->q, &f->s.grid.box));
}

static void flux_close(flux_scene *f) {
  cf_face_destroy(&f->q, &f->s.grid.box);
  scene_close(&f->s);
}

static void move_flux(flux_scene *f, const double dt, const cf_flux_rate rate) {
  OK(cf_advect_begin(f->s.advect, 0, dt));
  OK(cf_advect_face(f->s.advect, &f->s.walls, rate, f->q));
}

typedef double (*component)(int a, const double x[3], double t);

static void place_of(const cf_grid *g, const int a, const int i[3], double x[3]) {
  for (int d = 0; d < 3; ++d) x[d] = cf_grid_place(g, d, i[d], d == a) - 0.5;
}

/* Calls for every face: sets it (to != 0), or returns the largest |q - f| within `reach` of the middle. */
static double each_face(flux_scene *f, const cf_face q, const component c, const double t, const int set,
                        const double reach) {
  const cf_box *b = &f->s.grid.box;
  double worst = 0;
  for (int a = 0; a < b->dim; ++a)
    for (int k = 0; k < cf_box_extent(b, 2, a); ++k)
      for (int j = 0; j < cf_box_extent(b, 1, a); ++j)
        for (int i = 0; i < cf_box_extent(b, 0, a); ++i) {
          const int at[3] = {i, j, k};
          double x[3];
          place_of(&f->s.grid, a, at, x);
          const ptrdiff_t p = cf_box_at(b, i, j, k);
          if (set)
            q.at[a][p] = (cf_real)c(a, x, t);
          else if (hypot(x[0], x[1]) < reach)
            worst = fmax(worst, fabs((double)q.at[a][p] - c(a, x, t)));
        }
  return worst;
}

static void a_uniform_flow_carries_components_like_scalars_to_the_bit(void **state) {
  (void)state;
  for (int dim = 2; dim <= 3; ++dim) {
    flux_scene f;
    flux_open(&f, dim, dim == 2 ? flat : solid, walls_all(CF_WALL_PERIODIC), CF_ADVECT_PPM);
    const cf_box *b = &f.s.grid.box;
    const double u[3] = {0.7, -0.4, 0.3};
    for (ptrdiff_t r = 0; r < cf_box_rows(b); ++r)
      for (int i = 0; i < b->n[0]; ++i) {
        const ptrdiff_t p = cf_box_row(b, r) + i;
        f.s.phi.at[p] = (cf_real)noise(p, 1);
        for (int a = 0; a < dim; ++a) f.q.at[a][p] = f.s.phi.at[p], f.s.u.at[a][p] = (cf_real)u[a];
      }
    OK(cf_advect_set_velocity(f.s.advect, f.s.u, &f.s.walls));
    for (int step = 0; step < 5; ++step) {
      OK(cf_advect_begin(f.s.advect, 0, step_of(&f.s, 1.3)));
      OK(cf_advect_cell(f.s.advect, &f.s.walls, f.s.phi, NULL));
      OK(cf_advect_face(f.s.advect, &f.s.walls, CF_RATE_CONSERVATIVE, f.q));
    }
    for (ptrdiff_t r = 0; r < cf_box_rows(b); ++r)
      for (int a = 0; a < dim; ++a)
        assert_memory_equal(f.q.at[a] + cf_box_row(b, r), f.s.phi.at + cf_box_row(b, r),
                            (size_t)b->n[0] * sizeof(cf_real));
    for (int a = 0; a < dim; ++a) /* the last layer is the image of the first */
      assert_true(f.q.at[a][b->n[a] * b->stride[a]] == f.q.at[a][0]);
    flux_close(&f);
  }
}

static double sum_of_component(const flux_scene *f, const int a) {
  const cf_box *b = &f->s.grid.box;
  double sum = 0;
  for (ptrdiff_t r = 0; r < cf_box_rows(b); ++r)
    for (int i = 0; i < b->n[0]; ++i) sum += (double)f->q.at[a][cf_box_row(b, r) + i];
  return sum;
}

static double noisy(const int a, const double x[3], const double t) {
  return noise((int64_t)(1e6 * (x[0] + 2 * x[1] + 3 * x[2])), a + (int64_t)t);
}
static double constant(const int a, const double x[3], const double t) {
  (void)x, (void)t;
  return a == 0 ? 0.7 : -0.3;
}

static void check_random_flow(const int dim, const int *cells, const cf_wall kind, const cf_flux_rate rate) {
  flux_scene f;
  flux_open(&f, dim, cells, walls_all(kind), CF_ADVECT_PPM);
  const cf_box *b = &f.s.grid.box;
  cf_face c;
  OK(cf_face_create(&c, b));
  each_face(&f, f.q, noisy, 1, 1, 0);
  each_face(&f, c, constant, 0, 1, 0);
  const double first = sum_of_component(&f, 1);
  for (int step = 0; step < 10; ++step) {
    set_random_flow(&f.s, 300 + step, kind == CF_WALL_INSULATED);
    OK(cf_advect_set_velocity(f.s.advect, f.s.u, &f.s.walls));
    OK(cf_advect_begin(f.s.advect, 0, step_of(&f.s, 0.9)));
    OK(cf_advect_face(f.s.advect, &f.s.walls, rate, f.q));
    OK(cf_advect_face(f.s.advect, &f.s.walls, rate, c));
  }
  if (kind == CF_WALL_PERIODIC && rate == CF_RATE_CONSERVATIVE)
    assert_true(fabs(sum_of_component(&f, 1) - first) < 30 * EPS * first);
  for (int a = 0; a < dim; ++a)
    for (int k = 0; k < cf_box_extent(b, 2, a); ++k)
      for (int j = 0; j < cf_box_extent(b, 1, a); ++j)
        for (int i = 0; i < cf_box_extent(b, 0, a); ++i) {
          const ptrdiff_t p = cf_box_at(b, i, j, k);
          const int at[3] = {i, j, k};
          const bool wall = kind == CF_WALL_INSULATED && (at[a] == 0 || at[a] == b->n[a]);
          const double v = (double)f.q.at[a][p], w = (double)c.at[a][p];
          if (wall) {
            assert_true(v == 0 && w == 0);
            continue;
          }
          assert_true(v > -8 * EPS && v < 1 + 8 * EPS);
          if (kind != CF_WALL_INSULATED) assert_true(fabs(w - constant(a, NULL, 0)) < 40 * EPS);
        }
  cf_face_destroy(&c, b);
  flux_close(&f);
}

static void fluxes_keep_bounds_sums_and_constants(void **state) {
  (void)state;
  const cf_wall kinds[3] = {CF_WALL_PERIODIC, CF_WALL_INSULATED, CF_WALL_OPEN};
  for (int i = 0; i < 3; ++i)
    for (int rate = CF_RATE_CONSERVATIVE; rate <= CF_RATE_MATERIAL; ++rate) {
      check_random_flow(2, flat, kinds[i], (cf_flux_rate)rate);
      check_random_flow(3, solid, kinds[i], (cf_flux_rate)rate);
    }
}

/* --- a medium that turns ------------------------------------------------------------------------------ */

static double spin_axis[3];

/* u = w x (x - middle), free of divergence face by face. */
static double spin_velocity(const int a, const double x[3], const double t) {
  (void)t;
  const int b = (a + 1) % 3, c = (a + 2) % 3;
  return spin_axis[b] * x[c] - spin_axis[c] * x[b];
}

/* v turned by angle t |w| about w. */
static void turn(const double v[3], const double t, double out[3]) {
  const double w =
      sqrt(spin_axis[0] * spin_axis[0] + spin_axis[1] * spin_axis[1] + spin_axis[2] * spin_axis[2]);
  double n[3], along = 0;
  for (int a = 0; a < 3; ++a) n[a] = spin_axis[a] / w, along += n[a] * v[a];
  for (int a = 0; a < 3; ++a) {
    const int b = (a + 1) % 3, c = (a + 2) % 3;
    out[a] = v[a] * cos(w * t) + (n[b] * v[c] - n[c] * v[b]) * sin(w * t) + n[a] * along * (1 - cos(w * t));
  }
}

static double uniform_turned(const int a, const double x[3], const double t) {
  (void)x;
  const double q0[3] = {1, 0.2, spin_axis[0] == 0 ? 0 : -0.4};
  double q[3];
  turn(q0, t, q);
  return q[a];
}

/* A uniform flux after a quarter turn in the rotating medium; returns the largest error. */
static double quarter_turn(const int dim, const int steps, const cf_flux_rate rate,
                           const double t_of_medium) {
  const int cells[3] = {24, 24, 24};
  flux_scene f;
  flux_open(&f, dim, cells, walls_all(CF_WALL_OPEN), CF_ADVECT_PPM);
  each_face(&f, f.s.u, spin_velocity, 0, 1, 0);
  each_face(&f, f.q, uniform_turned, 0, 1, 0);
  OK(cf_advect_set_velocity(f.s.advect, f.s.u, &f.s.walls));
  const double dt = 0.5 * PI / steps;
  for (int step = 0; step < steps; ++step) move_flux(&f, dt, rate);
  const double error = each_face(&f, f.q, uniform_turned, t_of_medium, 0, 10);
  flux_close(&f);
  return error;
}

static void a_flux_turns_with_the_medium_only_under_the_objective_rate(void **state) {
  (void)state;
  for (int dim = 2; dim <= 3; ++dim) {
    const double axis[2][3] = {{0, 0, 1}, {0.6, 0, 0.8}};
    memcpy(spin_axis, axis[dim - 2], sizeof spin_axis);
    const double coarse = quarter_turn(dim, 40, CF_RATE_OBJECTIVE, 0.5 * PI),
                 fine = quarter_turn(dim, 80, CF_RATE_OBJECTIVE, 0.5 * PI);
    print_message("%dD quarter turn: %.2e %.2e\n", dim, coarse, fine);
    assert_true(fine < 1e-3);
    if (EPS < 1e-10) assert_true(coarse / fine > 3.8 && coarse / fine < 4.2);
    assert_true(quarter_turn(dim, 40, CF_RATE_MATERIAL, 0) < 400 * EPS);
    assert_true(quarter_turn(dim, 40, CF_RATE_CONSERVATIVE, 0) < 400 * EPS);
  }
}

/* A patch of flux that is carried around and turned; what lies within 0.4 of the middle never meets a wall. */
static double patch(const int a, const double x[3], const double t) {
  double place[3], back[3], q0[3], q[3];
  memcpy(place, x, sizeof place);
  place[2] = 0;
  turn(place, -t, back);
  const double r2 = pow(back[0] - 0.1, 2) + pow(back[1], 2);
  q0[0] = exp(-r2 / 0.03), q0[1] = 0.5 * q0[0], q0[2] = 0;
  turn(q0, t, q);
  return q[a];
}

static double patch_error(const int n) {
  const int cells[3] = {n, n, 1};
  const double axis[3] = {0, 0, 1};
  memcpy(spin_axis, axis, sizeof spin_axis);
  flux_scene f;
  flux_open(&f, 2, cells, walls_all(CF_WALL_OPEN), CF_ADVECT_PPM);
  each_face(&f, f.s.u, spin_velocity, 0, 1, 0);
  each_face(&f, f.q, patch, 0, 1, 0);
  OK(cf_advect_set_velocity(f.s.advect, f.s.u, &f.s.walls));
  for (int step = 0; step < 2 * n; ++step) move_flux(&f, 2.0 / (2 * n), CF_RATE_OBJECTIVE);
  double sum = 0;
  const cf_box *b = &f.s.grid.box;
  for (int a = 0; a < 2; ++a)
    for (int j = 0; j < n; ++j)
      for (int i = 0; i < n; ++i) {
        const int at[3] = {i, j, 0};
        double x[3];
        place_of(&f.s.grid, a, at, x);
        if (hypot(x[0], x[1]) < 0.4)
          sum += fabs((double)f.q.at[a][cf_box_at(b, i, j, 0)] - patch(a, x, 2.0)) / (n * n);
      }
  flux_close(&f);
  return sum;
}

static void a_patch_of_flux_is_carried_and_turned_to_second_order(void **state) {
  (void)state;
  const double coarse = patch_error(64), fine = patch_error(128);
  print_message("patch: %.2e %.2e, order %.2f\n", coarse, fine, log2(coarse / fine));
  assert_true(fine < 5e-4);
  assert_true(log2(coarse / fine) > 1.8);
}

/* Shear u_x = y stretches q_y into q_x: exactly q_x = q_y t, up to walls that let the flow through in x and
 * closed ones in y. */
static double sheared(const int a, const double x[3], const double t) {
  (void)x;
  return a == 0 ? t * 0.5 : 0.5;
}
static double shear(const int a, const double x[3], const double t) {
  (void)t;
  return a == 0 ? x[1] : 0;
}

static void a_shear_tilts_a_flux_also_beside_open_walls(void **state) {
  (void)state;
  flux_scene f;
  cf_walls walls = walls_all(CF_WALL_OPEN);
  flux_open(&f, 2, flat, walls, CF_ADVECT_PPM);
  each_face(&f, f.s.u, shear, 0, 1, 0);
  each_face(&f, f.q, sheared, 0, 1, 0);
  OK(cf_advect_set_velocity(f.s.advect, f.s.u, &f.s.walls));
  for (int step = 0; step < 20; ++step) move_flux(&f, 0.05, CF_RATE_OBJECTIVE);
  assert_true(each_face(&f, f.q, sheared, 1, 0, 10) < 200 * EPS);
  flux_close(&f);
}

static void linear_tracing_carries_fluxes_too(void **state) {
  (void)state;
  const double axis[3] = {0, 0, 1};
  memcpy(spin_axis, axis, sizeof spin_axis);
  flux_scene f;
  flux_open(&f, 2, flat, walls_all(CF_WALL_OPEN), CF_ADVECT_LINEAR);
  each_face(&f, f.s.u, spin_velocity, 0, 1, 0);
  each_face(&f, f.q, uniform_turned, 0, 1, 0);
  OK(cf_advect_set_velocity(f.s.advect, f.s.u, &f.s.walls));
  assert_true(cf_advect_substeps(f.s.advect, 1000) == 1);
  for (int step = 0; step < 10; ++step) move_flux(&f, 0.1, CF_RATE_OBJECTIVE);
  assert_true(each_face(&f, f.q, uniform_turned, 1, 0, 10) < 5e-3);
  each_face(&f, f.q, noisy, 1, 1, 0);
  for (int step = 0; step < 10; ++step) move_flux(&f, 3, CF_RATE_MATERIAL);
  const cf_box *b = &f.s.grid.box;
  for (int i = 0; i < b->n[0]; ++i) assert_true(f.q.at[0][i] >= 0 && f.q.at[0][i] <= 1);
  flux_close(&f);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(a_uniform_flow_carries_components_like_scalars_to_the_bit),
      cmocka_unit_test(fluxes_keep_bounds_sums_and_constants),
      cmocka_unit_test(a_flux_turns_with_the_medium_only_under_the_objective_rate),
      cmocka_unit_test(a_patch_of_flux_is_carried_and_turned_to_second_order),
      cmocka_unit_test(a_shear_tilts_a_flux_also_beside_open_walls),
      cmocka_unit_test(linear_tracing_carries_fluxes_too),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
