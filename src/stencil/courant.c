/* SPDX-License-Identifier: MIT */
#include "stencil/courant.h"

#include <math.h>

#include "grid/sweep.h"

/* --- ghosts ------------------------------------------------------------------------------------------- */

/* A layer of f across axis a: f[to] = (1 + goes_on) f[near] - goes_on f[far]. */
typedef struct layer {
  int axis, to, near, far;
  cf_real goes_on; /* 0 or 1 */
} layer;

static void fill_layer(const cf_box *b, const layer *l, const int low[3], const int high[3], cf_real *f) {
  int from[3], stop[3];
  for (int a = 0; a < 3; ++a) {
    from[a] = a == l->axis ? l->to : low[a];
    stop[a] = a == l->axis ? l->to + 1 : high[a];
  }
  const ptrdiff_t near = (l->near - l->to) * b->stride[l->axis], far = (l->far - l->to) * b->stride[l->axis];
  for (int k = from[2]; k < stop[2]; ++k)
    for (int j = from[1]; j < stop[1]; ++j) {
      cf_real *row = f + cf_box_at(b, 0, j, k);
      for (int i = from[0]; i < stop[0]; ++i)
        row[i] = l->goes_on > 0 ? 2 * row[i + near] - row[i + far] : row[i + near];
    }
}

static void fill_component(const cf_box *b, const bool wrap[3], const int c, cf_real *f) {
  int low[3] = {0, 0, 0}, high[3];
  for (int a = 0; a < 3; ++a) high[a] = cf_box_extent(b, a, c);
  for (int a = 0; a < b->dim; ++a) {
    const int n = b->n[a], last = high[a] - 1;
    if (wrap[a]) {
      fill_layer(b, &(layer){a, n, 0, 0, 0}, low, high, f);
      fill_layer(b, &(layer){a, -1, n - 1, 0, 0}, low, high, f);
      if (last == n) fill_layer(b, &(layer){a, n + 1, 1, 0, 0}, low, high, f);
    } else {
      const cf_real own = a == c ? 1 : 0;
      fill_layer(b, &(layer){a, -1, 0, a == c ? 1 : 0, own}, low, high, f);
      fill_layer(b, &(layer){a, last + 1, last, a == c ? last - 1 : last, own}, low, high, f);
    }
    low[a] = -1;
    high[a] = last + 2;
  }
}

void cf_courant_ghosts(const cf_grid *g, const bool wrap[3], const cf_face u) {
  for (int c = 0; c < g->box.dim; ++c) fill_component(&g->box, wrap, c, u.at[c]);
}

bool cf_courant_still(const cf_grid *g, const cf_face u, const int axis) {
  const cf_box *b = &g->box;
  for (int k = 0; k < cf_box_extent(b, 2, axis); ++k)
    for (int j = 0; j < cf_box_extent(b, 1, axis); ++j) {
      const cf_real *row = u.at[axis] + cf_box_at(b, 0, j, k);
      for (int i = 0; i < cf_box_extent(b, 0, axis); ++i)
        if (!(row[i] == 0)) return false;
    }
  return true;
}

/* --- the rate ----------------------------------------------------------------------------------------- */

#define LANES 16

typedef struct outflow {
  const cf_real *u[3];
  ptrdiff_t stride[3];
} outflow;

static inline cf_real positive(const cf_real a) { return a > 0 ? a : 0; }

/* What one axis does to a cell: the sum of losses over axes, the most that leaves through both faces of one, and
 * a mark that is NaN if a face is not finite. */
typedef struct losses {
  cf_real sum, most, mark;
} losses;

static inline losses with_axis(const losses before, const cf_real low, const cf_real high) {
  const cf_real grows = positive(high - low), extra = positive(high) + positive(-low) - grows;
  return (losses){before.sum + grows, extra > before.most ? extra : before.most,
                  before.mark + (low + high) * 0};
}

/* K h/dt of one cell; NaN if a face is not finite. Axes one by one: clang does not unroll a loop within a row. */
CF_KERNEL cf_real outflow_of(const int dim, const outflow *o, const ptrdiff_t p) {
  losses l = {0, 0, 0};
  l = with_axis(l, o->u[0][p], o->u[0][p + o->stride[0]]);
  l = with_axis(l, o->u[1][p], o->u[1][p + o->stride[1]]);
  if (dim == 3) l = with_axis(l, o->u[2][p], o->u[2][p + o->stride[2]]);
  return l.sum + l.most + l.mark;
}

/* The largest of a row in a few lanes, with a mark that is NaN if any was. */
CF_KERNEL void outflow_row(const int dim, const int n, const outflow *o, cf_real *lanes) {
  cf_real *mark = lanes + LANES;
  int i = 0;
  for (; i + LANES <= n; i += LANES) {
    CF_ROW_LOOP
    for (int l = 0; l < LANES; ++l) {
      const cf_real k = outflow_of(dim, o, i + l);
      lanes[l] = k > lanes[l] ? k : lanes[l];
      mark[l] += k * 0;
    }
  }
  for (int l = 0; i < n; ++i, ++l) {
    const cf_real k = outflow_of(dim, o, i);
    lanes[l] = k > lanes[l] ? k : lanes[l];
    mark[l] += k * 0;
  }
}
CF_CLONED(outflow_row, const outflow *, cf_real *)

static double outflow_of_row(const cf_box *b, const cf_face u, const ptrdiff_t p, const int n) {
  outflow o;
  cf_real lanes[2 * LANES] = {0};
  for (int a = 0; a < b->dim; ++a) o.u[a] = u.at[a] + p, o.stride[a] = b->stride[a];
  outflow_row_by_dim(b->dim, n, &o, lanes);
  double most = 0;
  for (int l = 0; l < LANES; ++l) {
    if (!(lanes[LANES + l] == 0)) return INFINITY;
    most = CF_MAX(most, (double)lanes[l]);
  }
  return most;
}

static cf_status blame(const cf_grid *g, const cf_face u) {
  const cf_box *b = &g->box;
  for (int a = 0; a < b->dim; ++a)
    for (int k = 0; k < cf_box_extent(b, 2, a); ++k)
      for (int j = 0; j < cf_box_extent(b, 1, a); ++j)
        for (int i = 0; i < cf_box_extent(b, 0, a); ++i) {
          const double value = (double)u.at[a][cf_box_at(b, i, j, k)];
          if (!isfinite(value))
            return cf_fail(CF_NOT_FINITE, "the velocity along %c is %g on face (%d, %d, %d)", "xyz"[a], value,
                           i, j, k);
        }
  return cf_fail(CF_NOT_FINITE, "the velocity is too large to be worked with");
}

cf_status cf_courant_rate(const cf_grid *g, const cf_face u, double *rate) {
  const cf_box *b = &g->box;
  const int ny = b->n[1] + 2, nz = b->dim == 3 ? b->n[2] + 2 : 1;
  double most = 0;
#pragma omp parallel for schedule(static) num_threads(cf_sweep_threads(b, g->threads)) reduction(max : most)
  for (int r = 0; r < ny * nz; ++r) {
    const int j = r % ny - 1, k = b->dim == 3 ? r / ny - 1 : 0;
    const bool beside_y = j < 0 || j == b->n[1], beside_z = k < 0 || k == b->n[2];
    if (beside_y && beside_z) continue;
    /* Rows beside the box have no ghosts of their own at their ends. */
    const int ends = beside_y || beside_z ? 0 : 1;
    const double row = outflow_of_row(b, u, cf_box_at(b, -ends, j, k), b->n[0] + 2 * ends);
    most = row > most ? row : most;
  }
  if (!isfinite(most)) return blame(g, u);
  *rate = most / g->h;
  return CF_OK;
}
