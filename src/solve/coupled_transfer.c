/* SPDX-License-Identifier: MIT
 *
 * Between two levels of couplings: the residual summed over the children of coarse cells, and the interpolated correction.
 */
#include "solve/coupled.h"

/* Sums over the children of coarse cells in a row; what lies beyond the box is 0. */
CF_CLONES static void gather_pairs(const int n, const int rows, const float *const *fine, float *coarse) {
  for (int i = 0; i < n; ++i) coarse[i] = 0;
  for (int v = 0; v < rows; ++v) {
    const float *f = fine[v];
    CF_ROW_LOOP
    for (int i = 0; i < n; ++i) coarse[i] += f[2 * i] + f[2 * i + 1];
  }
}

CF_CLONES static void gather_single(const int n, const int rows, const float *const *fine, float *coarse) {
  for (int i = 0; i < n; ++i) coarse[i] = 0;
  for (int v = 0; v < rows; ++v) {
    const float *f = fine[v];
    CF_ROW_LOOP
    for (int i = 0; i < n; ++i) coarse[i] += f[i];
  }
}

void cf_coupled_restrict(const cf_coupled *l, const cf_coupled *coarse) {
  for (ptrdiff_t v = 0; v < l->odds; ++v) {
    l->odd_value[v] = l->rest[l->odd_cell[v]];
    l->rest[l->odd_cell[v]] = 0;
  }
  const int x = l->coarsened[0], y = l->coarsened[1], z = l->coarsened[2];
  CF_PARALLEL_COUPLED (coarse, v)
    CF_TILE_ROWS (coarse, v, j, k)
      CF_TILE_RUNS (coarse, v, run) {
        const float *fine[4];
        int rows = 0;
        for (int kk = 0; kk <= z; ++kk)
          for (int jj = 0; jj <= y; ++jj)
            fine[rows++] = l->rest + cf_box_at(&l->box, run->low << x, (j << y) + jj, (k << z) + kk);
        float *out = coarse->r + cf_box_at(&coarse->box, run->low, j, k);
        (x ? gather_pairs : gather_single)(run->high - run->low, rows, fine, out);
      }
  for (ptrdiff_t v = 0; v < l->odds; ++v)
    if (l->odd_parent[v] != CF_NO_PARENT) coarse->r[l->odd_parent[v]] += l->odd_value[v];
}

/* The constant of an island: what its residual sums to over its free and held. Its cells follow each other in the list. */
static ptrdiff_t lift_island(const cf_coupled *l, const ptrdiff_t first) {
  double residual = 0, fixed = 0;
  ptrdiff_t end = first;
  for (; end < l->odds && l->odd_island[end] == l->odd_island[first]; ++end) {
    const ptrdiff_t p = l->odd_cell[end];
    residual += (double)l->odd_value[end];
    fixed += (double)l->free[p] + (double)l->held[p];
  }
  for (ptrdiff_t v = first; v < end; ++v) l->odd_value[v] = fixed > 0 ? (float)(residual / fixed) : 0;
  return end;
}

void cf_coupled_lift_odds(const cf_coupled *coarse, const cf_coupled *l) {
  for (ptrdiff_t v = 0; v < l->odds;) {
    if (l->odd_parent[v] == CF_NO_PARENT) {
      v = lift_island(l, v);
      continue;
    }
    l->odd_value[v] = coarse->e[l->odd_parent[v]];
    ++v;
  }
}

/* What the cells with another parent will be: their e and their own correction. */
static void correct_odds(const cf_coupled *coarse, const cf_coupled *l) {
  cf_coupled_lift_odds(coarse, l);
  for (ptrdiff_t v = 0; v < l->odds; ++v) l->odd_value[v] += l->e[l->odd_cell[v]];
}

/* A row of coarse cells, and those of its neighbours in y and z on the side of the fine row. */
typedef struct spread {
  const float *own, *y, *z;
  const unsigned char *weight[3];
  float *e;
} spread;

CF_KERNEL float interpolated(const int dim, const spread *s, const int I, const int i, const int side) {
  const float own = s->own[I], unit = 1.0f / 256;
  float sum = (float)s->weight[1][i] * (s->y[I] - own);
  if (dim == 3) sum += (float)s->weight[2][i] * (s->z[I] - own);
  if (side != 0) sum += (float)s->weight[0][i] * (s->own[I + side] - own);
  return own + unit * sum;
}

CF_KERNEL void spread_pairs(const int dim, const int n, const spread *s, const int odd_end) {
  const spread w = *s;
  CF_ROW_LOOP
  for (int I = 0; I < n; ++I) {
    w.e[2 * I] += interpolated(dim, &w, I, 2 * I, -1);
    w.e[2 * I + 1] += interpolated(dim, &w, I, 2 * I + 1, 1);
  }
  if (odd_end) w.e[2 * n] += interpolated(dim, &w, n, 2 * n, -1);
}

CF_KERNEL void spread_single(const int dim, const int n, const spread *s, const int unused) {
  (void)unused;
  const spread w = *s;
  CF_ROW_LOOP
  for (int i = 0; i < n; ++i) w.e[i] += interpolated(dim, &w, i, i, 0);
}

/* The transpose of the sums of restriction. */
CF_CLONES static void copy_pairs(const int n, const float *own, float *e) {
  for (int i = 0; i < n; ++i) e[i] += own[i / 2];
}

CF_CLONES static void copy_single(const int n, const float *own, float *e) {
  CF_ROW_LOOP
  for (int i = 0; i < n; ++i) e[i] += own[i];
}

CF_CLONED(spread_pairs, const spread *, const int)
CF_CLONED(spread_single, const spread *, const int)

/* Cells that alpha holds take no correction: next to it a wrong one of theirs would be a large residual. */
CF_CLONES static void keep_held_row(const int n, const float *r, const float *inverse, const float *free,
                                    float *e) {
  CF_ROW_LOOP
  for (int i = 0; i < n; ++i) e[i] = free[i] * inverse[i] > 0.99f ? inverse[i] * r[i] : e[i];
}

/* The coarse neighbour of fine index i on its side: -1, 1, or 0 where the axis is not coarsened. */
static int side_of(const cf_coupled *l, const int a, const int i) {
  return !l->coarsened[a] ? 0 : i % 2 == 0 ? -1 : 1;
}

void cf_coupled_prolong_back(const cf_coupled *coarse, const cf_coupled *l) {
  correct_odds(coarse, l);
  CF_PARALLEL_COUPLED (l, v)
    CF_TILE_ROWS (l, v, j, k)
      CF_TILE_RUNS (l, v, run) {
        const float *own = coarse->e + cf_box_at(&coarse->box, run->low >> l->coarsened[0],
                                                 j >> l->coarsened[1], k >> l->coarsened[2]);
        float *e = l->e + cf_box_at(&l->box, run->low, j, k);
        (l->coarsened[0] ? copy_pairs : copy_single)(run->high - run->low, own, e);
      }
  for (ptrdiff_t v = 0; v < l->odds; ++v) l->e[l->odd_cell[v]] = l->odd_value[v];
}

void cf_coupled_spread(const cf_coupled *coarse, const cf_coupled *l, const cf_run *run, const int j,
                       const int k) {
  const cf_box *c = &coarse->box;
  const int x = l->coarsened[0], n = run->high - run->low;
  const float *own = coarse->e + cf_box_at(c, run->low >> x, j >> l->coarsened[1], k >> l->coarsened[2]);
  const ptrdiff_t p = cf_box_at(&l->box, run->low, j, k);
  const spread s = {.own = own,
                    .y = own + side_of(l, 1, j) * c->stride[1],
                    .z = l->dim == 3 ? own + side_of(l, 2, k) * c->stride[2] : own,
                    .weight = {l->weight[0] + p, l->weight[1] + p, l->dim == 3 ? l->weight[2] + p : NULL},
                    .e = l->e + p};
  if (x)
    spread_pairs_by_dim(l->dim, n / 2, &s, n % 2);
  else
    spread_single_by_dim(l->dim, n, &s, 0);
  if (l->is_gentle) keep_held_row(n, l->r + p, l->inverse + p, l->free + p, l->e + p);
}

void cf_coupled_prolong(const cf_coupled *coarse, const cf_coupled *l) {
  cf_coupled_wrap(coarse, coarse->e);
  correct_odds(coarse, l);
  CF_PARALLEL_COUPLED (l, v)
    CF_TILE_ROWS (l, v, j, k)
      CF_TILE_RUNS (l, v, run) cf_coupled_spread(coarse, l, run, j, k);
  for (ptrdiff_t v = 0; v < l->odds; ++v) l->e[l->odd_cell[v]] = l->odd_value[v];
}
