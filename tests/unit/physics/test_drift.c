/* SPDX-License-Identifier: MIT
 *
 * Points in a flow: orders in time and space, no divergence between the faces of a field that has none, walls.
 */
/* also in single precision */
#include "physics/drift.h"

#include <math.h>

#include "base/rng.h"
#include "stencil/courant.h"
#include "testing.h"

#define PI     3.14159265358979323846
#define SINGLE (sizeof(cf_real) == sizeof(float))

typedef struct flow {
  cf_grid grid;
  cf_drift drift;
  cf_particles *set;
} flow;

static void open_flow(flow *f, const int dim, const int n) {
  const int cells[3] = {n, n, n};
  OK(cf_grid_init(&f->grid, dim, cells, 1.0 / n, NULL));
  f->drift = (cf_drift){.grid = &f->grid};
  OK(cf_face_create(&f->drift.u[2], &f->grid.box));
  f->drift.u[0] = f->drift.u[1] = f->drift.u[2];
  OK(cf_particles_create(&f->set, "points", dim, 16));
}

static void close_flow(flow *f) {
  cf_particles_destroy(f->set);
  cf_face_destroy(&f->drift.u[2], &f->grid.box);
}

static void add_point(flow *f, const double x, const double y, const double z) {
  const double place[3] = {x, y, z};
  int64_t i;
  OK(cf_particles_append(f->set, 1, &i));
  for (int a = 0; a < f->grid.box.dim; ++a)
    f->set->attribute[CF_PARTICLE_POSITION].at[a][i] = (cf_real)place[a];
}

static double place(const flow *f, const int a, const int64_t i) {
  return (double)f->set->attribute[CF_PARTICLE_POSITION].at[a][i];
}

/* u = (d psi/dy, -d psi/dx) of a stream function at the corners: exactly free of divergence. */
static void stir(flow *f, double (*psi)(double, double)) {
  const cf_grid *g = &f->grid;
  const int n = g->box.n[0], layers = g->box.dim == 3 ? n + 1 : 1;
  for (int k = 0; k < layers; ++k)
    for (int j = 0; j <= n; ++j)
      for (int i = 0; i <= n; ++i) {
        const double x = i * g->h, y = j * g->h;
        const ptrdiff_t p = cf_box_at(&g->box, i, j, k);
        if (j < n) f->drift.u[2].at[0][p] = (cf_real)((psi(x, y + g->h) - psi(x, y)) / g->h);
        if (i < n) f->drift.u[2].at[1][p] = (cf_real)((psi(x, y) - psi(x + g->h, y)) / g->h);
      }
  cf_courant_ghosts(g, f->drift.wraps, f->drift.u[2]);
}

/* --- orders ----------------------------------------------------------------------------------------------- */

static double turning(const double x, const double y) {
  return -PI * ((x - 0.5) * (x - 0.5) + (y - 0.5) * (y - 0.5));
}

/* How far a point is from where it was after one turn in `steps` steps. */
static double after_a_turn(const int steps) {
  flow f;
  open_flow(&f, 2, 16);
  stir(&f, turning);
  add_point(&f, 0.7, 0.5, 0);
  for (int s = 0; s < steps; ++s) cf_drift_move(&f.drift, 1.0 / steps, f.set, 0);
  const double off = hypot(place(&f, 0, 0) - 0.7, place(&f, 1, 0) - 0.5);
  close_flow(&f);
  return off;
}

static void a_turn_has_third_order_in_time(void **state) {
  (void)state;
  const double coarse = after_a_turn(20), fine = after_a_turn(40);
  print_message("off by %.2e, %.2e: order %.2f\n", coarse, fine, log2(coarse / fine));
  BELOW(2.9, log2(coarse / fine));
  BELOW(fine, 1e-3);
}

static double whirls(const double x, const double y) { return sin(PI * x) * sin(PI * y) / PI; }

static void whirl_at(const double x[2], double v[2]) {
  v[0] = sin(PI * x[0]) * cos(PI * x[1]);
  v[1] = -cos(PI * x[0]) * sin(PI * x[1]);
}

/* The largest distance from the exact path (Runge and Kutta's fourth order, 2000 steps) after a time 2. */
static double off_the_path(const int n) {
  flow f;
  double worst = 0;
  open_flow(&f, 2, n);
  stir(&f, whirls);
  for (int i = 0; i < 5; ++i) add_point(&f, 0.12 + 0.08 * i, 0.47, 0);
  for (int s = 0; s < 200; ++s) cf_drift_move(&f.drift, 0.01, f.set, 0);
  for (int i = 0; i < 5; ++i) {
    double x[2] = {0.12 + 0.08 * i, 0.47};
    for (int s = 0; s < 2000; ++s) {
      double k[4][2], y[2];
      whirl_at(x, k[0]);
      for (int stage = 1; stage < 4; ++stage) {
        for (int a = 0; a < 2; ++a) y[a] = x[a] + (stage == 3 ? 1e-3 : 5e-4) * k[stage - 1][a];
        whirl_at(y, k[stage]);
      }
      for (int a = 0; a < 2; ++a) x[a] += 1e-3 / 6 * (k[0][a] + 2 * k[1][a] + 2 * k[2][a] + k[3][a]);
    }
    worst = fmax(worst, hypot(place(&f, 0, i) - x[0], place(&f, 1, i) - x[1]));
  }
  close_flow(&f);
  return worst;
}

static void paths_have_second_order_in_space(void **state) {
  (void)state;
  const double coarse = off_the_path(16), fine = off_the_path(32);
  print_message("off by %.2e, %.2e: order %.2f\n", coarse, fine, log2(coarse / fine));
  BELOW(1.9, log2(coarse / fine));
  BELOW(fine, 5e-3);
}

/* --- between the faces ------------------------------------------------------------------------------------ */

static double rough(const double x, const double y) {
  return cf_random(1, 0, (uint64_t)lround(x * 12), (uint64_t)lround(y * 12)) / 12;
}

/* Numerical divergence at places within the box, and the normal velocity on its walls. */
static void no_place_has_divergence(void **state) {
  (void)state;
  if (SINGLE) return; /* differences of rounding */
  const double e = 1e-6;
  for (int dim = 2; dim <= 3; ++dim) {
    flow f;
    int v;
    double most = 0, speed = 0;
    open_flow(&f, dim, 12);
    OK(cf_particles_attribute(f.set, "velocity", "m/s", dim, CF_CARRIED, &v));
    stir(&f, rough);
    for (uint64_t i = 0; i < 100; ++i) {
      double x[3];
      for (int a = 0; a < 3; ++a) x[a] = 0.01 + 0.98 * cf_random(2, 0, (uint64_t)a, i);
      for (int a = 0; a < dim; ++a)
        for (int side = -1; side <= 1; side += 2)
          add_point(&f, x[0] + (a == 0 ? side * e : 0), x[1] + (a == 1 ? side * e : 0),
                    x[2] + (a == 2 ? side * e : 0));
    }
    cf_drift_velocity(&f.drift, f.set, v);
    for (int i = 0; i < 100; ++i) {
      double sum = 0;
      for (int a = 0; a < dim; ++a) {
        const cf_real *u = f.set->attribute[v].at[a] + 2 * (dim * i + a);
        sum += ((double)u[1] - (double)u[0]) / (2 * e);
        speed = fmax(speed, fabs((double)u[0]));
      }
      most = fmax(most, fabs(sum));
    }
    print_message("%d dimensions: divergence %.1e, speed %.2f in cells of 1/12\n", dim, most, speed);
    BELOW(0.1, speed);
    BELOW(most, 1e-6 * 12 * speed);
    close_flow(&f);
  }
}

static void points_stay_behind_closed_walls_and_leave_through_open_ones(void **state) {
  (void)state;
  flow f;
  open_flow(&f, 3, 8);
  stir(&f, whirls);
  for (int i = 0; i < 8; ++i) add_point(&f, 0, 0.1 + 0.1 * i, 0.5);
  for (int s = 0; s < 50; ++s) cf_drift_move(&f.drift, 0.02, f.set, 0);
  for (int i = 0; i < 8; ++i) BELOW(fabs(place(&f, 0, i)), SINGLE ? 1e-6 : 1e-14);
  for (int r = 0; r < 10; ++r)
    for (int j = 0; j <= 8; ++j)
      for (int i = 0; i <= 8; ++i)
        f.drift.u[2].at[2][cf_box_at(&f.grid.box, i, j, r > 8 ? 8 : r)] = 1; /* upwards */
  cf_courant_ghosts(&f.grid, f.drift.wraps, f.drift.u[2]);
  cf_drift_move(&f.drift, 0.6, f.set, 0);
  CLOSE(place(&f, 2, 0), 1, 1e-12); /* stopped */
  assert_int_equal(f.set->key[0], 0);
  f.drift.open[2][1] = true;
  cf_drift_move(&f.drift, 0.1, f.set, 0);
  cf_particles_remove(f.set, 1);
  assert_int_equal(f.set->count, 0);
  add_point(&f, 0.5, 0.5, 0.9);
  f.drift.wraps[2] = true;
  cf_drift_move(&f.drift, 0.3, f.set, 0);
  CLOSE(place(&f, 2, 0), 0.2, 1e-6);
  close_flow(&f);
}

static void sorting_keeps_every_point(void **state) {
  (void)state;
  flow f;
  open_flow(&f, 3, 20);
  for (uint64_t i = 0; i < 500; ++i)
    add_point(&f, cf_random(3, 0, 0, i), cf_random(3, 0, 1, i), cf_random(3, 0, 2, i));
  cf_drift_sort(&f.grid, f.set);
  for (int64_t i = 0; i < 500; ++i) {
    for (int a = 0; a < 3; ++a)
      assert_true((cf_real)cf_random(3, 0, (uint64_t)a, (uint64_t)f.set->id[i]) ==
                  f.set->attribute[CF_PARTICLE_POSITION].at[a][i]);
    if (i > 0) assert_true(f.set->key[i - 1] <= f.set->key[i]);
  }
  close_flow(&f);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(a_turn_has_third_order_in_time),
      cmocka_unit_test(paths_have_second_order_in_space),
      cmocka_unit_test(no_place_has_divergence),
      cmocka_unit_test(points_stay_behind_closed_walls_and_leave_through_open_ones),
      cmocka_unit_test(sorting_keeps_every_point),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
