/* SPDX-License-Identifier: MIT
 *
 * One Fourier mode on the MAC grid: both schemes must reproduce the closed-form step matrix to round-off
 * (amplification.csv: phi = P cos(m pi x/L) in cells, q = Q sin(m pi x/L) on faces, insulated walls).
 */
#include <math.h>

#include "physics/diffuse.h"
#include "reference.h"
#include "testing.h"

static void run(const table *t, const int row, const cf_diffuse_scheme scheme, double *P, double *Q) {
  const int n[3] = {(int)table_at(t, row, "n"), 1, 1};
  const double pi = acos(-1), L = table_at(t, row, "L"), K = table_at(t, row, "m") * pi / L, h = L / n[0];
  cf_grid g;
  OK(cf_grid_init(&g, 2, n, h, NULL));
  const cf_walls walls = {0};
  const cf_diffuse_params p = {.k = cf_fn_constant(table_at(t, row, "k")),
                               .capacity = cf_fn_constant(1),
                               .tau = table_at(t, row, "tau"),
                               .f_t = table_at(t, row, "F"),
                               .scheme = scheme,
                               .solver = {1e-14, 200}};
  cf_cell phi;
  cf_face q;
  cf_diffuse *d;
  OK(cf_cell_create(&phi, &g.box));
  OK(cf_face_create(&q, &g.box));
  OK(cf_diffuse_create(&d, &g, &walls, &p, NULL));
  for (int i = 0; i < n[0]; ++i) phi.at[i] = (cf_real)cos(K * (i + 0.5) * h);
  for (int i = 1; i < n[0]; ++i) q.at[0][i] = (cf_real)(0.25 * sin(K * i * h));
  cf_ledger ledger = {.first = cf_diffuse_content(d, phi)};
  cf_solve_report report;
  const double dt = table_at(t, row, "dt");
  for (int s = 0; s < (int)table_at(t, row, "nsteps"); ++s)
    OK(cf_diffuse_step(d, s * dt, dt, phi, q, &ledger, &report));
  *P = *Q = 0;
  for (int i = 0; i < n[0]; ++i) *P += 2.0 / n[0] * (double)phi.at[i] * cos(K * (i + 0.5) * h);
  for (int i = 1; i < n[0]; ++i) *Q += 2.0 / n[0] * (double)q.at[0][i] * sin(K * i * h);
  cf_diffuse_destroy(d);
  cf_cell_destroy(&phi, &g.box);
  cf_face_destroy(&q, &g.box);
}

static void every_step_matches_the_closed_form(void **state) {
  (void)state;
  const double tolerance = sizeof(cf_real) == 8 ? 1e-12 : 1e-5;
  table t = table_read("amplification.csv");
  int compared = 0;
  for (int row = 0; row < t.rows; ++row) {
    const int paper = table_is(&t, row, "scheme", "be");
    if (!paper && !table_is(&t, row, "scheme", "sdirk2")) continue;
    double P, Q;
    run(&t, row, paper ? CF_DIFFUSE_PAPER : CF_DIFFUSE_SDIRK2, &P, &Q);
    CLOSE(P, table_at(&t, row, "P"), tolerance);
    CLOSE(Q, table_at(&t, row, "Q"), tolerance);
    ++compared;
  }
  assert_int_equal(compared, 108);
  table_free(&t);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(every_step_matches_the_closed_form)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
/* also in single precision */
