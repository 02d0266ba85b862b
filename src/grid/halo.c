/* SPDX-License-Identifier: MIT */
#include "grid/halo.h"

#include "grid/field.h"
#include "grid/sweep.h"

/* Layers of fewer cells are filled by one thread. */
#define SERIAL_CELLS 4096

/* One ghost layer of axis a, at index `to`, from index `from` (or zero), over the given window of the other
 * axes. */
typedef struct layer {
  int axis, to, from, zero;
  int low[3], high[3];
  int threads;
} layer;

static void copy_layer(const cf_box *b, const layer *l, cf_real *f) {
  const ptrdiff_t shift = (l->from - l->to) * b->stride[l->axis];
  int low[3], high[3];
  for (int a = 0; a < 3; ++a) {
    low[a] = a == l->axis ? l->to : l->low[a];
    high[a] = a == l->axis ? l->to + 1 : l->high[a];
  }
  const ptrdiff_t cells = (ptrdiff_t)(high[0] - low[0]) * (high[1] - low[1]) * (high[2] - low[2]);
#pragma omp parallel for collapse(2) schedule(static) num_threads(cells < SERIAL_CELLS ? 1 : l->threads)
  for (int k = low[2]; k < high[2]; ++k)
    for (int j = low[1]; j < high[1]; ++j) {
      cf_real *row = f + cf_box_at(b, 0, j, k);
      for (int i = low[0]; i < high[0]; ++i) row[i] = l->zero ? 0 : row[i + shift];
    }
}

/* Extents of one cell wrap onto themselves as often as the width asks. */
static int wrapped(const int i, const int n) { return ((i % n) + n) % n; }

void cf_halo_fill(const cf_box *b, const cf_halo *halo, const int width, const int component, cf_real *f) {
  layer l = {.threads = CF_MAX(halo->threads, 1)};
  for (int a = 0; a < 3; ++a) l.low[a] = 0, l.high[a] = cf_box_extent(b, a, component);
  for (int a = 0; a < b->dim; ++a) {
    const int n = b->n[a], extent = cf_box_extent(b, a, component);
    l.axis = a;
    for (int side = 0; side < 2; ++side) {
      const cf_halo_rule rule = halo->rule[a][side];
      if (rule == CF_HALO_NONE) continue;
      /* A wrapped face field repeats its first layer as its last. */
      const int start = side == 1 && rule == CF_HALO_WRAP ? n : extent;
      const int stop = CF_MAX(n + width, extent);
      for (int g = side == 0 ? -width : start; g < (side == 0 ? 0 : stop); ++g) {
        l.to = g;
        l.from = rule == CF_HALO_WRAP ? wrapped(g, n) : side == 0 ? 0 : extent - 1;
        l.zero = rule == CF_HALO_ZERO;
        copy_layer(b, &l, f);
      }
    }
    l.low[a] = halo->rule[a][0] == CF_HALO_NONE ? 0 : -width;
    l.high[a] = halo->rule[a][1] == CF_HALO_NONE ? extent : CF_MAX(n + width, extent);
  }
}
