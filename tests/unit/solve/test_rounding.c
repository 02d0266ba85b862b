/* SPDX-License-Identifier: MIT
 *
 * Conjugate gradients at the end of what the precision can hold: they stop there, say so, and never hand back a
 * worse solution than they were given.
 */
/* also in single precision */
#include <math.h>
#include <string.h>

#include "grid/region.h"
#include "solve/helmholtz.h"
#include "testing.h"

static const bool single = sizeof(cf_real) == sizeof(float);

/* A box with a ball in it; the coefficient jumps tenfold at the middle, so no other path can take it. */
typedef struct jump {
  cf_grid g;
  cf_helmholtz *A;
  cf_region *region;
  cf_face beta;
  cf_cell x, b;
} jump;

static void jump_begin(jump *s, const int n, const double alpha) {
  *s = (jump){0};
  OK(cf_grid_init(&s->g, 2, (int[]){n, n, 1}, 1.0 / n, NULL));
  OK(cf_helmholtz_create(&s->A, &s->g, &(cf_walls){0}, 0));
  OK(cf_region_create(&s->region, &s->g));
  OK(cf_face_create(&s->beta, &s->g.box));
  OK(cf_cell_create(&s->x, &s->g.box));
  OK(cf_cell_create(&s->b, &s->g.box));
  const cf_shape ball = cf_shape_sphere((double[]){0.45, 0.55, 0}, 0.2);
  OK(cf_region_add(s->region, &ball, NULL, 0, CF_CELL_WALL, NULL));
  OK(cf_region_update(s->region));
  for (int j = 0; j <= n; ++j)
    for (int i = 0; i <= n; ++i) {
      const ptrdiff_t p = cf_box_at(&s->g.box, i, j, 0);
      for (int a = 0; a < 2; ++a) s->beta.at[a][p] = i < n / 2 ? 1 : 10;
      if (i == n || j == n) continue;
      s->b.at[p] = (cf_real)(cos(3.0 * i / n) * sin(5.0 * j / n));
    }
  OK(cf_helmholtz_set(s->A, &(cf_coefficients){.alpha = alpha, .beta_at = &s->beta, .region = s->region}));
}

static void jump_end(jump *s) {
  cf_helmholtz_destroy(s->A);
  cf_region_destroy(s->region);
  cf_face_destroy(&s->beta, &s->g.box);
  cf_cell_destroy(&s->x, &s->g.box);
  cf_cell_destroy(&s->b, &s->g.box);
}

static void rounding_is_the_end_and_passes_for_it(void **state) {
  (void)state;
  for (int poisson = 0; poisson < 2; ++poisson) {
    jump s;
    cf_solve_report report;
    jump_begin(&s, 96, poisson ? 0 : 1);
    OK(cf_helmholtz_solve(s.A, s.b, &(cf_solve_options){single ? 1e-8 : 1e-16, 200}, s.x, &report));
    print_message("residual %.1e after %d iterations\n", report.residual, report.iterations);
    assert_true(report.converged);
    assert_true(report.iterations < (single ? 25 : 45));
    BELOW(report.residual, single ? 1e-3 : 1e-11);
    BELOW(single ? 1e-8 : 1e-16, report.residual); /* it is said as it is */
    OK(cf_helmholtz_solve(s.A, s.b, &(cf_solve_options){single ? 1e-8 : 1e-16, 200}, s.x, &report));
    assert_true(report.converged);
    assert_true(report.iterations < 10);
    jump_end(&s);
  }
}

/* Also where iterations are few: conjugate gradients make the error smaller, not always the residual. */
static void what_comes_back_is_never_worse(void **state) {
  (void)state;
  uint64_t seed = 3;
  for (int round = 0; round < 3; ++round) {
    jump s;
    cf_solve_report report;
    jump_begin(&s, 48, 0);
    for (int j = 0; j <= 48; ++j)
      for (int i = 0; i <= 48; ++i) {
        const ptrdiff_t p = cf_box_at(&s.g.box, i, j, 0);
        for (int a = 0; a < 2; ++a) s.beta.at[a][p] = (cf_real)pow(10, 4 * test_random(&seed) - 2);
        if (i < 48 && j < 48) s.x.at[p] = (cf_real)(round == 2 ? 100 : round * test_random(&seed));
      }
    OK(cf_helmholtz_set(s.A, &(cf_coefficients){.beta_at = &s.beta, .region = s.region}));
    for (int most = 1; most <= 3; ++most)
      for (int v = 0; v < 12; ++v) {
        const double before = cf_helmholtz_residual(s.A, s.x, s.b);
        OK(cf_helmholtz_solve(s.A, s.b, &(cf_solve_options){1e-16, most}, s.x, &report));
        BELOW(cf_helmholtz_residual(s.A, s.x, s.b), before * (single ? 1.001 : 1 + 1e-6));
      }
    jump_end(&s);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(rounding_is_the_end_and_passes_for_it),
                                     cmocka_unit_test(what_comes_back_is_never_worse)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
