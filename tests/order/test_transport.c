/* SPDX-License-Identifier: MIT
 *
 * A release in one dimension whose fronts travel 90 cells (F_T = 0, periodic, 256 cells, Gaussian of w = 7.68 h,
 * tau = 128 h/c): relative L1 error of both schemes against the exact solution, beside the values that an
 * independent implementation of the schemes gave (also with F_T = 0.02).
 */
#include "diffuse_case.h"

enum { CELLS = 256 };
static const double width = 7.68, tau = 128;

static double gauss(const void *context, double x, double y, double z) {
  (void)context, (void)y, (void)z;
  return exp(-0.5 * (x - CELLS / 2) * (x - CELLS / 2) / (width * width));
}

/* Sum over the Fourier modes of the ring. */
static void exact(const double k, const double F, const double t, double *phi) {
  const double pi = acos(-1);
  for (int i = 0; i < CELLS; ++i) phi[i] = width * sqrt(2 * pi) / CELLS;
  for (int m = 1; m < CELLS / 2; ++m) {
    const double K = 2 * pi * m / CELLS;
    double P = 1, Q = 0;
    exact_mode(k, tau, F, K, t, &P, &Q);
    const double weight = 2 * width * sqrt(2 * pi) / CELLS * exp(-0.5 * K * K * width * width) * P;
    for (int i = 0; i < CELLS; ++i) phi[i] += weight * cos(K * (i + 0.5 - CELLS / 2));
  }
}

static double l1_error(const cf_diffuse_scheme scheme, const double F, const double step) {
  diffuse_case c = diffuse_case_of(2, (int[3]){CELLS, 1, 1}, 1);
  const double k = tau / (1 - F); /* c = 1 */
  c.p.k = cf_fn_constant(k);
  c.p.tau = tau;
  c.p.f_t = F;
  c.p.scheme = scheme;
  c.walls.kind[0][0] = c.walls.kind[0][1] = CF_WALL_PERIODIC;
  diffuse_begin(&c);
  diffuse_fill(&c, gauss, NULL);
  diffuse_run(&c, step, (int)lround(90 / step));
  static double phi[CELLS];
  exact(k, F, c.t, phi);
  double error = 0, size = 0;
  for (int i = 0; i < CELLS; ++i) {
    error += fabs(cell_at(&c, i, 0, 0) - phi[i]);
    size += fabs(phi[i]);
  }
  BELOW(fabs(diffuse_ledger_error(&c)), 1e-13);
  diffuse_end(&c);
  return error / size;
}

/* Rounding of the printed values included. */
static void compare(const double error, const double expected, const double unit) {
  if (!(fabs(error - expected) <= 0.05 * expected + 0.5 * unit))
    fail_msg("L1 %.5f, expected %.5f", error, expected);
}

static void errors_are_those_of_the_schemes(void **state) {
  (void)state;
  const double steps[] = {0.5, 1, 2}, paper[] = {.192, .308, .456}, sdirk2[] = {.0109, .0171, .0417};
  const double paper_f[] = {.0475, .087, .151}, sdirk2_f[] = {.0009, .0014, .0034};
  print_message(
      "c dt/h    paper (expected)   sdirk2 (expected)   F = .02: paper (expected)   sdirk2 (expected)\n");
  for (int i = 0; i < 3; ++i) {
    const double e[] = {l1_error(CF_DIFFUSE_PAPER, 0, steps[i]), l1_error(CF_DIFFUSE_SDIRK2, 0, steps[i]),
                        l1_error(CF_DIFFUSE_PAPER, 0.02, steps[i]),
                        l1_error(CF_DIFFUSE_SDIRK2, 0.02, steps[i])};
    print_message("%5g   %.4f (%.4f)     %.4f (%.4f)              %.4f (%.4f)   %.5f (%.4f)\n", steps[i],
                  e[0], paper[i], e[1], sdirk2[i], e[2], paper_f[i], e[3], sdirk2_f[i]);
    compare(e[0], paper[i], 1e-3);
    compare(e[1], sdirk2[i], 1e-4);
    compare(e[2], paper_f[i], 1e-3);
    compare(e[3], sdirk2_f[i], 1e-4);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(errors_are_those_of_the_schemes)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
