/* SPDX-License-Identifier: MIT
 *
 * A region that changes: what is made anew of the levels is what has changed, and the result has the bits of levels made
 * as a whole.
 */
#include <string.h>

#include "grid/region.h"
#include "solve/helmholtz.h"
#include "solve/varied_part.h"
#include "testing.h"

static uint64_t seed = 5;

static int pick(const int count) { return (int)(test_random(&seed) * count); }

/* A box whose cells come and go, on tiles or not. */
typedef struct scene {
  cf_grid g;
  cf_walls walls;
  cf_tiles *tiles;
  cf_region *region;
  cf_cell x[2], b[2];
} scene;

static void scene_begin(scene *s, const int dim, const int n[3], const bool tiles) {
  *s = (scene){0};
  OK(cf_grid_init(&s->g, dim, n, 1.0, NULL));
  for (int a = 0; a < dim; ++a) {
    const bool periodic = !tiles && pick(3) == 0;
    for (int side = 0; side < 2; ++side)
      s->walls.kind[a][side] = periodic ? CF_WALL_PERIODIC : pick(2) ? CF_WALL_INSULATED : CF_WALL_OPEN;
  }
  if (tiles) OK(cf_tiles_create(&s->tiles, &s->g.box, (int[]){8, 4, dim == 3 ? 4 : 1}));
  OK(cf_region_create_on(&s->region, &s->g, s->tiles));
  for (int v = 0; v < 2; ++v) {
    OK(cf_cell_create(&s->x[v], &s->g.box));
    OK(cf_cell_create(&s->b[v], &s->g.box));
  }
}

static void scene_end(scene *s) {
  cf_region_destroy(s->region);
  cf_tiles_destroy(s->tiles);
  for (int v = 0; v < 2; ++v) {
    cf_cell_destroy(&s->x[v], &s->g.box);
    cf_cell_destroy(&s->b[v], &s->g.box);
  }
}

static bool is_there(const scene *s, const int i, const int j, const int k) {
  return s->tiles == NULL || cf_tiles_has_cell(s->tiles, i, j, k);
}

/* Cells of a random window become of a random kind, some at random. */
static void change(const scene *s) {
  int low[3], high[3];
  const int share = pick(2) ? 4 : 1, kind = pick(4);
  for (int a = 0; a < 3; ++a) {
    low[a] = pick(s->g.box.n[a]);
    high[a] = CF_MIN(low[a] + 1 + pick(pick(2) ? 7 : 2), s->g.box.n[a]);
  }
  for (int k = low[2]; k < high[2]; ++k)
    for (int j = low[1]; j < high[1]; ++j)
      for (int i = low[0]; i < high[0]; ++i)
        if (is_there(s, i, j, k) && pick(share) == 0)
          cf_region_kinds(s->region)[cf_box_at(&s->g.box, i, j, k)] = (unsigned char)kind;
}

/* Plates of a cell with holes, which cut blocks into pieces on all levels. */
static void stand_plates(const scene *s) {
  const int apart = 2 + pick(5), across = pick(2);
  for (int k = 0; k < s->g.box.n[2]; ++k)
    for (int j = 0; j < s->g.box.n[1]; ++j)
      for (int i = 0; i < s->g.box.n[0]; ++i)
        if (is_there(s, i, j, k) && (across ? i : j) % apart == 0 && pick(6) > 0)
          cf_region_kinds(s->region)[cf_box_at(&s->g.box, i, j, k)] = CF_CELL_WALL;
}

/* Tiles come, inside, and go. */
static void change_tiles(const scene *s) {
  cf_tiles *t = s->tiles;
  for (int v = 0; v < 6; ++v) {
    const int at[3] = {pick(t->n[0]), pick(t->n[1]), pick(t->n[2])};
    if (pick(3) == 0)
      cf_tiles_drop(t, at[0], at[1], at[2]);
    else
      cf_tiles_add(t, at[0], at[1], at[2]);
  }
  OK(cf_tiles_update(t));
  cf_region_retire(s->region);
  for (int v = 0; v < 2; ++v) {
    cf_tiles_retire_cell(t, s->x[v]);
    cf_tiles_retire_cell(t, s->b[v]);
  }
}

static void fill_sides(const scene *s) {
  for (int k = 0; k < s->g.box.n[2]; ++k)
    for (int j = 0; j < s->g.box.n[1]; ++j)
      for (int i = 0; i < s->g.box.n[0]; ++i) {
        const ptrdiff_t p = cf_box_at(&s->g.box, i, j, k);
        const double value = 2 * test_random(&seed) - 1;
        if (!is_there(s, i, j, k)) continue;
        s->b[0].at[p] = s->b[1].at[p] = (cf_real)value;
        s->x[0].at[p] = s->x[1].at[p] = 0;
      }
}

/* Solves with levels that were changed and with new ones. */
static void compare(const scene *s, cf_helmholtz *changed, const cf_coefficients *c) {
  cf_helmholtz *fresh;
  cf_solve_report report[2];
  const cf_solve_options o = {1e-5, 12};
  OK(cf_helmholtz_create(&fresh, &s->g, &s->walls, 0));
  OK(cf_helmholtz_set(fresh, c));
  OK(cf_helmholtz_set(changed, c));
  fill_sides(s);
  OK(cf_helmholtz_solve(changed, s->b[0], &o, s->x[0], &report[0]));
  OK(cf_helmholtz_solve(fresh, s->b[1], &o, s->x[1], &report[1]));
  assert_int_equal(report[0].iterations, report[1].iterations);
  for (int k = 0; k < s->g.box.n[2]; ++k)
    for (int j = 0; j < s->g.box.n[1]; ++j)
      assert_memory_equal(&s->x[0].at[cf_box_at(&s->g.box, 0, j, k)],
                          &s->x[1].at[cf_box_at(&s->g.box, 0, j, k)],
                          (size_t)s->g.box.n[0] * sizeof(cf_real));
  cf_helmholtz_destroy(fresh);
}

static void a_changed_region_has_the_bits_of_a_new_one(void **state) {
  (void)state;
  for (int round = 0; round < 32; ++round) {
    const int dim = 2 + round % 2, most = dim == 2 ? 160 : 24;
    const bool tiles = round / 2 % 2;
    const double alpha = pick(3) == 0 ? 0 : pick(2) ? 1e-3 : 0.3;
    scene s;
    cf_helmholtz *A;
    scene_begin(&s, dim, (int[]){12 + pick(most), 9 + pick(most), dim == 3 ? 9 + pick(most) : 1}, tiles);
    OK(cf_helmholtz_create(&A, &s.g, &s.walls, 0));
    if (tiles) change_tiles(&s);
    if (tiles || pick(2)) cf_region_fill(s.region, CF_CELL_INSIDE);
    if (pick(2)) stand_plates(&s);
    for (int step = 0; step < 6; ++step) {
      if (tiles && pick(2)) change_tiles(&s);
      for (int v = pick(4); v >= 0; --v) change(&s);
      OK(cf_region_update(s.region));
      compare(&s, A, &(cf_coefficients){.alpha = alpha, .beta = 1, .region = s.region});
    }
    cf_helmholtz_destroy(A);
    scene_end(&s);
  }
}

/* A ball of a few cells that moves through a box takes what its surroundings take, whatever the size of the box. */
static void what_is_made_follows_what_has_changed(void **state) {
  (void)state;
  ptrdiff_t renewed[2];
  for (int size = 0; size < 2; ++size) {
    const int n = size ? 160 : 80;
    scene s;
    cf_helmholtz *A;
    scene_begin(&s, 3, (int[]){n, n, n}, false);
    OK(cf_helmholtz_create(&A, &s.g, &s.walls, 0));
    const cf_coefficients c = {.alpha = 1e-3, .beta = 1, .region = s.region};
    for (int step = 0; step < 2; ++step) {
      const cf_shape ball = cf_shape_sphere((double[]){40 + step, 40, 40}, 5);
      cf_region_fill(s.region, CF_CELL_INSIDE);
      OK(cf_region_add(s.region, &ball, NULL, 0, CF_CELL_WALL, NULL));
      OK(cf_region_update(s.region));
      OK(cf_helmholtz_set(A, &c));
      if (step == 0) assert_true(A->varied->renewed >= cf_box_cells(&s.g.box));
    }
    renewed[size] = A->varied->renewed;
    OK(cf_region_update(s.region)); /* nothing has changed */
    OK(cf_helmholtz_set(A, &c));
    assert_int_equal(A->varied->renewed, 0);
    cf_helmholtz_destroy(A);
    scene_end(&s);
  }
  BELOW((double)renewed[1],
        1.6 * (double)renewed[0]); /* coarse levels of the smaller box are smaller than the ball's reach */
  BELOW((double)renewed[1], 0.03 * 160 * 160 * 160);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(a_changed_region_has_the_bits_of_a_new_one),
      cmocka_unit_test(what_is_made_follows_what_has_changed),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
