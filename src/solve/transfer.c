/* SPDX-License-Identifier: MIT */
#include "solve/transfer.h"

#include <omp.h>
#include <string.h>

#include "base/mem.h"
#include "grid/sweep.h"

static cf_status axis_allocate(cf_axis *axis, const int n) {
  axis->n = n;
  CF_TRY(CF_NEW(&axis->width, n));
  CF_TRY(CF_NEW(&axis->lo, n));
  CF_TRY(CF_NEW(&axis->hi, n));
  CF_TRY(CF_NEW(&axis->lo1, n));
  return CF_NEW(&axis->hi1, n);
}

void cf_axis_clear(cf_axis *axis) {
  cf_free(axis->width);
  cf_free(axis->lo);
  cf_free(axis->hi);
  cf_free(axis->lo1);
  cf_free(axis->hi1);
  *axis = (cf_axis){0};
}

/* 1/(width * distance) to the neighbour on a side, in units of 1/m^2. */
static double metric(const cf_axis *axis, const int i, const int side, const double h) {
  const int neighbour = i + (side == 0 ? -1 : 1);
  const bool at_wall = neighbour < 0 || neighbour >= axis->n;
  double distance = 0;
  if (!at_wall)
    distance = 0.5 * (axis->width[i] + axis->width[neighbour]);
  else if (axis->periodic)
    distance = 0.5 * (axis->width[i] + axis->width[side == 0 ? axis->n - 1 : 0]);
  else if (axis->held[side])
    distance = 0.5 * axis->width[i];
  return distance > 0 ? 1 / (axis->width[i] * distance * h * h) : 0;
}

static void fill_metrics(cf_axis *axis, const double h) {
  for (int i = 0; i < axis->n; ++i) {
    axis->lo1[i] = metric(axis, i, 0, h);
    axis->hi1[i] = metric(axis, i, 1, h);
  }
}

cf_status cf_axis_create(cf_axis *axis, const int n, const double h, const cf_wall wall[2]) {
  CF_TRY(axis_allocate(axis, n));
  axis->periodic = wall[0] == CF_WALL_PERIODIC && n > 1;
  for (int side = 0; side < 2; ++side) axis->held[side] = cf_wall_is_held(wall[side]);
  for (int i = 0; i < n; ++i) axis->width[i] = 1;
  fill_metrics(axis, h);
  return CF_OK;
}

void cf_pairing_clear(cf_pairing *pairing) {
  cf_free(pairing->parent);
  cf_free(pairing->other);
  cf_free(pairing->weight[0]);
  cf_free(pairing->weight[1]);
  cf_free(pairing->share);
  *pairing = (cf_pairing){0};
}

/* Linear interpolation of fine cell i, whose centre lies `offset` above its parent's, from the parent and the
 * neighbour on that side. */
static void interpolate(cf_pairing *p, const cf_axis *coarse, const int i, const double offset) {
  const int parent = p->parent[i], side = offset > 0, other = parent + (side ? 1 : -1);
  double away = 0; /* the share of the neighbour */
  p->other[i] = parent;
  p->weight[0][i] = 1;
  p->weight[1][i] = 0;
  if (offset == 0) return;
  const double size = offset > 0 ? offset : -offset;
  const bool at_wall = other < 0 || other >= coarse->n;
  if (!at_wall || coarse->periodic) {
    const int image = other < 0 ? coarse->n - 1 : other >= coarse->n ? 0 : other;
    away = size / (0.5 * (coarse->width[parent] + coarse->width[image]));
    p->other[i] = other;
  } else if (coarse->held[side]) {
    away = size / (0.5 * coarse->width[parent]);
    p->other[i] = other; /* a ghost, 0 */
  }
  p->weight[0][i] = (cf_real)(1 - away);
  p->weight[1][i] = (cf_real)away;
}

static cf_status pairing_allocate(cf_pairing *p, const int n) {
  CF_TRY(CF_NEW(&p->parent, n));
  CF_TRY(CF_NEW(&p->other, n));
  CF_TRY(CF_NEW(&p->weight[0], n));
  CF_TRY(CF_NEW(&p->weight[1], n));
  return CF_NEW(&p->share, n);
}

int cf_axis_coarse_count(const cf_axis *fine) {
  const bool alone = fine->n % 2 == 1 && fine->width[fine->n - 1] >= fine->width[0];
  return fine->n / 2 + (alone ? 1 : 0);
}

cf_status cf_axis_coarsen(const cf_axis *fine, const bool coarsened, const double h, cf_pairing *p,
                          cf_axis *coarse) {
  const int n = coarsened ? cf_axis_coarse_count(fine) : fine->n;
  p->coarsened = coarsened;
  CF_TRY(pairing_allocate(p, fine->n));
  CF_TRY(axis_allocate(coarse, n));
  coarse->periodic = fine->periodic && n > 1;
  memcpy(coarse->held, fine->held, sizeof fine->held);
  for (int i = 0; i < fine->n; ++i) {
    p->parent[i] = coarsened ? CF_MIN(i / 2, n - 1) : i;
    coarse->width[p->parent[i]] += fine->width[i];
  }
  double edge = 0; /* of fine cell i, from the low edge of its parent */
  for (int i = 0; i < fine->n; ++i) {
    const int parent = p->parent[i];
    if (i > 0 && p->parent[i - 1] != parent) edge = 0;
    p->share[i] = (cf_real)(fine->width[i] / coarse->width[parent]);
    interpolate(p, coarse, i, edge + 0.5 * fine->width[i] - 0.5 * coarse->width[parent]);
    edge += fine->width[i];
  }
  fill_metrics(coarse, h);
  return CF_OK;
}

/* The children of coarse cell I along an axis: first, first + 1, ... first + count - 1. */
static void children(const cf_pairing *p, const int n_fine, const int n_coarse, const int I, int *first,
                     int *count) {
  *first = p->coarsened ? 2 * I : I;
  *count = !p->coarsened ? 1 : I == n_coarse - 1 ? n_fine - 2 * (n_coarse - 1) : 2;
}

CF_CLONES static void add_scaled_row(const int n, const cf_real factor, const cf_real *from, cf_real *to) {
  CF_ROW_LOOP
  for (int i = 0; i < n; ++i) to[i] += factor * from[i];
}

CF_CLONES static void pair_row(const int n, const cf_real *fine, const cf_real *share, cf_real *coarse) {
  CF_ROW_LOOP
  for (int I = 0; I < n; ++I) coarse[I] = share[2 * I] * fine[2 * I] + share[2 * I + 1] * fine[2 * I + 1];
}

static void restrict_row(const cf_level *fine, const cf_real *r, const cf_level *coarse, const ptrdiff_t row,
                         cf_real *sum, cf_real *b) {
  const cf_box *f = &fine->box, *c = &coarse->box;
  const int at[3] = {0, (int)(row % c->n[1]), (int)(row / c->n[1])};
  int first[3] = {0, 0, 0}, count[3] = {1, 1, 1};
  for (int a = 1; a < c->dim; ++a) children(&fine->pairing[a], f->n[a], c->n[a], at[a], &first[a], &count[a]);
  memset(sum, 0, (size_t)f->n[0] * sizeof *sum);
  for (int k = first[2]; k < first[2] + count[2]; ++k)
    for (int j = first[1]; j < first[1] + count[1]; ++j) {
      const cf_real share = fine->pairing[1].share[j] * (c->dim == 3 ? fine->pairing[2].share[k] : 1);
      add_scaled_row(f->n[0], share, r + cf_box_at(f, 0, j, k), sum);
    }
  const cf_pairing *x = &fine->pairing[0];
  cf_real *out = b + cf_box_row(c, row);
  if (!x->coarsened) {
    memcpy(out, sum, (size_t)c->n[0] * sizeof *out);
    return;
  }
  const int pairs = f->n[0] / 2, last = f->n[0] - 1;
  pair_row(pairs, sum, x->share, out);
  if (c->n[0] > pairs) out[c->n[0] - 1] = 0;
  if (last == 2 * pairs) out[c->n[0] - 1] += x->share[last] * sum[last];
}

void cf_level_restrict(const cf_level *fine, const cf_cell r, const cf_level *coarse, const cf_cell b,
                       cf_real *scratch) {
  CF_PARALLEL_ROWS (&coarse->box, coarse->threads, row)
    restrict_row(fine, r.at, coarse, row, scratch + (ptrdiff_t)omp_get_thread_num() * (fine->box.n[0] + 2),
                 b.at);
}

/* x[2I], x[2I+1] += interpolated from c[I] and its two neighbours. */
CF_CLONES static void spread_row(const int n, const cf_real *c, const cf_real *own, const cf_real *away,
                                 cf_real *x) {
  CF_ROW_LOOP
  for (int I = 0; I < n; ++I) {
    x[2 * I] += own[2 * I] * c[I] + away[2 * I] * c[I - 1];
    x[2 * I + 1] += own[2 * I + 1] * c[I] + away[2 * I + 1] * c[I + 1];
  }
}

static void prolong_row(const cf_level *coarse, const cf_real *x_c, const cf_level *fine, const ptrdiff_t row,
                        cf_real *sum, cf_real *x_f) {
  const cf_box *f = &fine->box, *c = &coarse->box;
  const int at[3] = {0, (int)(row % f->n[1]), (int)(row / f->n[1])};
  const cf_pairing *x = &fine->pairing[0], *y = &fine->pairing[1], *z = &fine->pairing[2];
  const int n = c->n[0];
  memset(sum, 0, (size_t)(n + 2) * sizeof *sum);
  for (int kk = 0; kk < (c->dim == 3 ? 2 : 1); ++kk)
    for (int jj = 0; jj < 2; ++jj) {
      const int j = jj == 0 ? y->parent[at[1]] : y->other[at[1]];
      const int k = c->dim == 2 ? 0 : kk == 0 ? z->parent[at[2]] : z->other[at[2]];
      const cf_real weight = y->weight[jj][at[1]] * (c->dim == 3 ? z->weight[kk][at[2]] : 1);
      if (weight != 0) add_scaled_row(n + 2, weight, x_c + cf_box_at(c, -1, j, k), sum);
    }
  const cf_real *line = sum + 1; /* line[-1] and line[n] are ghosts */
  cf_real *out = x_f + cf_box_row(f, row);
  if (!x->coarsened) {
    add_scaled_row(n, 1, line, out);
    return;
  }
  /* The pairs; a triple and a single cell are done apart. */
  const int pairs = CF_MIN(f->n[0] / 2, f->n[0] % 2 == 0 ? n : n - 1);
  spread_row(pairs, line, x->weight[0], x->weight[1], out);
  for (int i = 2 * pairs; i < f->n[0]; ++i)
    out[i] += x->weight[0][i] * line[x->parent[i]] + x->weight[1][i] * line[x->other[i]];
}

void cf_level_prolong(const cf_level *coarse, const cf_cell x_c, const cf_level *fine, const cf_cell x_f,
                      cf_real *scratch) {
  if (coarse->has_seam) cf_halo_fill(&coarse->box, &coarse->wrap, 1, -1, x_c.at);
  CF_PARALLEL_ROWS (&fine->box, fine->threads, row)
    prolong_row(coarse, x_c.at, fine, row, scratch + (ptrdiff_t)omp_get_thread_num() * (fine->box.n[0] + 2),
                x_f.at);
}
