/* SPDX-License-Identifier: MIT */
#include "render/plane.h"

#include <math.h>
#include <string.h>

#include "base/mem.h"
#include "base/real.h"

#define SOLID_LAYERS 4

/* --- the plane ------------------------------------------------------------------------------------------------ */

/* Of cells [from, to) looked along. `solid`: of two that a slice lies between, one in a body does not count beside one that is not. */
static double value_at(const cf_plane *p, const cf_box *b, const cf_real *f, const cf_real *solid,
                       const int i, const int j, const int from, const int to) {
  ptrdiff_t at = i * b->stride[p->axis[0]] + j * b->stride[p->axis[1]];
  double sum = 0, outside = 0;
  int count = 0;
  if (p->along < 0) return (double)f[at];
  at += from * b->stride[p->along];
  for (int k = from; k < to; ++k, at += b->stride[p->along]) {
    sum += (double)f[at];
    if (solid == NULL || (double)solid[at] > 0.5) continue;
    outside += (double)f[at];
    ++count;
  }
  return count > 0 ? outside / count : sum / (to - from);
}

/* Values in bodies become means of those around them, a few cells deep, so that what is smooth stays so at the edge. */
static cf_status continue_values(cf_plane *p) {
  const int n = p->n[0], all = n * p->n[1];
  unsigned char *known;
  CF_TRY(CF_NEW(&known, all));
  for (int i = 0; i < all; ++i) known[i] = p->solid[i] <= 0.5;
  for (int layer = 1; layer <= SOLID_LAYERS; ++layer)
    for (int i = 0; i < all; ++i) {
      const int near[4] = {i % n > 0 ? i - 1 : i, i % n < n - 1 ? i + 1 : i, i >= n ? i - n : i,
                           i < all - n ? i + n : i};
      double sum = 0;
      int count = 0;
      for (int c = 0; c < 4 && known[i] == 0; ++c) {
        if (known[near[c]] == 0 || known[near[c]] > layer) continue;
        sum += p->at[near[c]];
        ++count;
      }
      if (count == 0) continue;
      p->at[i] = sum / count;
      known[i] = (unsigned char)(layer + 1);
    }
  cf_free(known);
  return CF_OK;
}

cf_status cf_plane_create(cf_plane *p, const cf_grid *g, const cf_real *f, const cf_preview *how) {
  const cf_box *b = &g->box;
  const int along = b->dim == 2 ? -1 : how->axis >= 0 && how->axis < 3 ? how->axis : 2;
  *p = (cf_plane){.along = along, .h = g->h};
  for (int a = 0, shown = 0; a < b->dim; ++a)
    if (a != along) p->axis[shown++] = a;
  for (int s = 0; s < 2; ++s) {
    p->n[s] = b->n[p->axis[s]];
    p->low[s] = g->origin[p->axis[s]];
  }
  int from = 0, to = 1;
  if (along >= 0) {
    from = how->view == CF_VIEW_MEAN ? 0 : (b->n[along] - 1) / 2;
    to = how->view == CF_VIEW_MEAN ? b->n[along] : b->n[along] / 2 + 1;
    p->middle = g->origin[along] + g->h * b->n[along] / 2;
  }
  const cf_real *bodies = how->view == CF_VIEW_MEAN ? NULL : how->solid;
  CF_TRY(CF_NEW(&p->at, (size_t)p->n[0] * (size_t)p->n[1]));
  for (int j = 0; j < p->n[1]; ++j)
    for (int i = 0; i < p->n[0]; ++i)
      p->at[(size_t)j * (size_t)p->n[0] + (size_t)i] = value_at(p, b, f, bodies, i, j, from, to);
  if (how->solid == NULL) return CF_OK;
  cf_status s = CF_NEW(&p->solid, (size_t)p->n[0] * (size_t)p->n[1]);
  for (int j = 0; s == CF_OK && j < p->n[1]; ++j)
    for (int i = 0; i < p->n[0]; ++i)
      p->solid[(size_t)j * (size_t)p->n[0] + (size_t)i] = value_at(p, b, how->solid, NULL, i, j, from, to);
  if (s == CF_OK) s = continue_values(p);
  if (s != CF_OK) cf_plane_destroy(p);
  return s;
}

void cf_plane_destroy(cf_plane *p) {
  cf_free(p->at);
  cf_free(p->solid);
  *p = (cf_plane){.at = NULL};
}

/* --- at the size of a picture ---------------------------------------------------------------------------------- */

/* How the pixels of one axis are made of cells: pixel i is the sum of weight[taps i + t] times cell first[i] + t. */
typedef struct mixing {
  int taps;
  int *first;
  double *weight;
} mixing;

/* Larger: the cubic through the four nearest cells (Catmull and Rom), or the nearest alone. */
static void mix_larger(mixing *m, const int cells, const int pixels, const bool nearest) {
  for (int i = 0; i < pixels; ++i) {
    const double at = (i + 0.5) * cells / pixels - 0.5, s = at - floor(at);
    double *w = m->weight + (size_t)i * (size_t)m->taps;
    m->first[i] = (int)floor(at) - 1;
    if (nearest) {
      w[s < 0.5 ? 1 : 2] = 1;
      continue;
    }
    w[0] = 0.5 * s * (-1 + s * (2 - s));
    w[1] = 0.5 * (2 + s * s * (3 * s - 5));
    w[2] = 0.5 * s * (1 + s * (4 - 3 * s));
    w[3] = 0.5 * s * s * (s - 1);
  }
}

/* Smaller: the mean over what a pixel covers. */
static void mix_smaller(mixing *m, const int cells, const int pixels) {
  for (int i = 0; i < pixels; ++i) {
    const double low = (double)i * cells / pixels, high = (i + 1.0) * cells / pixels;
    m->first[i] = (int)floor(low);
    for (int t = 0; t < m->taps; ++t) {
      const double from = CF_MAX(low, m->first[i] + t), to = CF_MIN(high, m->first[i] + t + 1.0);
      m->weight[(size_t)i * (size_t)m->taps + (size_t)t] = CF_MAX(to - from, 0) / (high - low);
    }
  }
}

static cf_status mixing_create(mixing *m, const int cells, const int pixels, const bool nearest) {
  const bool larger = pixels >= cells;
  *m = (mixing){.taps = larger ? 4 : cells / pixels + 2};
  CF_TRY(CF_NEW(&m->first, pixels));
  const cf_status s = CF_NEW(&m->weight, (size_t)pixels * (size_t)m->taps);
  if (s != CF_OK) {
    cf_free(m->first);
    return s;
  }
  if (larger)
    mix_larger(m, cells, pixels, nearest);
  else
    mix_smaller(m, cells, pixels);
  return CF_OK;
}

static void mixing_destroy(mixing *m) {
  cf_free(m->first);
  cf_free(m->weight);
}

static int inside(const int i, const int n) { return CF_MIN(CF_MAX(i, 0), n - 1); }

/* out[i] for the pixels of a line of cells that lie `stride` apart; pixels `step` apart. */
static void mix_line(const mixing *m, const int cells, const int pixels, const double *in,
                     const ptrdiff_t stride, double *out, const ptrdiff_t step) {
  for (int i = 0; i < pixels; ++i) {
    const double *w = m->weight + (size_t)i * (size_t)m->taps;
    double sum = 0;
    for (int t = 0; t < m->taps; ++t)
      if (w[t] != 0) sum += w[t] * in[inside(m->first[i] + t, cells) * stride];
    out[i * step] = sum;
  }
}

/* A cubic may swing beyond the cells it lies between: it is held among the four. Where a cell that takes part is not
 * finite, the nearest one is shown. */
static double held(const cf_plane *p, const double x, const double y, const double value) {
  const int i[2] = {inside((int)floor(x), p->n[0]), inside((int)floor(x) + 1, p->n[0])};
  const int j[2] = {inside((int)floor(y), p->n[1]), inside((int)floor(y) + 1, p->n[1])};
  double least = INFINITY, largest = -INFINITY;
  if (!isfinite(value)) {
    const int column = inside((int)floor(x + 0.5), p->n[0]), row = inside((int)floor(y + 0.5), p->n[1]);
    return p->at[(size_t)row * (size_t)p->n[0] + (size_t)column];
  }
  for (int c = 0; c < 4; ++c) {
    const double v = p->at[(size_t)j[c / 2] * (size_t)p->n[0] + (size_t)i[c % 2]];
    least = CF_MIN(least, v);
    largest = CF_MAX(largest, v);
  }
  return CF_MIN(CF_MAX(value, least), largest);
}

static void hold_all(const cf_plane *p, const int width, const int height, double *values) {
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      double *v = &values[(size_t)(height - 1 - y) * (size_t)width + (size_t)x];
      *v = held(p, (x + 0.5) * p->n[0] / width - 0.5, (y + 0.5) * p->n[1] / height - 0.5, *v);
    }
}

cf_status cf_plane_resample(const cf_plane *p, const int width, const int height, const bool cells,
                            double *values) {
  mixing across, up;
  double *rows;
  CF_TRY(CF_NEW(&rows, (size_t)width * (size_t)p->n[1]));
  cf_status s = mixing_create(&across, p->n[0], width, cells);
  if (s == CF_OK) {
    s = mixing_create(&up, p->n[1], height, cells);
    if (s == CF_OK) {
      for (int j = 0; j < p->n[1]; ++j)
        mix_line(&across, p->n[0], width, p->at + (size_t)j * (size_t)p->n[0], 1,
                 rows + (size_t)j * (size_t)width, 1);
      for (int i = 0; i < width; ++i)
        mix_line(&up, p->n[1], height, rows + i, width, values + (size_t)(height - 1) * (size_t)width + i,
                 -width);
      if (width >= p->n[0] && height >= p->n[1]) hold_all(p, width, height, values);
      mixing_destroy(&up);
    }
    mixing_destroy(&across);
  }
  cf_free(rows);
  return s;
}

/* --- the range -------------------------------------------------------------------------------------------------- */

#define BINS   4096
#define BEYOND 0.005 /* of the values may lie beyond an end of the colours */

typedef struct spread {
  double min, max; /* of the finite values; min > max if there are none */
  double count;
  double low, high;    /* the ends, drawn in */
  double below, above; /* values beyond them */
  double bins[BINS];
} spread;

static void find_ends(spread *s, const cf_plane *p) {
  for (size_t i = 0; i < (size_t)p->n[0] * (size_t)p->n[1]; ++i) {
    if (!isfinite(p->at[i])) continue;
    s->min = CF_MIN(s->min, p->at[i]);
    s->max = CF_MAX(s->max, p->at[i]);
    ++s->count;
  }
}

static void count_bins(spread *s, const cf_plane *p) {
  const double span = s->high - s->low;
  for (size_t i = 0; i < (size_t)p->n[0] * (size_t)p->n[1]; ++i) {
    const double v = p->at[i];
    if (!isfinite(v)) continue;
    if (v < s->low)
      ++s->below;
    else if (v > s->high)
      ++s->above;
    else
      ++s->bins[CF_MIN((int)((v - s->low) / span * BINS), BINS - 1)];
  }
}

/* Draws the ends in as far as the quantiles allow; how many bins are left between them. */
static int draw_in_once(spread *s, const int planes, const cf_plane *plane) {
  const double width = (s->high - s->low) / BINS;
  int low = 0, high = BINS - 1;
  memset(s->bins, 0, sizeof s->bins);
  s->below = s->above = 0;
  for (int p = 0; p < planes; ++p) count_bins(s, &plane[p]);
  while (low < BINS - 1 && s->below + s->bins[low] <= BEYOND * s->count) s->below += s->bins[low++];
  while (high > low && s->above + s->bins[high] <= BEYOND * s->count) s->above += s->bins[high--];
  s->high -= (BINS - 1 - high) * width;
  s->low += low * width;
  return high - low + 1;
}

/* A few values far off leave all others in one bin: then these are looked at more closely. If they are all the
 * same, the few are what there is to see. */
static void draw_in(spread *s, const int planes, const cf_plane *plane) {
  const double span = s->max - s->min;
  s->low = s->min, s->high = s->max;
  while (draw_in_once(s, planes, plane) < BINS / 64) {
    if (s->high - s->low > 1e-9 * span) continue;
    s->low = s->min, s->high = s->max;
    return;
  }
}

/* The ends as the rule has them. */
static void settle_range(cf_scale *s, double min, double max) {
  if (!(min <= max)) min = 0, max = 1;
  if (min == max) {
    min = CF_MIN(min, 0);
    max = max > 0 ? max : min < 0 ? 0 : 1;
  }
  const bool both = min < -0.05 * max && max > -0.05 * min;
  const double largest = CF_MAX(-min, max);
  s->low = both ? -largest : max > 0 && min < max / 2 ? 0 : min;
  s->high = both ? largest : min < 0 && max <= 0 && max > min / 2 ? 0 : max;
  if (!both && max > 0 && min < 0) s->low = 0;
  if (!both && max > 0 && -min > max) s->low = min, s->high = 0;
  s->map = both ? CF_COLORMAP_balance : CF_COLORMAP_ember;
}

static bool given_range(const cf_preview *how) { return how->low < how->high; }

cf_status cf_plane_scale(cf_scale *s, const int planes, const cf_plane *plane, const cf_preview *how) {
  spread *all;
  cf_colormap map;
  *s = (cf_scale){.low = 0};
  if (how->map != NULL) CF_TRY(cf_colormap_find(how->map, &map));
  CF_TRY(CF_NEW(&all, 1));
  all->min = INFINITY, all->max = -INFINITY;
  for (int p = 0; p < planes; ++p) find_ends(all, &plane[p]);
  const double least = all->min, largest = all->max;
  all->low = least, all->high = largest;
  if (least < largest && isfinite(largest - least) && !given_range(how)) draw_in(all, planes, plane);
  settle_range(s, given_range(how) ? how->low : all->low, given_range(how) ? how->high : all->high);
  if (given_range(how)) s->low = how->low, s->high = how->high;
  const double slack = 1e-6 * (s->high - s->low);
  s->below = least < s->low - slack;
  s->above = largest > s->high + slack;
  if (how->map != NULL) s->map = (int)map;
  cf_free(all);
  return CF_OK;
}
