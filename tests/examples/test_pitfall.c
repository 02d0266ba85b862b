/* SPDX-License-Identifier: MIT
 *
 * examples/pitfall: wave speeds in a moving medium. With flux and scalar both carried along (eqs 1, 6 to 10) the
 * exponents of a mode exp(iKx + st) are those at rest, less iKV, and the fronts move with V +- c. Appendix A's single
 * equation, tau d/dt(D phi/Dt) + D phi/Dt = k phi_xx, has with D = s + iKV
 *
 *     tau D^2 + (1 - i tau K V) D + k K^2 = 0,    fronts V/2 +- sqrt(V^2/4 + c^2)
 *
 * (the appendix prints (1/2) sqrt(V^2 - 4 c^2), with the wrong sign and without V/2). Both are run and measured.
 * And Appendix B: the Jacobian of the flux G of eq. 19 along any direction n has the eigenvalues u.n, u.n +- c and 0.
 */
#include <complex.h>

#include "example.h"

#define PI 3.14159265358979323846

static const double k = 0.02, tau = 0.5; /* of line.yaml; checked below */

typedef double complex number;

/* The two exponents s of a mode. */
static void exponents(const int single, const double K, const double V, number s[2]) {
  const number b = single ? 1 - I * tau * K * V : 1, root = csqrt(b * b - 4 * tau * k * K * K);
  for (int i = 0; i < 2; ++i) s[i] = (-b + (i == 0 ? root : -root)) / (2 * tau) - I * K * V;
}

/* phi of the mode that starts as exp(iKx) with no flux: D phi/Dt = 0 at the start, so phi' = -iKV. */
static number mode_at(const int single, const double K, const double V, const double t) {
  number s[2];
  exponents(single, K, V, s);
  const number a = (-I * K * V - s[1]) / (s[0] - s[1]);
  return a * cexp(s[0] * t) + (1 - a) * cexp(s[1] * t);
}

/* The coefficient of exp(iKx), doubled, for a real field. */
static number coefficient(const cf_view *v, const double K) {
  number sum = 0;
  for (int i = 0; i < v->shape[0]; ++i) sum += view_at(v, i, 0, 0) * cexp(-I * K * view_x(v, 0, i));
  return 2 * sum / v->shape[0];
}

static double worst_mode(const int single, const double V) {
  char set[40];
  const double K = 4 * PI;
  snprintf(set, sizeof set, "let.V=%.17g", V);
  example e = example_open("pitfall/line.yaml",
                           (const char *const[]){set, single ? "diffusion.flux_rate=partial" : NULL, NULL});
  double worst = 0;
  for (int i = 1; i <= 20; ++i) {
    example_run(&e, 0.05 * i);
    const cf_view v = example_field(&e, "phi", 0);
    worst = fmax(worst, cabs(coefficient(&v, K) - mode_at(single, K, V, cf_sim_time(e.sim))));
  }
  example_close(&e);
  return worst;
}

static void both_models_move_a_mode_as_their_theory_says(void **state) {
  (void)state;
  for (int i = 0; i < 3; ++i) {
    const double V = (const double[]){0.1, 0.3, 1}[i], two = worst_mode(0, V), one = worst_mode(1, V);
    print_message("V = %g: two fields off by %.1e, the single equation by %.1e\n", V, two, one);
    BELOW(two, 1e-3);
    BELOW(one, 1e-3);
  }
}

static void the_theory_is_that_of_the_table(void **state) {
  (void)state;
  table t = table_read("moving_dispersion.csv");
  for (int r = 0; r < t.rows; ++r) {
    const double K = table_at(&t, r, "K"), V = table_at(&t, r, "V");
    static const char *const column[2][2] = {{"two_phase_plus", "two_phase_minus"},
                                             {"single_phase_plus", "single_phase_minus"}};
    for (int single = 0; single < 2; ++single) {
      number s[2];
      exponents(single, K, V, s);
      const double speed[2] = {-cimag(s[0]) / K, -cimag(s[1]) / K};
      CLOSE(fmax(speed[0], speed[1]), table_at(&t, r, column[single][0]), 1e-9);
      CLOSE(fmin(speed[0], speed[1]), table_at(&t, r, column[single][1]), 1e-9);
    }
    const double c = sqrt(k / tau), half = sqrt(V * V + 4 * c * c) / 2;
    CLOSE(table_at(&t, r, "single_char_plus"), V / 2 + half, 1e-12);
    CLOSE(table_at(&t, r, "single_char_minus"), V / 2 - half, 1e-12);
    CLOSE(table_at(&t, r, "V_plus_c"), V + c, 1e-12);
  }
  table_free(&t);
}

/* Where, on the axis of the stream, |phi| is first and last above a share of its largest value. */
static void reach(const char *rate, double edge[2]) {
  example e = example_open("pitfall/scene.yaml", (const char *const[]){rate, NULL});
  example_run(&e, INFINITY);
  const cf_view v = example_field(&e, "phi", 0);
  const int j = v.shape[1] / 2;
  double most = 0;
  for (int i = 0; i < v.shape[0]; ++i) most = fmax(most, fabs(view_at(&v, i, j, 0)));
  edge[0] = NAN;
  for (int i = 0; i < v.shape[0]; ++i) {
    if (fabs(view_at(&v, i, j, 0)) < 0.01 * most) continue;
    if (isnan(edge[0])) edge[0] = view_x(&v, 0, i);
    edge[1] = view_x(&v, 0, i);
  }
  print_message("%s: ink from %.3f to %.3f\n", rate, edge[0], edge[1]);
  example_close(&e);
}

/* Beyond the fronts, 3 w of a Gaussian are above a hundredth. */
static void only_the_single_equation_sends_ink_upstream(void **state) {
  (void)state;
  double two[2], one[2];
  const double V = 0.5, c = 0.2, w = 0.03, half = sqrt(V * V + 4 * c * c) / 2;
  reach("diffusion.flux_rate=objective", two);
  reach("diffusion.flux_rate=partial", one);
  CLOSE(two[0], V - c - 3 * w, 1.2 * w);
  CLOSE(two[1], V + c + 3 * w, 1.2 * w);
  CLOSE(one[0], V / 2 - half - 3 * w, 1.2 * w);
  CLOSE(one[1], V / 2 + half + 3 * w, 1.2 * w);
  assert_true(V / 2 - half < 0 && one[0] < -2 * w && two[0] > 0);
}

/* --- Appendix B ------------------------------------------------------------------------------------------------- */

enum { STATE = 7 };

/* Column `axis` of G, from U = (phi, 0, 0, 0, tau q_C); q_F is given. Row 2, column 3 is 0 (the appendix prints
 * F_T k phi there). */
static void flux_of(const double *U, const double *u, const double f_t, const int axis, double *G) {
  static const double q_F[3] = {0.3, -0.2, 0.7};
  for (int r = 0; r < STATE; ++r) G[r] = 0;
  G[0] = u[axis] * U[0] + q_F[axis] + U[4 + axis] / tau;
  G[1 + axis] = f_t * k * U[0];
  for (int b = 0; b < 3; ++b) G[4 + b] = U[4 + b] * u[axis] + (b == axis ? (1 - f_t) * k * U[0] : 0);
}

/* A.n by differences; G is linear in U, so they are exact. */
static void jacobian(const double *u, const double f_t, const double *n, double A[STATE][STATE]) {
  const double here[STATE] = {0.4, 0, 0, 0, 0.1, -0.3, 0.2};
  for (int column = 0; column < STATE; ++column) {
    double there[STATE], G[2][STATE];
    memcpy(there, here, sizeof there);
    there[column] += 1;
    for (int r = 0; r < STATE; ++r) A[r][column] = 0;
    for (int axis = 0; axis < 3; ++axis) {
      flux_of(here, u, f_t, axis, G[0]);
      flux_of(there, u, f_t, axis, G[1]);
      for (int r = 0; r < STATE; ++r) A[r][column] += n[axis] * (G[1][r] - G[0][r]);
    }
  }
}

static double determinant(double A[STATE][STATE]) {
  double product = 1;
  for (int p = 0; p < STATE; ++p) {
    int best = p;
    for (int r = p; r < STATE; ++r)
      if (fabs(A[r][p]) > fabs(A[best][p])) best = r;
    if (A[best][p] == 0) return 0;
    for (int c = 0; c < STATE; ++c) {
      const double kept = A[p][c];
      A[p][c] = A[best][c];
      A[best][c] = kept;
    }
    product *= best == p ? A[p][p] : -A[p][p];
    for (int r = p + 1; r < STATE; ++r) {
      const double share = A[r][p] / A[p][p];
      for (int c = p; c < STATE; ++c) A[r][c] -= share * A[p][c];
    }
  }
  return product;
}

/* det(lambda - A.n) is lambda^3 (lambda - u.n)^2 ((lambda - u.n)^2 - c^2), for every lambda. */
static void the_jacobian_has_the_eigenvalues_of_the_medium_and_of_the_waves(void **state) {
  (void)state;
  uint64_t seed = 5;
  double worst = 0;
  for (int trial = 0; trial < 500; ++trial) {
    double n[3], u[3], A[STATE][STATE], length = 0, along = 0;
    for (int a = 0; a < 3; ++a) n[a] = test_random(&seed) - 0.5, u[a] = 2 * test_random(&seed) - 1;
    for (int a = 0; a < 3; ++a) length += n[a] * n[a];
    for (int a = 0; a < 3; ++a) n[a] /= sqrt(length), along += n[a] * u[a];
    const double f_t = test_random(&seed), c2 = (1 - f_t) * k / tau, lambda = 4 * test_random(&seed) - 2;
    jacobian(u, f_t, n, A);
    for (int r = 0; r < STATE; ++r)
      for (int c = 0; c < STATE; ++c) A[r][c] = (r == c ? lambda : 0) - A[r][c];
    const double free = lambda - along;
    worst = fmax(worst, fabs(determinant(A) - lambda * lambda * lambda * free * free * (free * free - c2)));
  }
  print_message("characteristic polynomial off by %.1e\n", worst);
  BELOW(worst, 1e-11);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(the_theory_is_that_of_the_table),
      cmocka_unit_test(both_models_move_a_mode_as_their_theory_says),
      cmocka_unit_test(only_the_single_equation_sends_ink_upstream),
      cmocka_unit_test(the_jacobian_has_the_eigenvalues_of_the_medium_and_of_the_waves),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
