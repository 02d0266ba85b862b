/* SPDX-License-Identifier: MIT */
#include "physics/snowpack.h"

#include <math.h>
#include <stddef.h>

#define SHARE \
  0.125 /* of the excess, that slides in one sweep to one of four neighbours: a column is never overshot */

static int wrap(const int i, const int n) { return ((i % n) + n) % n; }

/* The four columns around a place and their weights. */
typedef struct cf_corners {
  ptrdiff_t column[4];
  double weight[4];
} cf_corners;

static cf_corners corners_at(const cf_snowpack *s, const double x, const double y) {
  const double at[2] = {(x - s->place[0]) / s->h, (y - s->place[1]) / s->h};
  const double low[2] = {floor(at[0]), floor(at[1])};
  const double f[2] = {at[0] - low[0], at[1] - low[1]};
  cf_corners c;
  for (int q = 0; q < 4; ++q) {
    const int i = wrap((int)fmod(low[0], s->n[0]) + (q & 1), s->n[0]);
    const int j = wrap((int)fmod(low[1], s->n[1]) + (q >> 1), s->n[1]);
    c.column[q] = i + (ptrdiff_t)j * s->n[0];
    c.weight[q] = (q & 1 ? f[0] : 1 - f[0]) * (q >> 1 ? f[1] : 1 - f[1]);
  }
  return c;
}

/* Adds `depth` times the weight of each column on the disc, and returns the sum of the weights. */
static double strew(const cf_snowpack *s, const double x, const double y, const double wide,
                    const double depth) {
  const double at[2] = {(x - s->place[0]) / s->h, (y - s->place[1]) / s->h}, r = wide / s->h;
  double sum = 0;
  for (int j = (int)ceil(at[1] - r); j <= (int)floor(at[1] + r); ++j)
    for (int i = (int)ceil(at[0] - r); i <= (int)floor(at[0] + r); ++i) {
      const double u = (i - at[0]) / r, v = (j - at[1]) / r, left = CF_MAX(1 - u * u - v * v, 0);
      s->depth[wrap(i, s->n[0]) + (ptrdiff_t)wrap(j, s->n[1]) * s->n[0]] += (cf_real)(depth * left * left);
      sum += left * left;
    }
  return sum;
}

void cf_snowpack_land(const cf_snowpack *s, const double x, const double y, const double wide,
                      const double volume) {
  const cf_corners c = corners_at(s, x, y);
  if (wide > s->h) {
    strew(s, x, y, wide, volume / (s->h * s->h) / strew(s, x, y, wide, 0));
    return;
  }
  for (int q = 0; q < 4; ++q) s->depth[c.column[q]] += (cf_real)(c.weight[q] * volume / (s->h * s->h));
}

double cf_snowpack_top(const cf_snowpack *s, const double x, const double y) {
  const cf_corners c = corners_at(s, x, y);
  double top = 0;
  for (int q = 0; q < 4; ++q)
    top += c.weight[q] * ((double)s->base[c.column[q]] + (double)s->depth[c.column[q]]);
  return top;
}

/* What column p gets from column q: what slides from q to p, less what slides from p to q. */
static double exchange(const cf_snowpack *s, const ptrdiff_t p, const ptrdiff_t q) {
  const double d_p = (double)s->depth[p], d_q = (double)s->depth[q];
  const double rise = ((double)s->base[q] + d_q) - ((double)s->base[p] + d_p);
  const double excess = SHARE * CF_MAX(fabs(rise) - s->h * s->steepest, 0);
  return rise > 0 ? CF_MIN(excess, d_q / 4) : -CF_MIN(excess, d_p / 4);
}

void cf_snowpack_slump(const cf_snowpack *s, const int threads) {
#pragma omp parallel for schedule(static) num_threads(threads)
  for (int j = 0; j < s->n[1]; ++j)
    for (int i = 0; i < s->n[0]; ++i) {
      const ptrdiff_t row = (ptrdiff_t)j * s->n[0], p = row + i;
      const ptrdiff_t up = (ptrdiff_t)wrap(j + 1, s->n[1]) * s->n[0] + i;
      const ptrdiff_t down = (ptrdiff_t)wrap(j - 1, s->n[1]) * s->n[0] + i;
      s->change[p] = (cf_real)((exchange(s, p, row + wrap(i + 1, s->n[0])) +
                                exchange(s, p, row + wrap(i - 1, s->n[0]))) +
                               (exchange(s, p, up) + exchange(s, p, down)));
    }
#pragma omp parallel for schedule(static) num_threads(threads)
  for (int j = 0; j < s->n[1]; ++j)
    for (int i = 0; i < s->n[0]; ++i)
      s->depth[i + (ptrdiff_t)j * s->n[0]] += s->change[i + (ptrdiff_t)j * s->n[0]];
}

double cf_snowpack_volume(const cf_snowpack *s) {
  double sum = 0;
  for (int j = 0; j < s->n[1]; ++j) {
    double row = 0;
    for (int i = 0; i < s->n[0]; ++i) row += (double)s->depth[i + (ptrdiff_t)j * s->n[0]];
    sum += row;
  }
  return sum * s->h * s->h;
}
