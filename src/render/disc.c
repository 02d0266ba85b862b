/* SPDX-License-Identifier: MIT */
#include "render/disc.h"

#include <math.h>
#include <stddef.h>
#include <string.h>

#include "base/real.h"
#include "grid/sweep.h"

int cf_disc_margin(const float r) { return (int)ceilf(r + 0.5f); }

/* The area of half a disc of radius r below y. */
static float area_below(const float r, const float y) {
  const float t = fminf(fmaxf(y, -r), r);
  return 0.5f * (t * sqrtf(fmaxf(r * r - t * t, 0)) + r * r * asinf(t / r));
}

/* The value at k becomes the sum of those before it. */
static void run_sums(float (*row)[4], const int places) {
  float sum[4] = {0, 0, 0, 0};
  for (int k = 0; k <= places; ++k)
    for (int c = 0; c < 4; ++c) {
      const float own = k < places ? row[k][c] : 0;
      row[k][c] = sum[c];
      sum[c] += own;
    }
}

/* out += norm times the integral of a row over -w .. w around each place; `middle` is the running sum up to place 0. */
CF_CLONES static void add_strip(const float *middle, const int n, const float w, const float norm,
                                float *restrict out) {
  const int whole = (int)(0.5f + w);
  const float part = 0.5f + w - (float)whole, inner = norm * (1 - part), outer = norm * part;
  const float *in = middle - 4 * (ptrdiff_t)(whole - 1), *far = middle + 4 * (ptrdiff_t)whole;
  for (ptrdiff_t q = 0; q < 4 * (ptrdiff_t)n; ++q)
    out[q] += inner * (far[q] - in[q]) + outer * (far[q + 4] - in[q - 4]);
}

void cf_disc_blur(float (*in)[4], const int n, const int rows, const float r, float (*out)[4]) {
  const int m = cf_disc_margin(r);
  const ptrdiff_t row = n + 2 * m + 1;
  const float norm = 1 / (2 * area_below(r, r) - 2 * area_below(r, -r));
  for (int j = 0; j < rows + 2 * m; ++j) run_sums(in + j * row, n + 2 * m);
  memset(out, 0, (size_t)n * (size_t)rows * sizeof *out);
  for (int dj = -m; dj <= m; ++dj) {
    const float w = area_below(r, (float)dj + 0.5f) - area_below(r, (float)dj - 0.5f);
    if (w <= 0) continue;
    for (int j = 0; j < rows; ++j) add_strip(in[(j + m + dj) * row + m], n, w, norm, out[(ptrdiff_t)j * n]);
  }
}
