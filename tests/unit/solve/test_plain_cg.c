/* SPDX-License-Identifier: MIT
 *
 * Conjugate gradients without a preconditioner take the iterations of an independent implementation
 * (cg_counts.csv: 32^3 insulated cells, right side a ball, from x = 0).
 */
#include <stdlib.h>

#include "reference.h"
#include "solve/multigrid.h"
#include "solve/pcg.h"
#include "solve_case.h"

static void fill_ball(const cf_box *box, const cf_cell b) {
  for (int k = 0; k < box->n[2]; ++k)
    for (int j = 0; j < box->n[1]; ++j)
      for (int i = 0; i < box->n[0]; ++i) {
        const double x = (i + 0.5) / box->n[0] - 0.5, y = (j + 0.5) / box->n[1] - 0.5,
                     z = (k + 0.5) / box->n[2] - 0.5;
        b.at[cf_box_at(box, i, j, k)] = x * x + y * y + z * z < 0.06 ? 1 : 0;
      }
}

static int count(const int n, const double sigma, const double tolerance) {
  solve_case c = {.dim = 3, .n = {n, n, n}, .walls = "iii", .sigma = sigma};
  solve_setup s;
  case_begin(&c, &s);
  fill_ball(&s.g.box, s.b);
  cf_cell work[3];
  for (int v = 0; v < 3; ++v) OK(cf_cell_create(&work[v], &s.g.box));
  const cf_solve_options o = {tolerance, 2000};
  const int its = cf_pcg_plain(&s.A->level[0], false, s.b, &o, work, s.x);
  BELOW(cf_helmholtz_residual(s.A, s.x, s.b), 1.001 * tolerance);
  for (int v = 0; v < 3; ++v) cf_cell_destroy(&work[v], &s.g.box);
  case_end(&s);
  return its;
}

static void counts_match_the_reference(void **state) {
  (void)state;
  table t = table_read("cg_counts.csv");
  assert_int_equal(t.rows, 5);
  for (int row = 0; row < t.rows; ++row) {
    const int n = (int)table_at(&t, row, "n");
    const double sigma = table_at(&t, row, "sigma");
    const int loose = count(n, sigma, 1e-6), tight = count(n, sigma, 1e-10);
    print_message("sigma %6g: %3d to 1e-6, %3d to 1e-10\n", sigma, loose, tight);
    assert_true(abs(loose - (int)table_at(&t, row, "cg_ball_1e-6")) <= 1);
    assert_true(abs(tight - (int)table_at(&t, row, "cg_ball_1e-10")) <= 1);
  }
  table_free(&t);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(counts_match_the_reference)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
