/* SPDX-License-Identifier: MIT
 *
 * One thread and many give the same bits: the solver (any walls, constant and variable coefficients, singular) and
 * whole diffusion steps with everything that a step can hold. Boxes are large enough that threads are used.
 */
#include <string.h>

#include "base/mem.h"
#include "diffuse_case.h"
#include "grid/sweep.h"
#include "solve_case.h"

static bool same_cells(const cf_box *b, const cf_cell x, const cf_cell y) {
  for (ptrdiff_t r = 0; r < cf_box_rows(b); ++r)
    if (memcmp(x.at + cf_box_row(b, r), y.at + cf_box_row(b, r), (size_t)b->n[0] * sizeof(cf_real)) != 0)
      return false;
  return true;
}

static void solve_with(solve_case c, const int threads, solve_setup *s, cf_solve_report *report) {
  c.threads = threads;
  case_begin(&c, s);
  assert_true(cf_box_cells(&s->g.box) >= CF_SERIAL_CELLS);
  OK(cf_helmholtz_solve(s->A, s->b, &(cf_solve_options){1e-4, 60}, s->x, report));
}

static void the_solver_gives_the_same_bits(void **state) {
  (void)state;
  const int n[][4] = {{2, 130, 101, 1}, {2, 7, 1400, 1}, {3, 33, 21, 17}, {3, 40, 32, 24}, {3, 9, 40, 31}};
  const char *const walls[] = {"iii", "ppp", "hip", "pgo"};
  for (int q = 0; q < 5; ++q)
    for (int w = 0; w < 4; ++w)
      for (int kind = 0; kind < 5; ++kind) {
        const double sigma = (const double[]){0.3, 40, INFINITY, 40, INFINITY}[kind];
        solve_case c = {.dim = n[q][0], .n = {n[q][1], n[q][2], n[q][3]}, .walls = walls[w], .sigma = sigma};
        c.beta = kind < 3 ? BETA_NUMBER : BETA_BLOCKS;
        c.alpha_varies = kind == 3;
        c.side = SIDE_MIXED;
        solve_setup one, many;
        cf_solve_report first, other;
        solve_with(c, 1, &one, &first);
        const int threads = (q + w + kind) % 4 == 0 ? 3 : 2;
        solve_with(c, threads, &many, &other);
        assert_int_equal(first.iterations, other.iterations);
        assert_true(first.residual == other.residual);
        if (!same_cells(&one.g.box, one.x, many.x))
          fail_msg("%d x %d x %d, walls %s, kind %d: %d threads differ from one", n[q][1], n[q][2], n[q][3],
                   walls[w], kind, threads);
        case_end(&many);
        case_end(&one);
      }
}

static void uneven_row(const void *context, int n, const double *x, const double *y, const double *z,
                       double t, double *out) {
  const double base = *(const double *)context;
  for (int i = 0; i < n; ++i) out[i] = base + 0.5 * sin(9 * x[i] + 7 * y[i] + 5 * z[i] + 2 * t);
}

static double bump(const void *context, double x, double y, double z) {
  (void)context;
  return exp(-5 * ((x - 1) * (x - 1) + (y - 1) * (y - 1) + z * z)) + 0.1 * sin(40 * x * y);
}

static cf_status give(void *context, double t, cf_cell W) {
  const cf_grid *g = context;
  const double base = 0.3;
  return cf_grid_sample(g, &(cf_fn){.eval = uneven_row, .context = &base, .in_time = true}, CF_CENTRES, t,
                        W.at);
}

static cf_status hold(void *context, double t, cf_cell fraction, cf_cell value) {
  const cf_grid *g = context;
  for (ptrdiff_t r = 0; r < cf_box_rows(&g->box); ++r)
    for (int i = 0; i < g->box.n[0]; ++i) {
      const ptrdiff_t p = cf_box_row(&g->box, r) + i;
      fraction.at[p] = (cf_real)(i < 4 && r % 9 < 3 ? 1 : i == 4 ? 0.5 : 0);
      value.at[p] = (cf_real)cos(t);
    }
  return CF_OK;
}

static void run(const int dim, const cf_diffuse_scheme scheme, const int form, const int threads,
                diffuse_case *c) {
  static const double k = 0.6, C = 1.2;
  *c = diffuse_case_of(dim, dim == 2 ? (int[3]){120, 90, 1} : (int[3]){30, 24, 20}, 0.05);
  c->g.threads = threads;
  assert_true(cf_box_cells(&c->g.box) >= CF_SERIAL_CELLS);
  c->p.scheme = scheme;
  c->p.solver.tolerance = 1e-4;
  c->p.tau = 0.1;
  c->p.f_t = 0.05;
  c->walls.kind[0][0] = CF_WALL_VALUE;
  c->walls.value[0][0] = (cf_fn){.eval = uneven_row, .context = &k, .in_time = true};
  c->walls.kind[1][0] = c->walls.kind[1][1] = CF_WALL_PERIODIC;
  if (form & 1) c->p.k = (cf_fn){.eval = uneven_row, .context = &k};
  if (form & 2) c->p.capacity = (cf_fn){.eval = uneven_row, .context = &C};
  c->source = (cf_source){.rate = give, .hold = form == 3 ? hold : NULL, .context = &c->g};
  diffuse_begin(c);
  diffuse_fill(c, bump, NULL);
  diffuse_run(c, 0.02, 3);
}

static void diffusion_gives_the_same_bits(void **state) {
  (void)state;
  for (int dim = 2; dim <= 3; ++dim)
    for (int scheme = CF_DIFFUSE_PAPER; scheme <= CF_DIFFUSE_SDIRK2; ++scheme)
      for (int form = 0; form < 4; ++form) {
        diffuse_case one, many;
        run(dim, (cf_diffuse_scheme)scheme, form, 1, &one);
        const int threads = form == 3 ? 3 : 2;
        run(dim, (cf_diffuse_scheme)scheme, form, threads, &many);
        assert_int_equal(one.iterations, many.iterations);
        assert_true(same_cells(&one.g.box, one.phi, many.phi));
        for (int a = 0; a < dim; ++a)
          assert_true(same_cells(&one.g.box, (cf_cell){one.q.at[a]}, (cf_cell){many.q.at[a]}));
        assert_memory_equal(&one.ledger, &many.ledger, sizeof one.ledger);
        assert_true(cf_diffuse_content(one.d, one.phi) == cf_diffuse_content(many.d, many.phi));
        diffuse_end(&many);
        diffuse_end(&one);
      }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(the_solver_gives_the_same_bits),
      cmocka_unit_test(diffusion_gives_the_same_bits),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
/* also in single precision */
