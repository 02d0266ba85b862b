/* SPDX-License-Identifier: MIT
 *
 * Signed distances against closed forms, and rigid motions against what a rigid body does.
 */
/* also in single precision */
#include "grid/shape.h"

#include <math.h>
#include <string.h>

#include "base/mem.h"
#include "testing.h"

static const double pi = 3.14159265358979323846;

static double at(const cf_shape *s, const double x, const double y, const double z) {
  return cf_shape_distance(s, NULL, 0, (double[]){x, y, z});
}

static void simple_shapes_have_their_distances(void **state) {
  (void)state;
  const cf_shape ball = cf_shape_sphere((double[]){1, 2, 3}, 2);
  CLOSE(at(&ball, 1, 2, 3), -2, 0);
  CLOSE(at(&ball, 1, 2, 6), 1, 1e-15);
  const cf_shape brick = cf_shape_box(3, (double[]){0, 0, 0}, (double[]){1, 2, 3});
  CLOSE(at(&brick, 0, 0, 0), -1, 0);
  CLOSE(at(&brick, 0.5, 1.9, 0), -0.1, 1e-15);
  CLOSE(at(&brick, 4, 6, 0), 5, 1e-15);
  const cf_shape square = cf_shape_box(2, (double[]){0, 0, 0}, (double[]){1, 1, 0});
  CLOSE(at(&square, 0, 0, 0), -1, 0);
  CLOSE(at(&square, 2, 0, 0), 1, 0);
  const cf_shape rod = cf_shape_capsule((double[]){0, 0, 0}, (double[]){4, 0, 0}, 1);
  CLOSE(at(&rod, 2, 3, 0), 2, 1e-15);
  CLOSE(at(&rod, 7, 4, 0), 4, 1e-15);
  const cf_shape point = cf_shape_capsule((double[]){1, 0, 0}, (double[]){1, 0, 0}, 1);
  CLOSE(at(&point, 3, 0, 0), 1, 1e-15);
  const cf_shape ground = cf_shape_plane((double[]){0, 1, 0}, (double[]){0, 5, 0});
  CLOSE(at(&ground, 7, 4, 2), 3, 1e-15);
  CLOSE(at(&ground, 7, -1, 2), -2, 1e-15);
}

static void parts_are_joined(void **state) {
  (void)state;
  const cf_shape part[2] = {cf_shape_sphere((double[]){0, 0, 0}, 1), cf_shape_sphere((double[]){1, 0, 0}, 1)};
  const cf_shape both = cf_shape_union(part, 2), common = cf_shape_intersection(part, 2);
  const cf_shape rest = cf_shape_complement(&both), none = cf_shape_union(NULL, 0);
  for (int v = 0; v < 200; ++v) {
    const double x = -2 + 0.02 * v, d0 = fabs(x) - 1, d1 = fabs(x - 1) - 1;
    CLOSE(at(&both, x, 0, 0), fmin(d0, d1), 1e-15);
    CLOSE(at(&common, x, 0, 0), fmax(d0, d1), 1e-15);
    CLOSE(at(&rest, x, 0, 0), -fmin(d0, d1), 1e-15);
  }
  assert_true(at(&none, 0, 0, 0) > 0);
}

static void wavy(const void *context, const int n, const double *x, const double *y, const double *z,
                 const double t, double *out) {
  (void)context;
  (void)z;
  for (int i = 0; i < n; ++i) out[i] = y[i] - sin(x[i]) - t;
}

static void rows_of_a_function_are_its_values(void **state) {
  (void)state;
  const cf_fn fn = {.eval = wavy, .in_time = true};
  const cf_shape wave = cf_shape_function(&fn);
  double x[100], y[100], z[100], out[100];
  for (int i = 0; i < 100; ++i) x[i] = 0.1 * i, y[i] = 0.3 * i, z[i] = 0;
  cf_shape_distance_row(&wave, NULL, 2, 100, x, y, z, out);
  for (int i = 0; i < 100; ++i) CLOSE(out[i], y[i] - sin(x[i]) - 2, 1e-15);
}

static void samples_are_interpolated_and_continued(void **state) {
  (void)state;
  cf_samples s = {.n = {5, 4, 3}, .place = {-1, 0, 2}, .h = 0.5};
  OK(CF_NEW(&s.value, 60));
  for (int k = 0; k < 3; ++k)
    for (int j = 0; j < 4; ++j)
      for (int i = 0; i < 5; ++i)
        s.value[i + 5 * (j + 4 * k)] = (float)((-1 + 0.5 * i) + 2 * (0.5 * j) - (2 + 0.5 * k));
  const cf_shape shape = cf_shape_sampled(&s);
  CLOSE(at(&shape, 0.3, 0.7, 2.2), 0.3 + 1.4 - 2.2, 1e-6);
  CLOSE(at(&shape, -1, 0, 2), -3, 1e-6);
  CLOSE(at(&shape, 1, 1.5, 3), 1, 1e-6);
  CLOSE(at(&shape, 4, 1.5, 7), 1 + 5, 1e-6); /* 3 and 4 beyond */
  cf_samples_destroy(&s);
}

static void normals_point_outward(void **state) {
  (void)state;
  const cf_shape ball = cf_shape_sphere((double[]){0, 0, 0}, 1);
  double n[3];
  cf_shape_normal(&ball, NULL, 0, (double[]){0.6, 0.8, 0}, 1e-4, n);
  CLOSE(n[0], 0.6, 1e-7);
  CLOSE(n[1], 0.8, 1e-7);
  CLOSE(n[2], 0, 1e-7);
}

static void angle_of(const void *context, const int n, const double *x, const double *y, const double *z,
                     const double t, double *out) {
  (void)x, (void)y, (void)z;
  for (int i = 0; i < n; ++i) out[i] = t * *(const double *)context;
}

static void a_turned_body_is_where_it_should_be(void **state) {
  (void)state;
  const double quarter = pi / 2, two = 2;
  cf_motion m = {.angle = {.eval = angle_of, .context = &quarter, .in_time = true},
                 .shift = {{.value = 0}, {.eval = angle_of, .context = &two, .in_time = true}, {.value = 0}},
                 .pivot = {1, 0, 0}};
  const cf_shape rod = cf_shape_capsule((double[]){1, 0, 0}, (double[]){4, 0, 0}, 0.5);
  const cf_pose p = cf_motion_at(&m, 1, 1e-3); /* a quarter turn about (1, 0), then up by 2 */
  CLOSE(cf_shape_distance(&rod, &p, 0, (double[]){1, 5, 0}), -0.5, 1e-14);
  CLOSE(cf_shape_distance(&rod, &p, 0, (double[]){1, 6, 0}), 0.5, 1e-14);
  CLOSE(cf_shape_distance(&rod, &p, 0, (double[]){3, 2, 0}), 1.5, 1e-14);
  double u[3];
  cf_pose_velocity(&p, (double[]){1, 5, 0}, u); /* 3 away from the pivot, turning to -x */
  CLOSE(u[0], -3 * quarter, 1e-9);
  CLOSE(u[1], 2, 1e-9);
  CLOSE(u[2], 0, 0);
}

/* The distance to a body at rest, carried along with the body's own velocity, does not change. */
static void distances_move_with_the_body(void **state) {
  (void)state;
  const double rate = 0.7;
  const cf_motion m = {.angle = {.eval = angle_of, .context = &rate, .in_time = true},
                       .shift = {{.eval = angle_of, .context = &rate, .in_time = true}},
                       .pivot = {0.3, 0.1, -0.2},
                       .axis = {1, 2, 2}};
  const cf_shape brick = cf_shape_box(3, (double[]){0, 0.5, 0}, (double[]){1, 0.5, 0.25});
  const double dt = 1e-4, place[3] = {1.5, 0.9, 0.7};
  const cf_pose before = cf_motion_at(&m, 2, dt), after = cf_motion_at(&m, 2 + dt, dt);
  double u[3], later[3];
  cf_pose_velocity(&before, place, u);
  for (int a = 0; a < 3; ++a) later[a] = place[a] + dt * u[a];
  CLOSE(cf_shape_distance(&brick, &after, 0, later), cf_shape_distance(&brick, &before, 0, place),
        3 * dt * dt);
  CLOSE(before.turn[0][0] * before.turn[1][0] + before.turn[0][1] * before.turn[1][1] +
            before.turn[0][2] * before.turn[1][2],
        0, 1e-15);
}

static void a_window_holds_every_cell_inside(void **state) {
  (void)state;
  cf_grid g;
  OK(cf_grid_init(&g, 3, (int[]){40, 30, 20}, 0.1, (double[]){-1, 0, 0.5}));
  const double rate = 0.9;
  const cf_motion m = {.angle = {.eval = angle_of, .context = &rate, .in_time = true}, .pivot = {1, 1, 1}};
  const cf_shape part[2] = {cf_shape_box(3, (double[]){1, 1.2, 1.4}, (double[]){0.5, 0.3, 0.2}),
                            cf_shape_capsule((double[]){0, 1, 1}, (double[]){0.5, 1.5, 1.6}, 0.2)};
  const cf_shape both = cf_shape_union(part, 2);
  cf_cell d;
  OK(cf_cell_create(&d, &g.box));
  for (int t = 0; t < 5; ++t) {
    const cf_pose pose = cf_motion_at(&m, t, 1e-3);
    int low[3], high[3], inside = 0;
    cf_shape_cells(&both, &pose, &g, 0, low, high);
    OK(cf_shape_sample(&both, &pose, 0, &g, d));
    for (int k = 0; k < 20; ++k)
      for (int j = 0; j < 30; ++j)
        for (int i = 0; i < 40; ++i) {
          if (d.at[cf_box_at(&g.box, i, j, k)] > 0) continue;
          ++inside;
          assert_true(i >= low[0] && i < high[0] && j >= low[1] && j < high[1] && k >= low[2] && k < high[2]);
        }
    assert_true(inside > 200);
    assert_true((high[0] - low[0]) * (high[1] - low[1]) * (high[2] - low[2]) < 40 * 30 * 20);
  }
  cf_cell_destroy(&d, &g.box);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(simple_shapes_have_their_distances),
      cmocka_unit_test(parts_are_joined),
      cmocka_unit_test(rows_of_a_function_are_its_values),
      cmocka_unit_test(samples_are_interpolated_and_continued),
      cmocka_unit_test(normals_point_outward),
      cmocka_unit_test(a_turned_body_is_where_it_should_be),
      cmocka_unit_test(distances_move_with_the_body),
      cmocka_unit_test(a_window_holds_every_cell_inside),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
