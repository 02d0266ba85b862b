/* SPDX-License-Identifier: MIT */
#include "grid/sweep.h"

#include <math.h>
#include <stdbool.h>
#include <stdint.h>

double cf_sum_ordered(const double *v, const ptrdiff_t n) {
  if (n <= 8) {
    double sum = 0;
    for (ptrdiff_t i = 0; i < n; ++i) sum += v[i];
    return sum;
  }
  return cf_sum_ordered(v, n / 2) + cf_sum_ordered(v + n / 2, n - n / 2);
}

CF_CLONES double cf_sweep_row_sum(const int n, const cf_real *f) {
  double lane[CF_SUM_LANES] = {0};
  int i = 0;
  for (; i + CF_SUM_LANES <= n; i += CF_SUM_LANES)
    for (int l = 0; l < CF_SUM_LANES; ++l) lane[l] += (double)f[i + l];
  for (int l = 0; i < n; ++i, ++l) lane[l] += (double)f[i];
  return cf_sum_lanes(lane);
}

double cf_sweep_sum(const cf_box *b, const int threads, const cf_real *f, double *rows) {
  CF_PARALLEL_ROWS (b, threads, r) rows[r] = cf_sweep_row_sum(b->n[0], f + cf_box_row(b, r));
  return cf_sum_ordered(rows, cf_box_rows(b));
}

CF_CLONES static void row_ends(const int n, const cf_real *row, cf_real *min, cf_real *max) {
  cf_real least = row[0], largest = row[0];
#pragma omp simd reduction(min : least) reduction(max : largest)
  for (int i = 0; i < n; ++i) {
    least = row[i] < least ? row[i] : least;
    largest = row[i] > largest ? row[i] : largest;
  }
  *min = least;
  *max = largest;
}

cf_range cf_sweep_range(const cf_box *b, const int threads, const cf_real *f, double *rows) {
  const ptrdiff_t count = cf_box_rows(b);
  CF_PARALLEL_ROWS (b, threads, r) {
    const cf_real *row = f + cf_box_row(b, r);
    cf_real least, largest;
    row_ends(b->n[0], row, &least, &largest);
    rows[r] = cf_sweep_row_sum(b->n[0], row);
    rows[count + r] = (double)least;
    rows[2 * count + r] = (double)largest;
  }
  cf_range range = {cf_sum_ordered(rows, count), rows[count], rows[2 * count]};
  for (ptrdiff_t r = 0; r < count; ++r) {
    range.min = CF_MIN(range.min, rows[count + r]);
    range.max = CF_MAX(range.max, rows[2 * count + r]);
  }
  return range;
}

/* 0 * x is not 0 only where x is not finite. */
CF_CLONES static bool row_is_finite(const int n, const cf_real *row) {
  cf_real zero = 0;
#pragma omp simd reduction(+ : zero)
  for (int i = 0; i < n; ++i) zero += row[i] * 0;
  return zero == 0;
}

int cf_sweep_finite(const cf_box *b, const int threads, const cf_real *f, int where[3]) {
  ptrdiff_t bad = PTRDIFF_MAX;
#pragma omp parallel for schedule(static) num_threads(cf_sweep_threads(b, threads)) reduction(min : bad)
  for (ptrdiff_t r = 0; r < cf_box_rows(b); ++r) {
    if (r < bad && !row_is_finite(b->n[0], f + cf_box_row(b, r))) bad = r;
  }
  if (bad == PTRDIFF_MAX) return 1;
  const cf_real *row = f + cf_box_row(b, bad);
  int i = 0;
  while (i + 1 < b->n[0] && isfinite((double)row[i])) ++i;
  where[0] = i;
  where[1] = (int)(bad % b->n[1]);
  where[2] = (int)(bad / b->n[1]);
  return 0;
}
