/* SPDX-License-Identifier: MIT
 *
 * examples/smoke-cone: the half-angle of the cone in the slice z = 0, beside asin(1/H_c) and beside what the exact solution
 * of the same source at the same time gives; and how far smoke gets upstream.
 */
#include "example.h"
#include "reference.h"

#define PI 3.14159265358979323846

/* In the slice between the two middle layers. */
static double slice_at(const cf_view *v, const int i, const int j) {
  const int k = v->shape[2] / 2;
  return (view_at(v, i, j, k) + view_at(v, i, j, k - 1)) / 2;
}

/* Outwards from the axis at station i: where phi has fallen to half of the outermost maximum above a fifth of the largest. */
static double edge_at(const cf_view *v, const int i, const int side) {
  const int half = v->shape[1] / 2, start = side > 0 ? half : half - 1;
  double largest = -INFINITY;
  int ridge = -1, where = 0;
  for (int n = 0; n < half; ++n)
    if (slice_at(v, i, start + side * n) > largest) largest = slice_at(v, i, start + side * n), where = n;
  for (int n = 1; n < half - 1; ++n) {
    const double here = slice_at(v, i, start + side * n);
    if (here >= slice_at(v, i, start + side * (n - 1)) && here > slice_at(v, i, start + side * (n + 1)) &&
        here > 0.2 * largest)
      ridge = n;
  }
  if (ridge < 0) ridge = where;
  const double level = slice_at(v, i, start + side * ridge) / 2;
  int n = ridge;
  while (n + 1 < half && slice_at(v, i, start + side * (n + 1)) > level) ++n;
  assert_true(n + 1 < half);
  const double inner = slice_at(v, i, start + side * n), outer = slice_at(v, i, start + side * (n + 1));
  return fabs(view_x(v, 1, start + side * n)) + (inner - level) / (inner - outer) * v->h;
}

/* Row of the reference: what the exact solution gives, measured in the same way. */
static void cone(const char *H, const int row) {
  table t = table_read("plume_angles_3d.csv");
  const double from = table_at(&t, row, "fit_x1"), to = table_at(&t, row, "fit_x2");
  const double angle = table_at(&t, row, "measured_deg"), theory = table_at(&t, row, "asin_deg");
  table_free(&t);
  char set[64];
  double n = 0, sx = 0, sy = 0, sxx = 0, sxy = 0, largest = 0, upstream = 0;
  snprintf(set, sizeof set, "let.H=%s", H);
  example e = example_open("smoke-cone/scene.yaml", (const char *const[]){set, NULL});
  example_run(&e, INFINITY);
  const cf_view v = example_field(&e, "phi", 0);
  for (int i = 0; i < v.shape[0]; ++i) {
    const double x = view_x(&v, 0, i), middle = slice_at(&v, i, v.shape[1] / 2);
    largest = fmax(largest, middle);
    if (x < -0.1) upstream = fmax(upstream, fabs(middle));
    if (x < from || x > to) continue;
    for (int side = -1; side <= 1; side += 2) {
      const double edge = edge_at(&v, i, side);
      n += 1, sx += x, sy += edge, sxx += x * x, sxy += x * edge;
    }
  }
  const double found = atan((n * sxy - sx * sy) / (n * sxx - sx * sx)) * 180 / PI;
  print_message(
      "H_c = %s: %.2f degrees, exactly %.2f, a point for ever %.2f; upstream %.1e of the largest value\n", H,
      found, angle, theory, upstream / largest);
  CLOSE(found, angle, 0.5);
  CLOSE(found, theory, 0.5);
  BELOW(upstream, 0.01 * largest);
  example_close(&e);
}

static void smoke_stays_in_its_cone(void **state) {
  (void)state;
  cone("3", 0);
  cone("2", 1);
  cone("sqrt(2)", 2);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(smoke_stays_in_its_cone)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
