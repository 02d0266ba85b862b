/* SPDX-License-Identifier: MIT
 *
 * What coarse levels need beyond what their blocks tell: a bar that turns by a right angle conducts on the coarse level what it
 * conducts on the finer one once couplings at the corner are larger, and not before; and it does not matter in which
 * parts a level is made.
 */
#include "solve/amend.h"

#include <math.h>

#include "solve/band.h"
#include "solve/coarsen.h"
#include "testing.h"

enum { ARM = 8, CELLS = 2 * ARM };

static bool is_inside(const int i, const int j) {
  return i >= 0 && j >= 0 && i < CELLS && j < CELLS && (i < ARM || j < ARM);
}

/* Couplings of 1 in an L, known values beyond the ends of both arms. */
static void fill(const cf_coupled *l) {
  for (int j = 0; j < CELLS; ++j)
    for (int i = 0; i < CELLS; ++i) {
      const ptrdiff_t p = cf_box_at(&l->box, i, j, 0);
      const bool here = is_inside(i, j);
      l->c[0][p] = here && is_inside(i - 1, j) ? 1 : 0;
      l->c[1][p] = here && is_inside(i, j - 1) ? 1 : 0;
      l->held[p] = here && (i == CELLS - 1 || j == CELLS - 1) ? 2 : 0;
    }
}

/* What flows from 1 beyond the end of one arm to 0 beyond the other. */
static double conductance(const cf_coupled *l) {
  const int n = l->box.n[0];
  cf_band band = {0};
  OK(cf_band_factor(&band, l));
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < n; ++i) {
      const ptrdiff_t p = cf_box_at(&l->box, i, j, 0);
      l->r[p] = i == n - 1 ? l->held[p] : 0;
    }
  cf_band_solve(&band, l);
  double sum = 0;
  for (int j = 0; j < n; ++j) {
    const ptrdiff_t p = cf_box_at(&l->box, n - 1, j, 0);
    sum += (double)l->held[p] * (1 - (double)l->e[p]);
  }
  cf_band_destroy(&band);
  return sum;
}

static void a_corner_lets_as_much_pass_on_the_coarse_level(void **state) {
  (void)state;
  cf_box box;
  cf_coupled fine, coarse;
  OK(cf_box_init(&box, 2, (int[]){CELLS, CELLS, 1}, 1));
  OK(cf_coupled_create(&fine, &box, (bool[]){false, false, false}, 2, NULL));
  fine.coarsened[0] = fine.coarsened[1] = true;
  fill(&fine);
  const cf_part all = cf_coupled_all(&fine);
  OK(cf_coupled_finish(&fine, &all));
  OK(cf_coarsen_create(&fine, &coarse));
  const cf_part below = cf_coupled_all(&coarse);
  const double passes = conductance(&fine);
  double off[2];
  for (int with = 0; with < 2; ++with) {
    coarse.excess[2] = with ? 0.15f : 0;
    OK(cf_coarsen(&fine, &coarse, &below));
    off[with] = conductance(&coarse) / passes - 1;
  }
  print_message("the coarse level lets %.4f less pass, with couplings at corners 1.15 times as large %.5f\n",
                -off[0], -off[1]);
  assert_true(off[0] < -0.01);
  BELOW(fabs(off[1]), 5e-4);
  /* alpha and beta that differ are in all of the level */
  coarse.excess[1] = 0.5f;
  OK(cf_coarsen(&fine, &coarse, &below));
  BELOW(fabs(conductance(&coarse) / passes / 1.5 - 1), 5e-4);
  cf_coupled_destroy(&coarse);
  cf_coupled_destroy(&fine);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(a_corner_lets_as_much_pass_on_the_coarse_level)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
