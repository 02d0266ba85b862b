/* SPDX-License-Identifier: MIT
 *
 * Standing modes against the exact solution (modes_exact.csv): the default is of second order in h and dt together
 * and in each alone, the paper's scheme of first order in dt. Uniformly in tau: from 1e-8 (where the equation is
 * Fourier's) to 1e4 (where it is the wave equation).
 */
#include "diffuse_case.h"
#include "reference.h"

typedef struct mode {
  double k, tau, F, L, K;
} mode;

static double cosine(const void *context, double x, double y, double z) {
  (void)y, (void)z;
  return cos(((const mode *)context)->K * x);
}

/* Amplitudes of phi and q at time t, from 1 and 0. */
static void run(const mode *m, const cf_diffuse_scheme scheme, const int n, const int steps, const double t,
                double *P, double *Q) {
  diffuse_case c = diffuse_case_of(2, (int[3]){n, 1, 1}, m->L / n);
  c.p.k = cf_fn_constant(m->k);
  c.p.tau = m->tau;
  c.p.f_t = m->F;
  c.p.scheme = scheme;
  diffuse_begin(&c);
  diffuse_fill(&c, cosine, m);
  diffuse_run(&c, t / steps, steps);
  *P = *Q = 0;
  for (int i = 0; i < n; ++i) *P += 2.0 / n * cell_at(&c, i, 0, 0) * cos(m->K * cf_grid_place(&c.g, 0, i, 0));
  for (int i = 1; i < n; ++i) *Q += 2.0 / n * (double)c.q.at[0][i] * sin(m->K * cf_grid_place(&c.g, 0, i, 1));
  diffuse_end(&c);
}

static double error(const mode *m, const cf_diffuse_scheme scheme, const int n, const int steps,
                    const double t, const double P, const double Q) {
  double p, q;
  run(m, scheme, n, steps, t, &p, &q);
  const double speed = m->tau > 0 && m->F < 1 ? sqrt((1 - m->F) * m->k / m->tau) : 1;
  return hypot(p - P, m->tau < 1e-3 ? 0 : (q - Q) / speed); /* both in units of phi */
}

static mode mode_of(const table *t, const int row) {
  mode m = {table_at(t, row, "k"), table_at(t, row, "tau"), table_at(t, row, "F"), table_at(t, row, "L"), 0};
  m.K = table_at(t, row, "m") * acos(-1) / m.L;
  return m;
}

static void modes_converge_to_the_reference(void **state) {
  (void)state;
  table t = table_read("modes_exact.csv");
  double least_sdirk2 = 9, least_paper = 9;
  for (int row = 0; row < t.rows; ++row) {
    const mode m = mode_of(&t, row);
    const double time = table_at(&t, row, "t"), P = table_at(&t, row, "phi_hat"),
                 Q = table_at(&t, row, "qC_hat");
    double p = 1, q = 0;
    exact_mode(m.k, m.tau, m.F, m.K, time, &p, &q);
    CLOSE(p, P, 1e-12);
    if (m.F < 1) CLOSE(q, Q, 1e-12);
    const int n = 128, steps = 64;
    const double sdirk2 = order_of(error(&m, CF_DIFFUSE_SDIRK2, n, steps, time, P, m.F < 1 ? Q : 0),
                                   error(&m, CF_DIFFUSE_SDIRK2, 2 * n, 2 * steps, time, P, m.F < 1 ? Q : 0));
    /* h so small that dt alone shows */
    const double paper = order_of(error(&m, CF_DIFFUSE_PAPER, 1024, 5 * steps, time, P, m.F < 1 ? Q : 0),
                                  error(&m, CF_DIFFUSE_PAPER, 1024, 10 * steps, time, P, m.F < 1 ? Q : 0));
    if (sdirk2 < 1.9 || paper < 0.95) print_message("row %d: sdirk2 %.3f, paper %.3f\n", row, sdirk2, paper);
    least_sdirk2 = fmin(least_sdirk2, sdirk2);
    least_paper = fmin(least_paper, paper);
  }
  print_message("modes_exact: least order %.3f (sdirk2, h and dt), %.3f (paper, dt)\n", least_sdirk2,
                least_paper);
  BELOW(1.9, least_sdirk2);
  BELOW(0.95, least_paper);
  table_free(&t);
}

/* On one grid, against the solution that is exact in time on that grid. */
static double order_in_dt(const mode *m, const cf_diffuse_scheme scheme, const int n, const int steps,
                          const double t, double *last) {
  const double h = m->L / n, kap = 2 / h * sin(m->K * h / 2);
  double P = 1, Q = 0;
  exact_mode(m->k, m->tau, m->F, kap, t, &P, &Q);
  const double coarse = error(m, scheme, n, steps, t, P, Q), fine = error(m, scheme, n, 2 * steps, t, P, Q);
  *last = fine;
  return order_of(coarse, fine);
}

static void orders_in_dt_and_h_alone(void **state) {
  (void)state;
  table t = table_read("modes_exact.csv");
  double in_dt = 9, in_dt_paper = 9, in_h = 9, last;
  for (int row = 0; row < t.rows; row += 5) {
    const mode m = mode_of(&t, row);
    in_dt = fmin(in_dt, order_in_dt(&m, CF_DIFFUSE_SDIRK2, 64, 200, 1, &last));
    in_dt_paper = fmin(in_dt_paper, order_in_dt(&m, CF_DIFFUSE_PAPER, 64, 400, 1, &last));
    double P = 1, Q = 0;
    exact_mode(m.k, m.tau, m.F, m.K, 1, &P, &Q);
    if (m.F == 1) Q = 0;
    const double coarse = error(&m, CF_DIFFUSE_SDIRK2, 24, 4000, 1, P, Q);
    in_h = fmin(in_h, order_of(coarse, error(&m, CF_DIFFUSE_SDIRK2, 48, 4000, 1, P, Q)));
  }
  print_message("orders alone: sdirk2 %.3f in dt, %.3f in h; paper %.3f in dt\n", in_dt, in_h, in_dt_paper);
  BELOW(1.9, in_dt);
  BELOW(1.9, in_h);
  BELOW(0.95, in_dt_paper);
  table_free(&t);
}

/* k = 0.02 held, tau to 0: the same orders and the same errors as Fourier's equation. */
static void small_tau_is_fourier_to_the_error_constant(void **state) {
  (void)state;
  const double pi = acos(-1), taus[] = {0, 1e-8, 1e-6, 1e-4, 1e-2, 1};
  double fourier[2] = {0, 0}, e;
  for (int i = 0; i < 6; ++i) {
    const mode m = {0.02, taus[i], 0, 1, 4 * pi};
    const double paper = order_in_dt(&m, CF_DIFFUSE_PAPER, 64, 160, 1, &e);
    if (i == 0) fourier[0] = e;
    if (i == 1) CLOSE(e / fourier[0], 1, 1e-4);
    const double sdirk2 = order_in_dt(&m, CF_DIFFUSE_SDIRK2, 64, 160, 1, &e);
    if (i == 0) fourier[1] = e;
    if (i == 1) CLOSE(e / fourier[1], 1, 1e-2);
    print_message("tau %-6g orders %.3f (paper) %.3f (sdirk2)\n", taus[i], paper, sdirk2);
    CLOSE(paper, 1, 0.05);
    CLOSE(sdirk2, 2, 0.1);
  }
}

/* c = 0.2 held, tau to infinity. */
static void large_tau_is_the_wave_equation(void **state) {
  (void)state;
  const double pi = acos(-1), taus[] = {1e-3, 1e-2, 0.1, 1, 10, 1e2, 1e4};
  double e;
  for (int i = 0; i < 7; ++i) {
    const mode m = {0.04 * taus[i], taus[i], 0, 1, 4 * pi};
    const double sdirk2 = order_in_dt(&m, CF_DIFFUSE_SDIRK2, 64, 320, 1, &e);
    print_message("tau %-6g k %-6g order %.3f, error %.2e\n", taus[i], m.k, sdirk2, e);
    BELOW(1.7, sdirk2);
    BELOW(e, 1e-3);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(modes_converge_to_the_reference),
      cmocka_unit_test(orders_in_dt_and_h_alone),
      cmocka_unit_test(small_tau_is_fourier_to_the_error_constant),
      cmocka_unit_test(large_tau_is_the_wave_equation),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
