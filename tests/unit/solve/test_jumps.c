/* SPDX-License-Identifier: MIT
 *
 * Coefficients that jump far: stationary cycles are not made for them, and conjugate gradients go on around levels of
 * clusters. Where nothing can be matched they do around a cycle whose transfers are each other's transposes.
 */
#include <math.h>

#include "solve/multigrid.h"
#include "solve/varied_part.h"
#include "solve_case.h"

static double dot(const cf_coupled *l, const float *f, const float *g) {
  double sum = 0;
  for (ptrdiff_t r = 0; r < cf_box_rows(&l->box); ++r)
    for (int i = 0; i < l->box.n[0]; ++i) {
      const ptrdiff_t p = cf_box_row(&l->box, r) + i;
      sum += (double)f[p] * (double)g[p];
    }
  return sum;
}

/* Numbers between -1 and 1 where there is an equation. */
static void fill(const cf_coupled *l, uint64_t *seed, float *f) {
  for (ptrdiff_t r = 0; r < cf_box_rows(&l->box); ++r)
    for (int i = 0; i < l->box.n[0]; ++i) {
      const ptrdiff_t p = cf_box_row(&l->box, r) + i;
      f[p] = cf_coupled_has(l, p) ? (float)(2 * test_random(seed) - 1) : 0;
    }
}

/* f . P c = R f . c between two levels. Islands have a solution of their own besides. */
static void compare_transfers(const cf_coupled *l, const cf_coupled *coarse, uint64_t *seed) {
  float *f = calloc((size_t)l->box.size, sizeof *f), *c = calloc((size_t)coarse->box.size, sizeof *c);
  assert_true(f != NULL && c != NULL);
  float *fine = f + l->box.first, *wide = c + coarse->box.first;
  fill(l, seed, fine);
  fill(coarse, seed, wide);
  for (ptrdiff_t v = 0; v < l->odds; ++v)
    if (l->odd_island[v] != 0) fine[l->odd_cell[v]] = 0;
  for (ptrdiff_t r = 0; r < cf_box_rows(&l->box); ++r)
    for (int i = 0; i < l->box.n[0]; ++i) {
      const ptrdiff_t p = cf_box_row(&l->box, r) + i;
      l->rest[p] = fine[p];
      l->e[p] = 0;
    }
  cf_coupled_restrict_alike(l, coarse);
  const double down = dot(coarse, coarse->r, wide);
  for (ptrdiff_t r = 0; r < cf_box_rows(&coarse->box); ++r)
    for (int i = 0; i < coarse->box.n[0]; ++i) {
      const ptrdiff_t p = cf_box_row(&coarse->box, r) + i;
      coarse->e[p] = wide[p];
    }
  cf_coupled_prolong_alike(coarse, l);
  const double up = dot(l, fine, l->e);
  BELOW(fabs(up - down), 1e-6 * sqrt(dot(l, fine, fine) * dot(l, l->e, l->e)));
  free(f);
  free(c);
}

static void transfers_are_transposes(void **state) {
  (void)state;
  static const int n[][3] = {{24, 20, 1}, {17, 32, 1}, {16, 12, 20}, {9, 18, 13}, {32, 4, 8}};
  static const char *const walls[] = {"iii", "ppp", "opi", "pio"};
  uint64_t seed = 11;
  for (int q = 0; q < 5; ++q)
    for (int w = 0; w < 4; ++w)
      for (int holes = 0; holes < 2; ++holes) {
        solve_case k = {.dim = q < 2 ? 2 : 3, .n = {n[q][0], n[q][1], n[q][2]}, .walls = walls[w]};
        k.sigma = 100;
        k.beta = BETA_BLOCKS;
        solve_setup s;
        cf_region *region;
        case_begin(&k, &s);
        OK(cf_region_create(&region, &s.g));
        for (ptrdiff_t r = 0; r < cf_box_rows(&s.g.box); ++r)
          for (int i = 0; i < k.n[0] && holes; ++i)
            if (test_random(&seed) < 0.3) region->kind[cf_box_row(&s.g.box, r) + i] = CF_CELL_WALL;
        OK(cf_region_update(region));
        const cf_coefficients all = {.alpha = 1, .beta_at = &s.beta, .region = region};
        OK(cf_helmholtz_set(s.A, &all));
        const cf_varied *v = s.A->varied;
        for (int at = 0; at + 1 < v->depth; ++at) compare_transfers(&v->level[at], &v->level[at + 1], &seed);
        cf_region_destroy(region);
        case_end(&s);
      }
}

/* k of a cell: 1, or many times that, in a ball, in blocks that meet at corners, in layers of a few cells, or at random in
 * between (log-uniform); faces have the harmonic mean. */
typedef enum jumps { BALL, BLOCKS, LAYERS, THIN_LAYERS, CELLS, KINDS } jumps;

static double k_at(const solve_case *c, const jumps kind, const int at[3], const double jump) {
  int sum = 0, here[3] = {0, 0, 0};
  double r2 = 0;
  for (int a = 0; a < c->dim; ++a) {
    here[a] = CF_MIN(CF_MAX(at[a], 0), c->n[a] - 1);
    const double s = (here[a] + 0.5) / c->n[a] - 0.5;
    sum += 5 * here[a] / c->n[a];
    r2 += s * s;
  }
  uint64_t seed = 1 + (uint64_t)(here[0] + 1000 * (here[1] + 1000 * here[2]));
  bool in = false;
  switch (kind) {
    case BALL:
      in = r2 < 0.09;
      break;
    case BLOCKS:
      in = sum % 2 == 1;
      break;
    case LAYERS:
      in = here[0] / 5 % 2 == 1;
      break;
    case THIN_LAYERS:
      in = here[1] * 3 / 4 % 2 == 1;
      break;
    default:
      test_random(&seed);
      return pow(jump, test_random(&seed));
  }
  return in ? jump : 1;
}

/* That with alpha. */
static void jump(const int dim, const jumps kind, const double by, const double alpha, solve_setup *s) {
  const int n = dim == 2 ? 96 : 28;
  const solve_case c = {
      .dim = dim, .n = {n, n, dim == 3 ? n : 1}, .walls = "iii", .sigma = INFINITY, .beta = BETA_SMOOTH};
  case_begin(&c, s);
  for (int a = 0; a < c.dim; ++a)
    for (int k = 0; k < c.n[2] + (a == 2); ++k)
      for (int j = 0; j < c.n[1] + (a == 1); ++j)
        for (int i = 0; i < c.n[0] + (a == 0); ++i) {
          const int here[3] = {i, j, k}, before[3] = {i - (a == 0), j - (a == 1), k - (a == 2)};
          s->beta.at[a][cf_box_at(&s->g.box, i, j, k)] =
              (cf_real)(2 / (1 / k_at(&c, kind, here, by) + 1 / k_at(&c, kind, before, by)));
        }
  const cf_coefficients all = {.alpha = alpha, .beta_at = &s->beta};
  OK(cf_helmholtz_set(s->A, &all));
}

static void jumps_of_any_kind_take_few_iterations(void **state) {
  (void)state;
  static const double by[] = {1e-6, 1e-3, 1e3, 1e6};
  for (int dim = 2; dim <= 3; ++dim)
    for (int kind = 0; kind < KINDS; ++kind) {
      int most = 0;
      for (int v = 0; v < 8; ++v) {
        solve_setup s;
        cf_solve_report report;
        jump(dim, (jumps)kind, by[v / 2], v % 2 ? 0.01 : 0, &s);
        OK(cf_helmholtz_solve(s.A, s.b, &(cf_solve_options){1e-6, 100}, s.x, &report));
        assert_true(report.converged);
        BELOW(cf_helmholtz_residual(s.A, s.x, s.b), 1.001e-6);
        most = CF_MAX(most, report.iterations);
        case_end(&s);
      }
      print_message("%dD, kind %d: at most %d iterations\n", dim, kind, most);
      assert_true(most <= (kind == CELLS ? 25 : 19));
    }
}

/* However far the coefficients jump, and however early it has to stop. */
static void jumps_do_no_harm(void **state) {
  (void)state;
  static const int iterations[] = {1, 2, 5};
  for (int dim = 2; dim <= 3; ++dim)
    for (int v = 0; v < 3; ++v) {
      solve_setup s;
      cf_solve_report report;
      jump(dim, BLOCKS, 1e6, 0, &s);
      OK(cf_helmholtz_solve(s.A, s.b, &(cf_solve_options){1e-6, iterations[v]}, s.x, &report));
      BELOW(cf_helmholtz_residual(s.A, s.x, s.b), 1.001);
      case_end(&s);
    }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(transfers_are_transposes),
      cmocka_unit_test(jumps_of_any_kind_take_few_iterations),
      cmocka_unit_test(jumps_do_no_harm),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
