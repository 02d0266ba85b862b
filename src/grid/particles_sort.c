/* SPDX-License-Identifier: MIT
 *
 * Sorting by key: a counting sort for every 11 bits of the keys, from the lowest up, each keeping the order of
 * equal digits. The set is cut into parts; every part counts its digits, a sum over parts and digits says where the
 * first of each goes, and every part puts its own in place. The result does not depend on the number of parts, and
 * so not on that of the threads.
 */
#include <string.h>

#include "grid/particles.h"
#include "grid/particles_part.h"
#include "grid/sweep.h"

/* Part p of `parts` begins with this particle. */
static int64_t part_start(const int64_t count, const int parts, const int p) {
  return count / parts * p + CF_MIN(p, count % parts);
}

static int digit(const uint32_t key, const int shift) { return (int)(key >> shift & (CF_SORT_BINS - 1)); }

static void count_digits(const cf_particles *s, const int shift, const int64_t from, const int64_t to,
                         int32_t *bins) {
  memset(bins, 0, CF_SORT_BINS * sizeof *bins);
  for (int64_t i = from; i < to; ++i) ++bins[digit(s->key[i], shift)];
}

static void place(cf_particles *s, const int shift, const int64_t from, const int64_t to, int32_t *next) {
  for (int64_t i = from; i < to; ++i) {
    const int32_t to_place = next[digit(s->key[i], shift)]++;
    s->spare_key[to_place] = s->key[i];
    s->spare_order[to_place] = s->order[i];
  }
}

/* Counts become the places where the first of each digit of each part goes. */
static void sum_bins(int32_t *bins, const int parts) {
  int32_t sum = 0;
  for (int d = 0; d < CF_SORT_BINS; ++d)
    for (int p = 0; p < parts; ++p) {
      const int32_t here = bins[p * CF_SORT_BINS + d];
      bins[p * CF_SORT_BINS + d] = sum;
      sum += here;
    }
}

static void sort_digit(cf_particles *s, const int shift, const int parts) {
#pragma omp parallel for schedule(static) num_threads(parts)
  for (int p = 0; p < parts; ++p)
    count_digits(s, shift, part_start(s->count, parts, p), part_start(s->count, parts, p + 1),
                 s->bins + p * CF_SORT_BINS);
  sum_bins(s->bins, parts);
#pragma omp parallel for schedule(static) num_threads(parts)
  for (int p = 0; p < parts; ++p)
    place(s, shift, part_start(s->count, parts, p), part_start(s->count, parts, p + 1),
          s->bins + p * CF_SORT_BINS);
  uint32_t *key = s->key;
  s->key = s->spare_key, s->spare_key = key;
  int32_t *order = s->order;
  s->order = s->spare_order, s->spare_order = order;
}

void cf_particles_sort(cf_particles *s, const int threads) {
  const int parts = s->count < CF_SERIAL_CELLS ? 1 : CF_MIN(threads, CF_SORT_CHUNKS);
  uint32_t most = 0;
  bool sorted = true;
  for (int64_t i = 0; i < s->count; ++i) {
    most = CF_MAX(most, s->key[i]);
    sorted = sorted && (i == 0 || s->key[i - 1] <= s->key[i]);
    s->order[i] = (int32_t)i;
  }
  if (sorted) return;
  for (int shift = 0; shift < 32 && most >> shift != 0; shift += CF_SORT_BITS) sort_digit(s, shift, parts);
  cf_particles_reorder(s, s->order, s->count, threads);
}
