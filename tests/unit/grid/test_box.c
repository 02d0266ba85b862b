/* SPDX-License-Identifier: MIT
 *
 * Index space and memory: where cells lie, that nothing overlaps, what is refused; fields and places.
 */
#include <limits.h>
#include <math.h>
#include <string.h>

#include "base/mem.h"
#include "grid/field.h"
#include "grid/grid.h"
#include "testing.h"

static const int shapes[][4] = {{2, 1, 1, 1}, {2, 5, 3, 1}, {2, 64, 64, 1}, {2, 250, 7, 1},  {2, 506, 2, 1},
                                {3, 1, 1, 1}, {3, 4, 3, 2}, {3, 64, 1, 9},  {3, 121, 5, 17}, {3, 7, 250, 3}};
enum { SHAPES = sizeof shapes / sizeof *shapes };

static void rows_are_aligned_and_strides_hold_the_halo(void **state) {
  (void)state;
  for (int s = 0; s < SHAPES; ++s)
    for (int halo = 0; halo <= 3; ++halo) {
      cf_box b;
      OK(cf_box_init(&b, shapes[s][0], &shapes[s][1], halo));
      assert_int_equal(b.stride[0], 1);
      assert_int_equal(b.stride[1] % CF_LANES, 0);
      assert_int_equal(b.stride[2] % b.stride[1], 0);
      assert_int_equal(b.first % CF_LANES, 0);
      assert_true(b.stride[1] >= b.n[0] + 2 * halo);
      assert_true(b.stride[2] >= (b.n[1] + 2 * halo) * b.stride[1]);
      const int in_z = b.dim == 3 ? halo : 0;
      assert_true(b.first + cf_box_at(&b, -halo, -halo, -in_z) >= 0);
      /* the high walls' faces are one past the last cell even without a halo */
      const int up = halo > 1 ? halo : 1;
      assert_true(b.first +
                      cf_box_at(&b, b.n[0] - 1 + up, b.n[1] - 1 + up, b.n[2] - 1 + (b.dim == 3 ? up : 0)) <
                  b.size);
      assert_int_equal(cf_box_cells(&b), b.n[0] * b.n[1] * b.n[2]);
      assert_int_equal(cf_box_rows(&b), b.n[1] * b.n[2]);
      for (int r = 0; r < b.n[1] * b.n[2]; ++r)
        assert_int_equal(cf_box_row(&b, r), cf_box_at(&b, 0, r % b.n[1], r / b.n[1]));
    }
}

/* Neighbouring rows a power of two apart would fall into the same sets of a cache. */
static void long_rows_are_no_power_of_two_apart(void **state) {
  (void)state;
  for (int n = 200; n < 5000; ++n) {
    cf_box b;
    OK(cf_box_init(&b, 2, (int[3]){n, 4, 1}, 3));
    assert_true((b.stride[1] & (b.stride[1] - 1)) != 0);
  }
}

static void every_cell_and_ghost_has_its_own_place(void **state) {
  (void)state;
  cf_box b;
  OK(cf_box_init(&b, 3, (int[3]){5, 4, 3}, 2));
  cf_cell f;
  OK(cf_cell_create(&f, &b));
  int count = 0;
  for (int k = -2; k < 5; ++k)
    for (int j = -2; j < 6; ++j)
      for (int i = -2; i < 7; ++i) {
        assert_true(f.at[cf_box_at(&b, i, j, k)] == 0);
        f.at[cf_box_at(&b, i, j, k)] = (cf_real)++count;
      }
  count = 0;
  for (int k = -2; k < 5; ++k)
    for (int j = -2; j < 6; ++j)
      for (int i = -2; i < 7; ++i) assert_true(f.at[cf_box_at(&b, i, j, k)] == (cf_real)++count);
  cf_cell_destroy(&f, &b);
  assert_null(f.at);
  cf_cell_destroy(&f, &b);
}

static void shapes_that_make_no_sense_are_refused(void **state) {
  (void)state;
  cf_box b;
  const int bad[][4] = {{1, 4, 4, 4}, {4, 4, 4, 4},  {0, 1, 1, 1}, {-2, 4, 4, 4},
                        {2, 0, 4, 1}, {2, 4, -1, 1}, {3, 4, 4, 0}};
  for (int s = 0; s < 7; ++s) assert_int_equal(cf_box_init(&b, bad[s][0], &bad[s][1], 1), CF_BAD_ARGUMENT);
  assert_int_equal(cf_box_init(&b, 3, (int[3]){INT_MAX, INT_MAX, INT_MAX}, 3), CF_BAD_ARGUMENT);
  assert_non_null(strstr(cf_status_sentence(), "addressed"));
  OK(cf_box_init(&b, 2, (int[3]){4, 4, -7}, 1)); /* the third extent is not read in 2D */
  assert_int_equal(b.n[2], 1);
}

static void a_field_too_large_for_the_machine_is_refused(void **state) {
  (void)state;
  cf_box b;
  OK(cf_box_init(&b, 3, (int[3]){1 << 18, 1 << 17, 1 << 16}, 1));
  cf_cell f;
  assert_int_equal(cf_cell_create(&f, &b), CF_NO_MEMORY);
  assert_null(f.at);
  cf_face q;
  assert_int_equal(cf_face_create(&q, &b), CF_NO_MEMORY);
  assert_null(q.at[0]);
}

static void a_face_field_that_fails_half_way_leaves_nothing(void **state) {
  (void)state;
  cf_box b;
  OK(cf_box_init(&b, 3, (int[3]){4, 4, 4}, 1));
  for (int n = 1; n <= 3; ++n) {
    cf_face q;
    cf_mem_fail_at(n);
    assert_int_equal(cf_face_create(&q, &b), CF_NO_MEMORY);
    cf_mem_fail_at(0);
    for (int a = 0; a < 3; ++a) assert_null(q.at[a]);
  }
  cf_face q;
  OK(cf_face_create(&q, &b));
  assert_non_null(q.at[2]);
  cf_face_destroy(&q, &b);
}

static void grids_check_their_spacing(void **state) {
  (void)state;
  cf_grid g;
  const double bad[] = {0, -1, NAN, INFINITY, -INFINITY};
  for (int v = 0; v < 5; ++v)
    assert_int_equal(cf_grid_init(&g, 2, (int[2]){4, 4}, bad[v], NULL), CF_BAD_ARGUMENT);
  assert_int_equal(cf_grid_init(&g, 7, (int[7]){4, 4, 4, 4, 4, 4, 4}, 1, (double[7]){0}), CF_BAD_ARGUMENT);
  OK(cf_grid_init(&g, 2, (int[2]){4, 4}, 0.5, NULL));
  CLOSE(cf_grid_volume(&g), 0.25, 0);
  CLOSE(cf_grid_area(&g), 0.5, 0);
  OK(cf_grid_init(&g, 3, (int[3]){4, 4, 4}, 0.5, NULL));
  CLOSE(cf_grid_volume(&g), 0.125, 0);
  CLOSE(cf_grid_area(&g), 0.25, 0);
}

static void number_places(const void *context, int n, const double *x, const double *y, const double *z,
                          double t, double *out) {
  (void)context;
  for (int i = 0; i < n; ++i) out[i] = x[i] + 10 * y[i] + 100 * z[i] + 1000 * t;
}

static void samples_are_taken_at_centres_and_on_faces(void **state) {
  (void)state;
  const cf_fn w = {.eval = number_places};
  for (int dim = 2; dim <= 3; ++dim)
    for (int axis = -1; axis < dim; ++axis) {
      cf_grid g;
      OK(cf_grid_init(&g, dim, (int[3]){4, 3, 2}, 0.5, (double[3]){-1, 2, 5}));
      cf_cell f;
      OK(cf_cell_create(&f, &g.box));
      OK(cf_grid_sample(&g, &w, axis, 3, f.at));
      for (int k = 0; k < cf_box_extent(&g.box, 2, axis); ++k)
        for (int j = 0; j < cf_box_extent(&g.box, 1, axis); ++j)
          for (int i = 0; i < cf_box_extent(&g.box, 0, axis); ++i) {
            const double x = -1 + 0.5 * (i + (axis == 0 ? 0 : 0.5)),
                         y = 2 + 0.5 * (j + (axis == 1 ? 0 : 0.5));
            const double z = dim == 3 ? 5 + 0.5 * (k + (axis == 2 ? 0 : 0.5)) : 0;
            CLOSE(f.at[cf_box_at(&g.box, i, j, k)], x + 10 * y + 100 * z + 3000, 4000 * CF_REAL_EPSILON);
          }
      assert_true(f.at[cf_box_at(&g.box, -1, 0, 0)] == 0); /* ghosts stay */
      cf_mem_fail_at(1);
      assert_int_equal(cf_grid_sample(&g, &w, axis, 3, f.at), CF_NO_MEMORY);
      cf_mem_fail_at(0);
      cf_cell_destroy(&f, &g.box);
    }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(rows_are_aligned_and_strides_hold_the_halo),
      cmocka_unit_test(long_rows_are_no_power_of_two_apart),
      cmocka_unit_test(every_cell_and_ghost_has_its_own_place),
      cmocka_unit_test(shapes_that_make_no_sense_are_refused),
      cmocka_unit_test(a_field_too_large_for_the_machine_is_refused),
      cmocka_unit_test(a_face_field_that_fails_half_way_leaves_nothing),
      cmocka_unit_test(grids_check_their_spacing),
      cmocka_unit_test(samples_are_taken_at_centres_and_on_faces),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
/* also in single precision */
