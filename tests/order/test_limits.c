/* SPDX-License-Identifier: MIT
 *
 * The ends of every parameter's range are ordinary values: tau = 0 and infinite, F_T = 0 and 1, k = 0, dt = 0 and
 * very long, boxes one cell wide. What makes no sense is refused with a sentence.
 */
#include <string.h>

#include "diffuse_case.h"

static double bump(const void *context, double x, double y, double z) {
  (void)context;
  return exp(-8 * ((x - 0.6) * (x - 0.6) + (y - 0.4) * (y - 0.4) + z * z)) + 0.1 * x;
}

static diffuse_case case_with(const double tau, const double F, const double k) {
  diffuse_case c = diffuse_case_of(2, (int[3]){24, 16, 1}, 1.0 / 24);
  c.p.tau = tau;
  c.p.f_t = F;
  c.p.k = cf_fn_constant(k);
  return c;
}

static double largest_difference(const diffuse_case *a, const diffuse_case *b) {
  double worst = 0;
  for (int j = 0; j < a->g.box.n[1]; ++j)
    for (int i = 0; i < a->g.box.n[0]; ++i)
      worst = fmax(worst, fabs(cell_at(a, i, j, 0) - cell_at(b, i, j, 0)));
  return worst;
}

/* tau = 0 with any F_T, and F_T = 1 with any tau, are Fourier's equation where q_C starts at 0. */
static void fourier_is_reached_from_both_sides(void **state) {
  (void)state;
  const double pairs[][2] = {{0, 0}, {0, 0.3}, {0, 1}, {0.7, 1}, {1e-300, 0}, {INFINITY, 1}, {1e300, 1}};
  for (int scheme = CF_DIFFUSE_PAPER; scheme <= CF_DIFFUSE_SDIRK2; ++scheme) {
    diffuse_case reference = case_with(0, 1, 0.3);
    reference.p.scheme = (cf_diffuse_scheme)scheme;
    diffuse_begin(&reference);
    diffuse_fill(&reference, bump, NULL);
    diffuse_run(&reference, 0.05, 5);
    for (int i = 0; i < 7; ++i) {
      diffuse_case c = case_with(pairs[i][0], pairs[i][1], 0.3);
      c.p.scheme = (cf_diffuse_scheme)scheme;
      diffuse_begin(&c);
      diffuse_fill(&c, bump, NULL);
      diffuse_run(&c, 0.05, 5);
      BELOW(largest_difference(&c, &reference), 1e-11);
      BELOW(fabs(diffuse_ledger_error(&c)), 1e-12);
      diffuse_end(&c);
    }
    diffuse_end(&reference);
  }
}

/* tau infinite, F_T = 0: q_C stays what it is and phi falls by t div q. */
static void an_infinite_memory_keeps_the_flux(void **state) {
  (void)state;
  diffuse_case c = case_with(INFINITY, 0, 0.3);
  diffuse_begin(&c);
  diffuse_fill(&c, bump, NULL);
  static double before[24][16];
  for (int j = 0; j < 16; ++j)
    for (int i = 0; i < 24; ++i) {
      before[i][j] = cell_at(&c, i, j, 0);
      if (i > 0) c.q.at[0][cf_box_at(&c.g.box, i, j, 0)] = (cf_real)sin(i + j);
      if (j > 0) c.q.at[1][cf_box_at(&c.g.box, i, j, 0)] = (cf_real)cos(i * j);
    }
  diffuse_run(&c, 0.01, 7);
  for (int j = 0; j < 16; ++j)
    for (int i = 0; i < 24; ++i) {
      const double qx = i > 0 ? sin(i + j) : 0, qx1 = i < 23 ? sin(i + 1 + j) : 0;
      const double qy = j > 0 ? cos(i * j) : 0, qy1 = j < 15 ? cos(i * (j + 1)) : 0;
      CLOSE(cell_at(&c, i, j, 0), before[i][j] - 0.07 * 24 * (qx1 - qx + qy1 - qy), 1e-11);
      CLOSE(c.q.at[0][cf_box_at(&c.g.box, i, j, 0)], qx, 1e-13);
    }
  diffuse_end(&c);
}

/* k = 0: nothing spreads; a flux that is there decays with tau (by the scheme's own factor) and carries on. */
static void without_k_the_flux_only_decays(void **state) {
  (void)state;
  for (int with_q = 0; with_q < 2; ++with_q) {
    diffuse_case c = case_with(0.5, 0.2, 0);
    diffuse_begin(&c);
    diffuse_fill(&c, bump, NULL);
    static double before[24];
    for (int i = 0; i < 24; ++i) before[i] = cell_at(&c, i, 8, 0);
    for (int i = 1; i < 24 && with_q; ++i) c.q.at[0][cf_box_at(&c.g.box, i, 8, 0)] = (cf_real)sin(i);
    diffuse_run(&c, 0.05, 40);
    for (int i = 0; i < 24; ++i) {
      const double q = i > 0 && with_q ? sin(i) : 0, q1 = i < 23 && with_q ? sin(i + 1) : 0;
      CLOSE(c.q.at[0][cf_box_at(&c.g.box, i, 8, 0)], q * exp(-2 / 0.5), 1e-4);
      CLOSE(cell_at(&c, i, 8, 0), before[i] - 24 * (q1 - q) * 0.5 * (1 - exp(-2 / 0.5)),
            1e-2 * with_q + 1e-15);
    }
    diffuse_end(&c);
  }
}

static void a_step_of_no_length_changes_nothing(void **state) {
  (void)state;
  const double taus[] = {0, 0.4, INFINITY};
  for (int i = 0; i < 3; ++i)
    for (int scheme = CF_DIFFUSE_PAPER; scheme <= CF_DIFFUSE_SDIRK2; ++scheme) {
      diffuse_case c = case_with(taus[i], 0.1, 0.3), before = case_with(taus[i], 0.1, 0.3);
      c.p.scheme = before.p.scheme = (cf_diffuse_scheme)scheme;
      diffuse_begin(&c), diffuse_begin(&before);
      diffuse_fill(&c, bump, NULL), diffuse_fill(&before, bump, NULL);
      diffuse_run(&c, 0, 2);
      BELOW(largest_difference(&c, &before), 1e-14);
      diffuse_end(&c), diffuse_end(&before);
    }
}

/* Two steps of 1e6 s end in the mean (L-stable), between walls held at two values in the straight line between. */
static void a_very_long_step_ends_in_the_steady_state(void **state) {
  (void)state;
  for (int held = 0; held < 2; ++held)
    for (int scheme = CF_DIFFUSE_PAPER; scheme <= CF_DIFFUSE_SDIRK2; ++scheme)
      for (int t = 0; t < 3; ++t) {
        diffuse_case c = case_with((const double[]){0, 0.4, 100}[t], 0.1, 0.3);
        c.p.scheme = (cf_diffuse_scheme)scheme;
        for (int side = 0; side < 2 && held; ++side) {
          c.walls.kind[0][side] = CF_WALL_VALUE;
          c.walls.value[0][side] = cf_fn_constant(side == 0 ? 3 : -1);
        }
        diffuse_begin(&c);
        diffuse_fill(&c, bump, NULL);
        const double mean = c.ledger.first / (1.0 * 16 / 24);
        diffuse_run(&c, 1e6, 2);
        for (int i = 0; i < 24; ++i) CLOSE(cell_at(&c, i, 5, 0), held ? 3 - 4 * (i + 0.5) / 24 : mean, 1e-5);
        BELOW(fabs(diffuse_ledger_error(&c)), scheme == CF_DIFFUSE_SDIRK2 ? 1e-13 : 1e-3);
        diffuse_end(&c);
      }
}

static void boxes_one_cell_wide_are_boxes(void **state) {
  (void)state;
  const int n[][3] = {{1, 1, 1}, {1, 9, 1}, {9, 1, 1}, {1, 1, 9}, {2, 1, 2}};
  for (int dim = 2; dim <= 3; ++dim)
    for (int q = 0; q < 5; ++q)
      for (int wall = CF_WALL_INSULATED; wall <= CF_WALL_PERIODIC; ++wall) {
        if (dim == 2 && n[q][2] > 1) continue;
        diffuse_case c = diffuse_case_of(dim, n[q], 0.1);
        c.p.tau = 0.3;
        for (int a = 0; a < dim; ++a) c.walls.kind[a][0] = c.walls.kind[a][1] = (cf_wall)wall;
        diffuse_begin(&c);
        diffuse_fill(&c, bump, NULL);
        diffuse_run(&c, 0.02, 5);
        BELOW(fabs(diffuse_ledger_error(&c)), 1e-13);
        assert_true(isfinite(cell_at(&c, 0, 0, 0)));
        diffuse_end(&c);
      }
}

static void jump_row(const void *context, int n, const double *x, const double *y, const double *z, double t,
                     double *out) {
  (void)y, (void)z, (void)t;
  for (int i = 0; i < n; ++i) out[i] = x[i] > 0.5 ? *(const double *)context : 1;
}

static void refused(const cf_diffuse_params *p, const char *word) {
  cf_grid g;
  OK(cf_grid_init(&g, 2, (int[2]){8, 8}, 0.125, NULL));
  const cf_walls walls = {0};
  cf_diffuse *d = (cf_diffuse *)&g;
  assert_int_equal(cf_diffuse_create(&d, &g, &walls, p, NULL), CF_BAD_ARGUMENT);
  assert_null(d);
  if (strstr(cf_status_sentence(), word) == NULL)
    fail_msg("\"%s\" does not speak of %s", cf_status_sentence(), word);
}

static void parameters_out_of_range_are_refused(void **state) {
  (void)state;
  const cf_diffuse_params good = {.k = {.value = 1},
                                  .capacity = {.value = 1},
                                  .tau = 1,
                                  .scheme = CF_DIFFUSE_SDIRK2,
                                  .solver = {1e-6, 100}};
  const double bad[] = {-1, NAN, -INFINITY};
  static const double values[] = {-1, NAN, INFINITY, 0};
  for (int i = 0; i < 3; ++i) {
    cf_diffuse_params p = good;
    p.tau = bad[i];
    refused(&p, "tau");
    p = good, p.f_t = bad[i];
    refused(&p, "f_t");
    p = good, p.k.value = bad[i];
    refused(&p, "k");
    p = good, p.capacity.value = bad[i];
    refused(&p, "capacity");
    p = good, p.solver.tolerance = bad[i];
    refused(&p, "tolerance");
    p = good, p.k = (cf_fn){.eval = jump_row, .context = &values[i]};
    refused(&p, "k");
    p = good, p.capacity = (cf_fn){.eval = jump_row, .context = &values[i]};
    refused(&p, "capacity");
  }
  cf_diffuse_params p = good;
  p.f_t = 1.0000001;
  refused(&p, "f_t");
  p = good, p.k.value = INFINITY;
  refused(&p, "k");
  p = good, p.capacity.value = 0;
  refused(&p, "capacity");
  p = good, p.capacity.value = INFINITY;
  refused(&p, "capacity");
  p = good, p.capacity = (cf_fn){.eval = jump_row, .context = &values[3]};
  refused(&p, "capacity");
  p = good, p.solver.tolerance = 0;
  refused(&p, "tolerance");
}

static void a_state_that_is_not_finite_is_refused(void **state) {
  (void)state;
  for (int what = 0; what < 2; ++what)
    for (int scheme = CF_DIFFUSE_PAPER; scheme <= CF_DIFFUSE_SDIRK2; ++scheme) {
      diffuse_case c = case_with(0.4, 0.1, 0.3);
      c.p.scheme = (cf_diffuse_scheme)scheme;
      diffuse_begin(&c);
      diffuse_fill(&c, bump, NULL);
      (what ? c.q.at[1] : c.phi.at)[cf_box_at(&c.g.box, 7, 9, 0)] = (cf_real)NAN;
      assert_int_equal(cf_diffuse_step(c.d, 0, 0.1, c.phi, c.q, &c.ledger, &c.report), CF_NOT_FINITE);
      diffuse_end(&c);
    }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(fourier_is_reached_from_both_sides),
      cmocka_unit_test(an_infinite_memory_keeps_the_flux),
      cmocka_unit_test(without_k_the_flux_only_decays),
      cmocka_unit_test(a_step_of_no_length_changes_nothing),
      cmocka_unit_test(a_very_long_step_ends_in_the_steady_state),
      cmocka_unit_test(boxes_one_cell_wide_are_boxes),
      cmocka_unit_test(parameters_out_of_range_are_refused),
      cmocka_unit_test(a_state_that_is_not_finite_is_refused),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
