/* SPDX-License-Identifier: MIT
 *
 * The second moment of a release grows by an exact law, whatever its shape and on any grid: for the paper's scheme
 * a discrete law to round-off (variance_law_discrete_be.csv), for both schemes the continuous one with their order
 * (variance_law.csv). Walls are far away. In 2D and 3D it holds for every axis.
 */
#include "diffuse_case.h"
#include "reference.h"

/* Two unequal lumps: the law asks for no symmetry. The context: centre, width, axes. */
static double lumps(const void *context, double x, double y, double z) {
  const double *at = context, s = at[1];
  const double u = (x - at[0]) / s, v = at[2] > 1 ? (y - at[0]) / s : 0, w = at[2] > 2 ? (z - at[0]) / s : 0;
  const double d = u - 0.7;
  return exp(-0.5 * (u * u + v * v + w * w)) + 0.4 * exp(-2 * (d * d + v * v + w * w));
}

/* Mass, centre and variance along an axis. */
static void moments(const diffuse_case *c, const int axis, double m[3]) {
  double sum[3] = {0, 0, 0};
  for (int pass = 0; pass < 2; ++pass)
    for (int k = 0; k < c->g.box.n[2]; ++k)
      for (int j = 0; j < c->g.box.n[1]; ++j)
        for (int i = 0; i < c->g.box.n[0]; ++i) {
          const int at[3] = {i, j, k};
          const double phi = cell_at(c, i, j, k), x = cf_grid_place(&c->g, axis, at[axis], 0);
          if (pass == 0)
            sum[0] += phi, sum[1] += phi * x;
          else
            sum[2] += phi * (x - sum[1] / sum[0]) * (x - sum[1] / sum[0]);
        }
  m[0] = sum[0];
  m[1] = sum[1] / sum[0];
  m[2] = sum[2] / sum[0];
}

static void begin(const table *t, const int row, const int dim, const int n, const double dt, double at[3],
                  diffuse_case *run) {
  const double k = table_at(t, row, "k"), tau = table_at(t, row, "tau"), F = table_at(t, row, "F");
  const double reach = sqrt(k * dt * (dt + F * tau) / (dt + tau)), spread = sqrt(20 * k * dt);
  const double L = dim == 1 ? 100 * reach + 16 * spread : 24 * reach + 5 * spread;
  const int d = dim == 1 ? 2 : dim;
  *run = diffuse_case_of(d, (int[3]){n, dim == 1 ? 1 : n, n}, L / n);
  run->p.k = cf_fn_constant(k);
  run->p.tau = tau;
  run->p.f_t = F;
  run->p.scheme = CF_DIFFUSE_PAPER;
  diffuse_begin(run);
  at[0] = 0.5 * L, at[1] = 0.02 * L, at[2] = dim;
  diffuse_fill(run, lumps, at);
}

static void the_papers_scheme_obeys_the_discrete_law(void **state) {
  (void)state;
  table t = table_read("variance_law_discrete_be.csv");
  int compared = 0;
  for (int row = 0; row < t.rows; row += 10) {
    const double dt = table_at(&t, row, "dt");
    double at[3], first[3], now[3];
    diffuse_case c;
    begin(&t, row, 1, 1500, dt, at, &c);
    moments(&c, 0, first);
    for (int n = 0; n < 10; ++n) {
      diffuse_run(&c, dt, 1);
      moments(&c, 0, now);
      assert_int_equal((int)table_at(&t, row + n, "n"), n + 1);
      CLOSE(now[2] - first[2], table_at(&t, row + n, "variance_increase_per_axis"), 1e-10);
      CLOSE(now[0] / first[0], 1, 1e-12);
      CLOSE((now[1] - first[1]) / at[0], 0, 1e-12);
      ++compared;
    }
    diffuse_end(&c);
  }
  assert_int_equal(compared, 180);
  table_free(&t);
}

static void the_discrete_law_holds_for_every_axis(void **state) {
  (void)state;
  table t = table_read("variance_law_discrete_be.csv");
  for (int dim = 2; dim <= 3; ++dim)
    for (int row = 10; row < t.rows; row += 60) {
      const double dt = table_at(&t, row, "dt");
      double at[3], first[3][3], now[3];
      diffuse_case c;
      begin(&t, row, dim, dim == 2 ? 120 : 40, dt, at, &c);
      for (int a = 0; a < dim; ++a) moments(&c, a, first[a]);
      for (int n = 0; n < 3; ++n) {
        diffuse_run(&c, dt, 1);
        const double law = table_at(&t, row + n, "variance_increase_per_axis");
        for (int a = 0; a < dim; ++a) {
          moments(&c, a, now);
          CLOSE((now[2] - first[a][2]) / law, 1, 1e-6);
        }
      }
      diffuse_end(&c);
    }
  table_free(&t);
}

static double growth_error(const table *t, const int row, const cf_diffuse_scheme scheme, const int steps) {
  const double k = table_at(t, row, "k"), tau = table_at(t, row, "tau"), F = table_at(t, row, "F");
  const double time = table_at(t, row, "t"), L = 100 * sqrt(k * time);
  diffuse_case c = diffuse_case_of(2, (int[3]){1200, 1, 1}, L / 1200);
  c.p.k = cf_fn_constant(k);
  c.p.tau = tau;
  c.p.f_t = F;
  c.p.scheme = scheme;
  diffuse_begin(&c);
  const double at[3] = {0.5 * L, 0.01 * L, 1};
  double first[3], now[3];
  diffuse_fill(&c, lumps, at);
  moments(&c, 0, first);
  diffuse_run(&c, time / steps, steps);
  moments(&c, 0, now);
  diffuse_end(&c);
  return fabs(now[2] - first[2] - table_at(t, row, "variance_increase_per_axis"));
}

/* Fourier's variance grows linearly and is exact at any order: rows with F = 1 or tau = 0 show no error to shrink. */
static void both_schemes_converge_to_the_continuous_law(void **state) {
  (void)state;
  table t = table_read("variance_law.csv");
  double paper = 9, sdirk2 = 9;
  for (int row = 0; row < t.rows; ++row) {
    const double law = table_at(&t, row, "variance_increase_per_axis");
    if (table_at(&t, row, "F") == 1 || table_at(&t, row, "tau") < 1e-3) {
      BELOW(growth_error(&t, row, CF_DIFFUSE_SDIRK2, 32) / law, 1e-5);
      continue;
    }
    const double p =
        order_of(growth_error(&t, row, CF_DIFFUSE_PAPER, 32), growth_error(&t, row, CF_DIFFUSE_PAPER, 64));
    const double s =
        order_of(growth_error(&t, row, CF_DIFFUSE_SDIRK2, 32), growth_error(&t, row, CF_DIFFUSE_SDIRK2, 64));
    paper = fmin(paper, p);
    sdirk2 = fmin(sdirk2, s);
  }
  print_message("variance law: least order %.3f (paper), %.3f (sdirk2)\n", paper, sdirk2);
  BELOW(0.95, paper);
  BELOW(1.9, sdirk2);
  table_free(&t);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(the_papers_scheme_obeys_the_discrete_law),
      cmocka_unit_test(the_discrete_law_holds_for_every_axis),
      cmocka_unit_test(both_schemes_converge_to_the_continuous_law),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
