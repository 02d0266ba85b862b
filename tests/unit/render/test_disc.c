/* SPDX-License-Identifier: MIT
 *
 * A place that is blurred becomes a disc: its sum, its width in both directions, its edge.
 *
 * also in single precision
 */
#include "testing.h"

#include <math.h>
#include <stdlib.h>

#include "base/mem.h"
#include "render/disc.h"

enum { N = 40 };

/* One place in the middle, of 1 2 3 4, blurred. */
static void blur_one(const float r, float (*out)[4]) {
  const int m = cf_disc_margin(r), row = N + 2 * m + 1;
  float(*in)[4];
  OK(CF_NEW(&in, row * (N + 2 * m)));
  for (int c = 0; c < 4; ++c) in[(N / 2 + m) * row + N / 2 + m][c] = (float)(c + 1);
  cf_disc_blur(in, N, N, r, out);
  cf_free(in);
}

static void a_place_becomes_a_disc(void **state) {
  (void)state;
  static float out[N * N][4];
  const float radii[] = {0.5f, 0.7f, 1, 1.7f, 3, 5.9f, 12.3f};
  for (size_t n = 0; n < sizeof radii / sizeof *radii; ++n) {
    const double r = (double)radii[n];
    double sum = 0, far[2] = {0, 0};
    blur_one(radii[n], out);
    for (int j = 0; j < N; ++j)
      for (int i = 0; i < N; ++i) {
        const double v = (double)out[j * N + i][0], x = i - N / 2, y = j - N / 2, d = hypot(x, y);
        sum += v, far[0] += v * x * x, far[1] += v * y * y;
        for (int c = 1; c < 4; ++c) CLOSE(out[j * N + i][c], (c + 1) * v, 1e-6);
        if (d < r - 1) CLOSE(v, 1 / (acos(-1) * r * r), 1e-6);
        if (d > r + 1.5) CLOSE(v, 0, 1e-6);
        CLOSE(v, (double)out[j * N + (N - i) % N][0], 1e-6);
        CLOSE(v, (double)out[(N - j) % N * N + i][0], 1e-6);
      }
    CLOSE(sum, 1, 2e-6);
    /* Of a disc: r^2/4; of a place: 1/12. Discs within a place do nothing. */
    CLOSE(far[0], r * r / 4 + 1 / 12.0, 0.15 + 0.01 * r * r);
    CLOSE(far[1], r * r / 4 + 1 / 12.0, 0.15 + 0.01 * r * r);
  }
}

static void what_comes_from_outside_counts(void **state) {
  (void)state;
  enum { R = 4, M = 5, ROW = N + 2 * M + 1 };
  static float in[ROW * (N + 2 * M)][4], out[N * N][4];
  assert_int_equal(cf_disc_margin(R), M);
  for (int k = 0; k < ROW * (N + 2 * M); ++k) in[k][0] = 3;
  cf_disc_blur(in, N, N, R, out);
  for (int k = 0; k < N * N; ++k) CLOSE(out[k][0], 3, 1e-4);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(a_place_becomes_a_disc),
      cmocka_unit_test(what_comes_from_outside_counts),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
