/* SPDX-License-Identifier: MIT
 *
 * Between two levels of couplings: the residual summed over the children of coarse cells, and the interpolated correction.
 */
#include "solve/coupled.h"

#include <string.h>

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

/* Cells that have another parent leave nothing to the one around them. */
static void set_odds_apart(const cf_coupled *l) {
  for (ptrdiff_t v = 0; v < l->odds; ++v) {
    l->odd_value[v] = l->rest[l->odd_cell[v]];
    l->rest[l->odd_cell[v]] = 0;
  }
}

static void add_odds(const cf_coupled *l, const cf_coupled *coarse) {
  for (ptrdiff_t v = 0; v < l->odds; ++v)
    if (l->odd_parent[v] != CF_NO_PARENT) coarse->r[l->odd_parent[v]] += l->odd_value[v];
}

void cf_coupled_restrict(const cf_coupled *l, const cf_coupled *coarse) {
  set_odds_apart(l);
  const int x = l->coarsened[0], y = l->coarsened[1], z = l->coarsened[2];
  CF_PARALLEL_COUPLED (coarse, v)
    CF_TILE_ROWS (coarse, v, j, k) {
      const cf_run *run, *end;
      for (cf_coupled_runs(coarse, j, k, &run, &end); run < end; ++run) {
        const float *fine[4];
        int rows = 0;
        for (int kk = 0; kk <= z; ++kk)
          for (int jj = 0; jj <= y; ++jj)
            fine[rows++] = l->rest + cf_box_at(&l->box, run->low << x, (j << y) + jj, (k << z) + kk);
        float *out = coarse->r + cf_box_at(&coarse->box, run->low, j, k);
        (x ? gather_pairs : gather_single)(run->high - run->low, rows, fine, out);
      }
    }
  add_odds(l, coarse);
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

static void spread_run(const cf_coupled *coarse, const cf_coupled *l, const cf_run *run, const int j,
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
}

void cf_coupled_spread(const cf_coupled *coarse, const cf_coupled *l, const cf_run *run, const int j,
                       const int k) {
  const ptrdiff_t p = cf_box_at(&l->box, run->low, j, k);
  spread_run(coarse, l, run, j, k);
  if (l->is_gentle) keep_held_row(run->high - run->low, l->r + p, l->inverse + p, l->free + p, l->e + p);
}

static void prolong(const cf_coupled *coarse, const cf_coupled *l,
                    void (*by)(const cf_coupled *, const cf_coupled *, const cf_run *, int, int)) {
  cf_coupled_wrap(coarse, coarse->e);
  correct_odds(coarse, l);
  CF_PARALLEL_COUPLED (l, v)
    CF_TILE_ROWS (l, v, j, k) {
      const cf_run *run, *end;
      for (cf_coupled_runs(l, j, k, &run, &end); run < end; ++run) by(coarse, l, run, j, k);
    }
  for (ptrdiff_t v = 0; v < l->odds; ++v) l->e[l->odd_cell[v]] = l->odd_value[v];
}

void cf_coupled_prolong(const cf_coupled *coarse, const cf_coupled *l) {
  prolong(coarse, l, cf_coupled_spread);
}

void cf_coupled_prolong_alike(const cf_coupled *coarse, const cf_coupled *l) {
  prolong(coarse, l, spread_run);
}

/* --- the transpose of interpolation ------------------------------------------------------------------- */

/* A fine row and what it is to a coarse one: -1: a row of children; a = 1, 2: one whose cells are interpolated with it as their
 * neighbour along axis a. */
typedef struct leaving {
  ptrdiff_t row; /* its cell 0 */
  int along;
} leaving;

/* What the cells of a run leave to the coarse row `out`. */
static void leave_run(const cf_coupled *l, const cf_coupled *coarse, const cf_run *run, const leaving *f,
                      float *out) {
  const int x = l->coarsened[0], n = coarse->box.n[0];
  for (int i = run->low; i < run->high; ++i) {
    const ptrdiff_t p = f->row + i;
    const float rest = l->rest[p] * (1.0f / 256);
    if (f->along > 0) {
      out[i >> x] += (float)l->weight[f->along][p] * rest;
      continue;
    }
    int kept = 256;
    for (int a = 0; a < l->dim; ++a) kept -= l->coarsened[a] ? l->weight[a][p] : 0;
    out[i >> x] += (float)kept * rest;
    if (!x || l->weight[0][p] == 0) continue;
    int to = (i >> 1) + (i % 2 == 0 ? -1 : 1);
    if (l->periodic[0]) to = (to + n) % n;
    if (to >= 0 && to < n) out[to] += (float)l->weight[0][p] * rest;
  }
}

/* The fine rows along axis a that belong to coarse row c (step 0), or are interpolated with it as their neighbour from the
 * next one (1) or the one before (-1). Returns how many. */
static int fine_rows(const cf_coupled *l, const cf_coupled *coarse, const int a, const int c, const int step,
                     int row[2]) {
  const int n = l->box.n[a], of = coarse->box.n[a];
  int count = 0, place = c + step;
  if (!l->coarsened[a]) {
    row[0] = c;
    return step == 0;
  }
  if (l->periodic[a]) place = (place + of) % of;
  if (place < 0 || place >= of) return 0;
  for (int child = 0; child < 2; ++child)
    if ((step == 0 || child == (step < 0)) && 2 * place + child < n) row[count++] = 2 * place + child;
  return count;
}

static void leave_rows(const cf_coupled *l, const cf_coupled *coarse, const int j, const int k,
                       const int step_j, const int step_k, float *out) {
  int jj[2], kk[2];
  const int n_j = fine_rows(l, coarse, 1, j, step_j, jj), n_k = fine_rows(l, coarse, 2, k, step_k, kk);
  for (int b = 0; b < n_k; ++b)
    for (int a = 0; a < n_j; ++a) {
      const cf_tile_row *row = cf_coupled_row_at(l, jj[a], kk[b]);
      const leaving f = {cf_box_at(&l->box, 0, jj[a], kk[b]), step_j != 0 ? 1 : step_k != 0 ? 2 : -1};
      if (row == NULL) continue;
      for (const cf_run *run = l->run + row->run; run < l->run + row->run_end; ++run)
        leave_run(l, coarse, run, &f, out);
    }
}

void cf_coupled_restrict_alike(const cf_coupled *l, const cf_coupled *coarse) {
  set_odds_apart(l);
  CF_PARALLEL_COUPLED (coarse, v)
    CF_TILE_ROWS (coarse, v, j, k) {
      float *out = coarse->r + cf_box_at(&coarse->box, 0, j, k);
      CF_TILE_RUNS (coarse, v, run) memset(out + run->low, 0, (size_t)(run->high - run->low) * sizeof *out);
      leave_rows(l, coarse, j, k, 0, 0, out);
      for (int step = -1; step <= 1; step += 2) {
        leave_rows(l, coarse, j, k, step, 0, out);
        leave_rows(l, coarse, j, k, 0, step, out);
      }
    }
  add_odds(l, coarse);
}
