/* SPDX-License-Identifier: MIT
 *
 * Counted random numbers: nothing of their counts is lost, and they are as even as chance would have it.
 */
#include "base/rng.h"

#include <math.h>

#include "testing.h"

static void a_number_depends_on_all_its_counts(void **state) {
  (void)state;
  const uint64_t one = cf_random_bits(1, 2, 3, 4);
  assert_true(one == cf_random_bits(1, 2, 3, 4));
  assert_true(one != cf_random_bits(0, 2, 3, 4));
  assert_true(one != cf_random_bits(1, 3, 2, 4));
  assert_true(one != cf_random_bits(1, 2, 4, 3));
  assert_true(one != cf_random_bits(2, 1, 3, 4));
}

/* Means and correlations of n numbers scatter by 1/sqrt(12 n) and 1/(12 sqrt n). */
static void numbers_are_even_and_neighbours_unrelated(void **state) {
  (void)state;
  enum { N = 100000 };
  double sum = 0, squares = 0, along[3] = {0};
  int tenth[10] = {0};
  for (uint64_t i = 0; i < N; ++i) {
    const double v = cf_random(7, 0, 1, i) - 0.5;
    sum += v;
    squares += v * v;
    along[0] += v * (cf_random(7, 0, 1, i + 1) - 0.5);
    along[1] += v * (cf_random(7, 0, 2, i) - 0.5);
    along[2] += v * (cf_random(7, 1, 1, i) - 0.5);
    ++tenth[(int)((v + 0.5) * 10)];
  }
  CLOSE(sum / N, 0, 4 / sqrt(12.0 * N));
  CLOSE(squares / N, 1.0 / 12, 4 / sqrt(180.0 * N));
  for (int v = 0; v < 3; ++v) CLOSE(along[v] / N, 0, 4 / (12 * sqrt((double)N)));
  for (int v = 0; v < 10; ++v) CLOSE(tenth[v], N / 10.0, 4 * sqrt(N * 0.09));
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(a_number_depends_on_all_its_counts),
      cmocka_unit_test(numbers_are_even_and_neighbours_unrelated),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
