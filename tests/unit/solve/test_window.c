/* SPDX-License-Identifier: MIT
 *
 * Regions that fill a small part of their box, solved in a window: the solution of the whole box, bits that depend neither on
 * what has been before nor on tiles nor on threads, and which window it is.
 */
/* also in single precision */
#include "solve/window.h"

#include <math.h>
#include <string.h>

#include "base/mem.h"
#include "solve/multigrid.h"
#include "testing.h"

static uint64_t seed = 3;

static int pick(const int count) { return (int)(test_random(&seed) * count); }

/* A box with a region, two solvers for it, and fields for each. */
enum { SOLVERS = 2 };
typedef struct scene {
  cf_grid g;
  cf_walls walls;
  cf_tiles *tiles;
  cf_region *region;
  cf_helmholtz *A[SOLVERS];
  cf_cell x[SOLVERS], b[SOLVERS], alpha;
  cf_face beta;
} scene;

static void scene_begin(scene *s, const int dim, const int n[3], const bool tiles) {
  *s = (scene){0};
  OK(cf_grid_init(&s->g, dim, n, 0.5, NULL));
  for (int a = 0; a < dim; ++a) {
    const cf_wall kinds[] = {CF_WALL_INSULATED, CF_WALL_OPEN, CF_WALL_VALUE};
    const bool periodic = pick(3) == 0;
    for (int side = 0; side < 2; ++side)
      s->walls.kind[a][side] = periodic ? CF_WALL_PERIODIC : kinds[pick(3)];
  }
  if (tiles) OK(cf_tiles_create(&s->tiles, &s->g.box, (int[]){8, 4, dim == 3 ? 4 : 1}));
  OK(cf_region_create_on(&s->region, &s->g, s->tiles));
  for (int v = 0; v < SOLVERS; ++v) {
    OK(cf_helmholtz_create(&s->A[v], &s->g, &s->walls, 0));
    OK(cf_cell_create(&s->x[v], &s->g.box));
    OK(cf_cell_create(&s->b[v], &s->g.box));
  }
  OK(cf_cell_create(&s->alpha, &s->g.box));
  OK(cf_face_create(&s->beta, &s->g.box));
}

static void scene_end(scene *s) {
  cf_region_destroy(s->region);
  cf_tiles_destroy(s->tiles);
  for (int v = 0; v < SOLVERS; ++v) {
    cf_helmholtz_destroy(s->A[v]);
    cf_cell_destroy(&s->x[v], &s->g.box);
    cf_cell_destroy(&s->b[v], &s->g.box);
  }
  cf_cell_destroy(&s->alpha, &s->g.box);
  cf_face_destroy(&s->beta, &s->g.box);
}

/* Every cell of a box, row by row; p is where it lies. */
#define FOR_CELLS(box, i, j, k, p)        \
  for (int k = 0; k < (box)->n[2]; ++k)   \
    for (int j = 0; j < (box)->n[1]; ++j) \
      for (ptrdiff_t i = 0, p = cf_box_at(box, 0, j, k); i < (box)->n[0]; ++i, ++p)

/* From a cell to the middle of a drop, around seams: squared. */
static double far_from(const scene *s, const double middle[3], const int at[3]) {
  double r2 = 0;
  for (int a = 0; a < s->g.box.dim; ++a) {
    double d = at[a] + 0.5 - middle[a];
    if (s->walls.kind[a][0] == CF_WALL_PERIODIC) d -= s->g.box.n[a] * round(d / s->g.box.n[a]);
    r2 += d * d;
  }
  return r2;
}

/* A drop with holes, in cells of the kind `around`; some of them are held. Tiles where it is, and a cell further. */
static void drip(const scene *s, const double middle[3], const double radius, const int around) {
  const cf_box *box = &s->g.box;
  unsigned char *kind = s->region->kind;
  if (s->tiles != NULL) {
    cf_tiles_drop_all(s->tiles);
    FOR_CELLS(box, i, j, k, p)
    if (far_from(s, middle, (int[]){(int)i, j, k}) < radius * radius)
      cf_tiles_add_cell(s->tiles, (int)i, j, k, 1);
    OK(cf_tiles_update(s->tiles));
    cf_region_retire(s->region);
    for (int v = 0; v < SOLVERS; ++v) cf_tiles_retire_cell(s->tiles, s->x[v]);
  }
  FOR_CELLS(box, i, j, k, p) {
    const bool inside = far_from(s, middle, (int[]){(int)i, j, k}) < radius * radius;
    const int other = pick(30) == 0 ? pick(4) : inside ? CF_CELL_INSIDE : around;
    const bool is_there = s->tiles == NULL || cf_tiles_has_cell(s->tiles, (int)i, j, k);
    if (!inside && other == CF_CELL_INSIDE)
      kind[p] = CF_CELL_WALL;
    else if (is_there)
      kind[p] = (unsigned char)other;
  }
  OK(cf_region_update(s->region));
}

static void fill(const scene *s) {
  FOR_CELLS(&s->g.box, i, j, k, p) {
    const bool inside = s->region->kind[p] == CF_CELL_INSIDE;
    const cf_real b = (cf_real)(2 * test_random(&seed) - 1);
    for (int v = 0; v < SOLVERS; ++v) {
      s->b[v].at[p] = inside ? b : (cf_real)NAN;
      s->x[v].at[p] = inside ? 0 : 7;
    }
    s->region->value.at[p] = (cf_real)test_random(&seed);
    s->alpha.at[p] = (cf_real)(0.2 + test_random(&seed));
    for (int a = 0; a < s->g.box.dim; ++a) {
      s->beta.at[a][p] = (cf_real)(0.5 + test_random(&seed));
      s->beta.at[a][p + s->g.box.stride[a]] = (cf_real)(0.5 + test_random(&seed));
    }
  }
}

/* Numbers or fields, alpha from 0 to much. */
static cf_coefficients law_of(const scene *s) {
  cf_coefficients c = {.alpha = pick(3) == 0 ? 0 : pow(10, 4 * test_random(&seed) - 3), .beta = 1};
  if (pick(3) == 0) c.alpha_at = &s->alpha;
  if (pick(3) == 0) c.beta_at = &s->beta;
  c.region = s->region;
  return c;
}

static void same_bits(const scene *s) {
  for (ptrdiff_t r = 0; r < cf_box_rows(&s->g.box); ++r) {
    const ptrdiff_t p = cf_box_row(&s->g.box, r);
    assert_memory_equal(s->x[0].at + p, s->x[1].at + p, (size_t)s->g.box.n[0] * sizeof(cf_real));
  }
}

static void any_middle(const scene *s, double middle[3]) {
  for (int a = 0; a < 3; ++a) middle[a] = test_random(&seed) * s->g.box.n[a];
}

/* --- what is solved --------------------------------------------------------------------------------------- */

static void add_sides(const scene *s, const int v, const cf_wall_values *walls) {
  cf_helmholtz_add_held(s->A[v], s->b[v]);
  cf_helmholtz_add_walls(s->A[v], walls, s->b[v]);
}

/* y = A x has the same values, and is 0 elsewhere. */
static void compare_products(const scene *s) {
  cf_cell y[SOLVERS];
  for (int v = 0; v < SOLVERS; ++v) {
    OK(cf_cell_create(&y[v], &s->g.box));
    FOR_CELLS(&s->g.box, i, j, k, p) y[v].at[p] = 5;
    cf_helmholtz_apply(s->A[v], s->x[0], y[v]);
  }
  FOR_CELLS(&s->g.box, i, j, k, p) {
    if (s->region->kind[p] == CF_CELL_INSIDE)
      CLOSE((double)y[0].at[p], (double)y[1].at[p], 1e3 * CF_REAL_EPSILON * (1 + fabs((double)y[1].at[p])));
    else
      assert_true(y[0].at[p] == 0);
  }
  for (int v = 0; v < SOLVERS; ++v) cf_cell_destroy(&y[v], &s->g.box);
}

/* One solver without windows. What it says of the other's solution counts. */
static void a_window_has_the_solution_of_the_box(void **state) {
  (void)state;
  const double tolerance = CF_MAX(1e-9, 200 * CF_REAL_EPSILON);
  int windows = 0;
  for (int round = 0; round < 40; ++round) {
    const int dim = 2 + round % 2, least = dim == 2 ? 70 : 36;
    const int n[3] = {least + pick(20), least + pick(20), dim == 3 ? least + pick(8) : 1};
    scene s;
    double middle[3], largest = 0;
    scene_begin(&s, dim, n, false);
    any_middle(&s, middle);
    cf_helmholtz_forbid_windows(s.A[1]);
    const int around = pick(2) ? CF_CELL_WALL : pick(4),
              radius = 9 + pick(6); /* in this order with any compiler */
    drip(&s, middle, radius, around);
    fill(&s);
    const cf_coefficients c = law_of(&s);
    cf_solve_report report[SOLVERS];
    double wall[128 * 128];
    cf_wall_values values = {0};
    for (int q = 0; q < 128 * 128; ++q) wall[q] = test_random(&seed);
    for (int a = 0; a < dim; ++a)
      for (int side = 0; side < 2; ++side)
        if (s.walls.kind[a][side] == CF_WALL_VALUE) values.at[a][side] = wall;
    for (int v = 0; v < SOLVERS; ++v) {
      OK(cf_helmholtz_set(s.A[v], &c));
      add_sides(&s, v, &values);
    }
    windows += s.A[0]->in_window;
    assert_false(s.A[1]->in_window);
    FOR_CELLS(&s.g.box, i, j, k, p)
    if (s.region->kind[p] == CF_CELL_INSIDE) assert_true(s.b[0].at[p] == s.b[1].at[p]);
    for (int v = 0; v < SOLVERS; ++v) {
      OK(cf_helmholtz_solve(s.A[v], s.b[v], &(cf_solve_options){tolerance, 200}, s.x[v], &report[v]));
      assert_true(report[v].converged);
    }
    assert_int_equal(report[0].pockets, report[1].pockets);
    BELOW(cf_helmholtz_residual(s.A[1], s.x[0], s.b[1]), CF_MAX(1.01 * tolerance, 2 * report[0].residual));
    BELOW(cf_helmholtz_residual(s.A[0], s.x[1], s.b[0]), CF_MAX(1.01 * tolerance, 2 * report[1].residual));
    FOR_CELLS(&s.g.box, i, j, k, p) largest = fmax(largest, fabs((double)s.x[1].at[p]));
    FOR_CELLS(&s.g.box, i, j, k, p) {
      if (s.region->kind[p] != CF_CELL_INSIDE)
        assert_true(s.x[0].at[p] == 7 && isnan((double)s.b[0].at[p]));
      else /* means that were taken out are taken out of the caller's b */
        CLOSE((double)s.b[0].at[p], (double)s.b[1].at[p], 100 * tolerance * (1 + fabs((double)s.b[1].at[p])));
    }
    compare_products(&s);
    scene_end(&s);
  }
  print_message("%d of 40 in windows\n", windows);
  assert_true(windows > 25);
}

/* --- bits --------------------------------------------------------------------------------------------------- */

/* A drop goes through the box, over the ends of windows and seams, grows and shrinks; a solver that has followed it against a
 * fresh one. In some rounds without windows: of a level nothing may be left where the drop has been. */
static void a_moving_drop_has_the_bits_of_one_just_met(void **state) {
  (void)state;
  int windows = 0, moves = 0;
  for (int round = 0; round < 8; ++round) {
    const int dim = 2 + round % 2, least = dim == 2 ? 90 : 50;
    scene s;
    double middle[3];
    ptrdiff_t size = 0;
    scene_begin(&s, dim, (int[]){least, least, dim == 3 ? least : 1}, round / 2 == 1);
    any_middle(&s, middle);
    for (int step = 0; step < 8; ++step) {
      for (int a = 0; a < dim; ++a) middle[a] = fmod(middle[a] + 3, s.g.box.n[a]);
      cf_helmholtz_destroy(s.A[1]);
      OK(cf_helmholtz_create(&s.A[1], &s.g, &s.walls, 0));
      for (int v = 0; v < SOLVERS && round > 5; ++v) cf_helmholtz_forbid_windows(s.A[v]);
      drip(&s, middle, step % 3 == 0 ? 11 : 8 + step, CF_CELL_WALL);
      fill(&s);
      const cf_coefficients c = law_of(&s);
      cf_solve_report report[SOLVERS];
      for (int v = 0; v < SOLVERS; ++v) {
        OK(cf_helmholtz_set(s.A[v], &c));
        OK(cf_helmholtz_set(s.A[v], &c));
        OK(cf_helmholtz_solve(s.A[v], s.b[v], &(cf_solve_options){1e-5, 20}, s.x[v], &report[v]));
      }
      assert_int_equal(report[0].iterations, report[1].iterations);
      same_bits(&s);
      windows += s.A[0]->in_window;
      moves += s.region->inside != size;
      size = s.region->inside;
    }
    scene_end(&s);
  }
  assert_true(windows > 20 && moves > 40);
}

/* The same drop on tiles and in the whole box. */
static void tiles_do_not_change_a_window(void **state) {
  (void)state;
  int windows = 0;
  for (int round = 0; round < 4; ++round) {
    scene s;
    cf_region *dense;
    scene_begin(&s, 2 + round % 2, (int[]){64, 70, round % 2 ? 60 : 1}, true);
    OK(cf_region_create(&dense, &s.g));
    for (int step = 0; step < 3; ++step) {
      drip(&s, (double[]){20 + 11 * step, 32, 30}, 16, CF_CELL_HELD);
      fill(&s);
      FOR_CELLS(&s.g.box, i, j, k, p) dense->kind[p] = s.region->kind[p];
      OK(cf_region_update(dense));
      for (int v = 0; v < SOLVERS; ++v) {
        const cf_coefficients c = {.alpha = 1e-2, .beta = 1, .region = v == 0 ? s.region : dense};
        cf_solve_report report;
        OK(cf_helmholtz_set(s.A[v], &c));
        windows += s.A[v]->in_window;
        OK(cf_helmholtz_solve(s.A[v], s.b[v], &(cf_solve_options){1e-5, 20}, s.x[v], &report));
      }
      same_bits(&s);
    }
    cf_region_destroy(dense);
    scene_end(&s);
  }
  assert_true(windows > 12);
}

/* One to three threads. */
static void threads_do_not_change_a_window(void **state) {
  (void)state;
  for (int round = 0; round < 4; ++round) {
    scene s;
    scene_begin(&s, 2 + round % 2, (int[]){200, 64, round % 2 ? 64 : 1}, round > 1);
    s.g.threads = 2 + round % 2;
    cf_helmholtz_destroy(s.A[1]);
    OK(cf_helmholtz_create(&s.A[1], &s.g, &s.walls, 0));
    drip(&s, (double[]){70, 30, 32}, 24, CF_CELL_HELD);
    fill(&s);
    for (int v = 0; v < SOLVERS; ++v) {
      cf_solve_report report;
      OK(cf_helmholtz_set(s.A[v], &(cf_coefficients){.alpha = 1e-2, .beta = 1, .region = s.region}));
      assert_true(s.A[v]->in_window);
      OK(cf_helmholtz_solve(s.A[v], s.b[v], &(cf_solve_options){1e-5, 20}, s.x[v], &report));
    }
    same_bits(&s);
    scene_end(&s);
  }
}

/* --- which window ------------------------------------------------------------------------------------------- */

static bool pays(const scene *s) {
  OK(cf_region_update(s->region));
  const cf_coefficients c = {.alpha = 1, .beta = 1, .region = s->region};
  cf_solve_report report;
  OK(cf_helmholtz_set(s->A[0], &c));
  OK(cf_helmholtz_solve(s->A[0], s->b[0], &(cf_solve_options){1e-5, 20}, s->x[0], &report));
  assert_true(report.converged);
  return s->A[0]->in_window;
}

static void windows_are_for_drops_that_fill_them(void **state) {
  (void)state;
  scene s;
  scene_begin(&s, 3, (int[]){80, 80, 80}, false);
  cf_region_fill(s.region, CF_CELL_WALL);
  assert_false(pays(&s)); /* nothing */
  s.region->kind[cf_box_at(&s.g.box, 40, 40, 40)] = CF_CELL_INSIDE;
  assert_false(pays(&s)); /* a cell in 16^3 */
  drip(&s, (double[]){40, 40, 40}, 14, CF_CELL_WALL);
  assert_true(pays(&s));
  for (int v = 0; v < 3; ++v) {
    assert_true(s.region->low[v] >= 26 && s.region->high[v] <= 54);
  }
  s.region->kind[cf_box_at(&s.g.box, 79, 79, 79)] = CF_CELL_INSIDE;
  assert_false(pays(&s)); /* something at the other end of the box */
  cf_region_fill(s.region, CF_CELL_INSIDE);
  assert_false(pays(&s));
  scene_end(&s);
}

/* --- memory ------------------------------------------------------------------------------------------------- */

/* Whatever allocation fails: the solver can be set again, and destroyed. */
static void a_window_that_gets_no_memory_can_be_had_later(void **state) {
  (void)state;
  scene s;
  scene_begin(&s, 3, (int[]){48, 48, 48}, false);
  drip(&s, (double[]){20, 20, 20}, 10, CF_CELL_WALL);
  fill(&s);
  int failures = 0;
  for (int fields = 0; fields < 2; ++fields)
    for (long n = 1;; n += 3) {
      cf_coefficients c = {.alpha = 0.01, .beta = 1, .region = s.region};
      if (fields) c.alpha_at = &s.alpha, c.beta_at = &s.beta;
      cf_helmholtz_destroy(s.A[0]);
      OK(cf_helmholtz_create(&s.A[0], &s.g, &s.walls, 0));
      cf_mem_fail_at(n);
      const cf_status status = cf_helmholtz_set(s.A[0], &c);
      cf_mem_fail_at(0);
      if (status == CF_OK) break;
      assert_int_equal(status, CF_NO_MEMORY);
      ++failures;
      if (n % 16 != 0) continue;
      OK(cf_helmholtz_set(s.A[0], &c));
      assert_true(s.A[0]->in_window);
    }
  assert_true(failures > 40);
  scene_end(&s);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(a_window_has_the_solution_of_the_box),
      cmocka_unit_test(a_moving_drop_has_the_bits_of_one_just_met),
      cmocka_unit_test(tiles_do_not_change_a_window),
      cmocka_unit_test(threads_do_not_change_a_window),
      cmocka_unit_test(windows_are_for_drops_that_fill_them),
      cmocka_unit_test(a_window_that_gets_no_memory_can_be_had_later),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
