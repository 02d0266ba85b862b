/* SPDX-License-Identifier: MIT */
#include "solve/band.h"

#include <string.h>

#include "base/mem.h"

/* Axes from the shortest to the longest, the numbers from a cell to its neighbour along each, and the width of the band. */
typedef struct order {
  int axis[3];
  ptrdiff_t step[3], width;
} order;

static order order_of(const cf_box *b, const bool periodic[3]) {
  order o = {.axis = {0, 1, 2}};
  for (int v = 0; v < 2; ++v)
    for (int u = 0; u < 2; ++u)
      if (b->n[o.axis[u]] > b->n[o.axis[u + 1]]) {
        const int swap = o.axis[u];
        o.axis[u] = o.axis[u + 1];
        o.axis[u + 1] = swap;
      }
  ptrdiff_t step = 1;
  for (int v = 0; v < 3; ++v) {
    const int a = o.axis[v];
    o.step[a] = step;
    if (b->n[a] > 1) o.width = CF_MAX(o.width, periodic[a] ? step * (b->n[a] - 1) : step);
    step *= b->n[a];
  }
  return o;
}

double cf_band_work(const cf_box *b, const bool periodic[3]) {
  const double width = (double)order_of(b, periodic).width;
  return (double)cf_box_cells(b) * CF_MAX(width * width, 1);
}

void cf_band_destroy(cf_band *s) {
  cf_free(s->coupling);
  cf_free(s->surplus);
  cf_free(s->pivot);
  cf_free(s->solution);
  cf_free(s->place);
  *s = (cf_band){0};
}

static cf_status make_room(cf_band *s) {
  if (s->cells > s->cells_room || s->cells * s->width > s->room) {
    const ptrdiff_t cells = s->cells, width = s->width;
    cf_band_destroy(s);
    s->cells = cells, s->width = width;
    CF_TRY(CF_NEW(&s->coupling, cells * width));
    CF_TRY(CF_NEW(&s->surplus, cells));
    CF_TRY(CF_NEW(&s->pivot, cells));
    CF_TRY(CF_NEW(&s->solution, cells));
    CF_TRY(CF_NEW(&s->place, cells));
    s->cells_room = cells;
    s->room = cells * width;
  }
  memset(s->coupling, 0, (size_t)(s->cells * s->width) * sizeof *s->coupling);
  return CF_OK;
}

static void gather(cf_band *s, const cf_coupled *l, const order *o, const int at[3]) {
  const ptrdiff_t p = cf_box_at(&l->box, at[0], at[1], at[2]);
  const ptrdiff_t me = at[0] * o->step[0] + at[1] * o->step[1] + at[2] * o->step[2];
  s->place[me] = p;
  s->surplus[me] = (double)l->free[p] + (double)l->held[p];
  for (int a = 0; a < l->dim; ++a) {
    if (at[a] == 0 && !l->periodic[a]) continue;
    const ptrdiff_t other = at[a] > 0 ? me - o->step[a] : me + (l->box.n[a] - 1) * o->step[a];
    const ptrdiff_t low = CF_MIN(me, other), apart = CF_MAX(me, other) - low;
    s->coupling[low * s->width + apart - 1] += (double)l->c[a][p];
  }
}

/* Cell j leaves: its neighbours are coupled to each other, and its surplus is shared among them. */
static void eliminate(cf_band *s, const ptrdiff_t j) {
  const double *row = s->coupling + j * s->width;
  const ptrdiff_t last = CF_MIN(s->width, s->cells - 1 - j);
  double sum = s->surplus[j];
  for (ptrdiff_t v = 0; v < last; ++v) sum += row[v];
  s->pivot[j] = sum;
  if (!(sum > 0)) return;
  for (ptrdiff_t v = 0; v < last; ++v) {
    const double share = row[v] / sum;
    if (share == 0) continue;
    s->surplus[j + 1 + v] += share * s->surplus[j];
    double *to = s->coupling + (j + 1 + v) * s->width - v - 1;
    for (ptrdiff_t u = v + 1; u < last; ++u) to[u] += share * row[u];
  }
}

cf_status cf_band_factor(cf_band *s, const cf_coupled *l) {
  const order o = order_of(&l->box, l->periodic);
  s->cells = cf_box_cells(&l->box);
  s->width = CF_MAX(o.width, 1);
  CF_TRY(make_room(s));
  int at[3];
  for (at[2] = 0; at[2] < l->box.n[2]; ++at[2])
    for (at[1] = 0; at[1] < l->box.n[1]; ++at[1])
      for (at[0] = 0; at[0] < l->box.n[0]; ++at[0]) gather(s, l, &o, at);
  for (ptrdiff_t j = 0; j < s->cells; ++j) eliminate(s, j);
  return CF_OK;
}

void cf_band_solve(const cf_band *s, const cf_coupled *l) {
  double *y = s->solution;
  for (ptrdiff_t j = 0; j < s->cells; ++j) y[j] = (double)l->r[s->place[j]];
  for (ptrdiff_t j = 0; j < s->cells; ++j) {
    const double *row = s->coupling + j * s->width;
    y[j] = s->pivot[j] > 0 ? y[j] / s->pivot[j] : 0;
    const ptrdiff_t last = CF_MIN(s->width, s->cells - 1 - j);
    for (ptrdiff_t v = 0; v < last; ++v) y[j + 1 + v] += row[v] * y[j];
  }
  for (ptrdiff_t j = s->cells - 1; j >= 0; --j) {
    const double *row = s->coupling + j * s->width;
    const ptrdiff_t last = CF_MIN(s->width, s->cells - 1 - j);
    double sum = 0;
    for (ptrdiff_t v = 0; v < last; ++v) sum += row[v] * y[j + 1 + v];
    if (s->pivot[j] > 0) y[j] += sum / s->pivot[j];
  }
  for (ptrdiff_t j = 0; j < s->cells; ++j) l->e[s->place[j]] = s->pivot[j] > 0 ? (float)y[j] : 0;
}
