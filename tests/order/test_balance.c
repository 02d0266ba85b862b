/* SPDX-License-Identifier: MIT
 *
 * Nothing is lost and nothing appears: what is in the box is what was there, plus what sources gave and held cells
 * and walls let in, minus what went out, to round-off. With the default scheme at ANY tolerance of the solver, for
 * any walls, coefficients and sources.
 */
#include "diffuse_case.h"

static uint64_t seed = 17;

static int pick(const int count) { return (int)(test_random(&seed) * count); }

static void rough_row(const void *context, int n, const double *x, const double *y, const double *z, double t,
                      double *out) {
  const double *range = context;
  for (int i = 0; i < n; ++i)
    out[i] = range[0] + range[1] * (0.5 + 0.5 * sin(17 * x[i] + 23 * y[i] * y[i] + 31 * z[i] + 3 * t));
}

typedef struct acting {
  const cf_grid *g;
} acting;

static cf_status give(void *context, double t, cf_cell W) {
  const cf_grid *g = ((const acting *)context)->g;
  for (ptrdiff_t r = 0; r < cf_box_rows(&g->box); ++r)
    for (int i = 0; i < g->box.n[0]; ++i)
      W.at[cf_box_row(&g->box, r) + i] = (cf_real)(sin(0.3 * i + 5 * t) * (double)(r % 5 - 1));
  return CF_OK;
}

static cf_status push(void *context, double t, cf_face B) {
  const cf_grid *g = ((const acting *)context)->g;
  for (int a = 0; a < g->box.dim; ++a)
    for (int k = 0; k < cf_box_extent(&g->box, 2, a); ++k)
      for (int j = 0; j < cf_box_extent(&g->box, 1, a); ++j)
        for (int i = 0; i < cf_box_extent(&g->box, 0, a); ++i)
          B.at[a][cf_box_at(&g->box, i, j, k)] = (cf_real)cos(i + 2 * j - k + 4 * t);
  return CF_OK;
}

static cf_status hold(void *context, double t, cf_cell fraction, cf_cell value) {
  const cf_grid *g = ((const acting *)context)->g;
  for (ptrdiff_t r = 0; r < cf_box_rows(&g->box); ++r)
    for (int i = 0; i < g->box.n[0]; ++i) {
      const ptrdiff_t p = cf_box_row(&g->box, r) + i;
      fraction.at[p] = (cf_real)((i + r) % 7 == 0 ? 1 : (i + r) % 7 == 1 ? 0.4 : 0);
      value.at[p] = (cf_real)(2 + sin(t + i));
    }
  return CF_OK;
}

/* A box with everything chosen at random. */
static void random_case(diffuse_case *c, acting *who, const double *k, const double *C) {
  const int dim = 2 + pick(2);
  int n[3];
  for (int a = 0; a < 3; ++a) n[a] = 1 + pick(14 - 2 * a);
  *c = diffuse_case_of(dim, n, 0.05 + test_random(&seed));
  const cf_wall kinds[] = {CF_WALL_INSULATED, CF_WALL_OPEN, CF_WALL_VALUE, CF_WALL_RADIATE};
  for (int a = 0; a < dim; ++a) {
    const int periodic = pick(3) == 0;
    for (int side = 0; side < 2; ++side) {
      c->walls.kind[a][side] = periodic ? CF_WALL_PERIODIC : kinds[pick(4)];
      c->walls.value[a][side] = (cf_fn){.eval = rough_row, .context = C, .in_time = true};
    }
  }
  if (pick(2)) c->p.k = (cf_fn){.eval = rough_row, .context = k};
  if (pick(2)) c->p.capacity = (cf_fn){.eval = rough_row, .context = C};
  const double taus[] = {0, 1e-9, 0.3, 40, INFINITY}, fs[] = {0, 0.2, 1};
  c->p.tau = taus[pick(5)];
  c->p.f_t = fs[pick(3)];
  for (int a = 0; a < dim; ++a) /* without waves nothing radiates: such a wall is insulated */
    for (int side = 0; side < 2; ++side)
      if (c->walls.kind[a][side] == CF_WALL_RADIATE && isinf(c->p.tau))
        c->walls.kind[a][side] = CF_WALL_INSULATED;
  who->g = &c->g;
  c->source.context = who;
  if (pick(2)) c->source.rate = give;
  if (pick(2)) c->source.flux_rate = push;
  if (pick(3) == 0) c->source.hold = hold;
}

static void random_state(diffuse_case *c) {
  for (ptrdiff_t r = 0; r < cf_box_rows(&c->g.box); ++r)
    for (int i = 0; i < c->g.box.n[0]; ++i) {
      const ptrdiff_t p = cf_box_row(&c->g.box, r) + i;
      c->phi.at[p] = (cf_real)(2 * test_random(&seed) - 0.5);
      for (int a = 0; a < c->g.box.dim; ++a) c->q.at[a][p] = (cf_real)(test_random(&seed) - 0.5);
    }
  /* the high walls' faces as well: a step closes what a wall closes */
  for (int a = 0; a < c->g.box.dim; ++a) {
    const cf_wall_side w = cf_wall_side_of(&c->g.box, a, 1);
    for (int i_c = 0; i_c < w.n_c; ++i_c)
      for (int i_b = 0; i_b < w.n_b; ++i_b)
        c->q.at[a][cf_wall_cell(&c->g.box, &w, i_b, i_c) + w.outward] = (cf_real)(test_random(&seed) - 0.5);
    for (int side = 0; side < 2; ++side) {
      const cf_wall_side s = cf_wall_side_of(&c->g.box, a, side);
      if (c->walls.kind[a][side] != CF_WALL_INSULATED) continue;
      for (int i_c = 0; i_c < s.n_c; ++i_c)
        for (int i_b = 0; i_b < s.n_b; ++i_b)
          c->q.at[a][cf_wall_cell(&c->g.box, &s, i_b, i_c) + (side ? s.outward : 0)] = 0;
    }
  }
  c->ledger = (cf_ledger){.first = cf_diffuse_content(c->d, c->phi)};
}

static double worst_error(const cf_diffuse_scheme scheme, const double tolerance, const int rounds) {
  static const double k[2] = {0, 2}, C[2] = {0.3, 2};
  double worst = 0;
  for (int round = 0; round < rounds; ++round) {
    diffuse_case c;
    acting who;
    random_case(&c, &who, k, C);
    c.p.scheme = scheme;
    c.p.solver = (cf_solve_options){tolerance, 200};
    diffuse_begin(&c);
    random_state(&c);
    const double dt = pow(10, 4 * test_random(&seed) - 3);
    for (int s = 0; s < 4; ++s) {
      OK(cf_diffuse_step(c.d, s * dt, dt, c.phi, c.q, &c.ledger, &c.report));
      const double error = fabs(diffuse_ledger_error(&c));
      if (!(error <= 1e-13) && scheme == CF_DIFFUSE_SDIRK2)
        fail_msg(
            "round %d step %d: %d x %d x %d, walls %d%d %d%d %d%d, tau %g, F %g, dt %g, tolerance %g, "
            "sources %d%d%d: %.3g",
            round, s, c.g.box.n[0], c.g.box.n[1], c.g.box.n[2], c.walls.kind[0][0], c.walls.kind[0][1],
            c.walls.kind[1][0], c.walls.kind[1][1], c.walls.kind[2][0], c.walls.kind[2][1], c.p.tau, c.p.f_t,
            dt, tolerance, c.source.rate != NULL, c.source.flux_rate != NULL, c.source.hold != NULL, error);
      worst = fmax(worst, error);
    }
    diffuse_end(&c);
  }
  return worst;
}

static void the_default_balances_at_any_tolerance(void **state) {
  (void)state;
  print_message("ledger error, sdirk2: %.1e at tolerance 1e-2, %.1e at 1e-10\n",
                worst_error(CF_DIFFUSE_SDIRK2, 1e-2, 600), worst_error(CF_DIFFUSE_SDIRK2, 1e-10, 600));
}

static void the_papers_scheme_balances_as_far_as_it_is_solved(void **state) {
  (void)state;
  const double loose = worst_error(CF_DIFFUSE_PAPER, 1e-6, 300),
               tight = worst_error(CF_DIFFUSE_PAPER, 1e-13, 300);
  print_message("ledger error, paper: %.1e at tolerance 1e-6, %.1e at 1e-13\n", loose, tight);
  BELOW(tight, 1e-9);
  BELOW(tight, loose);
}

/* C varies by 100: sum C phi is kept, sum phi is not; and in the end phi is even, not C phi. */
static void what_is_conserved_is_capacity_times_phi(void **state) {
  (void)state;
  static const double C[2] = {0.1, 10};
  diffuse_case c = diffuse_case_of(2, (int[3]){24, 18, 1}, 0.1);
  c.p.capacity = (cf_fn){.eval = rough_row, .context = C};
  c.p.tau = 0.4;
  diffuse_begin(&c);
  random_state(&c);
  for (int j = 0; j < 18; ++j)
    for (int i = 0; i < 24; ++i) {
      const double x = cf_grid_place(&c.g, 0, i, 0), y = cf_grid_place(&c.g, 1, j, 0), z = 0;
      double here;
      rough_row(C, 1, &x, &y, &z, 0, &here);
      c.phi.at[cf_box_at(&c.g.box, i, j, 0)] = (cf_real)(1 / here);
    }
  double before = 0, after = 0, least = INFINITY, most = -INFINITY;
  for (int j = 0; j < 18; ++j)
    for (int i = 0; i < 24; ++i) before += cell_at(&c, i, j, 0);
  const double content = cf_diffuse_content(c.d, c.phi);
  diffuse_run(&c, 5, 100);
  for (int j = 0; j < 18; ++j)
    for (int i = 0; i < 24; ++i) {
      after += cell_at(&c, i, j, 0);
      least = fmin(least, cell_at(&c, i, j, 0));
      most = fmax(most, cell_at(&c, i, j, 0));
    }
  CLOSE(cf_diffuse_content(c.d, c.phi) / content, 1, 1e-13);
  BELOW(most - least, 1e-8);
  assert_true(after < 0.9 * before);
  diffuse_end(&c);
}

/* Fully held cells have their value after every step, and what that takes is in the ledger. */
static void held_cells_hold(void **state) {
  (void)state;
  for (int dim = 2; dim <= 3; ++dim) {
    diffuse_case c = diffuse_case_of(dim, (int[3]){13, 9, 5}, 0.2);
    acting who = {&c.g};
    c.p.tau = 0.2;
    c.source = (cf_source){.hold = hold, .context = &who};
    diffuse_begin(&c);
    random_state(&c);
    for (int s = 0; s < 20; ++s) {
      diffuse_run(&c, 0.03, 1);
      for (ptrdiff_t r = 0; r < cf_box_rows(&c.g.box); ++r)
        for (int i = 0; i < 13; ++i)
          if ((i + r) % 7 == 0) CLOSE(c.phi.at[cf_box_row(&c.g.box, r) + i], 2 + sin(c.t + i), 1e-8);
      BELOW(fabs(diffuse_ledger_error(&c)), 1e-13);
    }
    diffuse_end(&c);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(the_default_balances_at_any_tolerance),
      cmocka_unit_test(the_papers_scheme_balances_as_far_as_it_is_solved),
      cmocka_unit_test(what_is_conserved_is_capacity_times_phi),
      cmocka_unit_test(held_cells_hold),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
