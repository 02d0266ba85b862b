/* SPDX-License-Identifier: MIT
 *
 * examples/second-sound against closed forms: releases on a line, in the plane and in space, a standing wave, a wall
 * step, the band of waves of the mixed law, and moving media; on the example's own scenes.
 */
#include "example.h"

#define PI 3.14159265358979323846

/* Runs to every time of the table's rows that fit, calls `add` for each row with the value the run has there. */
typedef struct sums {
  double wrong, all, worst;
  int rows;
} sums;

static void add(sums *s, const double got, const double exact) {
  s->wrong += fabs(got - exact);
  s->all += fabs(exact);
  s->worst = fmax(s->worst, fabs(got - exact));
  ++s->rows;
}

static void a_release_on_a_line_runs_apart(void **state) {
  (void)state;
  table t = table_read("cauchy1d_gauss.csv");
  example e = example_open("second-sound/line.yaml", NULL);
  sums phi = {0}, q = {0};
  double peak = 0;
  for (int r = 0; r < t.rows; ++r) {
    if (table_at(&t, r, "F") != 0) continue;
    const double time = table_at(&t, r, "t"), x = table_at(&t, r, "x");
    if (time > cf_sim_time(e.sim) + 1e-9) example_run(&e, time);
    CLOSE(cf_sim_time(e.sim), time, 1e-9);
    const cf_view v = example_field(&e, "phi", 0), f = example_field(&e, "q", 0);
    add(&phi, view_along(&v, 0, x, 0, 0, 0), table_at(&t, r, "phi"));
    add(&q, view_along(&f, 0, x, 0, 0, 0), table_at(&t, r, "qC"));
    peak = fmax(peak, fabs(table_at(&t, r, "qC")));
  }
  print_message("line: phi L1 %.5f, worst %.5f; q L1 %.5f, worst %.5f of %.3f; %d points\n",
                phi.wrong / phi.all, phi.worst, q.wrong / q.all, q.worst, peak, phi.rows);
  assert_true(phi.rows >= 75);
  BELOW(phi.worst, 1e-3);
  BELOW(q.worst, 1e-3 * peak);
  example_close(&e);
  table_free(&t);
}

/* The release against phi(r) along the axes through its centre. */
static void check_ring(const char *file, const int d, const double f_t, const double allowed) {
  table t = table_read("radial_gauss.csv"), m = table_read("radial_minima.csv");
  example e = example_open(file, NULL);
  for (int r = 0; r < t.rows; ++r) {
    if (table_at(&t, r, "d") != d || table_at(&t, r, "F") != f_t || table_at(&t, r, "r") != 0) continue;
    const double time = table_at(&t, r, "t");
    if (time > cf_sim_end(e.sim) + 1e-9) continue;
    example_run(&e, time);
    const cf_view v = example_field(&e, "phi", 0);
    sums s = {0};
    double peak = 0;
    for (int i = r; i < t.rows && (i == r || table_at(&t, i, "r") > 0); ++i) {
      const double at = table_at(&t, i, "r"), exact = table_at(&t, i, "phi");
      /* Through the centre, where no cell's centre is: the mean of those beside the axis. */
      const int j = d == 2 ? v.shape[1] / 2 : 0;
      peak = fmax(peak, fabs(exact));
      if (at > view_x(&v, 0, v.shape[0] - 3)) continue;
      add(&s,
          d == 2 ? view_in_plane(&v, at, 0)
                 : (at == 0 ? view_at(&v, 0, j, 0) : view_along(&v, 0, at, 0, j, 0)),
          exact);
    }
    double least = example_metric(&e, "min_phi"), exact = NAN;
    for (int i = 0; i < m.rows; ++i)
      if (table_at(&m, i, "d") == d && table_at(&m, i, "F") == f_t && table_at(&m, i, "t") == time)
        exact = table_at(&m, i, "min_phi");
    print_message("%s, t = %g: worst %.5f of %.4f; trough %.5f, exact %.5f\n", file, time, s.worst, peak,
                  least, exact);
    BELOW(s.worst, allowed * peak);
    CLOSE(least, exact, allowed * peak);
  }
  example_close(&e);
  table_free(&t);
  table_free(&m);
}

static void a_ring_in_the_plane_has_the_exact_trough_behind_it(void **state) {
  (void)state;
  check_ring("second-sound/scene.yaml", 2, 0, 0.02);
}

static void a_ball_in_space_has_the_exact_trough_behind_it(void **state) {
  (void)state;
  check_ring("second-sound/space.yaml", 3, 0.1, 0.04);
}

/* The amplitude of cos(m pi x/L). */
static double amplitude(const cf_view *v, const double K) {
  double sum = 0;
  for (int i = 0; i < v->shape[0]; ++i) sum += view_at(v, i, 0, 0) * cos(K * view_x(v, 0, i));
  return 2 * sum / v->shape[0];
}

static void a_standing_wave_swings_and_dies_as_the_mode_does(void **state) {
  (void)state;
  table t = table_read("modes_exact.csv");
  example e = example_open("second-sound/mode.yaml", NULL);
  double worst = 0;
  for (int r = 0; r < t.rows; ++r) {
    if (table_at(&t, r, "case") != 0) continue;
    example_run(&e, table_at(&t, r, "t"));
    const cf_view v = example_field(&e, "phi", 0);
    worst = fmax(worst, fabs(amplitude(&v, 3 * PI) - table_at(&t, r, "phi_hat")));
  }
  print_message("standing wave: worst %.2e\n", worst);
  BELOW(worst, 3e-4);
  example_close(&e);
  table_free(&t);
}

/* --- the wall ------------------------------------------------------------------------------------------------- */

static void check_wall(const double f_t, const char *const *set, const double allowed) {
  table t = table_read("semi_infinite_step.csv");
  example e = example_open("second-sound/wall.yaml", set);
  for (int r = 0; r < t.rows; ++r) {
    if (table_at(&t, r, "F") != f_t || table_at(&t, r, "x") != 0) continue;
    const double time = table_at(&t, r, "t");
    example_run(&e, time);
    const cf_view v = example_field(&e, "phi", 0);
    sums s = {0};
    for (int i = r + 1; i < t.rows && table_at(&t, i, "x") > 0; ++i) {
      const double x = table_at(&t, i, "x");
      if (f_t == 0 && fabs(x - time) < 10 * v.h) continue; /* on the front */
      add(&s, view_along(&v, 0, x, 0, 0, 0), table_at(&t, i, "phi"));
    }
    print_message("wall, F_T = %g, t = %g: L1 %.5f\n", f_t, time, s.wrong / s.all);
    BELOW(s.wrong / s.all, allowed);
    if (f_t > 0) continue;
    /* The front: where phi passes half of the jump. */
    const double half = exp(-time / 2) / 2;
    double front = NAN, most = 0;
    for (int i = 0; i + 1 < v.shape[0]; ++i) {
      const double a = view_at(&v, i, 0, 0), b = view_at(&v, i + 1, 0, 0);
      most = fmax(most, a);
      if (a >= half && b < half) front = view_x(&v, 0, i) + v.h * (a - half) / (a - b);
    }
    print_message("wall: front at %.4f, largest value %.4f\n", front, most);
    CLOSE(front, time, 2 * v.h);
    BELOW(most, 1.01);
  }
  example_close(&e);
  table_free(&t);
}

static void a_warm_wall_sends_a_front_of_the_exact_height(void **state) {
  (void)state;
  check_wall(0, NULL, 0.01);
}

static void a_share_of_fourier_blurs_the_front_as_it_should(void **state) {
  (void)state;
  check_wall(0.1, (const char *const[]){"diffusion.f_t=0.1", NULL}, 0.01);
  check_wall(0.5, (const char *const[]){"diffusion.f_t=0.5", NULL}, 0.01);
}

/* --- the band ------------------------------------------------------------------------------------------------- */

/* The exponents of a mode, s = growth + i frequency, from phi at three equal intervals: p_2 - 2 e^a cos(b) p_1 +
 * e^2a p_0 = 0, fitted to all by least squares. */
static void exponents(const int n, const double *p, const double dt, double *growth, double *frequency) {
  double a11 = 0, a12 = 0, a22 = 0, b1 = 0, b2 = 0;
  for (int i = 0; i + 2 < n; ++i) {
    a11 += p[i + 1] * p[i + 1], a12 += p[i + 1] * p[i], a22 += p[i] * p[i];
    b1 += p[i + 1] * p[i + 2], b2 += p[i] * p[i + 2];
  }
  const double det = a11 * a22 - a12 * a12, c1 = (b1 * a22 - b2 * a12) / det,
               c0 = (a11 * b2 - a12 * b1) / det;
  *growth = log(-c0) / 2 / dt;
  *frequency = acos(c1 / 2 / sqrt(-c0)) / dt;
}

static void the_fastest_wave_of_the_band_moves_with_c(void **state) {
  (void)state;
  table t = table_read("jeffreys_wave_band.csv");
  for (int r = 0; r < t.rows; ++r) {
    const double f_t = table_at(&t, r, "F"), K = table_at(&t, r, "K_star");
    if (f_t < 0.05) continue; /* so short a wave, so long a life: another grid */
    char share[40], number[64];
    snprintf(share, sizeof share, "let.F=%.17g", f_t);
    snprintf(number, sizeof number, "let.K=%.17g", K);
    example e = example_open("second-sound/band.yaml", (const char *const[]){share, number, NULL});
    double p[21], growth, frequency;
    cf_view v = example_field(&e, "phi", 0);
    p[0] = amplitude(&v, K);
    for (int i = 1; i <= 20; ++i) {
      example_run(&e, 0.05 * i);
      p[i] = amplitude(&v, K);
    }
    exponents(21, p, 0.05, &growth, &frequency);
    print_message("band, F_T = %g: phase speed %.5f, c = %.5f; damping %.5f\n", f_t, frequency / K,
                  table_at(&t, r, "max_phase_speed"), growth);
    CLOSE(frequency / K, table_at(&t, r, "max_phase_speed"), 0.01 * table_at(&t, r, "max_phase_speed"));
    CLOSE(growth, table_at(&t, r, "-1/tau"), 0.02);
    example_close(&e);
  }
  table_free(&t);
}

/* --- moving media ----------------------------------------------------------------------------------------------- */

static double error_in_stream(const table *t, const double V) {
  char set[40];
  snprintf(set, sizeof set, "let.V=%.17g", V);
  example e = example_open("second-sound/stream.yaml", (const char *const[]){set, NULL});
  example_run(&e, INFINITY);
  const cf_view v = example_field(&e, "phi", 0);
  sums s = {0};
  for (int r = 0; r < t->rows; ++r)
    if (table_at(t, r, "V") == V)
      add(&s, view_along(&v, 0, table_at(t, r, "x"), 0, 0, 0), table_at(t, r, "phi"));
  assert_int_equal(s.rows, 16);
  example_close(&e);
  return s.wrong / s.all;
}

static void a_release_in_a_stream_is_that_at_rest_further_on(void **state) {
  (void)state;
  table t = table_read("moving_gauss_periodic.csv");
  const double rest = error_in_stream(&t, 0), slow = error_in_stream(&t, 0.1),
               fast = error_in_stream(&t, 0.3), faster = error_in_stream(&t, 1);
  print_message("stream: L1 at rest %.5f, V = .1, .3, 1: %.5f %.5f %.5f\n", rest, slow, fast, faster);
  BELOW(rest, 0.005);
  BELOW(slow, 2 * rest);
  BELOW(fast, 2 * rest);
  BELOW(faster, 2 * rest);
  table_free(&t);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(a_release_on_a_line_runs_apart),
      cmocka_unit_test(a_ring_in_the_plane_has_the_exact_trough_behind_it),
      cmocka_unit_test(a_ball_in_space_has_the_exact_trough_behind_it),
      cmocka_unit_test(a_standing_wave_swings_and_dies_as_the_mode_does),
      cmocka_unit_test(a_warm_wall_sends_a_front_of_the_exact_height),
      cmocka_unit_test(a_share_of_fourier_blurs_the_front_as_it_should),
      cmocka_unit_test(the_fastest_wave_of_the_band_moves_with_c),
      cmocka_unit_test(a_release_in_a_stream_is_that_at_rest_further_on),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
