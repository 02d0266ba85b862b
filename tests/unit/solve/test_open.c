/* SPDX-License-Identifier: MIT
 *
 * Fields for coefficients where nothing is closed: levels made whole rows at a time against the same ones made cell by cell,
 * which a region that has every cell inside asks for; and stationary cycles.
 */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "solve/multigrid.h"
#include "solve/varied_part.h"
#include "solve_case.h"

/* Couplings in series are formed in another way, and a weight may fall on the other side of a half. */
enum { WEIGHT_APART = 1 };
#define APART 2e-6

static void compare_floats(const cf_coupled *l, const float *a, const float *b, const char *what) {
  for (ptrdiff_t r = 0; r < cf_box_rows(&l->box); ++r)
    for (int i = 0; i < l->box.n[0]; ++i) {
      const ptrdiff_t p = cf_box_row(&l->box, r) + i;
      if (!(fabs((double)a[p] - (double)b[p]) <= APART * fabs((double)b[p])))
        fail_msg("%s at %d of row %td of %d cells: %.9g, cell by cell %.9g", what, i, r, l->box.n[0],
                 (double)a[p], (double)b[p]);
    }
}

static void compare_weights(const cf_coupled *l, const unsigned char *a, const unsigned char *b) {
  for (ptrdiff_t r = 0; r < cf_box_rows(&l->box); ++r)
    for (int i = 0; i < l->box.n[0]; ++i) {
      const ptrdiff_t p = cf_box_row(&l->box, r) + i;
      if (abs(a[p] - b[p]) > WEIGHT_APART)
        fail_msg("weight at %d of row %td of %d cells: %d, cell by cell %d", i, r, l->box.n[0], a[p], b[p]);
    }
}

/* A level below the finest one that was made from it apart by colour has the bits of one made from it in natural order. */
static void same_below(cf_varied *v) {
  cf_coupled *l = &v->level[1];
  const float *fields[] = {l->free, l->held, l->inverse, l->c[0], l->c[1], l->dim == 3 ? l->c[2] : l->c[1]};
  float *kept = malloc(6 * (size_t)cf_box_cells(&l->box) * sizeof *kept), *at = kept;
  for (int f = 0; f < 6; ++f)
    for (ptrdiff_t r = 0; r < cf_box_rows(&l->box); ++r, at += l->box.n[0])
      memcpy(at, fields[f] + cf_box_row(&l->box, r), (size_t)l->box.n[0] * sizeof *at);
  OK(cf_varied_make_plain(v));
  at = kept;
  for (int f = 0; f < 6; ++f)
    for (ptrdiff_t r = 0; r < cf_box_rows(&l->box); ++r, at += l->box.n[0])
      assert_memory_equal(at, fields[f] + cf_box_row(&l->box, r), (size_t)l->box.n[0] * sizeof *at);
  free(kept);
}

/* The finest level apart by colour holds what it holds in natural order. */
static void same_apart(const cf_varied *v) {
  const cf_coupled *l = &v->level[0];
  const cf_fields *f = &v->fields;
  for (int k = 0; k < l->box.n[2]; ++k)
    for (int j = 0; j < l->box.n[1]; ++j)
      for (int i = 0; i < l->box.n[0]; ++i) {
        const ptrdiff_t p = cf_box_at(&l->box, i, j, k);
        const ptrdiff_t q = j * f->split.row + k * f->split.plane + cf_split_at(&f->split, i);
        assert_true(f->inverse[q] == l->inverse[p]);
        assert_true(f->fixed[f->is_even ? cf_split_at(&f->split, i) : q] == l->free[p] + l->held[p]);
        for (int a = 0; a < l->dim; ++a)
          assert_true(f->c[a][q] == l->c[a][p] && f->weight[a][q] == l->weight[a][p]);
      }
}

static void compare(cf_varied *fast, cf_varied *slow) {
  cf_varied *both[] = {fast, slow};
  for (int v = 0; v < 2; ++v) {
    if (!both[v]->apart) continue;
    same_below(both[v]);
    same_apart(both[v]);
  }
  assert_int_equal(fast->depth, slow->depth);
  for (int at = 0; at < fast->depth; ++at) {
    const cf_coupled *l = &fast->level[at], *m = &slow->level[at];
    assert_int_equal(l->is_gentle, m->is_gentle);
    assert_int_equal(l->has_band, m->has_band);
    compare_floats(l, l->free, m->free, "free");
    compare_floats(l, l->held, m->held, "held");
    compare_floats(l, l->inverse, m->inverse, "1/diagonal");
    for (int a = 0; a < l->dim; ++a) {
      compare_floats(l, l->c[a], m->c[a], "coupling");
      if (at + 1 < fast->depth) compare_weights(l, l->weight[a], m->weight[a]);
    }
  }
}

static cf_coefficients coefficients_of(const solve_setup *s, const solve_case *c, const cf_region *region) {
  return (cf_coefficients){.alpha = isinf(c->sigma) ? 0 : 1,
                           .alpha_at = c->alpha_varies ? &s->alpha : NULL,
                           .beta_at = &s->beta,
                           .region = region};
}

static int apart; /* cases whose finest level was */

/* Returns how many levels below the finest one were made whole rows at a time. */
static int same_levels(const solve_case *c) {
  solve_setup fast, slow;
  cf_region *region;
  int open = 0;
  case_begin(c, &fast);
  apart += fast.A->varied->apart;
  case_begin(c, &slow);
  OK(cf_region_create(&region, &slow.g));
  OK(cf_region_update(region));
  const cf_coefficients all = coefficients_of(&slow, c, region);
  OK(cf_helmholtz_set(slow.A, &all));
  compare(fast.A->varied, slow.A->varied);
  assert_true(fast.A->varied->level[0].is_open);
  assert_false(slow.A->varied->level[0].is_open);
  for (int at = 1; at < fast.A->varied->depth; ++at) open += fast.A->varied->level[at].is_open;
  cf_region_destroy(region);
  case_end(&fast);
  case_end(&slow);
  return open;
}

static void rows_make_the_levels_that_cells_make(void **state) {
  (void)state;
  static const int n[][3] = {{32, 32, 1},  {48, 20, 1},  {64, 4, 1},  {17, 64, 1},  {600, 12, 1},
                             {16, 16, 16}, {32, 12, 20}, {24, 8, 40}, {20, 33, 16}, {4, 4, 64}};
  static const char *const walls[] = {"iii", "oio", "ppp", "iop", "pih"};
  int open = 0;
  for (int q = 0; q < 10; ++q)
    for (int w = 0; w < 5; ++w)
      for (int beta = BETA_SMOOTH; beta <= BETA_BLOCKS; ++beta) {
        solve_case c = {.dim = q < 5 ? 2 : 3, .n = {n[q][0], n[q][1], n[q][2]}, .walls = walls[w]};
        c.sigma = beta == BETA_SMOOTH ? INFINITY : 30;
        c.beta = (case_beta)beta;
        c.alpha_varies = w % 2 && isfinite(c.sigma);
        c.threads = 1 + w % 3;
        open += same_levels(&c);
      }
  assert_true(open > 150 && apart > 100);
  print_message("%d levels below the finest one\n", open);
}

/* --- cycles ----------------------------------------------------------------------------------------------- */

static solve_case random_case(const int dim, const int n, const char *walls, const double sigma) {
  return (solve_case){.dim = dim,
                      .n = {n, n - 4, dim == 3 ? n + 6 : 1},
                      .walls = walls,
                      .sigma = sigma,
                      .beta = BETA_SMOOTH,
                      .side = SIDE_MIXED};
}

static void threads_do_not_change_a_bit(void **state) {
  (void)state;
  static const char *const walls[] = {"iii", "oio", "pop"};
  for (int w = 0; w < 3; ++w)
    for (int dim = 2; dim <= 3; ++dim) {
      solve_setup s[3];
      for (int t = 0; t < 3; ++t) {
        solve_case c = random_case(dim, dim == 2 ? 160 : 42, walls[w], 50);
        c.threads = 1 + t;
        c.alpha_varies = w == 1;
        cf_solve_report report;
        case_begin(&c, &s[t]);
        OK(cf_helmholtz_solve(s[t].A, s[t].b, &(cf_solve_options){1e-8, 40}, s[t].x, &report));
        assert_true(report.converged);
        for (ptrdiff_t r = 0; r < cf_box_rows(&s[t].g.box); ++r) {
          const ptrdiff_t p = cf_box_row(&s[t].g.box, r);
          assert_memory_equal(s[t].x.at + p, s[0].x.at + p, (size_t)c.n[0] * sizeof(cf_real));
        }
      }
      for (int t = 0; t < 3; ++t) case_end(&s[t]);
    }
}

/* Far below what single precision can tell as well; few cycles, with or without alpha. */
static void cycles_tell_the_residual_that_is_true(void **state) {
  (void)state;
  static const double tolerance[] = {1e-4, 1e-6, 1e-10, 1e-13};
  static const int most[] = {5, 7, 12, 16};
  for (int dim = 2; dim <= 3; ++dim)
    for (int m = 0; m < 4; ++m)
      for (int poisson = 0; poisson < 2; ++poisson) {
        const solve_case c = random_case(dim, dim == 2 ? 128 : 48, "iii", poisson ? INFINITY : 30);
        solve_setup s;
        cf_solve_report report;
        case_begin(&c, &s);
        assert_true(cf_varied_can_cycle(s.A->varied));
        OK(cf_helmholtz_solve(s.A, s.b, &(cf_solve_options){tolerance[m], 40}, s.x, &report));
        const double residual = cf_helmholtz_residual(s.A, s.x, s.b);
        assert_true(report.converged);
        BELOW(residual, 1.001 * tolerance[m] + 2e-12);
        BELOW(fabs(report.residual - residual), 1e-7);
        BELOW(report.iterations, most[m]);
        case_end(&s);
      }
}

/* Where alpha holds enough, half sweeps alone: no levels, few passes, the same bits with any number of threads. */
static void half_sweeps_alone_do_where_alpha_holds(void **state) {
  (void)state;
  static const char *const walls[] = {"iii", "oih", "ppp"};
  for (int w = 0; w < 3; ++w)
    for (int dim = 2; dim <= 3; ++dim) {
      solve_setup s[2];
      for (int t = 0; t < 2; ++t) {
        solve_case c = random_case(dim, dim == 2 ? 96 : 38, walls[w], dim == 2 ? 0.6 : 0.4);
        c.threads = 1 + 2 * t;
        c.alpha_varies = w == 1;
        cf_solve_report report;
        case_begin(&c, &s[t]);
        assert_true(s[t].A->varied->apart && s[t].A->varied->fields.alone);
        assert_string_equal(cf_helmholtz_method(s[t].A), "sor");
        OK(cf_helmholtz_solve(s[t].A, s[t].b, &(cf_solve_options){1e-6, 40}, s[t].x, &report));
        assert_true(report.converged && report.iterations <= 3);
        BELOW(cf_helmholtz_residual(s[t].A, s[t].x, s[t].b), 1.001e-6);
        for (ptrdiff_t r = 0; r < cf_box_rows(&s[t].g.box); ++r) {
          const ptrdiff_t p = cf_box_row(&s[t].g.box, r);
          assert_memory_equal(s[t].x.at + p, s[0].x.at + p, (size_t)c.n[0] * sizeof(cf_real));
        }
      }
      for (int t = 0; t < 2; ++t) case_end(&s[t]);
    }
}

static double mean_of(const cf_box *b, const cf_cell f) {
  double sum = 0;
  for (ptrdiff_t r = 0; r < cf_box_rows(b); ++r)
    for (int i = 0; i < b->n[0]; ++i) sum += (double)f.at[cf_box_row(b, r) + i];
  return sum / (double)cf_box_cells(b);
}

/* Where nothing fixes the level of x its mean stays, whether b has a mean, which has no solution, or none. */
static void a_mean_that_nothing_fixes_stays(void **state) {
  (void)state;
  for (int with = 0; with < 2; ++with)
    for (int m = 0; m < 2; ++m) {
      const solve_case c = random_case(3, 32, "iip", INFINITY);
      solve_setup s;
      cf_solve_report report;
      case_begin(&c, &s);
      assert_true(s.A->varied->apart);
      for (ptrdiff_t r = 0; r < cf_box_rows(&s.g.box); ++r)
        for (int i = 0; i < c.n[0]; ++i) {
          s.x.at[cf_box_row(&s.g.box, r) + i] = 7;
          if (with) s.b.at[cf_box_row(&s.g.box, r) + i] += 3;
        }
      OK(cf_helmholtz_solve(s.A, s.b, &(cf_solve_options){m ? 1e-6 : 1e-11, 40}, s.x, &report));
      assert_true(report.converged);
      BELOW(cf_helmholtz_residual(s.A, s.x, s.b), m ? 1.001e-6 : 1.001e-11);
      BELOW(fabs(mean_of(&s.g.box, s.x) - 7), 1e-12);
      BELOW(fabs(mean_of(&s.g.box, s.b)), 1e-9);
      case_end(&s);
    }
}

/* A plane of closed faces; then none again, with the levels that never had any. */
static void closed_faces_are_seen_and_forgotten(void **state) {
  (void)state;
  const solve_case c = random_case(3, 24, "iii", 30);
  solve_setup s, fresh;
  cf_solve_report report;
  case_begin(&c, &s);
  case_begin(&c, &fresh);
  const cf_coefficients all = coefficients_of(&s, &c, NULL);
  for (int j = 0; j < c.n[1]; ++j)
    for (int k = 0; k < c.n[2]; ++k) s.beta.at[0][cf_box_at(&s.g.box, 11, j, k)] = 0;
  OK(cf_helmholtz_set(s.A, &all));
  assert_false(cf_varied_can_cycle(s.A->varied));
  OK(cf_helmholtz_solve(s.A, s.b, &(cf_solve_options){1e-6, 40}, s.x, &report));
  assert_true(report.converged);
  for (int again = 0; again < 2; ++again) { /* the first time cell by cell: there are marks to wipe out */
    case_fill_beta(&c, &s.g.box, 30, s.beta);
    OK(cf_helmholtz_set(s.A, &all));
    assert_int_equal(s.A->varied->level[0].is_open, again);
  }
  compare(s.A->varied, fresh.A->varied);
  case_end(&s);
  case_end(&fresh);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(threads_do_not_change_a_bit),
      cmocka_unit_test(cycles_tell_the_residual_that_is_true),
      cmocka_unit_test(half_sweeps_alone_do_where_alpha_holds),
      cmocka_unit_test(a_mean_that_nothing_fixes_stays),
      cmocka_unit_test(closed_faces_are_seen_and_forgotten),
      cmocka_unit_test(rows_make_the_levels_that_cells_make),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
