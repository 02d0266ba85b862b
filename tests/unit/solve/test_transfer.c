/* SPDX-License-Identifier: MIT
 *
 * Between levels: restriction averages (and so keeps integrals), prolongation reproduces constants and, away from
 * walls, linear functions; coarse faces carry what the fine ones beneath them carry in series and side by side.
 */
#include <math.h>

#include "solve/coarsen.h"
#include "solve/multigrid.h"
#include "solve/transfer.h"
#include "solve_case.h"

static const int extents[][4] = {{2, 12, 9, 1}, {2, 9, 11, 1}, {2, 64, 3, 1},
                                 {3, 5, 6, 7},  {3, 8, 8, 4},  {3, 9, 3, 5}};
enum { EXTENTS = sizeof extents / sizeof *extents };

static void begin(const int e, const char *walls, solve_setup *s) {
  solve_case c = {.dim = extents[e][0], .n = {extents[e][1], extents[e][2], extents[e][3]}, .walls = walls};
  c.sigma = INFINITY;
  case_begin(&c, s);
  assert_true(s->A->levels > 1);
}

static double smooth_at(const cf_level *l, const int at[3], const double slope[3]) {
  double sum = 1;
  for (int a = 0; a < l->box.dim; ++a) {
    double centre = 0.5 * l->axis[a].width[at[a]];
    for (int i = 0; i < at[a]; ++i) centre += l->axis[a].width[i];
    sum += slope[a] * centre;
  }
  return sum;
}

static void fill(const cf_level *l, const double slope[3], const cf_cell f) {
  int at[3];
  for (at[2] = 0; at[2] < l->box.n[2]; ++at[2])
    for (at[1] = 0; at[1] < l->box.n[1]; ++at[1])
      for (at[0] = 0; at[0] < l->box.n[0]; ++at[0])
        f.at[cf_box_at(&l->box, at[0], at[1], at[2])] = (cf_real)smooth_at(l, at, slope);
}

static void restriction_keeps_integrals_and_constants(void **state) {
  (void)state;
  for (int e = 0; e < EXTENTS; ++e)
    for (int kind = 0; kind < 3; ++kind) {
      solve_setup s;
      begin(e, kind == 0 ? "iii" : kind == 1 ? "ppp" : "ooo", &s);
      cf_helmholtz *A = s.A;
      for (int l = 0; l + 1 < A->levels; ++l) {
        cf_level *fine = &A->level[l], *coarse = &A->level[l + 1];
        uint64_t seed = 3;
        fill(fine, (double[3]){0, 0, 0}, fine->r);
        cf_level_restrict(fine, fine->r, coarse, coarse->b, A->scratch);
        for (ptrdiff_t r = 0; r < cf_box_rows(&coarse->box); ++r)
          for (int i = 0; i < coarse->box.n[0]; ++i)
            CLOSE(coarse->b.at[cf_box_row(&coarse->box, r) + i], 1, 4 * CF_REAL_EPSILON);
        for (ptrdiff_t r = 0; r < cf_box_rows(&fine->box); ++r)
          for (int i = 0; i < fine->box.n[0]; ++i)
            fine->r.at[cf_box_row(&fine->box, r) + i] = (cf_real)test_random(&seed);
        cf_level_restrict(fine, fine->r, coarse, coarse->b, A->scratch);
        const double sum = cf_level_sum(fine, fine->r);
        CLOSE(cf_level_sum(coarse, coarse->b) / sum, 1, 8 * CF_REAL_EPSILON);
      }
      case_end(&s);
    }
}

/* Whether a fine cell's interpolation reaches past a wall. */
static bool at_wall(const cf_level *fine, const int at[3]) {
  for (int a = 0; a < fine->box.dim; ++a) {
    const cf_pairing *p = &fine->pairing[a];
    if (fine->box.n[a] == 1 || !p->coarsened) continue;
    const int last = p->parent[fine->box.n[a] - 1];
    if (at[a] == 0 || at[a] == fine->box.n[a] - 1 || p->parent[at[a]] == last || p->parent[at[a]] == 0)
      return true;
  }
  return false;
}

static void check_prolongation(cf_helmholtz *A, const double slope[3], const bool inside_only) {
  for (int l = 0; l + 1 < A->levels; ++l) {
    cf_level *fine = &A->level[l], *coarse = &A->level[l + 1];
    fill(coarse, slope, coarse->x);
    cf_level_clear(fine, fine->r);
    cf_level_prolong(coarse, coarse->x, fine, fine->r, A->scratch);
    int at[3];
    for (at[2] = 0; at[2] < fine->box.n[2]; ++at[2])
      for (at[1] = 0; at[1] < fine->box.n[1]; ++at[1])
        for (at[0] = 0; at[0] < fine->box.n[0]; ++at[0]) {
          if (inside_only && at_wall(fine, at)) continue;
          const double expected = smooth_at(fine, at, slope);
          CLOSE(fine->r.at[cf_box_at(&fine->box, at[0], at[1], at[2])] / expected, 1, 8 * CF_REAL_EPSILON);
        }
  }
}

static void prolongation_reproduces_constants(void **state) {
  (void)state;
  for (int e = 0; e < EXTENTS; ++e)
    for (int kind = 0; kind < 2; ++kind) {
      solve_setup s;
      begin(e, kind == 0 ? "iii" : "ppp", &s);
      check_prolongation(s.A, (double[3]){0, 0, 0}, false);
      case_end(&s);
    }
}

static void prolongation_reproduces_linear_functions_inside(void **state) {
  (void)state;
  for (int e = 0; e < EXTENTS; ++e)
    for (int kind = 0; kind < 3; ++kind) {
      solve_setup s;
      begin(e, kind == 0 ? "iii" : kind == 1 ? "ppp" : "ooo", &s);
      check_prolongation(s.A, (double[3]){0.3, 0.7, 0.2}, true);
      case_end(&s);
    }
}

/* A level of couplings c(i) across x, 1 across y, and the one above it. */
typedef struct couple {
  cf_coupled fine, coarse;
} couple;

static void couple_begin(couple *t, const bool layered) {
  cf_box box;
  const bool periodic[3] = {false, false, false};
  OK(cf_box_init(&box, 2, (int[]){16, 16, 1}, 1));
  OK(cf_coupled_create(&t->fine, &box, periodic, 1, NULL));
  t->fine.coarsened[0] = t->fine.coarsened[1] = true;
  OK(cf_coarsen_create(&t->fine, &t->coarse));
  for (int j = 0; j < 16; ++j)
    for (int i = 0; i < 16; ++i) {
      const ptrdiff_t p = cf_box_at(&box, i, j, 0);
      t->fine.free[p] = 0.5f;
      t->fine.c[0][p] = i == 0 ? 0 : layered ? (float)(1 + i) : 0.7f;
      t->fine.c[1][p] = j == 0 ? 0 : 0.7f;
    }
  cf_part w = cf_coupled_all(&t->fine);
  OK(cf_coupled_finish(&t->fine, &w));
  w = cf_coupled_all(&t->coarse);
  OK(cf_coarsen(&t->fine, &t->coarse, &w));
}

static void couple_end(couple *t) {
  cf_coupled_destroy(&t->fine);
  cf_coupled_destroy(&t->coarse);
}

/* Twice the faces at twice the distance. */
static void coarse_couplings_of_a_constant_are_that_constant(void **state) {
  (void)state;
  couple t;
  couple_begin(&t, false);
  for (int J = 1; J < 7; ++J)
    for (int I = 2; I < 7; ++I) {
      const ptrdiff_t p = cf_box_at(&t.coarse.box, I, J, 0);
      CLOSE(t.coarse.free[p], 2, 1e-6);
      CLOSE(t.coarse.c[0][p], 0.7, 1e-6);
      CLOSE(t.coarse.c[1][p], 0.7, 1e-6);
      for (int a = 0; a < 2; ++a)
        assert_int_equal(t.fine.weight[a][cf_box_at(&t.fine.box, 2 * I, 2 * J, 0)], 64);
    }
  couple_end(&t);
}

/* Layers across x: between coarse centres the resistances of the fine faces add. */
static void layers_add_in_series(void **state) {
  (void)state;
  couple t;
  couple_begin(&t, true);
  for (int I = 1; I < 8; ++I) {
    const double resistance = 0.5 / (2 * I) + 1.0 / (2 * I + 1) + 0.5 / (2 * I + 2);
    CLOSE(t.coarse.c[0][cf_box_at(&t.coarse.box, I, 3, 0)], 2 / resistance, 1e-4);
  }
  couple_end(&t);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(restriction_keeps_integrals_and_constants),
      cmocka_unit_test(prolongation_reproduces_constants),
      cmocka_unit_test(prolongation_reproduces_linear_functions_inside),
      cmocka_unit_test(coarse_couplings_of_a_constant_are_that_constant),
      cmocka_unit_test(layers_add_in_series),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
/* also in single precision */
