/* SPDX-License-Identifier: MIT */
#include "solve/amend.h"

/* Factors of the couplings through the low faces of axis a. A face is next to a corner where of the two cells beside it
 * one can be left sideways and the other cannot. */
CF_KERNEL void find_row(const int dim, const int n, const cf_coupled *l, const ptrdiff_t p, const int a,
                        float *factor) {
  const float at_corner = 1 + l->excess[2];
  for (int i = 0; i < n; ++i) factor[i] = 1;
  for (int e = 0; e < dim; ++e)
    for (int side = 0; side < 2 && e != a; ++side) {
      const float *high = l->c[e] + p + side * l->box.stride[e], *low = high - l->box.stride[a];
      CF_ROW_LOOP
      for (int i = 0; i < n; ++i) factor[i] *= (high[i] > 0) != (low[i] > 0) ? at_corner : 1;
    }
}

CF_CLONES static void find_2d(const int n, const cf_coupled *l, const ptrdiff_t p) {
  find_row(2, n, l, p, 0, l->e + p);
  find_row(2, n, l, p, 1, l->r + p);
}

CF_CLONES static void find_3d(const int n, const cf_coupled *l, const ptrdiff_t p) {
  find_row(3, n, l, p, 0, l->e + p);
  find_row(3, n, l, p, 1, l->r + p);
  find_row(3, n, l, p, 2, l->rest + p);
}

CF_CLONES static void multiply(const int n, const float by, float *factor, float *c) {
  CF_ROW_LOOP
  for (int i = 0; i < n; ++i) {
    c[i] *= by * factor[i];
    factor[i] = 0;
  }
}

CF_CLONES static void scale(const int n, const float by, float *f) {
  CF_ROW_LOOP
  for (int i = 0; i < n; ++i) f[i] *= by;
}

void cf_amend(const cf_coupled *l, const cf_coupled *coarse, const cf_part *w) {
  const float alpha = 1 + coarse->excess[0], beta = 1 + coarse->excess[1];
  float *const factor[3] = {coarse->e, coarse->r, coarse->rest};
  if ((!l->has_band || coarse->excess[2] == 0) && alpha == 1 && beta == 1) return;
  for (int a = 0; a < l->dim; ++a) cf_coupled_wrap(coarse, coarse->c[a]);
  /* all are looked at before any is changed */
  CF_PARALLEL_PART (coarse, w, v)
    CF_TILE_ROWS (w, v, j, k)
      CF_TILE_RUNS (w, v, run)
        (l->dim == 3 ? find_3d : find_2d)(run->high - run->low, coarse,
                                          cf_box_at(&coarse->box, run->low, j, k));
  CF_PARALLEL_PART (coarse, w, v)
    CF_TILE_ROWS (w, v, j, k)
      CF_TILE_RUNS (w, v, run) {
        const int n = run->high - run->low;
        const ptrdiff_t p = cf_box_at(&coarse->box, run->low, j, k);
        for (int a = 0; a < l->dim; ++a) multiply(n, beta, factor[a] + p, coarse->c[a] + p);
        scale(n, alpha, coarse->free + p);
        scale(n, beta, coarse->held + p);
      }
}
