/* SPDX-License-Identifier: MIT
 *
 * A Gaussian release in the plane and in space (radial_gauss.csv, radial_minima.csv): profiles to 2 % of the largest
 * value at w = 8 h, and the trough below zero, which belongs to the exact solution and must neither be clipped nor
 * deepened. Insulated walls through the centre leave a quadrant or an octant to compute.
 */
#include "diffuse_case.h"
#include "reference.h"

static double gauss(const void *context, double x, double y, double z) {
  const double w = *(const double *)context;
  return exp(-0.5 * (x * x + y * y + z * z) / (w * w));
}

/* Along the diagonal of the cells and along x: even about 0 and smooth, so a parabola through three cells serves. */
static double on_axis(const diffuse_case *c, const double x) {
  const double s = x / c->g.h - 0.5;
  const int i = (int)fmin(floor(s + 0.5), c->g.box.n[0] - 2);
  const double u = s - i;
  double v[3];
  for (int m = -1; m <= 1; ++m) {
    /* the axis itself lies on the walls y = z = 0: extrapolate evenly from the first two rows of cells */
    const int k1 = c->g.box.dim == 3 ? 1 : 0, at = i + m < 0 ? -1 - (i + m) : i + m;
    const double near = cell_at(c, at, 0, 0), in_y = cell_at(c, at, 1, 0), in_z = cell_at(c, at, 0, k1);
    v[m + 1] = near + (near - in_y) / 8 + (k1 ? (near - in_z) / 8 : 0);
  }
  return v[1] + 0.5 * u * (v[2] - v[0]) + 0.5 * u * u * (v[2] - 2 * v[1] + v[0]);
}

static void compare(const int dim, const double F, const double time, const double reach, const double cfl,
                    const double allowed) {
  table t = table_read("radial_gauss.csv"), m = table_read("radial_minima.csv");
  int row = 0, minima = 0;
  while (!(table_at(&t, row, "d") == dim && table_at(&t, row, "F") == F && table_at(&t, row, "t") == time))
    ++row;
  while (!(table_at(&m, minima, "d") == dim && table_at(&m, minima, "F") == F &&
           table_at(&m, minima, "t") == time))
    ++minima;
  const double w = table_at(&t, row, "w"), h = w / 8, k = table_at(&t, row, "k"),
               tau = table_at(&t, row, "tau");
  const int n = (int)ceil(reach / h);
  diffuse_case c = diffuse_case_of(dim, (int[3]){n, n, n}, h);
  c.p.k = cf_fn_constant(k);
  c.p.tau = tau;
  c.p.f_t = F;
  c.p.solver.tolerance = 1e-6;
  diffuse_begin(&c);
  diffuse_fill(&c, gauss, &w);
  const int steps = (int)ceil(time * sqrt(k / tau) / (cfl * h));
  diffuse_run(&c, time / steps, steps);
  const double least = table_at(&m, minima, "min_phi"), most = table_at(&m, minima, "max_phi");
  const double peak = fmax(most, -least);
  double worst = 0, low = INFINITY, r_low = 0;
  for (; row < t.rows && table_at(&t, row, "t") == time && table_at(&t, row, "d") == dim; ++row) {
    const double r = table_at(&t, row, "r");
    if (r > reach - 0.1) break;
    worst = fmax(worst, fabs(on_axis(&c, r) - table_at(&t, row, "phi")));
  }
  for (double r = 0; r < reach - 0.1; r += 0.25 * h)
    if (on_axis(&c, r) < low) low = on_axis(&c, r), r_low = r;
  print_message(
      "%dD F = %-4g t = %-3g: worst %.2f %% of %.3f; trough %.4f (%.4f) at %.3f (%.3f); %d steps of %d "
      "cells\n",
      dim, F, time, 100 * worst / peak, peak, low, least, r_low, table_at(&m, minima, "r_at_min"), steps, n);
  BELOW(worst / peak, allowed);
  BELOW(fabs(low - least) / peak, allowed);
  if (-least > 0.05 * peak) BELOW(fabs(r_low - table_at(&m, minima, "r_at_min")), 2 * h);
  BELOW(fabs(diffuse_ledger_error(&c)), 1e-12);
  diffuse_end(&c);
  table_free(&t);
  table_free(&m);
}

static void a_release_in_the_plane_follows_the_exact_solution(void **state) {
  (void)state;
  const double F[] = {0, 0.02, 0.1};
  for (int i = 0; i < 3; ++i) {
    compare(2, F[i], 0.3, i == 2 ? 0.75 : 0.5, 0.25, 0.02);
    compare(2, F[i], 1.0, i == 0 ? 0.75 : 1.0, 0.25, 0.02);
  }
}

static void a_release_in_space_follows_the_exact_solution(void **state) {
  (void)state;
  compare(3, 0, 0.3, 0.42, 0.5, 0.02);
  compare(3, 0.1, 0.3, 0.55, 0.5, 0.02);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(a_release_in_the_plane_follows_the_exact_solution),
      cmocka_unit_test(a_release_in_space_follows_the_exact_solution),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
