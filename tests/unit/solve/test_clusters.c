/* SPDX-License-Identifier: MIT
 *
 * Levels of clusters: what they are made of, and that what comes out depends on neither threads nor tiles.
 */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "grid/region.h"
#include "grid/tiles.h"
#include "solve/multigrid.h"
#include "solve/varied_part.h"
#include "solve_case.h"

/* Face coefficients between 1 and 1e4, each for itself. */
static void scatter(solve_setup *s) {
  uint64_t seed = 5;
  for (int a = 0; a < s->g.box.dim; ++a)
    for (int k = 0; k < cf_box_extent(&s->g.box, 2, a); ++k)
      for (int j = 0; j < cf_box_extent(&s->g.box, 1, a); ++j)
        for (int i = 0; i < cf_box_extent(&s->g.box, 0, a); ++i)
          s->beta.at[a][cf_box_at(&s->g.box, i, j, k)] = (cf_real)pow(1e4, test_random(&seed));
}

static void open_case(const int dim, const int n, const char *walls, const int threads, solve_setup *s) {
  const solve_case c = {.dim = dim,
                        .n = {n, n - 1, dim == 3 ? n : 1},
                        .walls = walls,
                        .sigma = INFINITY,
                        .beta = BETA_SMOOTH,
                        .threads = threads};
  case_begin(&c, s);
  scatter(s);
}

/* Couplings between unknowns are alike both ways, what is fixed is handed down, and every child has one parent. */
static void check_level(const cf_cluster_level *s, const double fixed, const ptrdiff_t above) {
  double sum = 0;
  for (int32_t u = 0; u < s->n; ++u) {
    sum += (double)s->fixed[u];
    for (int32_t v = s->start[u]; v < s->start[u + 1]; ++v) {
      const int32_t w = s->to[v];
      float back = 0;
      assert_true(w != u && s->c[v] > 0);
      for (int32_t q = s->start[w]; q < s->start[w + 1]; ++q)
        if (s->to[q] == u) back = s->c[q];
      assert_true(fabsf(back - s->c[v]) <= 1e-5f * s->c[v]);
    }
  }
  BELOW(fabs(sum - fixed), 1e-5 * fixed);
  assert_true(s->first[s->n] <= above && 2 * (ptrdiff_t)s->n <= above);
}

static double fixed_above(const cf_coupled *l) {
  double sum = 0;
  for (ptrdiff_t r = 0; r < cf_box_rows(&l->box); ++r)
    for (int i = 0; i < l->box.n[0]; ++i) {
      const ptrdiff_t p = cf_box_row(&l->box, r) + i;
      sum += (double)l->free[p] + (double)l->held[p];
    }
  return sum;
}

static void levels_hold_what_is_above_them(void **state) {
  (void)state;
  for (int dim = 2; dim <= 3; ++dim) {
    solve_setup s;
    cf_clusters q = {0};
    bool made;
    open_case(dim, dim == 2 ? 120 : 30, "ppi", 1, &s);
    /* alpha is too small to hold anything fast, so all is handed down */
    OK(cf_helmholtz_set(s.A, &(cf_coefficients){.alpha = 1e-6, .beta_at = &s.beta}));
    OK(cf_varied_make_plain(s.A->varied));
    const cf_coupled *l = &s.A->varied->level[0];
    assert_true(cf_clusters_are_called_for(l));
    OK(cf_clusters_make(&q, l, &made));
    assert_true(made && q.levels >= 3 && q.factor != NULL);
    const double fixed = fixed_above(l);
    for (int v = 0; v < q.levels; ++v)
      check_level(&q.level[v], fixed, v > 0 ? q.level[v - 1].n : cf_box_cells(&l->box));
    cf_clusters_clear(&q);
    case_end(&s);
  }
}

/* Equal couplings call for no clusters, nor do those a few times apart. */
static void fields_without_jumps_have_none(void **state) {
  (void)state;
  const solve_case c = {.dim = 3, .n = {24, 24, 24}, .walls = "iop", .sigma = 100, .beta = BETA_BLOCKS};
  solve_setup s;
  cf_solve_report report;
  case_begin(&c, &s);
  OK(cf_helmholtz_solve(s.A, s.b, &(cf_solve_options){1e-8, 50}, s.x, &report));
  assert_true(report.converged && s.A->varied->clusters.levels == 0);
  case_end(&s);
}

static void solve(solve_setup *s, int *iterations) {
  cf_solve_report report;
  OK(cf_helmholtz_set(s->A, &(cf_coefficients){.beta_at = &s->beta}));
  OK(cf_helmholtz_solve(s->A, s->b, &(cf_solve_options){1e-8, 60}, s->x, &report));
  assert_true(report.converged && s->A->varied->clusters.levels > 0);
  *iterations = report.iterations;
}

/* Those of other coefficients would do harm; those that are there already serve again. */
static void what_was_solved_before_makes_no_difference(void **state) {
  (void)state;
  solve_setup fresh, used;
  int iterations[3];
  open_case(2, 90, "oo", 1, &fresh);
  open_case(2, 90, "oo", 1, &used);
  for (ptrdiff_t v = 0; v < used.g.box.size; ++v)
    used.beta.at[0][v - used.g.box.first] *= v % 7 < 3 ? 1000 : 1;
  solve(&used, &iterations[0]);
  scatter(&used);
  solve(&fresh, &iterations[0]);
  for (int again = 0; again < 2; ++again) {
    for (ptrdiff_t v = 0; v < used.g.box.size; ++v) used.x.at[v - used.g.box.first] = 0;
    if (again)
      OK(cf_helmholtz_solve(used.A, used.b, &(cf_solve_options){1e-8, 60}, used.x, &(cf_solve_report){0}));
    else
      solve(&used, &iterations[1]);
    for (ptrdiff_t r = 0; r < cf_box_rows(&used.g.box); ++r) {
      const ptrdiff_t p = cf_box_row(&used.g.box, r);
      assert_memory_equal(fresh.x.at + p, used.x.at + p, (size_t)used.g.box.n[0] * sizeof *used.x.at);
    }
  }
  assert_int_equal(iterations[0], iterations[1]);
  case_end(&fresh);
  case_end(&used);
}

static void threads_make_no_difference(void **state) {
  (void)state;
  solve_setup one, three;
  int iterations[2];
  open_case(3, 52, "ipo", 1, &one);
  open_case(3, 52, "ipo", 3, &three);
  solve(&one, &iterations[0]);
  solve(&three, &iterations[1]);
  assert_int_equal(iterations[0], iterations[1]);
  for (ptrdiff_t r = 0; r < cf_box_rows(&one.g.box); ++r) {
    const ptrdiff_t p = cf_box_row(&one.g.box, r);
    assert_memory_equal(one.x.at + p, three.x.at + p, (size_t)one.g.box.n[0] * sizeof *one.x.at);
  }
  case_end(&one);
  case_end(&three);
}

/* A ball of cells whose couplings jump, in the whole box and on its tiles. */
static void tiles_make_no_difference(void **state) {
  (void)state;
  enum { N = 40 };
  solve_setup s[2];
  cf_region *region[2];
  cf_tiles *tiles;
  for (int v = 0; v < 2; ++v) {
    open_case(3, N, "ooo", 1, &s[v]);
    const cf_box *box = &s[v].g.box;
    const double c = 20 * s[v].g.h; /* too wide for a window */
    const cf_shape ball = cf_shape_sphere((double[]){c, c, c}, 18 * s[v].g.h);
    if (v == 1) {
      OK(cf_tiles_create(&tiles, box, NULL));
      cf_tiles_add_box(tiles, (int[]){1, 1, 1}, (int[]){39, 39, 39});
      OK(cf_tiles_update(tiles));
      OK(cf_region_create_on(&region[v], &s[v].g, tiles));
    } else {
      OK(cf_region_create(&region[v], &s[v].g));
    }
    cf_region_fill(region[v], CF_CELL_WALL);
    OK(cf_region_add(region[v], &ball, NULL, 0, CF_CELL_INSIDE, NULL));
    OK(cf_region_update(region[v]));
    OK(cf_helmholtz_set(s[v].A, &(cf_coefficients){.beta_at = &s[v].beta, .region = region[v]}));
    cf_solve_report report;
    OK(cf_helmholtz_solve(s[v].A, s[v].b, &(cf_solve_options){1e-8, 60}, s[v].x, &report));
    assert_true(report.converged);
  }
  int cells = 0;
  for (ptrdiff_t r = 0; r < cf_box_rows(&s[0].g.box); ++r)
    for (int i = 0; i < N; ++i) {
      const ptrdiff_t p = cf_box_row(&s[0].g.box, r) + i;
      if (region[0]->kind[p] != CF_CELL_INSIDE) continue;
      assert_true(s[0].x.at[p] == s[1].x.at[p]);
      ++cells;
    }
  assert_true(cells > 20000 && s[1].A->varied->clusters.levels > 0 && s[1].A->varied->tiles != NULL);
  for (int v = 0; v < 2; ++v) {
    case_end(&s[v]);
    cf_region_destroy(region[v]);
  }
  cf_tiles_destroy(tiles);
}

/* Walls that are single cells, one in four: necks and pockets everywhere. */
static void grains_of_a_cell_take_few_iterations(void **state) {
  (void)state;
  static const double sigma[] = {16, 1e3, 1e5, INFINITY};
  for (int v = 0; v < 4; ++v) {
    const solve_case c = {.dim = 2, .n = {200, 200, 1}, .walls = "ii", .sigma = sigma[v]};
    solve_setup s;
    cf_region *region;
    cf_solve_report report;
    uint64_t seed = 77;
    case_begin(&c, &s);
    OK(cf_region_create(&region, &s.g));
    for (ptrdiff_t r = 0; r < cf_box_rows(&s.g.box); ++r)
      for (int i = 0; i < 200; ++i)
        if (test_random(&seed) < 0.25) region->kind[cf_box_row(&s.g.box, r) + i] = CF_CELL_WALL;
    OK(cf_region_update(region));
    const bool poisson = isinf(sigma[v]);
    OK(cf_helmholtz_set(
        s.A, &(cf_coefficients){.alpha = poisson ? 0 : 1, .beta = poisson ? 1 : sigma[v], .region = region}));
    OK(cf_helmholtz_solve(s.A, s.b, &(cf_solve_options){1e-6, 60}, s.x, &report));
    print_message("sigma %g: %d iterations\n", sigma[v], report.iterations);
    assert_true(report.converged && report.iterations <= 17);
    BELOW(cf_helmholtz_residual(s.A, s.x, s.b), 1.001e-6);
    cf_region_destroy(region);
    case_end(&s);
  }
}

static void memory_that_runs_out_is_given_back(void **state) {
  (void)state;
  solve_setup s;
  cf_clusters q = {0};
  int tries = 0;
  bool made = false;
  open_case(2, 40, "ii", 1, &s);
  OK(cf_helmholtz_set(s.A, &(cf_coefficients){.beta_at = &s.beta}));
  OK(cf_varied_make_plain(s.A->varied));
  for (long n = 1; !made; ++n, ++tries) {
    cf_mem_fail_at(n);
    const cf_status status = cf_clusters_make(&q, &s.A->varied->level[0], &made);
    cf_mem_fail_at(0);
    assert_int_equal(status, made ? CF_OK : CF_NO_MEMORY);
    assert_true(made || q.levels == 0);
  }
  assert_true(tries > 40);
  cf_clusters_clear(&q);
  case_end(&s);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(levels_hold_what_is_above_them),
      cmocka_unit_test(fields_without_jumps_have_none),
      cmocka_unit_test(what_was_solved_before_makes_no_difference),
      cmocka_unit_test(threads_make_no_difference),
      cmocka_unit_test(tiles_make_no_difference),
      cmocka_unit_test(grains_of_a_cell_take_few_iterations),
      cmocka_unit_test(memory_that_runs_out_is_given_back),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
