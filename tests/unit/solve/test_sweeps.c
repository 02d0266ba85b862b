/* SPDX-License-Identifier: MIT
 *
 * Fields for coefficients with little diffusion: half sweeps alone, in one pass, with the same bits for any number of
 * threads.
 */
/* also in single precision */
#include <math.h>
#include <string.h>

#include "solve/helmholtz.h"
#include "testing.h"

static const bool single = sizeof(cf_real) == sizeof(float);

typedef struct problem {
  cf_grid g;
  cf_helmholtz *A;
  cf_cell x, b, alpha;
  cf_face beta;
} problem;

/* alpha between 1 and 2; beta up to sigma h^2, a number or a field. */
static void begin(problem *q, const int dim, const cf_walls *walls, const int threads, const double sigma,
                  const bool field) {
  const int n[3] = {dim == 2 ? 117 : 37, dim == 2 ? 92 : 20, dim == 2 ? 1 : 26};
  uint64_t seed = 4;
  *q = (problem){0};
  OK(cf_grid_init(&q->g, dim, n, 0.25, NULL));
  q->g.threads = threads;
  const double beta = sigma * q->g.h * q->g.h;
  OK(cf_helmholtz_create(&q->A, &q->g, walls, 0));
  OK(cf_cell_create(&q->x, &q->g.box));
  OK(cf_cell_create(&q->b, &q->g.box));
  OK(cf_cell_create(&q->alpha, &q->g.box));
  OK(cf_face_create(&q->beta, &q->g.box));
  for (int k = 0; k < n[2] + (dim == 3); ++k)
    for (int j = 0; j <= n[1]; ++j)
      for (int i = 0; i <= n[0]; ++i) {
        const ptrdiff_t p = cf_box_at(&q->g.box, i, j, k);
        for (int a = 0; a < dim; ++a) q->beta.at[a][p] = (cf_real)(beta * test_random(&seed));
        if (i == n[0] || j == n[1] || k == n[2]) continue;
        q->alpha.at[p] = (cf_real)(1 + test_random(&seed));
        q->b.at[p] = (cf_real)(test_random(&seed) - 0.5);
      }
  OK(cf_helmholtz_set(
      q->A, &(cf_coefficients){
                .alpha_at = &q->alpha, .beta = field ? 0 : beta, .beta_at = field ? &q->beta : NULL}));
}

static void end(problem *q) {
  cf_helmholtz_destroy(q->A);
  cf_cell_destroy(&q->x, &q->g.box);
  cf_cell_destroy(&q->b, &q->g.box);
  cf_cell_destroy(&q->alpha, &q->g.box);
  cf_face_destroy(&q->beta, &q->g.box);
}

static cf_walls walls_of(const int which) {
  cf_walls w = {0};
  for (int a = 0; a < 3; ++a)
    for (int side = 0; side < 2; ++side)
      w.kind[a][side] = which == 2 && a != 1 ? CF_WALL_PERIODIC
                        : which == 1         ? CF_WALL_OPEN
                                             : CF_WALL_INSULATED;
  return w;
}

static void little_diffusion_takes_one_pass(void **state) {
  (void)state;
  const double sigmas[] = {1e-4, 0.05, 0.4}, tolerance = single ? 1e-5 : 1e-8;
  for (int dim = 2; dim <= 3; ++dim)
    for (int which = 0; which < 2; ++which)
      for (int s = 0; s < 3; ++s)
        for (int field = 0; field < 2; ++field) {
          const cf_walls walls = walls_of(which);
          problem q;
          cf_solve_report report;
          begin(&q, dim, &walls, 2, sigmas[s], field);
          assert_string_equal(cf_helmholtz_method(q.A), "sor");
          OK(cf_helmholtz_solve(q.A, q.b, &(cf_solve_options){tolerance, 20}, q.x, &report));
          assert_true(report.converged && report.iterations == 1 && report.levels == 1);
          BELOW(cf_helmholtz_residual(q.A, q.x, q.b), 1.001 * tolerance);
          CLOSE(cf_helmholtz_residual(q.A, q.x, q.b), report.residual, 0.001 * tolerance);
          end(&q);
        }
}

/* Slabs and wedges of a pass, and half sweep by half sweep across seams, of an odd axis too. */
static void threads_do_not_show(void **state) {
  (void)state;
  for (int dim = 2; dim <= 3; ++dim)
    for (int which = 0; which < 3; ++which) {
      const cf_walls walls = walls_of(which);
      problem q[3];
      cf_solve_report report;
      for (int v = 0; v < 3; ++v) {
        begin(&q[v], dim, &walls, v == 0 ? 1 : v == 1 ? 2 : 5, 0.08, true);
        OK(cf_helmholtz_solve(q[v].A, q[v].b, &(cf_solve_options){single ? 1e-5 : 1e-8, 20}, q[v].x,
                              &report));
        BELOW(cf_helmholtz_residual(q[v].A, q[v].x, q[v].b), single ? 1.001e-5 : 1.001e-8);
        for (ptrdiff_t row = 0; row < cf_box_rows(&q[v].g.box); ++row)
          assert_memory_equal(q[0].x.at + cf_box_row(&q[v].g.box, row),
                              q[v].x.at + cf_box_row(&q[v].g.box, row),
                              (size_t)q[v].g.box.n[0] * sizeof(cf_real));
      }
      for (int v = 0; v < 3; ++v) end(&q[v]);
    }
}

/* Two lone cells, one at a wall: the residual of all cells is the one that was found where there is something. */
static void far_from_what_is_something_nothing_is_missed(void **state) {
  (void)state;
  const double tolerance = single ? 1e-5 : 1e-8;
  for (int dim = 2; dim <= 3; ++dim)
    for (int s = 0; s < 2; ++s) {
      const cf_walls walls = walls_of(0);
      problem q;
      cf_solve_report report;
      begin(&q, dim, &walls, 2, s == 0 ? 0.01 : 0.4, true);
      for (ptrdiff_t row = 0; row < cf_box_rows(&q.g.box); ++row)
        memset(q.b.at + cf_box_row(&q.g.box, row), 0, (size_t)q.g.box.n[0] * sizeof(cf_real));
      q.b.at[cf_box_at(&q.g.box, dim == 3 ? 20 : 52, 10, dim == 3 ? 9 : 0)] = 1;
      q.b.at[cf_box_at(&q.g.box, 0, 17, dim == 3 ? 25 : 0)] = -2;
      OK(cf_helmholtz_solve(q.A, q.b, &(cf_solve_options){tolerance, 20}, q.x, &report));
      BELOW(cf_helmholtz_residual(q.A, q.x, q.b), 1.001 * tolerance);
      CLOSE(cf_helmholtz_residual(q.A, q.x, q.b), report.residual, 0.001 * tolerance);
      q.b.at[cf_box_at(&q.g.box, 3, dim == 3 ? 1 : 70, dim == 3 ? 20 : 0)] = (cf_real)NAN;
      assert_int_equal(cf_helmholtz_solve(q.A, q.b, &(cf_solve_options){tolerance, 20}, q.x, &report),
                       CF_NOT_FINITE);
      end(&q);
    }
}

static void what_is_not_a_number_is_refused(void **state) {
  (void)state;
  const cf_walls walls = walls_of(0);
  problem q;
  cf_solve_report report;
  begin(&q, 2, &walls, 1, 0.1, false);
  memset(&report, 0, sizeof report);
  for (ptrdiff_t row = 0; row < cf_box_rows(&q.g.box); ++row)
    for (int i = 0; i < q.g.box.n[0]; ++i) q.x.at[cf_box_row(&q.g.box, row) + i] = 3;
  q.b.at[cf_box_at(&q.g.box, 5, 6, 0)] = (cf_real)NAN;
  assert_int_equal(cf_helmholtz_solve(q.A, q.b, &(cf_solve_options){1e-5, 20}, q.x, &report), CF_NOT_FINITE);
  end(&q);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(little_diffusion_takes_one_pass),
                                     cmocka_unit_test(threads_do_not_show),
                                     cmocka_unit_test(far_from_what_is_something_nothing_is_missed),
                                     cmocka_unit_test(what_is_not_a_number_is_refused)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
