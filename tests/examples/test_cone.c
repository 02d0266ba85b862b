/* SPDX-License-Identifier: MIT
 *
 * examples/cone against the exact plume of a source in a uniform stream (by Fourier transform, in a box so large that
 * images do not meet): half-angle, transects, upstream reach and mass, on the example's own scenes.
 */
#include "example.h"

#define PI 3.14159265358979323846

/* --- the angle ------------------------------------------------------------------------------------------------ */

/* One half of a transect: values and distances from the axis, outwards. Returns the place, outside of the ridge
 * (the outermost maximum above a fifth of the largest), where phi has fallen to half of the ridge; NaN: nowhere. */
static double edge_of(const int n, const double *y, const double *v) {
  double largest = -INFINITY;
  int ridge = -1, where = 0;
  for (int j = 0; j < n; ++j)
    if (v[j] > largest) largest = v[j], where = j;
  if (largest <= 0) return NAN;
  for (int j = 1; j < n - 1; ++j)
    if (v[j] >= v[j - 1] && v[j] > v[j + 1] && v[j] > 0.2 * largest) ridge = j;
  if (ridge < 0) ridge = where;
  const double level = v[ridge] / 2;
  int q = ridge;
  while (q + 1 < n && v[q + 1] > level) ++q;
  if (q + 1 >= n) return NAN;
  return y[q] + (v[q] - level) / (v[q] - v[q + 1]) * (y[q + 1] - y[q]);
}

/* Half-angle in degrees from the least-squares line through the edges at the stations x1 <= x <= x2 behind a source
 * at the origin. */
static double cone_angle(const cf_view *v, const double x1, const double x2) {
  double *y = calloc((size_t)v->shape[1], sizeof *y), *f = calloc((size_t)v->shape[1], sizeof *f);
  double n = 0, sx = 0, sy = 0, sxx = 0, sxy = 0;
  for (int i = 0; i < v->shape[0]; ++i) {
    const double x = view_x(v, 0, i);
    if (x < x1 || x > x2) continue;
    for (int side = -1; side <= 1; side += 2) {
      int count = 0;
      for (int m = 0; m < v->shape[1]; ++m) {
        const int j = side > 0 ? m : v->shape[1] - 1 - m;
        if (view_x(v, 1, j) * side <= 0) continue;
        y[count] = fabs(view_x(v, 1, j));
        f[count++] = view_at(v, i, j, 0);
      }
      const double edge = edge_of(count, y, f);
      if (isnan(edge)) continue;
      n += 1, sx += x, sy += edge, sxx += x * x, sxy += x * edge;
    }
  }
  free(y);
  free(f);
  assert_true(n >= 4);
  return atan((n * sxy - sx * sy) / (n * sxx - sx * sx)) * 180 / PI;
}

static int row_of(const table *t, const double H_c) {
  for (int r = 0; r < t->rows; ++r)
    if (fabs(table_at(t, r, "Hc") - H_c) < 1e-6) return r;
  fail_msg("no H_c = %g", H_c);
  return -1;
}

/* --- transects ------------------------------------------------------------------------------------------------ */

/* Sum of |phi - exact| over that of |exact|, on all points of the table that lie in the box. */
static double transects_error(const cf_view *v, const double H_c) {
  table t = table_read("plume_transects.csv");
  double wrong = 0, all = 0;
  int points = 0;
  for (int r = 0; r < t.rows; ++r) {
    if (fabs(table_at(&t, r, "Hc") - H_c) > 1e-6) continue;
    const double x = table_at(&t, r, "x_minus_src"), y = table_at(&t, r, "y_minus_src");
    if (fabs(y) > view_x(v, 1, v->shape[1] - 3) || x > view_x(v, 0, v->shape[0] - 3)) continue;
    wrong += fabs(view_in_plane(v, x, y) - table_at(&t, r, "phi"));
    all += fabs(table_at(&t, r, "phi"));
    ++points;
  }
  table_free(&t);
  assert_true(points > 60);
  return wrong / all;
}

typedef struct measured {
  double angle, transects, upstream, mass, ledger, least;
} measured;

/* Leftmost place on the axis where phi is above a thousandth of its largest value there. */
static double upstream_edge(const cf_view *v) {
  const int j = v->shape[1] / 2;
  double largest = 0;
  for (int i = 0; i < v->shape[0]; ++i)
    largest = fmax(largest, (view_at(v, i, j, 0) + view_at(v, i, j - 1, 0)) / 2);
  for (int i = 0; i < v->shape[0]; ++i)
    if ((view_at(v, i, j, 0) + view_at(v, i, j - 1, 0)) / 2 > 1e-3 * largest) return view_x(v, 0, i);
  return NAN;
}

static measured measure(const char *file, const double H_c, const char *const *set) {
  table angles = table_read("plume_angles.csv");
  const int r = row_of(&angles, H_c);
  example e = example_open(file, set);
  example_run(&e, INFINITY);
  CLOSE(cf_sim_time(e.sim), table_at(&angles, r, "t"), 1e-12);
  const cf_view phi = example_field(&e, "phi", 0);
  const measured m = {
      .angle =
          H_c > 1 ? cone_angle(&phi, table_at(&angles, r, "fit_x1"), table_at(&angles, r, "fit_x2")) : NAN,
      .transects = transects_error(&phi, H_c),
      .upstream = upstream_edge(&phi) - table_at(&angles, r, "upstream_edge_x"),
      .mass = example_metric(&e, "sum_phi") / cf_sim_time(e.sim) - 1,
      .ledger = example_metric(&e, "error_phi"),
      .least = example_metric(&e, "min_phi") - table_at(&angles, r, "min_phi"),
  };
  print_message(
      "H_c = %.3f: angle %.2f (exact field %.2f), transects %.4f, upstream edge off by %.4f, mass %.1e, "
      "ledger "
      "%.1e, least value off by %.3f\n",
      H_c, m.angle, table_at(&angles, r, "measured_deg"), m.transects, m.upstream, m.mass, m.ledger, m.least);
  example_close(&e);
  table_free(&angles);
  return m;
}

/* --- the checks ----------------------------------------------------------------------------------------------- */

static void the_cone_of_a_stream_twice_as_fast_has_30_degrees(void **state) {
  (void)state;
  const measured m = measure("cone/scene.yaml", 2, NULL);
  CLOSE(m.angle, 30, 0.5);
  BELOW(m.transects, 0.03);
  BELOW(fabs(m.ledger), 1e-12);
}

static void the_cone_of_a_stream_sqrt_2_as_fast_has_45_degrees(void **state) {
  (void)state;
  const measured m = measure("cone/hc-1.41.yaml", sqrt(2), NULL);
  CLOSE(m.angle, 45, 0.5);
  BELOW(m.transects, 0.06);
  BELOW(fabs(m.ledger), 1e-12);
}

static void the_cone_of_a_stream_little_faster_than_the_front_has_60_degrees(void **state) {
  (void)state;
  const measured m = measure("cone/hc-1.15.yaml", 2 / sqrt(3), NULL);
  CLOSE(m.angle, 60, 0.5);
  BELOW(m.transects, 0.1); /* t = 8 with three cells a source width */
  BELOW(fabs(m.ledger), 1e-12);
}

static void in_a_stream_as_fast_as_the_front_nothing_goes_upstream(void **state) {
  (void)state;
  const measured m = measure("cone/hc-1.yaml", 1, NULL);
  BELOW(m.transects, 0.06);
  BELOW(fabs(m.upstream), 0.02);
  BELOW(fabs(m.ledger), 1e-12);
}

/* The same scene with a slower stream: the ink goes upstream at c - U, and no faster. */
static void in_a_slower_stream_ink_goes_upstream_as_far_as_the_front(void **state) {
  (void)state;
  const char *const half[] = {"let.U=0.125", "domain.origin=[-0.7, -1]", NULL};
  const char *const most[] = {"let.U=0.2", "domain.origin=[-0.5, -1]", NULL};
  const measured a = measure("cone/hc-1.yaml", 0.5, half), b = measure("cone/hc-1.yaml", 0.8, most);
  BELOW(a.transects, 0.06);
  BELOW(b.transects, 0.06);
  BELOW(fabs(a.upstream), 0.02);
  BELOW(fabs(b.upstream), 0.02);
}

/* As long as nothing has reached a wall what is in the box is what came in: a unit a second. */
static void what_came_in_is_in_the_box(void **state) {
  (void)state;
  example e = example_open("cone/scene.yaml", NULL);
  double worst = 0;
  for (int i = 0; i < 60; ++i) {
    OK(cf_sim_step(e.sim, NULL));
    worst = fmax(worst, fabs(example_metric(&e, "sum_phi") / cf_sim_time(e.sim) - 1));
  }
  print_message("sum of phi over t: off by %.1e\n", worst);
  BELOW(worst, 1e-12);
  example_close(&e);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(the_cone_of_a_stream_twice_as_fast_has_30_degrees),
      cmocka_unit_test(the_cone_of_a_stream_sqrt_2_as_fast_has_45_degrees),
      cmocka_unit_test(the_cone_of_a_stream_little_faster_than_the_front_has_60_degrees),
      cmocka_unit_test(in_a_stream_as_fast_as_the_front_nothing_goes_upstream),
      cmocka_unit_test(in_a_slower_stream_ink_goes_upstream_as_far_as_the_front),
      cmocka_unit_test(what_came_in_is_in_the_box),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
