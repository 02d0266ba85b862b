/* SPDX-License-Identifier: MIT
 *
 * Releases on an infinite line against the exact solution: a Gaussian (cauchy1d_gauss.csv, any F_T), a box and a
 * point (F_T = 0: jumps of e^{-t/2tau}/2, two deltas of that mass).
 */
#include "diffuse_case.h"
#include "reference.h"

static const double pi_half = 1.5707963267948966;

typedef struct release {
  double width, half, point; /* of a Gaussian; of a box; of a cell with mass 1: what is not 0 holds */
} release;

static double shape(const void *context, double x, double y, double z) {
  const release *r = context;
  (void)y, (void)z;
  if (r->width > 0) return exp(-0.5 * x * x / (r->width * r->width));
  if (r->half > 0) return fabs(x) < r->half ? 1 : 0;
  return fabs(x) < 0.5 * r->point ? 1 / r->point : 0;
}

/* A line of n cells (odd) whose middle cell is centred at 0. */
static void begin(const table *t, const int row, const double F, const int n, const double h,
                  const release *r, diffuse_case *c) {
  *c = diffuse_case_of(2, (int[3]){n, 1, 1}, h);
  c->g.origin[0] = -0.5 * n * h;
  c->p.k = cf_fn_constant(table_at(t, row, "k"));
  c->p.tau = table_at(t, row, "tau");
  c->p.f_t = F;
  diffuse_begin(c);
  diffuse_fill(c, shape, r);
}

/* Cubic interpolation between cell centres (faces where staggered), at x. */
static double at_place(const diffuse_case *c, const cf_real *f, const int staggered, const double x) {
  const double s = (x - c->g.origin[0]) / c->g.h - (staggered ? 0 : 0.5), i = floor(s), u = s - i;
  const cf_real *v = f + (int)i;
  return -u * (u - 1) * (u - 2) / 6 * (double)v[-1] + (u + 1) * (u - 1) * (u - 2) / 2 * (double)v[0] -
         (u + 1) * u * (u - 2) / 2 * (double)v[1] + (u + 1) * u * (u - 1) / 6 * (double)v[2];
}

/* w = 16 h: 1e-3 of the peak. */
static void a_gaussian_release_follows_the_exact_solution(void **state) {
  (void)state;
  table t = table_read("cauchy1d_gauss.csv");
  double worst = 0, worst_q = 0;
  for (int row = 0; row < t.rows; row += 25) {
    const double F = table_at(&t, row, "F"), time = table_at(&t, row, "t");
    const release r = {.width = table_at(&t, row, "w")};
    const double h = r.width / 16, speed = sqrt(table_at(&t, row, "k") / table_at(&t, row, "tau"));
    diffuse_case c;
    begin(&t, row, F, 1001, h, &r, &c);
    const int steps = (int)ceil(time / (0.25 * h / speed));
    diffuse_run(&c, time / steps, steps);
    double q_max = 0;
    for (int i = 0; i < 25; ++i) q_max = fmax(q_max, fabs(table_at(&t, row + i, "qC")));
    for (int i = 0; i < 25; ++i) {
      const double x = table_at(&t, row + i, "x");
      worst = fmax(worst, fabs(at_place(&c, c.phi.at, 0, x) - table_at(&t, row + i, "phi")));
      if (F < 1)
        worst_q = fmax(worst_q, fabs(at_place(&c, c.q.at[0], 1, x) - table_at(&t, row + i, "qC")) / q_max);
    }
    diffuse_end(&c);
  }
  print_message("Gaussian, w = 16 h, c dt = h/4: worst error %.2e of the first peak, q %.2e of its largest\n",
                worst, worst_q);
  BELOW(worst, 1e-3);
  BELOW(worst_q, 1e-2);
  table_free(&t);
}

/* Modified Bessel functions of order 0 and 1 (times 2/z) by their series; z stays below 4 here. */
static double bessel_0(const double z) {
  double term = 1, sum = 1;
  for (int m = 1; m < 40 && term > 1e-17; ++m) sum += term *= z * z / (4.0 * m * m);
  return sum;
}

static double bessel_1_over_half(const double z) {
  double term = 1, sum = 1;
  for (int m = 1; m < 40 && term > 1e-17; ++m) sum += term *= z * z / (4.0 * m * (m + 1));
  return sum;
}

/* The smooth part between the fronts of a point release. */
static double between_fronts(const double k, const double tau, const double t, const double x) {
  const double c = sqrt(k / tau), a = 0.5 / tau;
  if (fabs(x) >= c * t) return 0;
  const double z = a * sqrt(t * t - x * x / (c * c));
  return a / (2 * c) * (bessel_0(z) + 0.5 * a * t * bessel_1_over_half(z)) * exp(-a * t);
}

/* Mass left of x; delta masses included. */
static double mass_below(const double k, const double tau, const double t, const double x) {
  const double c = sqrt(k / tau), end = fmin(x, c * t);
  double sum = x > -c * t ? 0.5 * exp(-0.5 * t / tau) : 0;
  if (x > c * t) sum += 0.5 * exp(-0.5 * t / tau);
  const int n = 400; /* x = c t sin(s) takes the root at the ends away */
  if (end > -c * t) {
    const double s0 = -pi_half, s1 = asin(end / (c * t)), ds = (s1 - s0) / n;
    for (int i = 0; i < n; ++i) {
      const double s = s0 + (i + 0.5) * ds;
      sum += between_fronts(k, tau, t, c * t * sin(s)) * c * t * cos(s) * ds;
    }
  }
  return sum;
}

/* One cell of mass 1/h. The two deltas make any scheme ring, so what is compared is the mass left of x: its
 * integrated error (the distance that mass sits from where it belongs) falls with h, and half of a delta's mass
 * has passed within 2 h of the front. */
static double point_error(const table *t, const int row, const double h, double *front_off) {
  const double k = table_at(t, row, "k"), tau = table_at(t, row, "tau"), time = table_at(t, row, "t");
  const double c = sqrt(k / tau), mass = 0.5 * exp(-0.5 * time / tau);
  const release r = {.point = h};
  diffuse_case d;
  const int n = 2 * (int)(0.75 * (c * time + 0.4) / h) + 1;
  begin(t, row, 0, n, h, &r, &d);
  const int steps = (int)ceil(time / (0.25 * h / c));
  diffuse_run(&d, time / steps, steps);
  double below = 0, error = 0;
  *front_off = INFINITY;
  for (int i = 0; i < n; ++i) {
    below += cell_at(&d, i, 0, 0) * h;
    const double x = cf_grid_place(&d.g, 0, i + 1, 1), exact = mass_below(k, tau, time, x);
    error += fabs(below - exact) * h;
    if (below >= 1 - 0.5 * mass && isinf(*front_off)) *front_off = x - c * time;
  }
  CLOSE(below, 1, 1e-12);
  diffuse_end(&d);
  return error;
}

static void a_point_release_splits_into_two(void **state) {
  (void)state;
  table t = table_read("cauchy1d_point.csv");
  for (int row = 0; row < t.rows; ++row) {
    const double k = table_at(&t, row, "k"), tau = table_at(&t, row, "tau"), time = table_at(&t, row, "t");
    CLOSE(between_fronts(k, tau, time, table_at(&t, row, "x")), table_at(&t, row, "phi_smooth"), 1e-12);
    CLOSE(0.5 * exp(-0.5 * time / tau), table_at(&t, row, "delta_mass_each"), 1e-12);
    if (row % 25 != 0) continue;
    CLOSE(mass_below(k, tau, time, 5), 1, 1e-5);
    double off[2];
    const double coarse = point_error(&t, row, 0.005, &off[0]), fine = point_error(&t, row, 0.0025, &off[1]);
    print_message("point, t = %g: mass misplaced by %.4f, %.4f m; front off by %.1f h, %.1f h\n", time,
                  coarse, fine, off[0] / 0.005, off[1] / 0.0025);
    BELOW(fine, 0.75 * coarse);
    BELOW(fabs(off[1]), 2 * 0.0025);
    BELOW(fabs(off[0]), 2 * 0.005);
  }
  table_free(&t);
}

/* A box is a stretch of points. */
static double exact_box(const double k, const double tau, const double t, const double B, const double x) {
  return mass_below(k, tau, t, x + B) - mass_below(k, tau, t, x - B);
}

/* Where phi passes half of the jump expected at x, nearest to x; in h. */
static double jump_off(const diffuse_case *d, const double half, const double x) {
  double least = INFINITY;
  for (int i = 1; i < d->g.box.n[0]; ++i) {
    const double a = cell_at(d, i - 1, 0, 0) - half, b = cell_at(d, i, 0, 0) - half;
    if (a * b > 0 || a == b) continue;
    const double at = cf_grid_place(&d->g, 0, i - 1, 0) + d->g.h * a / (a - b);
    least = fmin(least, fabs(at - x) / d->g.h);
  }
  return least;
}

/* Relative L1 error, and by how many h the jumps are off. */
static double box_error(const table *t, const int row, const double h, double off[2]) {
  const double k = table_at(t, row, "k"), tau = table_at(t, row, "tau"), time = table_at(t, row, "t");
  const double c = sqrt(k / tau), B = table_at(t, row, "half_width");
  const release r = {.half = B};
  diffuse_case d;
  const int n = 2 * (int)((B + c * time + 0.3) / h) + 1;
  begin(t, row, 0, n, h, &r, &d);
  const int steps = (int)ceil(time / (0.25 * h / c));
  diffuse_run(&d, time / steps, steps);
  double error = 0, size = 0;
  for (int i = 0; i < n; ++i) {
    const double x = cf_grid_place(&d.g, 0, i, 0), exact = exact_box(k, tau, time, B, x);
    error += fabs(cell_at(&d, i, 0, 0) - exact);
    size += fabs(exact);
  }
  for (int side = 0; side < 2; ++side) {
    const double x = B + (side == 0 ? -1 : 1) * c * time;
    const double half = 0.5 * (exact_box(k, tau, time, B, x - 1e-9) + exact_box(k, tau, time, B, x + 1e-9));
    off[side] = jump_off(&d, half, x);
  }
  diffuse_end(&d);
  return error / size;
}

static void a_box_release_moves_its_jumps_at_wave_speed(void **state) {
  (void)state;
  table t = table_read("cauchy1d_box.csv");
  for (int row = 0; row < t.rows; ++row) {
    const double B = table_at(&t, row, "half_width"), time = table_at(&t, row, "t"),
                 x = table_at(&t, row, "x");
    if (fabs(fabs(x - B) - 0.4 * time) > 1e-9 && fabs(x + B - 0.4 * time) > 1e-9) /* not on a jump */
      CLOSE(exact_box(table_at(&t, row, "k"), table_at(&t, row, "tau"), time, B, x), table_at(&t, row, "phi"),
            1e-5);
    if (row % 25 != 0) continue;
    double off[2][2];
    const double coarse = box_error(&t, row, 0.01, off[0]), fine = box_error(&t, row, 0.0025, off[1]);
    print_message("box, t = %g: L1 %.4f, %.4f; jumps off by %.1f and %.1f h, %.1f and %.1f h\n", time, coarse,
                  fine, off[0][0], off[0][1], off[1][0], off[1][1]);
    BELOW(fine, 0.6 * coarse);
    for (int i = 0; i < 2; ++i) BELOW(off[1][i], 2);
  }
  table_free(&t);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(a_gaussian_release_follows_the_exact_solution),
      cmocka_unit_test(a_point_release_splits_into_two),
      cmocka_unit_test(a_box_release_moves_its_jumps_at_wave_speed),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
