/* SPDX-License-Identifier: MIT
 *
 * examples/laser-pulse: the temperature at the back of the slab against the sum of its modes,
 *
 *     T(L, t) = sum over n of (-1)^n W_n int_0^t h_n(t - s) g(s) ds,    h_n = A_1 exp(l_1 t) + A_2 exp(l_2 t)
 *
 * with Cattaneo's law, for which nothing arrives before L/c and the wave is thrown back and forth, and Fourier's.
 */
#include <complex.h>

#include "example.h"

#define PI 3.14159265358979323846

/* As in slab.yaml. */
static const double D = 0.5 / 4e6, L = 2e-3, rise = 1e4 / 4e6, pulse = 2, depth = 50e-6;

/* Response of a mode to a unit of heat: p' = -s, tau s' = -s + D K^2 p. */
static double response(const double tau, const double K, const double t) {
  if (tau == 0) return exp(-D * K * K * t);
  const double complex root = csqrt(1 - 4 * tau * D * K * K), a = (-1 + root) / (2 * tau),
                       b = (-1 - root) / (2 * tau);
  return creal((a * cexp(b * t) - b * cexp(a * t)) / (a - b));
}

static double folded(const double tau, const double K, const double t) {
  const double end = fmin(t, pulse);
  const int n = 400;
  double sum = 0;
  for (int i = 0; i <= n; ++i) { /* Simpson */
    const double s = end * i / n, g = 2 / pulse * pow(sin(PI * s / pulse), 2);
    sum += (i == 0 || i == n ? 1 : i % 2 == 1 ? 4 : 2) * g * response(tau, K, t - s);
  }
  return sum * end / n / 3;
}

static double exact_at_back(const double tau, const double t) {
  double sum = 0;
  for (int n = 0; n < 240; ++n) {
    const double K = n * PI / L, sign = n % 2 == 0 ? 1 : -1;
    const double shape = (1 - sign * exp(-L / depth)) / (1 + K * K * depth * depth) * (n == 0 ? 1 : 2) / L;
    sum += sign * rise * shape * folded(tau, K, t);
  }
  return sum;
}

static double back_of(const example *e) {
  const cf_view v = example_field(e, "temperature", 0);
  const int n = v.shape[0]; /* on the wall, where the slope is 0 */
  return (9 * view_at(&v, n - 1, 0, 0) - view_at(&v, n - 2, 0, 0)) / 8;
}

static double worst_history(const double tau, const char *const *set) {
  example e = example_open("laser-pulse/slab.yaml", set);
  const double last = rise / L;
  double worst = 0, most = 0, before = 0;
  for (int i = 1; i <= 100; ++i) {
    example_run(&e, i);
    const double T = back_of(&e), exact = exact_at_back(tau, i);
    worst = fmax(worst, fabs(T - exact));
    most = fmax(most, T);
    if (i < 18) before = fmax(before, fabs(T));
    if (i % 10 == 0 || i == 24) print_message("  t = %3d s: %.4f K, exact %.4f K\n", i, T, exact);
  }
  print_message(
      "tau = %g s: worst %.5f K, largest %.3f K of %.3f K at the end, before 18 s %.5f K, ledger %.1e\n", tau,
      worst, most, last, before, example_metric(&e, "error_temperature"));
  BELOW(fabs(example_metric(&e, "error_temperature")), 1e-12);
  CLOSE(example_metric(&e, "sum_temperature") / (L * 10e-6), last, 1e-3 * last);
  if (tau > 0) BELOW(before, 0.001 * last);
  if (tau > 0) assert_true(most > 10 * last);
  if (tau == 0) BELOW(most, last);
  if (tau == 0) assert_true(before > 0.3 * last);
  example_close(&e);
  return worst / most;
}

static void a_wave_of_heat_arrives_late_and_higher_than_it_stays(void **state) {
  (void)state;
  BELOW(worst_history(16, NULL), 0.02);
}

static void with_fourier_the_back_warms_at_once_and_never_too_much(void **state) {
  (void)state;
  BELOW(worst_history(0, (const char *const[]){"diffusion.tau=0", NULL}), 0.002);
}

/* The spot: what is in the slab is what the beam brought; the front is where theory says. */
static void a_spot_sends_its_heat_no_further_than_the_front(void **state) {
  (void)state;
  example e = example_open("laser-pulse/scene.yaml", NULL);
  example_run(&e, INFINITY);
  const cf_view v = example_field(&e, "temperature", 0);
  const double c = sqrt(D / 16), far = c * cf_sim_end(e.sim) + 4e-4; /* four beams, or eight depths */
  double most = 0, beyond = 0;
  for (int j = 0; j < v.shape[1]; ++j)
    for (int i = 0; i < v.shape[0]; ++i) {
      const double T = fabs(view_at(&v, i, j, 0)), r = hypot(view_x(&v, 0, i), view_x(&v, 1, j));
      most = fmax(most, T);
      if (r > far) beyond = fmax(beyond, T);
    }
  print_message("spot: largest %.3f K, beyond the front %.2e K, least %.3f K\n", most, beyond,
                example_metric(&e, "min_temperature"));
  BELOW(beyond, 1e-3 * most);
  CLOSE(example_metric(&e, "sum_temperature"), 20 / 4e6, 4e-3 * 20 / 4e6); /* four cells a depth */
  BELOW(fabs(example_metric(&e, "error_temperature")), 1e-12);
  example_close(&e);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(a_wave_of_heat_arrives_late_and_higher_than_it_stays),
      cmocka_unit_test(with_fourier_the_back_warms_at_once_and_never_too_much),
      cmocka_unit_test(a_spot_sends_its_heat_no_further_than_the_front),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
