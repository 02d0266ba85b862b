/* SPDX-License-Identifier: MIT
 *
 * Active tiles against a plain array of flags under random changes, and what their fields cost.
 */
/* also in single precision */
#define _GNU_SOURCE
#include "grid/tiles.h"

#include <string.h>
#include <sys/mman.h>

#include "base/mem.h"
#include "testing.h"

enum { NX = 150, NY = 37, NZ = 29 };
static unsigned char wanted[NZ][NY][NX], visited[NZ][NY][NX];

static uint64_t seed = 3;
static int pick(const int n) { return (int)(test_random(&seed) * n); }

static void visit(const cf_tiles *t) {
  memset(visited, 0, sizeof visited);
  CF_PARALLEL_TILES (t, 2, r)
    CF_TILE_ROWS (t, r, j, k)
      CF_TILE_RUNS (t, r, run)
        for (int i = run->low; i < run->high; ++i) ++visited[k][j][i];
}

static void set_wanted(const cf_tiles *t, const int ti, const int tj, const int tk, const int on) {
  for (int k = tk * t->edge[2]; k < (tk + 1) * t->edge[2] && k < NZ; ++k)
    for (int j = tj * t->edge[1]; j < (tj + 1) * t->edge[1] && j < NY; ++j)
      for (int i = ti * t->edge[0]; i < (ti + 1) * t->edge[0] && i < NX; ++i)
        wanted[k][j][i] = (unsigned char)on;
}

static cf_box box_3d(void) {
  cf_box b;
  OK(cf_box_init(&b, 3, (int[]){NX, NY, NZ}, 3));
  return b;
}

static void every_active_cell_is_visited_once(void **state) {
  (void)state;
  const cf_box b = box_3d();
  const int edges[][3] = {{16, 8, 8}, {8, 8, 8}, {8, 4, 4}, {32, 1, 2}};
  for (int e = 0; e < 4; ++e) {
    cf_tiles *t;
    OK(cf_tiles_create(&t, &b, edges[e]));
    memset(wanted, 0, sizeof wanted);
    for (int round = 0; round < 30; ++round) {
      for (int v = 0; v < 40; ++v) {
        const int ti = pick(t->n[0]), tj = pick(t->n[1]), tk = pick(t->n[2]), on = pick(3) > 0;
        if (on)
          cf_tiles_add(t, ti, tj, tk);
        else
          cf_tiles_drop(t, ti, tj, tk);
        set_wanted(t, ti, tj, tk, on);
      }
      OK(cf_tiles_update(t));
      visit(t);
      assert_memory_equal(visited, wanted, sizeof wanted);
      ptrdiff_t cells = 0;
      for (int p = 0; p < NX * NY * NZ; ++p) cells += (&wanted[0][0][0])[p];
      assert_int_equal(cells, cf_tiles_cells(t));
    }
    cf_tiles_drop_all(t);
    OK(cf_tiles_update(t));
    assert_int_equal(t->count, 0);
    assert_int_equal(t->rows, 0);
    cf_tiles_destroy(t);
  }
}

static void cells_and_boxes_bring_their_tiles(void **state) {
  (void)state;
  const cf_box b = box_3d();
  cf_tiles *t;
  OK(cf_tiles_create(&t, &b, NULL));
  cf_tiles_add_cell(t, 15, 7, 0, 0);
  OK(cf_tiles_update(t));
  assert_int_equal(t->count, 1);
  cf_tiles_add_cell(t, 15, 7, 0, 1);
  OK(cf_tiles_update(t));
  assert_int_equal(t->count, 4);
  cf_tiles_add_cell(t, -5, 1000, -1, 2); /* nowhere near */
  OK(cf_tiles_update(t));
  assert_int_equal(t->count, 4);
  cf_tiles_add_box(t, (int[]){-10, -10, -10}, (int[]){1000, 1000, 1000});
  OK(cf_tiles_update(t));
  assert_int_equal(t->count, t->n[0] * t->n[1] * t->n[2]);
  assert_int_equal(cf_tiles_cells(t), cf_box_cells(&b));
  cf_tiles_destroy(t);
}

/* Cells hold their own number while active, and 0 after they have left, whatever pages they share. */
static void what_leaves_is_zero_and_what_stays_is_kept(void **state) {
  (void)state;
  const cf_box b = box_3d();
  cf_tiles *t;
  cf_cell f;
  OK(cf_tiles_create(&t, &b, NULL));
  OK(cf_tiles_cell_create(t, &f));
  for (int round = 0; round < 40; ++round) {
    for (int v = 0; v < 60; ++v) {
      const int ti = pick(t->n[0]), tj = pick(t->n[1]), tk = pick(t->n[2]);
      if (pick(2))
        cf_tiles_add(t, ti, tj, tk);
      else
        cf_tiles_drop(t, ti, tj, tk);
    }
    OK(cf_tiles_update(t));
    cf_tiles_retire_cell(t, f);
    for (ptrdiff_t r = 0; r < t->rows; ++r)
      CF_TILE_ROWS (t, r, j, k)
        CF_TILE_RUNS (t, r, run)
          for (int i = run->low; i < run->high; ++i) {
            cf_real *at = &f.at[cf_box_at(&b, i, j, k)];
            const cf_real number = (cf_real)(1 + i + NX * (j + NY * k));
            assert_true(*at == 0 || *at == number);
            *at = number;
          }
    for (int k = 0; k < NZ; ++k)
      for (int j = 0; j < NY; ++j)
        for (int i = 0; i < NX; ++i)
          assert_true((f.at[cf_box_at(&b, i, j, k)] != 0) == cf_tiles_has_cell(t, i, j, k));
  }
  cf_cell_destroy(&f, &b);
  cf_tiles_destroy(t);
}

static size_t pages_touched(const cf_box *b, const cf_cell f) {
  const size_t bytes = (size_t)b->size * sizeof(cf_real), pages = (bytes + 4095) / 4096;
  unsigned char *in;
  size_t touched = 0;
  OK(CF_NEW(&in, pages));
  assert_int_equal(mincore(f.at - b->first, bytes, in), 0);
  for (size_t p = 0; p < pages; ++p) touched += in[p] & 1;
  cf_free(in);
  return touched;
}

/* A ball that moves through 256^3: it never costs more than what it covers, and leaves nothing behind. */
static void a_ball_that_moves_gives_its_pages_back(void **state) {
  (void)state;
  cf_box b;
  cf_tiles *t;
  cf_cell f;
  OK(cf_box_init(&b, 3, (int[]){256, 256, 256}, 1));
  OK(cf_tiles_create(&t, &b, NULL));
  OK(cf_tiles_cell_create(t, &f));
  const size_t all = (size_t)b.size * sizeof(cf_real) / 4096;
  for (int c = 50; c <= 210; c += 8) {
    cf_tiles_drop_all(t);
    for (int tk = 0; tk < t->n[2]; ++tk)
      for (int tj = 0; tj < t->n[1]; ++tj)
        for (int ti = 0; ti < t->n[0]; ++ti) {
          const double x = 16 * ti + 8 - c, y = 8 * tj + 4 - c, z = 8 * tk + 4 - c;
          if (x * x + y * y + z * z < 40 * 40) cf_tiles_add(t, ti, tj, tk);
        }
    OK(cf_tiles_update(t));
    cf_tiles_retire_cell(t, f);
    CF_PARALLEL_TILES (t, 2, r)
      CF_TILE_ROWS (t, r, j, k)
        CF_TILE_RUNS (t, r, run)
          for (int i = run->low; i < run->high; ++i) f.at[cf_box_at(&b, i, j, k)] = 1;
    BELOW((double)pages_touched(&b, f) / (double)all, 0.11);
    assert_true(t->changes > 0);
  }
  cf_tiles_drop_all(t);
  OK(cf_tiles_update(t));
  cf_tiles_retire_cell(t, f);
  assert_int_equal(pages_touched(&b, f), 0);
  cf_cell_destroy(&f, &b);
  cf_tiles_destroy(t);
}

static void an_update_without_changes_is_none(void **state) {
  (void)state;
  const cf_box b = box_3d();
  cf_tiles *t;
  OK(cf_tiles_create(&t, &b, NULL));
  cf_tiles_add(t, 1, 1, 1);
  OK(cf_tiles_update(t));
  assert_int_equal(t->changes, 1);
  cf_tiles_drop_all(t);
  cf_tiles_add(t, 1, 1, 1);
  OK(cf_tiles_update(t));
  assert_int_equal(t->changes, 0);
  assert_int_equal(t->count, 1);
  cf_tiles_destroy(t);
}

static void bad_edges_are_refused(void **state) {
  (void)state;
  const cf_box b = box_3d();
  cf_tiles *t;
  assert_int_equal(cf_tiles_create(&t, &b, (int[]){12, 8, 8}), CF_BAD_ARGUMENT);
  assert_int_equal(cf_tiles_create(&t, &b, (int[]){4, 8, 8}), CF_BAD_ARGUMENT);
  assert_null(t);
}

/* One number a row: as if rows without tiles had 0, whatever stands there. */
static void sums_over_rows_have_the_bits_of_dense_ones(void **state) {
  (void)state;
  const cf_box b = box_3d();
  static double sparse[NY * NZ], dense[NY * NZ];
  cf_tiles *t;
  OK(cf_tiles_create(&t, &b, NULL));
  for (int round = 0; round < 40; ++round) {
    cf_tiles_drop_all(t);
    for (int v = 0; v < round % 9; ++v) cf_tiles_add(t, pick(t->n[0]), pick(t->n[1]), pick(t->n[2]));
    OK(cf_tiles_update(t));
    visit(t);
    for (int r = 0; r < NY * NZ; ++r) {
      bool any = false;
      for (int i = 0; i < NX; ++i) any = any || visited[r / NY][r % NY][i] > 0;
      sparse[r] = any ? test_random(&seed) - 0.3 : 1e9;
      dense[r] = any ? sparse[r] : 0;
    }
    assert_true(cf_tiles_sum_rows(t, sparse) == cf_sum_ordered(dense, NY * NZ));
  }
  cf_tiles_destroy(t);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(every_active_cell_is_visited_once),
      cmocka_unit_test(cells_and_boxes_bring_their_tiles),
      cmocka_unit_test(what_leaves_is_zero_and_what_stays_is_kept),
      cmocka_unit_test(a_ball_that_moves_gives_its_pages_back),
      cmocka_unit_test(an_update_without_changes_is_none),
      cmocka_unit_test(sums_over_rows_have_the_bits_of_dense_ones),
      cmocka_unit_test(bad_edges_are_refused),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
