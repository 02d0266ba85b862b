/* SPDX-License-Identifier: MIT
 *
 * The fast path, where coefficients are numbers: cycles that depend neither on the right side nor on walls or extents,
 * and reports that are true.
 */
#include <string.h>

#include "solve_case.h"

static const double sigmas[] = {0.25, 1, 4, 16, 100, 1e4, INFINITY};
enum { SIGMAS = sizeof sigmas / sizeof *sigmas };

typedef struct outcome {
  cf_solve_report report;
  double residual;
} outcome;

static outcome solve(const solve_case *c, const double tolerance) {
  solve_setup s;
  outcome o;
  case_begin(c, &s);
  OK(cf_helmholtz_solve(s.A, s.b, &(cf_solve_options){tolerance, 100}, s.x, &o.report));
  o.residual = cf_helmholtz_residual(s.A, s.x, s.b);
  case_end(&s);
  return o;
}

static void few_cycles_for_any_right_side_and_walls(void **state) {
  (void)state;
  static const char *const walls[2][5] = {{"ii", "oo", "pp", "io", "hp"},
                                          {"iii", "ooo", "ppp", "ipo", "hgi"}};
  for (int dim = 2; dim <= 3; ++dim)
    for (int side = SIDE_SMOOTH; side <= SIDE_MIXED; ++side) {
      print_message("%dD, side %d:", dim, side);
      for (int s = 0; s < SIGMAS; ++s) {
        int most = 0;
        for (int w = 0; w < 5; ++w) {
          solve_case c = {
              .dim = dim, .n = {dim == 2 ? 192 : 48, dim == 2 ? 160 : 40, 56}, .walls = walls[dim - 2][w]};
          c.sigma = sigmas[s];
          c.side = (case_side)side;
          c.threads = 1;
          const outcome o = solve(&c, 1e-6);
          assert_true(o.report.converged);
          BELOW(o.residual, 1.01e-6);
          BELOW(o.report.iterations, c.sigma < 1.5 ? 2 : 4);
          if (o.report.iterations > most) most = o.report.iterations;
        }
        print_message(" %d", most);
      }
      print_message("\n");
    }
}

static void half_sweeps_alone_where_diffusion_is_small(void **state) {
  (void)state;
  const struct {
    double sigma;
    const char *method;
  } expected[] = {{1e-3, "sor"}, {0.25, "sor"}, {1.5, "sor"}, {2, "multigrid"}, {1e6, "multigrid"}};
  for (int v = 0; v < 5; ++v) {
    const solve_case c = {.dim = 3, .n = {24, 24, 24}, .walls = "iii", .sigma = expected[v].sigma};
    const outcome o = solve(&c, 1e-6);
    assert_string_equal(o.report.method, expected[v].method);
    assert_true((o.report.levels == 1) == (strcmp(o.report.method, "sor") == 0));
  }
}

/* Residual and correction are single: they alone reach about 1e-8. */
static void ten_digits_take_less_than_twice_the_cycles(void **state) {
  (void)state;
  for (int s = 0; s < SIGMAS; ++s) {
    const solve_case c = {
        .dim = 3, .n = {40, 48, 32}, .walls = "iio", .sigma = sigmas[s], .side = SIDE_MIXED};
    const outcome rough = solve(&c, 1e-6), fine = solve(&c, 1e-10);
    assert_true(fine.report.converged);
    BELOW(fine.residual, 1.01e-10);
    BELOW(fine.report.iterations, 2 * rough.report.iterations);
  }
}

/* What is reported is what there is, also where x cannot hold a better solution. */
static void reports_are_true(void **state) {
  (void)state;
  const int extent[][3] = {{32, 32, 32}, {4, 4, 1024}, {128, 96, 1}};
  for (int q = 0; q < 3; ++q)
    for (double sigma = 1e2; sigma < 1e15; sigma *= 1e3) {
      const solve_case c = {.dim = q < 2 ? 3 : 2,
                            .n = {extent[q][0], extent[q][1], extent[q][2]},
                            .walls = q < 2 ? "iii" : "ii",
                            .sigma = sigma > 1e13 ? INFINITY : sigma,
                            .side = SIDE_MIXED};
      const outcome o = solve(&c, 1e-6);
      if (o.report.converged) BELOW(o.residual, sizeof(cf_real) == sizeof(double) ? 1.01e-6 : 1.3e-2);
      if (!o.report.converged) CLOSE(o.report.residual, o.residual, 0.3 * o.residual);
    }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(few_cycles_for_any_right_side_and_walls),
      cmocka_unit_test(half_sweeps_alone_where_diffusion_is_small),
      cmocka_unit_test(ten_digits_take_less_than_twice_the_cycles),
      cmocka_unit_test(reports_are_true),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
