/* SPDX-License-Identifier: MIT
 *
 * The layer of snow: volume kept to round-off, no slope steeper than repose in the end, the same bits for any number
 * of threads and under mirroring.
 *
 * also in single precision
 */
#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "physics/snowpack.h"
#include "testing.h"

enum { N = 32 };

static void make(cf_snowpack *s) {
  *s = (cf_snowpack){.n = {N, N}, .h = 0.1, .place = {0.05, 0.05}, .steepest = 0.8};
  s->base = calloc(N * N, sizeof *s->base);
  s->depth = calloc(N * N, sizeof *s->depth);
  s->change = calloc(N * N, sizeof *s->change);
}

static void clear(cf_snowpack *s) {
  free(s->base);
  free(s->depth);
  free(s->change);
}

static void snow_that_lands_is_all_there(void **state) {
  (void)state;
  cf_snowpack s;
  make(&s);
  double all = 0;
  for (int i = 0; i < 1000; ++i) {
    cf_snowpack_land(&s, 0.0377 * i, -0.0713 * i, 0.002 * (i % 200), 1e-4);
    all += 1e-4;
  }
  assert_true(fabs(cf_snowpack_volume(&s) - all) <
              1000 * (double)(sizeof(cf_real) == 4 ? FLT_EPSILON : DBL_EPSILON) * all);
  clear(&s);
}

/* In the middle of a column, and halfway between two. */
static void snow_lies_where_it_landed(void **state) {
  (void)state;
  cf_snowpack s;
  make(&s);
  cf_snowpack_land(&s, 0.35, 0.55, 0, 0.01);
  assert_true(fabs((double)s.depth[3 + 5 * N] - 1) < 1e-6);
  assert_true(fabs(cf_snowpack_top(&s, 0.35, 0.55) - 1) < 1e-6);
  assert_true(fabs(cf_snowpack_top(&s, 0.40, 0.55) - 0.5) < 1e-6);
  clear(&s);
}

/* As much to the left as to the right, nothing outside, and all the lower. */
static void many_lie_around_one(void **state) {
  (void)state;
  cf_snowpack s;
  make(&s);
  cf_snowpack_land(&s, 0.35, 0.05, 0.35, 0.01);
  const cf_real *d = s.depth + 3;
  assert_true(d[0] > d[1] && d[1] > d[2] && d[2] > d[3] && d[3] > 0 && d[4] == 0 && d[0] < 0.3);
  const double other[3] = {(double)d[-2], (double)d[2 * N], (double)d[(N - 2) * N]};
  for (int i = 0; i < 3; ++i) assert_true(fabs(other[i] - (double)d[2]) < 1e-6);
  clear(&s);
}

static void snow_slides_until_no_slope_is_steeper_than_repose(void **state) {
  (void)state;
  cf_snowpack s;
  make(&s);
  for (int j = 8; j < 16; ++j)
    for (int i = 8; i < 16; ++i) s.base[i + j * N] = (cf_real)1.5; /* a table */
  for (int i = 0; i < N * N; ++i) s.depth[i] = (cf_real)0.02;
  s.depth[20 + 20 * N] += 1;
  s.depth[12 + 12 * N] += 1;
  const double before = cf_snowpack_volume(&s);
  for (int sweep = 0; sweep < 2000; ++sweep) cf_snowpack_slump(&s, 1);
  assert_true(fabs(cf_snowpack_volume(&s) / before - 1) < (sizeof(cf_real) == 4 ? 1e-5 : 1e-12));
  for (int j = 0; j < N; ++j)
    for (int i = 0; i < N; ++i) {
      const int p = i + j * N, q = (i + 1) % N + j * N;
      const double top_p = (double)s.base[p] + (double)s.depth[p],
                   top_q = (double)s.base[q] + (double)s.depth[q];
      const double given = top_p > top_q ? (double)s.depth[p] : (double)s.depth[q];
      assert_true((double)s.depth[p] >= 0);
      if (given > 1e-3) assert_true(fabs(top_p - top_q) < 1.02 * 0.1 * 0.8);
    }
  clear(&s);
}

static void snow_slides_alike_with_any_number_of_threads_and_mirrored(void **state) {
  (void)state;
  cf_snowpack one, more, mirror;
  make(&one);
  make(&more);
  make(&mirror);
  for (int i = 0; i < N * N; ++i) one.depth[i] = (cf_real)(((i * 7919) % 1009) * 1e-3);
  memcpy(more.depth, one.depth, N * N * sizeof *one.depth);
  for (int j = 0; j < N; ++j)
    for (int i = 0; i < N; ++i) mirror.depth[N - 1 - i + j * N] = one.depth[i + j * N];
  for (int sweep = 0; sweep < 20; ++sweep) {
    cf_snowpack_slump(&one, 1);
    cf_snowpack_slump(&more, 3);
    cf_snowpack_slump(&mirror, 2);
  }
  assert_memory_equal(one.depth, more.depth, N * N * sizeof *one.depth);
  for (int j = 0; j < N; ++j)
    for (int i = 0; i < N; ++i) assert_true(mirror.depth[N - 1 - i + j * N] == one.depth[i + j * N]);
  clear(&one);
  clear(&more);
  clear(&mirror);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(snow_that_lands_is_all_there), cmocka_unit_test(snow_lies_where_it_landed),
      cmocka_unit_test(many_lie_around_one),
      cmocka_unit_test(snow_slides_until_no_slope_is_steeper_than_repose),
      cmocka_unit_test(snow_slides_alike_with_any_number_of_threads_and_mirrored)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
