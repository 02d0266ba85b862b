/* SPDX-License-Identifier: MIT
 *
 * What a solver meets when something is wrong or extreme: it answers, with numbers or with one clear sentence.
 */
#include <math.h>
#include <string.h>

#include "solve_case.h"

static const cf_solve_options usual = {1e-8, 50};

static bool all_finite(const solve_setup *s) {
  for (ptrdiff_t r = 0; r < cf_box_rows(&s->g.box); ++r)
    for (int i = 0; i < s->g.box.n[0]; ++i)
      if (!isfinite((double)s->x.at[cf_box_row(&s->g.box, r) + i])) return false;
  return true;
}

static void fill(const cf_box *box, const double value, const cf_cell f) {
  for (ptrdiff_t r = 0; r < cf_box_rows(box); ++r)
    for (int i = 0; i < box->n[0]; ++i) f.at[cf_box_row(box, r) + i] = (cf_real)value;
}

static const char *const mixes[] = {"iii", "ooo", "ppp", "iop"};

static void zero_right_side_gives_zero(void **state) {
  (void)state;
  for (int m = 0; m < 4; ++m) {
    solve_case c = {.dim = 3, .n = {9, 8, 7}, .walls = mixes[m], .sigma = 3};
    solve_setup s;
    case_begin(&c, &s);
    fill(&s.g.box, 0, s.b);
    fill(&s.g.box, 5, s.x);
    cf_solve_report report;
    OK(cf_helmholtz_solve(s.A, s.b, &usual, s.x, &report));
    assert_true(report.converged);
    assert_int_equal(report.iterations, 0);
    for (int i = 0; i < 9; ++i) CLOSE(s.x.at[i], 0, 0);
    case_end(&s);
  }
}

static void a_singular_system_keeps_the_mean_it_came_with(void **state) {
  (void)state;
  for (int dim = 2; dim <= 3; ++dim)
    for (int m = 0; m < 2; ++m)
      for (int zero = 0; zero < 2; ++zero) {
        solve_case c = {.dim = dim, .n = {20, 13, 9}, .walls = m ? "ppp" : "iii", .sigma = INFINITY};
        solve_setup s;
        case_begin(&c, &s);
        if (zero) fill(&s.g.box, 0, s.b);
        fill(&s.g.box, 2.5, s.x);
        cf_solve_report report;
        OK(cf_helmholtz_solve(s.A, s.b, &usual, s.x, &report));
        assert_true(report.converged);
        double sum = 0;
        for (ptrdiff_t r = 0; r < cf_box_rows(&s.g.box); ++r)
          for (int i = 0; i < c.n[0]; ++i) sum += (double)s.x.at[cf_box_row(&s.g.box, r) + i];
        CLOSE(sum / (double)cf_box_cells(&s.g.box), 2.5, 1e-6);
        case_end(&s);
      }
}

/* A right side that does not sum to zero has no solution between insulated walls: its mean is taken out. */
static void inconsistent_neumann_data_are_made_consistent(void **state) {
  (void)state;
  solve_case c = {.dim = 2, .n = {32, 24, 1}, .walls = "ip", .sigma = INFINITY};
  solve_setup s;
  case_begin(&c, &s);
  for (int j = 0; j < 24; ++j)
    for (int i = 0; i < 32; ++i) s.b.at[cf_box_at(&s.g.box, i, j, 0)] += 100;
  cf_solve_report report;
  OK(cf_helmholtz_solve(s.A, s.b, &(cf_solve_options){1e-5, 50}, s.x, &report));
  assert_true(report.converged);
  BELOW(cf_helmholtz_residual(s.A, s.x, s.b), 1.1e-5);
  case_end(&s);
}

static void values_that_are_not_finite_are_refused(void **state) {
  (void)state;
  const double bad[] = {NAN, INFINITY, -INFINITY};
  for (int v = 0; v < 3; ++v)
    for (int in_x = 0; in_x < 2; ++in_x)
      for (int m = 0; m < 4; ++m)
        for (int poisson = 0; poisson < 2; ++poisson) {
          solve_case c = {.dim = 2, .n = {17, 12, 1}, .walls = mixes[m], .sigma = poisson ? INFINITY : 4};
          solve_setup s;
          case_begin(&c, &s);
          (in_x ? s.x : s.b).at[cf_box_at(&s.g.box, 16, 5, 0)] = (cf_real)bad[v];
          cf_solve_report report;
          assert_int_equal(cf_helmholtz_solve(s.A, s.b, &usual, s.x, &report), CF_NOT_FINITE);
          assert_non_null(strstr(cf_status_sentence(), "finite"));
          case_end(&s);
        }
}

static void a_box_of_one_cell_is_a_division(void **state) {
  (void)state;
  for (int dim = 2; dim <= 3; ++dim)
    for (int m = 0; m < 4; ++m) {
      solve_case c = {.dim = dim, .n = {1, 1, 1}, .walls = mixes[m], .sigma = 3};
      solve_setup s;
      case_begin(&c, &s);
      s.b.at[0] = 2;
      cf_solve_report report;
      OK(cf_helmholtz_solve(s.A, s.b, &usual, s.x, &report));
      double diagonal = 1;
      for (int a = 0; a < dim; ++a)
        for (int side = 0; side < 2; ++side) diagonal += cf_wall_is_held(s.walls.kind[a][side]) ? 6 : 0;
      CLOSE(s.x.at[0], 2 / diagonal, 1e-6);
      case_end(&s);
    }
}

static void one_cell_without_an_equation_keeps_its_value(void **state) {
  (void)state;
  solve_case c = {.dim = 3, .n = {1, 1, 1}, .walls = "ipi", .sigma = INFINITY};
  solve_setup s;
  case_begin(&c, &s);
  s.x.at[0] = 7;
  cf_solve_report report;
  OK(cf_helmholtz_solve(s.A, s.b, &usual, s.x, &report));
  CLOSE(s.x.at[0], 7, 0);
  case_end(&s);
}

static void long_thin_boxes_are_solved(void **state) {
  (void)state;
  const int n[][3] = {{4, 4, 4096}, {4096, 4, 4}, {1, 4096, 1}, {2, 3, 2000}, {4095, 1, 1}};
  for (int q = 0; q < 5; ++q)
    for (int m = 0; m < 4; ++m)
      for (int sigma = 0; sigma < 3; ++sigma) {
        solve_case c = {.dim = 3, .n = {n[q][0], n[q][1], n[q][2]}, .walls = mixes[m]};
        c.sigma = sigma == 0 ? 1 : sigma == 1 ? 1e4 : INFINITY;
        c.side = SIDE_NOISY;
        solve_setup s;
        case_begin(&c, &s);
        cf_solve_report report;
        OK(cf_helmholtz_solve(s.A, s.b, &(cf_solve_options){1e-6, 50}, s.x, &report));
        if (!report.converged || report.iterations > 10)
          fail_msg("%d x %d x %d, walls %s, sigma %g: %d iterations", n[q][0], n[q][1], n[q][2], mixes[m],
                   c.sigma, report.iterations);
        BELOW(cf_helmholtz_residual(s.A, s.x, s.b), 1.1e-6);
        case_end(&s);
      }
}

/* Extreme numbers: an answer that is finite, or a report or failure that says so; never a crash, never silence.
 * With a mean of b/alpha beside differences of b/beta, round-off alone leaves beta/alpha epsilon of b. */
static void extreme_coefficients_never_pass_for_a_solution(void **state) {
  (void)state;
  const double alphas[] = {0, 1e-300, 1e-12, 1, 1e300}, betas[] = {0, 1e-300, 1, 1e12, 1e300};
  for (int dim = 2; dim <= 3; ++dim)
    for (int m = 0; m < 4; ++m)
      for (int a = 0; a < 5; ++a)
        for (int b = 0; b < 5; ++b)
          for (int few = 0; few < 2; ++few) {
            solve_case c = {.dim = dim, .n = {few ? 3 : 17, few ? 4 : 10, 5}, .walls = mixes[m], .sigma = 1};
            solve_setup s;
            case_begin(&c, &s);
            OK(cf_helmholtz_set(s.A, &(cf_coefficients){.alpha = alphas[a], .beta = betas[b]}));
            cf_solve_report report;
            const cf_status status = cf_helmholtz_solve(s.A, s.b, &usual, s.x, &report);
            if (status == CF_OK && report.converged && !all_finite(&s))
              fail_msg("walls %s, alpha %g, beta %g: converged to what is not finite", mixes[m], alphas[a],
                       betas[b]);
            const double residual = cf_helmholtz_residual(s.A, s.x, s.b);
            const double attainable = 1e-6 + 10 * CF_REAL_EPSILON * betas[b] / alphas[a];
            if (status == CF_OK && report.converged && alphas[a] > 0 && !(residual <= attainable))
              fail_msg("walls %s, alpha %g, beta %g: %g is no solution", mixes[m], alphas[a], betas[b],
                       residual);
            case_end(&s);
          }
}

/* sigma = 1e12 and more is Poisson's equation but for the mean, which is known: sum alpha x = sum b. */
static void a_vanishing_alpha_still_fixes_the_mean(void **state) {
  (void)state;
  for (int m = 0; m < 3; m += 2)
    for (int few = 0; few < 2; ++few) {
      solve_case c = {.dim = 2, .n = {few ? 5 : 40, few ? 6 : 33, 1}, .walls = mixes[m], .sigma = 1e12};
      solve_setup s;
      case_begin(&c, &s);
      fill(&s.g.box, 3, s.b);
      cf_solve_report report;
      OK(cf_helmholtz_solve(s.A, s.b, &(cf_solve_options){1e-5, 50}, s.x, &report));
      assert_true(report.converged);
      for (int i = 0; i < 5; ++i) CLOSE(s.x.at[i], 3, 1e-3);
      case_end(&s);
    }
}

static void coefficients_out_of_range_are_refused(void **state) {
  (void)state;
  solve_case c = {.dim = 2, .n = {8, 8, 1}, .walls = "ii", .sigma = 1};
  solve_setup s;
  case_begin(&c, &s);
  const double bad[] = {-1, NAN, INFINITY, -INFINITY};
  for (int v = 0; v < 4; ++v) {
    assert_int_equal(cf_helmholtz_set(s.A, &(cf_coefficients){.alpha = bad[v], .beta = 1}), CF_BAD_ARGUMENT);
    assert_int_equal(cf_helmholtz_set(s.A, &(cf_coefficients){.alpha = 1, .beta = bad[v]}), CF_BAD_ARGUMENT);
  }
  case_end(&s);
  cf_walls half = {0};
  half.kind[1][0] = CF_WALL_PERIODIC;
  cf_helmholtz *A;
  assert_int_equal(cf_helmholtz_create(&A, &s.g, &half, 0), CF_BAD_ARGUMENT);
  assert_null(A);
}

static void too_few_iterations_are_reported(void **state) {
  (void)state;
  for (int limit = 0; limit < 3; ++limit) {
    solve_case c = {.dim = 2, .n = {64, 64, 1}, .walls = "ii", .sigma = 100, .side = SIDE_NOISY};
    solve_setup s;
    case_begin(&c, &s);
    cf_solve_report report;
    OK(cf_helmholtz_solve(s.A, s.b, &(cf_solve_options){1e-6, limit}, s.x, &report));
    assert_false(report.converged);
    assert_int_equal(report.iterations, limit);
    CLOSE(report.residual / cf_helmholtz_residual(s.A, s.x, s.b), 1, 1e-3);
    case_end(&s);
  }
}

/* Below what the precision can reach the solver stops, reports, and leaves a solution as good as there is. */
static void an_impossible_tolerance_ends(void **state) {
  (void)state;
  for (int m = 0; m < 4; ++m) {
    solve_case c = {.dim = 3, .n = {20, 21, 12}, .walls = mixes[m], .sigma = m % 2 ? 1e3 : INFINITY};
    c.beta = m % 2 ? BETA_BLOCKS : BETA_NUMBER;
    solve_setup s;
    case_begin(&c, &s);
    cf_solve_report report;
    OK(cf_helmholtz_solve(s.A, s.b, &(cf_solve_options){1e-200, 200}, s.x, &report));
    assert_true(all_finite(&s));
    BELOW(cf_helmholtz_residual(s.A, s.x, s.b), 2e4 * CF_REAL_EPSILON);
    case_end(&s);
  }
}

static void a_good_guess_needs_no_work(void **state) {
  (void)state;
  solve_case c = {.dim = 2, .n = {40, 30, 1}, .walls = "op", .sigma = 50, .side = SIDE_MIXED};
  solve_setup s;
  case_begin(&c, &s);
  cf_solve_report report;
  OK(cf_helmholtz_solve(s.A, s.b, &(cf_solve_options){1e-5, 50}, s.x, &report));
  OK(cf_helmholtz_solve(s.A, s.b, &(cf_solve_options){2e-5, 50}, s.x, &report));
  assert_int_equal(report.iterations, 0);
  case_end(&s);
}

/* What lies in a caller's ghosts is no part of the system. */
/* x of a box that is one cell thick along `thin`, and goes around there or is closed there. */
static void thin_box(const int thin, const bool around, const double sigma, solve_setup *s) {
  char walls[] = "oop";
  solve_case c = {.dim = 3, .n = {21, 18, 34}, .sigma = sigma, .walls = walls, .side = SIDE_MIXED};
  c.n[thin] = 1;
  walls[thin] = around ? 'p' : 'i';
  case_begin(&c, s);
  cf_solve_report report;
  OK(cf_helmholtz_solve(s->A, s->b, &usual, s->x, &report));
  assert_true(report.converged);
  assert_true(cf_helmholtz_residual(s->A, s->x, s->b) < 1e-8);
}

static void an_axis_of_one_cell_does_not_go_around(void **state) {
  (void)state;
  static const double sigmas[] = {0.1, 2, 40, INFINITY};
  for (int thin = 0; thin < 3; ++thin)
    for (int i = 0; i < 4; ++i) {
      solve_setup s[2];
      for (int around = 0; around < 2; ++around) thin_box(thin, around, sigmas[i], &s[around]);
      for (ptrdiff_t r = 0; r < cf_box_rows(&s[0].g.box); ++r) {
        const ptrdiff_t p = cf_box_row(&s[0].g.box, r);
        assert_memory_equal(s[0].x.at + p, s[1].x.at + p, (size_t)s[0].g.box.n[0] * sizeof(cf_real));
      }
      for (int around = 0; around < 2; ++around) case_end(&s[around]);
    }
}

/* Boxes of all methods, at tolerances that rounding does not allow among them. */
static void what_is_reported_is_true(void **state) {
  (void)state;
  static const solve_case cases[] = {
      {.dim = 2, .n = {1, 16, 1}, .walls = "ig", .sigma = 5e6},
      {.dim = 3, .n = {2, 1, 21}, .walls = "iii", .sigma = 1e5, .side = SIDE_MIXED},
      {.dim = 2, .n = {33, 33, 1}, .walls = "op", .sigma = 2e6, .side = SIDE_MIXED},
      {.dim = 3, .n = {32, 34, 21}, .walls = "iip", .sigma = 5e5, .side = SIDE_NOISY},
      {.dim = 3, .n = {33, 12, 8}, .walls = "oio", .sigma = 1e3, .side = SIDE_MIXED},
      {.dim = 3, .n = {32, 12, 8}, .walls = "pio", .sigma = 0.02},
      {.dim = 2, .n = {32, 12, 1}, .walls = "pi", .sigma = 30, .beta = BETA_BLOCKS, .side = SIDE_NOISY},
  };
  for (size_t i = 0; i < sizeof cases / sizeof *cases; ++i)
    for (double tolerance = 1e-3; tolerance > 1e-14; tolerance *= 1e-3) {
      solve_setup s;
      cf_solve_report report;
      case_begin(&cases[i], &s);
      const double start = cf_helmholtz_residual(s.A, s.x, s.b);
      OK(cf_helmholtz_solve(s.A, s.b, &(cf_solve_options){tolerance, 60}, s.x, &report));
      const double truth = cf_helmholtz_residual(s.A, s.x, s.b);
      assert_true(fabs(truth - report.residual) <= 0.2 * truth + (tolerance > 1e-8 ? 1e-7 * start : 0));
      case_end(&s);
    }
}

static void ghosts_of_x_and_b_do_not_matter(void **state) {
  (void)state;
  solve_case c = {.dim = 3, .n = {10, 9, 8}, .walls = "iop", .sigma = 50, .side = SIDE_MIXED};
  double clean[8] = {0};
  for (int dirty = 0; dirty < 2; ++dirty) {
    solve_setup s;
    case_begin(&c, &s);
    if (dirty) {
      for (int k = -3; k < 11; ++k)
        for (int j = -3; j < 12; ++j)
          for (int i = -3; i < 13; ++i) {
            if (i >= 0 && i < 10 && j >= 0 && j < 9 && k >= 0 && k < 8) continue;
            s.x.at[cf_box_at(&s.g.box, i, j, k)] = (cf_real)NAN;
            s.b.at[cf_box_at(&s.g.box, i, j, k)] = (cf_real)NAN;
          }
    }
    cf_solve_report report;
    OK(cf_helmholtz_solve(s.A, s.b, &usual, s.x, &report));
    for (int i = 0; i < 8; ++i) {
      const double x = (double)s.x.at[cf_box_at(&s.g.box, i, i, i)];
      if (dirty) CLOSE(x, clean[i], 0);
      clean[i] = x;
    }
    case_end(&s);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(zero_right_side_gives_zero),
      cmocka_unit_test(a_singular_system_keeps_the_mean_it_came_with),
      cmocka_unit_test(inconsistent_neumann_data_are_made_consistent),
      cmocka_unit_test(values_that_are_not_finite_are_refused),
      cmocka_unit_test(a_box_of_one_cell_is_a_division),
      cmocka_unit_test(one_cell_without_an_equation_keeps_its_value),
      cmocka_unit_test(long_thin_boxes_are_solved),
      cmocka_unit_test(extreme_coefficients_never_pass_for_a_solution),
      cmocka_unit_test(a_vanishing_alpha_still_fixes_the_mean),
      cmocka_unit_test(coefficients_out_of_range_are_refused),
      cmocka_unit_test(too_few_iterations_are_reported),
      cmocka_unit_test(an_impossible_tolerance_ends),
      cmocka_unit_test(a_good_guess_needs_no_work),
      cmocka_unit_test(an_axis_of_one_cell_does_not_go_around),
      cmocka_unit_test(what_is_reported_is_true),
      cmocka_unit_test(ghosts_of_x_and_b_do_not_matter),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
