/* SPDX-License-Identifier: MIT
 *
 * How many V-cycles a solution to a true relative residual of 1e-6 takes: at most 10 for sigma up to 1e3, 12 above
 * and for Poisson's equation, for any walls and any extents. Each test prints the largest count it met, by sigma.
 *
 * Coefficients that jump by 10 inside a cell of a coarse level (blocks that do not fit the extents: the odd ones)
 * cost up to 5 more, blocks that fit up to 2.
 */
#include "solve_case.h"

static const double sigmas[] = {0.1, 0.25, 1, 4, 16, 100, 1e3, 1e4, 1e5, INFINITY};
enum { SIGMAS = sizeof sigmas / sizeof *sigmas };

static const char *const walls_2d[] = {"ii", "oo", "pp", "ip", "op", "io", "ho", "pg", "gh"};
static const char *const walls_3d[] = {"iii", "ooo", "ppp", "iip", "opp", "ioi", "hgp", "pio", "ghi"};
enum { WALLS = 9 };

typedef struct worst {
  const char *what;
  int count[SIGMAS], solved;
} worst;

static void print_worst(const worst *w) {
  print_message("%-26s", w->what);
  for (int s = 0; s < SIGMAS; ++s) print_message("%4d", w->count[s]);
  print_message("   (%d systems)\n", w->solved);
}

static bool blocks_fit(const solve_case *c) {
  for (int a = 0; a < c->dim; ++a)
    if (c->n[a] % 8 != 0) return false;
  return true;
}

static int allowed(const solve_case *c) {
  const int jumps = c->beta == BETA_CHECKERS || c->beta == BETA_BLOCKS;
  return (c->sigma <= 1e3 ? 10 : 12) + (jumps && !blocks_fit(c) ? 5 : 2 * jumps);
}

static int iterations(const solve_case *c) {
  solve_setup s;
  case_begin(c, &s);
  cf_solve_report report;
  OK(cf_helmholtz_solve(s.A, s.b, &(cf_solve_options){1e-6, 100}, s.x, &report));
  const double true_residual = cf_helmholtz_residual(s.A, s.x, s.b);
  case_end(&s);
  if (report.iterations > allowed(c) || !report.converged || !(true_residual <= 1.01e-6))
    fail_msg(
        "%d x %d x %d, walls %s, sigma %g, beta %d, alpha %d, side %d, levels %d: %d iterations, residual "
        "%.3g",
        c->n[0], c->n[1], c->n[2], c->walls, c->sigma, (int)c->beta, c->alpha_varies, (int)c->side, c->levels,
        report.iterations, true_residual);
  return report.iterations;
}

/* Every step-th sigma from one that varies with `mix`, as the right side does. */
static void try_sigmas(solve_case c, const int mix, const int step, worst *w) {
  for (int s = mix % step; s < SIGMAS; s += step) {
    c.sigma = sigmas[s];
    c.side = (case_side)((mix + s) % 3);
    const int count = iterations(&c);
    w->count[s] = count > w->count[s] ? count : w->count[s];
    ++w->solved;
  }
}

static solve_case box(const int dim, const int n0, const int n1, const int n2, const char *walls) {
  return (solve_case){.dim = dim, .n = {n0, n1, n2}, .walls = walls, .threads = 1};
}

static const int small_2d[][2] = {{8, 8},   {16, 16}, {33, 33}, {64, 64}, {65, 131}, {512, 4}, {4, 512},
                                  {9, 300}, {7, 5},   {3, 3},   {2, 2},   {10, 1},   {1, 1},   {100, 37}};
static const int small_3d[][3] = {{3, 3, 3},   {5, 7, 9}, {8, 8, 8},    {9, 9, 9},   {15, 15, 15},
                                  {11, 13, 6}, {2, 2, 2}, {17, 17, 17}, {64, 8, 8},  {4, 4, 128},
                                  {6, 6, 1},   {1, 1, 5}, {2, 40, 3},   {33, 9, 21}, {24, 32, 16}};
enum { SMALL_2D = sizeof small_2d / sizeof *small_2d, SMALL_3D = sizeof small_3d / sizeof *small_3d };

static void small_boxes(const case_beta beta, const int alpha_varies, worst *w) {
  for (int q = 0; q < SMALL_2D + SMALL_3D; ++q)
    for (int v = 0; v < WALLS; ++v) {
      const int *n = q < SMALL_2D ? small_2d[q] : small_3d[q - SMALL_2D];
      solve_case c =
          q < SMALL_2D ? box(2, n[0], n[1], 1, walls_2d[v]) : box(3, n[0], n[1], n[2], walls_3d[v]);
      c.beta = beta;
      c.alpha_varies = alpha_varies;
      try_sigmas(c, q + v, beta == BETA_NUMBER && !alpha_varies ? 1 : 3, w);
    }
  print_worst(w);
}

static void any_extents_and_walls_take_few_iterations(void **state) {
  (void)state;
  static const char *const name[] = {".1", ".25", "1", "4", "16", "100", "1e3", "1e4", "1e5", "inf"};
  print_message("%-26s", "sigma");
  for (int s = 0; s < SIGMAS; ++s) print_message(" %3s", name[s]);
  print_message("\n");
  small_boxes(BETA_NUMBER, 0, &(worst){.what = "number"});
  small_boxes(BETA_NUMBER, 1, &(worst){.what = "number, alpha a field"});
}

static void smooth_coefficients_cost_nothing(void **state) {
  (void)state;
  small_boxes(BETA_SMOOTH, 0, &(worst){.what = "smooth"});
  small_boxes(BETA_SMOOTH, 1, &(worst){.what = "smooth, alpha a field"});
}

static void jumps_of_ten_cost_little(void **state) {
  (void)state;
  small_boxes(BETA_CHECKERS, 0, &(worst){.what = "checkers of 4 cells"});
  small_boxes(BETA_BLOCKS, 1, &(worst){.what = "blocks, alpha a field"});
}

static void counts_do_not_grow_with_the_box(void **state) {
  (void)state;
  for (int beta = BETA_NUMBER; beta <= BETA_BLOCKS; ++beta) {
    int least = 100, most = 0;
    for (int n = 32; n <= (beta == BETA_NUMBER ? 512 : 256); n *= 2) {
      solve_case c = box(2, n, n, 1, "io");
      c.beta = (case_beta)beta;
      c.sigma = INFINITY;
      c.side = SIDE_MIXED;
      const int count = iterations(&c);
      least = count < least ? count : least;
      most = count > most ? count : most;
    }
    print_message("beta %d, Poisson, from 32^2 on: %d to %d\n", beta, least, most);
    BELOW(most - least, beta <= BETA_SMOOTH ? 1 : 6);
  }
}

/* Extents that are not powers of two: the last cells of coarse levels are narrower or wider than the others. */
static void odd_extents_cost_a_cycle_at_most(void **state) {
  (void)state;
  const int odd[][3] = {{63, 63, 63}, {65, 65, 65}, {61, 67, 59}, {57, 71, 61}, {255, 255, 1}, {251, 261, 1}};
  for (int q = 0; q < 6; ++q)
    for (int v = 0; v < 2; ++v)
      for (int s = 0; s < 3; ++s) {
        const int dim = odd[q][2] > 1 ? 3 : 2, n = dim == 3 ? 64 : 256;
        const double sigma[] = {16, 1e4, INFINITY};
        solve_case even = box(dim, n, n, dim == 3 ? n : 1, v ? "ooo" : "iii");
        even.sigma = sigma[s];
        even.side = SIDE_MIXED;
        solve_case c = even;
        memcpy(c.n, odd[q], sizeof c.n);
        const int count = iterations(&c), least = iterations(&even);
        if (count > least + 1)
          fail_msg("%d x %d x %d, walls %s, sigma %g: %d cycles, %d of %d cells a side", c.n[0], c.n[1],
                   c.n[2], c.walls, c.sigma, count, least, n);
      }
}

static void large_boxes_take_few_iterations(void **state) {
  (void)state;
  worst cube = {.what = "96^3"}, brick = {.what = "100 x 60 x 36"}, sheet = {.what = "512^2"};
  const double some[] = {0.25, 4, 1e3, INFINITY};
  for (int s = 0; s < 4; ++s) {
    solve_case c = box(3, 96, 96, 96, s % 2 ? "iii" : "pop");
    c.sigma = some[s];
    c.side = SIDE_MIXED;
    print_message("%s sigma %g: %d\n", cube.what, c.sigma, iterations(&c));
  }
  try_sigmas(box(3, 100, 60, 36, "iii"), 0, 3, &brick);
  try_sigmas(box(3, 100, 60, 36, "opp"), 1, 3, &brick);
  print_worst(&brick);
  try_sigmas(box(2, 512, 512, 1, "pp"), 0, 3, &sheet);
  print_worst(&sheet);
}

/* Cells held at a value by a large alpha, one in seven or a third of the box: they must not drown the others. */
static void held_cells_cost_nothing(void **state) {
  (void)state;
  const int n[][3] = {{13, 9, 5}, {26, 18, 10}, {40, 33, 1}};
  int worst_count = 0;
  for (int q = 0; q < 3; ++q)
    for (int pattern = 0; pattern < 2; ++pattern)
      for (int v = 0; v < WALLS; v += 2)
        for (double weight = 1e3; weight < 1e13; weight *= 1e3) {
          solve_case c = box(q < 2 ? 3 : 2, n[q][0], n[q][1], n[q][2], q < 2 ? walls_3d[v] : walls_2d[v]);
          c.sigma = 1;
          c.side = SIDE_NOISY;
          solve_setup s;
          case_begin(&c, &s);
          OK(cf_cell_create(&s.alpha, &s.g.box));
          for (ptrdiff_t r = 0; r < cf_box_rows(&s.g.box); ++r)
            for (int i = 0; i < c.n[0]; ++i) {
              const ptrdiff_t p = cf_box_row(&s.g.box, r) + i;
              const bool held = pattern == 0 ? (i + r) % 7 == 0 : i < c.n[0] / 3;
              s.alpha.at[p] = (cf_real)(held ? weight : 1);
              if (held) s.b.at[p] = 0;
            }
          OK(cf_helmholtz_set(s.A, &(cf_coefficients){.alpha_at = &s.alpha, .beta = 20}));
          cf_solve_report report;
          OK(cf_helmholtz_solve(s.A, s.b, &(cf_solve_options){1e-6, 100}, s.x, &report));
          BELOW(cf_helmholtz_residual(s.A, s.x, s.b), 1.01e-6);
          case_end(&s);
          BELOW(report.iterations, 8);
          worst_count = report.iterations > worst_count ? report.iterations : worst_count;
        }
  print_message("held cells: at most %d\n", worst_count);
}

/* With few levels the coarsest is solved to its tolerance by conjugate gradients, however large. */
static void any_number_of_levels_does(void **state) {
  (void)state;
  for (int levels = 2; levels <= 6; ++levels) {
    worst w = {.what = "levels"};
    for (int v = 0; v < WALLS; ++v)
      for (int beta = BETA_NUMBER; beta <= BETA_SMOOTH; ++beta) {
        solve_case c = box(2, 48, 33, 1, walls_2d[v]), d = box(3, 16, 12, 9, walls_3d[v]);
        c.levels = d.levels = levels;
        c.beta = d.beta = (case_beta)beta;
        try_sigmas(c, v, 5, &w);
        try_sigmas(d, v + 1, 5, &w);
      }
    print_message("%d ", levels);
    print_worst(&w);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(any_extents_and_walls_take_few_iterations),
      cmocka_unit_test(smooth_coefficients_cost_nothing),
      cmocka_unit_test(jumps_of_ten_cost_little),
      cmocka_unit_test(counts_do_not_grow_with_the_box),
      cmocka_unit_test(odd_extents_cost_a_cycle_at_most),
      cmocka_unit_test(large_boxes_take_few_iterations),
      cmocka_unit_test(held_cells_cost_nothing),
      cmocka_unit_test(any_number_of_levels_does),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
