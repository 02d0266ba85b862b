/* SPDX-License-Identifier: MIT
 *
 * Sums in a fixed order, ranges, and the search for a value that is not finite: the same for any number of threads.
 */
#include "grid/sweep.h"

#include <math.h>

#include "base/mem.h"
#include "grid/field.h"
#include "testing.h"

static void ordered_sums_are_close_to_the_sum(void **state) {
  (void)state;
  static double v[10000];
  uint64_t seed = 11;
  long double sum = 0;
  for (int n = 0; n <= 10000; n = n < 40 ? n + 1 : n * 3) {
    sum = 0;
    for (int i = 0; i < n; ++i) sum += (long double)(v[i] = test_random(&seed) - 0.3);
    CLOSE(cf_sum_ordered(v, n), (double)sum, 1e-13 * (n + 1));
  }
  CLOSE(cf_sum_ordered(v, 0), 0, 0);
}

/* A running sum of 65536 tenths is off by 4e-13. */
static void ordered_sums_do_not_drift(void **state) {
  (void)state;
  static double v[1 << 16];
  for (int i = 0; i < 1 << 16; ++i) v[i] = 0.1;
  CLOSE(cf_sum_ordered(v, 1 << 16) / 6553.6, 1, 1e-15);
}

static cf_range range_with(const int threads, const cf_box *b, const cf_cell f) {
  double *rows;
  OK(CF_NEW(&rows, 3 * cf_box_rows(b)));
  const cf_range range = cf_sweep_range(b, threads, f.at, rows);
  cf_free(rows);
  return range;
}

static void ranges_do_not_depend_on_threads(void **state) {
  (void)state;
  const int shapes[][4] = {{2, 200, 77, 1}, {3, 33, 20, 21}, {2, 3, 5000, 1}, {3, 5, 3, 2}, {2, 1, 1, 1}};
  for (int s = 0; s < 5; ++s) {
    cf_box b;
    OK(cf_box_init(&b, shapes[s][0], &shapes[s][1], 2));
    cf_cell f;
    OK(cf_cell_create(&f, &b));
    uint64_t seed = 3;
    double least = INFINITY, most = -INFINITY, sum = 0;
    for (ptrdiff_t r = 0; r < cf_box_rows(&b); ++r) {
      const ptrdiff_t p = cf_box_row(&b, r);
      f.at[p - 1] = f.at[p + b.n[0]] = -1000; /* ghosts are not part of it */
      for (int i = 0; i < b.n[0]; ++i) {
        const double v =
            (double)(f.at[p + i] = (cf_real)(exp(20 * test_random(&seed)) * (test_random(&seed) - 0.5)));
        least = fmin(least, v);
        most = fmax(most, v);
        sum += v;
      }
    }
    const cf_range one = range_with(1, &b, f);
    CLOSE(one.min, least, 0);
    CLOSE(one.max, most, 0);
    CLOSE(one.sum / sum, 1, 1e-11);
    for (int threads = 2; threads <= 5; ++threads) {
      const cf_range many = range_with(threads, &b, f);
      assert_true(many.sum == one.sum && many.min == one.min && many.max == one.max);
    }
    cf_cell_destroy(&f, &b);
  }
}

static void the_first_value_that_is_not_finite_is_found(void **state) {
  (void)state;
  cf_box b;
  OK(cf_box_init(&b, 3, (int[3]){40, 23, 15}, 1));
  cf_cell f;
  OK(cf_cell_create(&f, &b));
  int where[3];
  const double bad[] = {NAN, INFINITY, -INFINITY};
  for (int threads = 1; threads <= 4; ++threads) {
    f.at[-1] = (cf_real)NAN; /* a ghost */
    assert_true(cf_sweep_finite(&b, threads, f.at, where));
    for (int v = 0; v < 3; ++v) {
      f.at[cf_box_at(&b, 39, 22, 14)] = (cf_real)bad[v];
      assert_false(cf_sweep_finite(&b, threads, f.at, where));
      assert_int_equal(where[0] + 100 * where[1] + 10000 * where[2], 39 + 2200 + 140000);
      f.at[cf_box_at(&b, 7, 3, 9)] = (cf_real)bad[v];
      assert_false(cf_sweep_finite(&b, threads, f.at, where));
      assert_int_equal(where[0] + 100 * where[1] + 10000 * where[2], 7 + 300 + 90000);
      f.at[cf_box_at(&b, 39, 22, 14)] = f.at[cf_box_at(&b, 7, 3, 9)] = 1;
    }
  }
  cf_cell_destroy(&f, &b);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(ordered_sums_are_close_to_the_sum),
      cmocka_unit_test(ordered_sums_do_not_drift),
      cmocka_unit_test(ranges_do_not_depend_on_threads),
      cmocka_unit_test(the_first_value_that_is_not_finite_is_found),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
/* also in single precision */
