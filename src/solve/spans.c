/* SPDX-License-Identifier: MIT
 *
 * How much of its rows a dense level of couplings visits: a drop fills half of the box around it, so half of every coarse level
 * has no equations. Rows go in fours, two along y and two along z, which are those of a coarse row: sums over children are all
 * formed over the same cells.
 *
 * Where a span ends nothing depends on it: cells without an equation have couplings and weights of 0, and a rest of 0.
 */
#include <string.h>

#include "base/mem.h"
#include "solve/coupled.h"

/* Cells that spans are made of. */
#define STEP 16

/* Whether cells [from, from + STEP) of any of the rows have an equation. */
CF_CLONES static bool has_any(const int rows, const float *const inverse[4], const int from, const int n) {
  int any = 0;
  for (int v = 0; v < rows; ++v) {
    const float *d = inverse[v] + from;
    CF_ROW_LOOP
    for (int i = 0; i < CF_MIN(STEP, n - from); ++i) any |= d[i] > 0;
  }
  return any != 0;
}

static cf_run span_of(const int rows, const float *const inverse[4], const int n) {
  int low = 0, high = (n + STEP - 1) / STEP * STEP;
  while (low < high && !has_any(rows, inverse, low, n)) low += STEP;
  while (high > low && !has_any(rows, inverse, high - STEP, n)) high -= STEP;
  return (cf_run){low, CF_MIN(high, n)};
}

/* f = 0 on cells of `old` that are not in `now`. */
static void clear(float *f, const cf_run *old, const cf_run *now) {
  const cf_run kept = now->low < now->high ? *now : (cf_run){old->high, old->high};
  if (old->low < kept.low)
    memset(f + old->low, 0, (size_t)(CF_MIN(kept.low, old->high) - old->low) * sizeof *f);
  const int from = CF_MAX(kept.high, old->low);
  if (from < old->high) memset(f + from, 0, (size_t)(old->high - from) * sizeof *f);
}

static void find_span(const cf_coupled *l, const int j, const int k, cf_run *span) {
  const float *inverse[4];
  ptrdiff_t row[4];
  int rows = 0;
  for (int kk = k; kk < CF_MIN(k + 2, l->box.n[2]); ++kk)
    for (int jj = j; jj < CF_MIN(j + 2, l->box.n[1]); ++jj) {
      row[rows] = cf_box_at(&l->box, 0, jj, kk);
      inverse[rows] = l->inverse + row[rows];
      ++rows;
    }
  const cf_run now = span_of(rows, inverse, l->box.n[0]);
  for (int v = 0; v < rows; ++v) {
    clear(l->e + row[v], span, &now);
    clear(l->rest + row[v], span, &now);
  }
  *span = now;
}

cf_status cf_coupled_find_spans(cf_coupled *l) {
  const int across = (l->box.n[1] + 1) / 2;
  const ptrdiff_t count = (ptrdiff_t)across * ((l->box.n[2] + 1) / 2);
  if (l->tiles != NULL) return CF_OK;
  if (l->span == NULL) {
    CF_TRY(CF_NEW(&l->span, count));
    for (ptrdiff_t v = 0; v < count; ++v) l->span[v] = l->all[0]; /* what has been visited so far */
  }
#pragma omp parallel for schedule(static) num_threads(cf_coupled_threads(l))
  for (ptrdiff_t v = 0; v < count; ++v)
    find_span(l, 2 * (int)(v % across), 2 * (int)(v / across), &l->span[v]);
  return CF_OK;
}
