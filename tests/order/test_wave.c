/* SPDX-License-Identifier: MIT
 *
 * How well each scheme carries fronts: errors against exact solutions, side by side with the paper's scheme at the
 * same step and at a cost that is at least the same; orders in time; jumps; stability on random data.
 */
#include "blob.h"
#include "reference.h"

static const char *const names[] = {"paper", "sdirk2", "leapfrog", "wave"};

/* --- a Gaussian on an axis: goal A1 ----------------------------------------------------------------------- */

/* Relative L1 error of a Gaussian of width 7.7 h whose fronts travel 90 cells. */
static double gaussian(const cf_diffuse_scheme scheme, const bool filter, const double courant,
                       const double f_t) {
  enum { N = 512, CELLS = 90 };
  const double h = 1.0 / N, tau = 125 * h;
  blob b = {
      .p = {
          .k = {.value = tau / (1 - f_t)}, .tau = tau, .f_t = f_t, .scheme = scheme, .front_filter = filter}};
  double first[N], exact[N], wrong = 0, sum = 0;
  b.walls.kind[0][0] = b.walls.kind[0][1] = CF_WALL_PERIODIC;
  blob_open(&b, 2, (int[]){N, 1}, h, NULL);
  for (int i = 0; i < N; ++i) {
    const double x = (i + 0.5 - N / 2.0) / 7.7;
    first[i] = exp(-x * x / 2);
    b.phi.at[i] = (cf_real)first[i];
  }
  blob_start(&b);
  blob_run(&b, CELLS * h, (int)lround(CELLS / courant));
  exact_axis(N, h, first, CELLS * h, &b, exact);
  for (int i = 0; i < N; ++i) {
    wrong += fabs((double)b.phi.at[i] - exact[i]);
    sum += fabs(exact[i]);
  }
  CLOSE(blob_error(&b), 0, 1e-12);
  blob_close(&b);
  return wrong / sum;
}

static void a_gaussian_keeps_its_shape_over_ninety_cells(void **state) {
  (void)state;
  const double courants[] = {0.25, 0.5, 1, 2, 4};
  double error[4][5];
  print_message("relative L1 error after 90 cells, F = 0; c dt/h =  .25     .5      1       2       4\n");
  for (int s = 0; s < 4; ++s) {
    for (int c = 0; c < 5; ++c) error[s][c] = gaussian((cf_diffuse_scheme)s, false, courants[c], 0);
    print_message("  %-40s %11.5f %7.5f %7.5f %7.5f %7.5f\n", names[s], error[s][0], error[s][1], error[s][2],
                  error[s][3], error[s][4]);
  }
  const double filtered[2] = {gaussian(CF_DIFFUSE_SDIRK2, true, 1, 0),
                              gaussian(CF_DIFFUSE_LEAPFROG, true, 1, 0)};
  print_message("  with the front filter at 1: sdirk2 %.5f, leapfrog %.5f\n", filtered[0], filtered[1]);
  print_message(
      "  at equal cost: paper at .25 (four solves a cell) %.4f, sdirk2 at .5 (four) %.4f, leapfrog at 1 (two "
      "sweeps, no solve) %.4f\n",
      error[0][0], error[1][1], error[2][2]);
  assert_true(error[0][2] > 0.25); /* the paper's, 0.308 where this was measured first */
  BELOW(error[1][2], 0.02);
  BELOW(error[2][2], 0.007);
  BELOW(error[3][1], 0.0005);
  BELOW(filtered[0], 0.02);
  BELOW(filtered[1], 0.009);
  const double mixed[3] = {gaussian(CF_DIFFUSE_PAPER, false, 1, 0.02),
                           gaussian(CF_DIFFUSE_SDIRK2, false, 1, 0.02),
                           gaussian(CF_DIFFUSE_LEAPFROG, false, 1, 0.02)};
  print_message("  F = .02 at 1: paper %.5f, sdirk2 %.5f, leapfrog %.5f\n", mixed[0], mixed[1], mixed[2]);
  BELOW(mixed[1], 0.0025);
  BELOW(mixed[2], 0.0025);
}

/* --- orders in time: goal A4 ------------------------------------------------------------------------------ */

/* Error in phi of the mode cos(2 pi x) at t = 1 against the same mode's own decay on the grid, where its wave number
 * is (2/h) sin(pi h): only the error in time is left. */
static double mode_error(const cf_diffuse_scheme scheme, const double k, const double tau, const double f_t,
                         const int steps) {
  enum { N = 32 };
  const double h = 1.0 / N, K = 2 / h * sin(PI * h);
  blob b = {.p = {.k = {.value = k}, .tau = tau, .f_t = f_t, .scheme = scheme, .solver = {1e-13, 200}}};
  b.walls.kind[0][0] = b.walls.kind[0][1] = CF_WALL_PERIODIC;
  blob_open(&b, 2, (int[]){N, 1}, h, NULL);
  for (int i = 0; i < N; ++i) b.phi.at[i] = (cf_real)cos(2 * PI * (i + 0.5) * h);
  blob_start(&b);
  blob_run(&b, 1, steps);
  double amplitude = 0;
  for (int i = 0; i < N; ++i) amplitude += 2.0 / N * (double)b.phi.at[i] * cos(2 * PI * (i + 0.5) * h);
  blob_close(&b);
  return fabs(amplitude - mode_factor(K, k, tau, f_t, 1));
}

/* The leapfrog is of second order where steps resolve the memory; below that it is Euler's explicit step, and the
 * default is sdirk2. */
static double order_of(const cf_diffuse_scheme scheme, const double k, const double tau, const double f_t) {
  const double coarse = mode_error(scheme, k, tau, f_t, 80), fine = mode_error(scheme, k, tau, f_t, 160);
  BELOW(coarse, 0.01);
  if (coarse < 1e-10) return 2;
  const double order = log2(coarse / fine);
  if (!(order > 1.7)) fail_msg("%s, k = %g, tau = %g: order %g", names[scheme], k, tau, order);
  return order;
}

static void order_two_in_time_for_every_memory(void **state) {
  (void)state;
  print_message("order in time            tau  k = .02: sdirk2 leapfrog   c = .5: sdirk2 leapfrog\n");
  for (double tau = 1e-8; tau < 2e4; tau *= 10) {
    const bool resolved = tau > 0.05;
    print_message("  %26.0e", tau);
    for (int c = 0; c < 2; ++c) {
      const double k = c == 0 ? 0.02 : 0.25 * tau;
      print_message("%16.2f", order_of(CF_DIFFUSE_SDIRK2, k, tau, 0));
      if (resolved) print_message("%9.2f", order_of(CF_DIFFUSE_LEAPFROG, k, tau, 0));
      if (!resolved) print_message("%9s", "-");
    }
    print_message("\n");
  }
  (void)order_of(CF_DIFFUSE_LEAPFROG, 0.02, 1, 0.3);
  (void)order_of(CF_DIFFUSE_SDIRK2, 0.02, 1, 0.3);
}

/* --- jumps: goal A5 --------------------------------------------------------------------------------------- */

typedef struct jumps {
  double error, over, under, variation;
} jumps;

/* A box of width 1/4 that splits into two of half its height, which run to +-1/4: 256 cells to a length of 1. The
 * exact solution is the mean of two shifted boxes where tau is long; with a short one nothing exceeds its height. */
static jumps box_profile(const cf_diffuse_scheme scheme, const bool filter, const double courant,
                         const double tau) {
  enum { N = 256 };
  const double h = 1.0 / N, end = 0.25;
  blob b = {.p = {.k = {.value = tau}, .tau = tau, .scheme = scheme, .front_filter = filter}};
  jumps j = {0, -1, 0, 0};
  double sum = 0;
  blob_open(&b, 2, (int[]){N, 1}, h, (double[]){-0.5, 0});
  for (int i = 0; i < N; ++i) b.phi.at[i] = fabs(-0.5 + (i + 0.5) * h) < 0.125;
  blob_start(&b);
  blob_run(&b, end, (int)ceil(end / (courant * h)));
  for (int i = 0; i < N; ++i) {
    const double phi = (double)b.phi.at[i], x = fabs(-0.5 + (i + 0.5) * h),
                 exact = fabs(x - 0.25) < 0.125 ? 0.5 : 0;
    j.error += fabs(phi - exact);
    sum += exact;
    j.over = fmax(j.over, phi - 0.5);
    j.under = fmin(j.under, phi);
    if (i > 0) j.variation += fabs(phi - (double)b.phi.at[i - 1]) / 2;
  }
  j.error /= sum;
  CLOSE(blob_error(&b), 0, 1e-12);
  blob_close(&b);
  return j;
}

static void jumps_stay_within_bounds(void **state) {
  (void)state;
  const double allowed[4] = {0, 0.035, 0.015, 0.001}, variation[4] = {0, 1.2, 1.1, 1.002};
  print_message(
      "box profile                without decay:  L1     over   under  variation   tau = .25: over   "
      "under\n");
  for (int s = 0; s < 4; ++s)
    for (int f = 0; f < (s == 1 || s == 2 ? 2 : 1); ++f) {
      const double courant = s == 3 ? 0.5 : 0.9;
      const jumps j = box_profile((cf_diffuse_scheme)s, f == 1, courant, 1e5);
      const jumps damped = box_profile((cf_diffuse_scheme)s, f == 1, courant, 0.25);
      print_message("  %-8s %-12s %23.3f %7.4f %7.4f %6.2f %20.4f %7.4f\n", names[s],
                    f == 1 ? "filtered" : "", j.error, j.over, j.under, j.variation, damped.over,
                    damped.under);
      if (f == 0 && s != 3) continue;
      BELOW(j.over, allowed[s]);
      BELOW(-j.under, allowed[s]);
      BELOW(j.variation, variation[s]);
      BELOW(damped.over, 0.01);
      BELOW(-damped.under, 0.01);
    }
}

/* --- two and three axes ----------------------------------------------------------------------------------- */

/* Random data keep |phi| bounded at the largest step the schemes take: the energy falls. */
static void random_data_stay_bounded(void **state) {
  (void)state;
  for (int dim = 2; dim <= 3; ++dim)
    for (int s = 2; s < 4; ++s)
      for (int tau = 0; tau < 3; ++tau) {
        const double taus[] = {0.02, 1, 1000};
        blob b = {.p = {.k = {.value = taus[tau]}, .tau = taus[tau], .scheme = (cf_diffuse_scheme)s}};
        uint64_t seed = 3;
        double most = 0;
        blob_open(&b, dim, (int[]){16, 13, 11}, 1.0 / 16, NULL);
        FOR_CELLS(&b, i, j, k) * blob_at(&b, i, j, k) = (cf_real)(test_random(&seed) - 0.5);
        blob_start(&b);
        double dt = 1;
        while (cf_diffuse_substeps(b.d, dt) > 1) dt *= 0.999;
        for (int i = 0; i < 600; ++i) blob_step(&b, dt);
        FOR_CELLS(&b, i, j, k) most = fmax(most, fabs((double)*blob_at(&b, i, j, k)));
        BELOW(most, 3);
        CLOSE(cf_diffuse_content(b.d, b.phi), b.ledger.first, 1e-13);
        blob_close(&b);
      }
}

/* A release at rest: the trough below zero of the exact solution is there, and of the right depth. */
static void the_trough_behind_a_release_is_the_exact_one(void **state) {
  (void)state;
  table t = table_read("radial_minima.csv");
  print_message("least value behind a release   exact    paper   sdirk2  leapfrog    wave\n");
  for (int r = 0; r < t.rows; ++r) {
    const int d = (int)table_at(&t, r, "d");
    const double w = table_at(&t, r, "w"), end = table_at(&t, r, "t"), f_t = table_at(&t, r, "F");
    if (d == 3 || f_t > 0.1 || end > 0.5) continue;
    const double k = table_at(&t, r, "k"), tau = table_at(&t, r, "tau"), h = w / 8;
    const int n = (int)ceil((4 * w + sqrt(k / tau) * end) / h);
    print_message("  2D, F = %-4g t = %-4g      ", f_t, end);
    print_message("%9.4f", table_at(&t, r, "min_phi"));
    for (int s = 0; s < (f_t > 0 ? 3 : 4); ++s) {
      blob b = {.p = {.k = {.value = k},
                      .tau = tau,
                      .f_t = f_t,
                      .scheme = (cf_diffuse_scheme)s,
                      .solver = {1e-7, 200}}};
      double least = 0;
      blob_open(&b, 2, (int[]){n, n}, h, NULL); /* a quarter */
      FOR_CELLS(&b, i, j, l) * blob_at(&b, i, j, l) =
          (cf_real)exp(-((i + 0.5) * (i + 0.5) + (j + 0.5) * (j + 0.5)) * h * h / (2 * w * w));
      blob_start(&b);
      blob_run(&b, end, (int)ceil(end * sqrt((1 - f_t) * k / tau) / (0.5 * h)));
      FOR_CELLS(&b, i, j, l) least = fmin(least, (double)*blob_at(&b, i, j, l));
      print_message("%9.4f", least);
      if (s > 0) CLOSE(least, table_at(&t, r, "min_phi"), 0.01);
      blob_close(&b);
    }
    print_message("\n");
  }
  table_free(&t);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(a_gaussian_keeps_its_shape_over_ninety_cells),
                                     cmocka_unit_test(order_two_in_time_for_every_memory),
                                     cmocka_unit_test(jumps_stay_within_bounds),
                                     cmocka_unit_test(random_data_stay_bounded),
                                     cmocka_unit_test(the_trough_behind_a_release_is_the_exact_one)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
