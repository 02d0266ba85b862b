/* SPDX-License-Identifier: MIT
 *
 * Values held on walls: the step 0 -> 1 on the wall of a half-space (semi_infinite_step.csv; Baumeister and Hamill
 * 1969 for F_T = 0), and values that swing in time, for which the exact solution is
 *
 *     phi = Re exp(i w t - lambda s),   lambda^2 = i w (1 + i w tau)/(k (1 + i w tau F)),   s along a direction,
 *     q_C = Re (1 - F) k lambda/(1 + i w tau) exp(i w t - lambda s) along it.
 */
#include "diffuse_case.h"
#include "reference.h"

static double nothing(const void *context, double x, double y, double z) {
  (void)context, (void)x, (void)y, (void)z;
  return 0;
}

/* Cubic interpolation; x at least 2 h from the walls. */
static double at_place(const diffuse_case *c, const double x) {
  const double s = x / c->g.h - 0.5, i = floor(s), u = s - i;
  const cf_real *v = c->phi.at + (int)i;
  return -u * (u - 1) * (u - 2) / 6 * (double)v[-1] + (u + 1) * (u - 1) * (u - 2) / 2 * (double)v[0] -
         (u + 1) * u * (u - 2) / 2 * (double)v[1] + (u + 1) * u * (u - 1) / 6 * (double)v[2];
}

static double last_crossing(const diffuse_case *c, const double value) {
  for (int i = c->g.box.n[0] - 1; i > 0; --i) {
    const double a = cell_at(c, i - 1, 0, 0), b = cell_at(c, i, 0, 0);
    if (a >= value && b < value) return cf_grid_place(&c->g, 0, i - 1, 0) + c->g.h * (a - value) / (a - b);
  }
  return NAN;
}

/* phi of the half-space for F = 0: e^{-ax/c} + (ax/c) int_{x/c}^t e^{-ay} I1(a s)/s dy, s^2 = y^2 - x^2/c^2. */
static double half_space(const double k, const double tau, const double t, const double x) {
  const double c = sqrt(k / tau), a = 0.5 / tau, x0 = x / c;
  if (x0 >= t) return 0;
  double sum = 0;
  for (int i = 0; i < 300; ++i) {
    const double y = x0 + (i + 0.5) * (t - x0) / 300, z2 = a * a * (y * y - x0 * x0);
    double term = 1, ratio = 1; /* I1(z) 2/z */
    for (int m = 1; m < 40 && term > 1e-17; ++m) ratio += term *= z2 / (4.0 * m * (m + 1));
    sum += exp(-a * y) * 0.5 * a * ratio * (t - x0) / 300;
  }
  return exp(-a * x0) + a * x0 * sum;
}

static void wall_step(const table *t, const int row, const int n, diffuse_case *c) {
  const double time = table_at(t, row, "t"), h = 1.0 / 200;
  *c = diffuse_case_of(2, (int[3]){n, 1, 1}, h);
  c->p.k = cf_fn_constant(table_at(t, row, "k"));
  c->p.tau = table_at(t, row, "tau");
  c->p.f_t = table_at(t, row, "F");
  c->p.front_filter = c->p.f_t == 0;
  c->walls.kind[0][0] = CF_WALL_VALUE;
  c->walls.value[0][0] = cf_fn_constant(1);
  diffuse_begin(c);
  diffuse_fill(c, nothing, NULL);
  const int steps = (int)lround(2 * time / h);
  diffuse_run(c, time / steps, steps);
  BELOW(fabs(diffuse_ledger_error(c)), 1e-13);
}

/* 200 cells a unit, F > 0: the fields are smooth. */
static void a_step_on_the_wall_spreads_as_the_exact_solution(void **state) {
  (void)state;
  table t = table_read("semi_infinite_step.csv");
  for (int first = 0; first < t.rows; first += 25) {
    if (table_at(&t, first, "F") == 0) continue;
    diffuse_case c;
    wall_step(&t, first, 2400, &c);
    double error = 0, size = 0;
    for (int row = first + 1; row < first + 25; ++row) {
      error += fabs(at_place(&c, table_at(&t, row, "x")) - table_at(&t, row, "phi"));
      size += fabs(table_at(&t, row, "phi"));
    }
    print_message("step on a wall, F = %-4g t = %-4g L1 %.4f %%\n", c.p.f_t, c.t, 100 * error / size);
    BELOW(error / size, 0.001);
    diffuse_end(&c);
  }
  table_free(&t);
}

/* F = 0: a jump that travels. L1 over all cells more than 2 h behind the front, with the front filter. */
static void a_step_on_the_wall_enters_with_a_front_at_wave_speed(void **state) {
  (void)state;
  table t = table_read("semi_infinite_step.csv");
  for (int first = 0; first < t.rows; first += 25) {
    const double time = table_at(&t, first, "t"), k = table_at(&t, first, "k"),
                 tau = table_at(&t, first, "tau");
    if (table_at(&t, first, "F") > 0) continue;
    for (int row = first; row < first + 25; ++row)
      if (fabs(table_at(&t, row, "x") - table_at(&t, first, "front_x")) > 1e-9)
        CLOSE(half_space(k, tau, time, table_at(&t, row, "x")), table_at(&t, row, "phi"), 1e-5);
    diffuse_case c;
    wall_step(&t, first, 700, &c);
    const double front = table_at(&t, first, "front_x"), jump = table_at(&t, first, "front_jump");
    double error = 0, size = 0;
    for (int i = 0; i < 700 && cf_grid_place(&c.g, 0, i, 0) < front - 2 * c.g.h; ++i) {
      const double phi = half_space(k, tau, time, cf_grid_place(&c.g, 0, i, 0));
      error += fabs(cell_at(&c, i, 0, 0) - phi);
      size += fabs(phi);
    }
    const double off = last_crossing(&c, 0.5 * jump) - front;
    print_message("step on a wall, F = 0    t = %-4g L1 %.3f %% behind the front, which is off by %.1f h\n",
                  time, 100 * error / size, off / c.g.h);
    BELOW(error / size, 0.01);
    BELOW(fabs(off), 2 * c.g.h);
    diffuse_end(&c);
  }
  table_free(&t);
}

typedef struct swing {
  double w, k, tau, F, direction[3];
} swing;

static double complex at_time(const swing *s, const double x, const double y, const double z, const double t,
                              double complex *flux) {
  const double complex i_w = I * s->w,
                       lambda = csqrt(i_w * (1 + i_w * s->tau) / (s->k * (1 + i_w * s->tau * s->F)));
  const double along = s->direction[0] * x + s->direction[1] * y + s->direction[2] * z;
  const double complex phi = cexp(i_w * t - lambda * along);
  *flux = (1 - s->F) * s->k * lambda / (1 + i_w * s->tau) * phi;
  return phi;
}

static void swing_row(const void *context, int n, const double *x, const double *y, const double *z, double t,
                      double *out) {
  double complex flux;
  for (int i = 0; i < n; ++i) out[i] = creal(at_time(context, x[i], y[i], z[i], t, &flux));
}

static double swing_error(const swing *s, const int dim, const int n) {
  diffuse_case c =
      diffuse_case_of(dim, (int[3]){n, s->direction[1] > 0 ? n : 1, s->direction[2] > 0 ? n : 1}, 1.0 / n);
  c.p.k = cf_fn_constant(s->k);
  c.p.tau = s->tau;
  c.p.f_t = s->F;
  c.p.solver.tolerance = 1e-9;
  for (int a = 0; a < dim; ++a)
    for (int side = 0; side < 2 && s->direction[a] > 0; ++side) {
      c.walls.kind[a][side] = CF_WALL_VALUE;
      c.walls.value[a][side] = (cf_fn){.eval = swing_row, .context = s, .in_time = true};
    }
  diffuse_begin(&c);
  double complex flux;
  double error = 0;
  for (int pass = 0; pass < 2; ++pass) {
    for (int a = -1; a < dim; ++a)
      for (int k = 0; k < cf_box_extent(&c.g.box, 2, a); ++k)
        for (int j = 0; j < cf_box_extent(&c.g.box, 1, a); ++j)
          for (int i = 0; i < cf_box_extent(&c.g.box, 0, a); ++i) {
            const double phi =
                creal(at_time(s, cf_grid_place(&c.g, 0, i, a == 0), cf_grid_place(&c.g, 1, j, a == 1),
                              cf_grid_place(&c.g, 2, k, a == 2), c.t, &flux));
            const ptrdiff_t p = cf_box_at(&c.g.box, i, j, k);
            if (pass == 1 && a < 0) error += ((double)c.phi.at[p] - phi) * ((double)c.phi.at[p] - phi);
            if (pass == 0 && a < 0) c.phi.at[p] = (cf_real)phi;
            if (pass == 0 && a >= 0) c.q.at[a][p] = (cf_real)(creal(flux) * s->direction[a]);
          }
    if (pass == 0) c.ledger.first = cf_diffuse_content(c.d, c.phi);
    if (pass == 0) diffuse_run(&c, 1.0 / n, n);
  }
  BELOW(fabs(diffuse_ledger_error(&c)), 1e-13);
  diffuse_end(&c);
  return sqrt(error / (double)cf_box_cells(&c.g.box));
}

static void values_that_swing_in_time_keep_the_order(void **state) {
  (void)state;
  const double r2 = sqrt(0.5), r3 = sqrt(1.0 / 3);
  const swing cases[] = {{3, 0.1, 0.5, 0, {1, 0, 0}},     {3, 0.1, 0.5, 0.2, {1, 0, 0}},
                         {3, 0.1, 0, 0, {1, 0, 0}},       {3, 0.1, 0.5, 1, {1, 0, 0}},
                         {3, 0.1, 0.5, 0, {r2, r2, 0}},   {3, 0.1, 0.5, 0.2, {r2, r2, 0}},
                         {3, 0.1, 0.5, 0.1, {r3, r3, r3}}};
  for (int i = 0; i < 7; ++i) {
    const int dim = i == 6 ? 3 : 2, n = i == 6 ? 12 : 32;
    const double coarse = swing_error(&cases[i], dim, n), fine = swing_error(&cases[i], dim, 2 * n);
    print_message("swing, tau %g F %g, direction (%.2f %.2f %.2f): L2 %.2e, %.2e, order %.2f\n", cases[i].tau,
                  cases[i].F, cases[i].direction[0], cases[i].direction[1], cases[i].direction[2], coarse,
                  fine, order_of(coarse, fine));
    BELOW(1.85, order_of(coarse, fine));
  }
}

/* Open is a value of 0, to the bit. */
static void an_open_wall_is_a_wall_held_at_zero(void **state) {
  (void)state;
  static double after[2][30];
  for (int kind = 0; kind < 2; ++kind) {
    diffuse_case c = diffuse_case_of(2, (int[3]){30, 7, 1}, 0.1);
    c.p.tau = 0.3;
    for (int side = 0; side < 2; ++side) c.walls.kind[0][side] = kind == 0 ? CF_WALL_OPEN : CF_WALL_VALUE;
    diffuse_begin(&c);
    for (int j = 0; j < 7; ++j)
      for (int i = 0; i < 30; ++i) c.phi.at[cf_box_at(&c.g.box, i, j, 0)] = (cf_real)(i * i % 7 + j);
    c.ledger.first = cf_diffuse_content(c.d, c.phi);
    diffuse_run(&c, 0.02, 20);
    for (int i = 0; i < 30; ++i) after[kind][i] = cell_at(&c, i, 3, 0);
    BELOW(fabs(diffuse_ledger_error(&c)), 1e-13);
    assert_true(c.ledger.left > 0);
    diffuse_end(&c);
  }
  for (int i = 0; i < 30; ++i) CLOSE(after[0][i], after[1][i], 0);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(a_step_on_the_wall_spreads_as_the_exact_solution),
      cmocka_unit_test(a_step_on_the_wall_enters_with_a_front_at_wave_speed),
      cmocka_unit_test(values_that_swing_in_time_keep_the_order),
      cmocka_unit_test(an_open_wall_is_a_wall_held_at_zero),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
