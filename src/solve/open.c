/* SPDX-License-Identifier: MIT */
#include "solve/open.h"

#include <string.h>

/* A coupling that is smaller than this (the largest diagonal is 1) counts as closed here: products of three are formed. */
#define FAINT 1e-15f

/* Cells of a row that go together. */
#define PIECE 256

/* --- the finest level --------------------------------------------------------------------------------- */

/* Everything at the first cell of a row. low and high: 1/h^2 for faces along an axis, 0 where the box ends; wall: what is held
 * there. Of axis 0 they are those of the first and of the last cell, and `inner` holds for all others. */
typedef struct source {
  const cf_real *beta[3];
  double beta_number, scale, inner, low[3], high[3], low_wall[3], high_wall[3];
  ptrdiff_t stride[3];
  float *c[3], *free, *held, *inverse;
  int last; /* cell of the row */
} source;

enum { CLOSED = 1, HEAVY = 2, FIXED = 4 };

CF_CLONES static void fill_free(const int n, const cf_real *alpha, const double number, const double scale,
                                float *free) {
  if (alpha == NULL) {
    for (int i = 0; i < n; ++i) free[i] = (float)(scale * number);
    return;
  }
  CF_ROW_LOOP
  for (int i = 0; i < n; ++i) free[i] = (float)(scale * (double)alpha[i]);
}

static int finish_cell(const source *s, const int i, const float around) {
  const float sum = s->free[i] + s->held[i] + around;
  s->inverse[i] = sum > 0 ? 1 / sum : 0;
  return (s->free[i] * s->inverse[i] > 0.3f ? HEAVY : 0) | (s->free[i] + s->held[i] > 0 ? FIXED : 0);
}

/* A cell that may be at walls. */
static int fill_cell(const int dim, const source *s, const int i) {
  double wall = 0;
  float around = 0;
  int flags = 0;
  for (int a = 0; a < dim; ++a) {
    const bool first = a == 0 && i > 0, last = a == 0 && i < s->last;
    const double low = first ? s->inner : s->low[a], high = last ? s->inner : s->high[a];
    const double below = s->beta[a] != NULL ? (double)s->beta[a][i] : s->beta_number,
                 above = s->beta[a] != NULL ? (double)s->beta[a][i + s->stride[a]] : s->beta_number;
    const float c = (float)(s->scale * (below * low)), d = (float)(s->scale * (above * high));
    wall += below * (first ? 0 : s->low_wall[a]);
    wall += above * (last ? 0 : s->high_wall[a]);
    if ((low > 0 && !(c > FAINT)) || (high > 0 && !(d > FAINT))) flags |= CLOSED;
    around += c + d;
    s->c[a][i] = c;
  }
  s->held[i] = (float)(s->scale * wall);
  return flags | finish_cell(s, i, around);
}

/* Cells 1 to n - 1 that are not, as above. form 1: beta is a field. */
CF_KERNEL void fill_inner(const int dim, const int form, const int n, const source *of, int *flags) {
  const source s = *of;
  const double inner = s.inner, scale = s.scale;
  int closed = 0, heavy = 0, fixed = 0;
#pragma omp simd reduction(| : closed, heavy, fixed)
  for (int i = 1; i < n; ++i) {
    float around = 0;
    CF_AXIS_LOOP
    for (int a = 0; a < dim; ++a) {
      const double below = form ? (double)s.beta[a][i] : s.beta_number,
                   above = form ? (double)s.beta[a][i + s.stride[a]] : s.beta_number;
      const float c = (float)(scale * (below * inner)), d = (float)(scale * (above * inner));
      closed |= c > FAINT ? 0 : 1;
      closed |= d > FAINT ? 0 : 1;
      around += c + d;
      s.c[a][i] = c;
    }
    const float free = s.free[i], sum = free + around, inverse = sum > 0 ? 1 / sum : 0;
    s.held[i] = 0;
    s.inverse[i] = inverse;
    heavy |= free * inverse > 0.3f ? 1 : 0;
    fixed |= free > 0 ? 1 : 0;
  }
  *flags = (closed ? CLOSED : 0) | (heavy ? HEAVY : 0) | (fixed ? FIXED : 0);
}
CF_CLONED_FORMS(fill_inner, const source *, int *)

static int fill_row_of(const cf_coupled *l, const source *s) {
  int flags = 0, ends = fill_cell(l->dim, s, 0);
  bool inside = true;
  for (int a = 1; a < l->dim; ++a) inside = inside && s->low[a] > 0 && s->high[a] > 0;
  if (inside)
    fill_inner_by_form(l->dim, s->beta[0] != NULL, s->last, s, &flags);
  else
    for (int i = 1; i < s->last; ++i) ends |= fill_cell(l->dim, s, i);
  if (s->last > 0) ends |= fill_cell(l->dim, s, s->last);
  return flags | ends;
}

static source source_of(const cf_varied *v, const cf_coefficients *c, const int j, const int k,
                        const cf_open_row *to) {
  const cf_coupled *l = &v->level[0];
  const ptrdiff_t p = cf_box_at(&l->box, 0, j, k);
  const int at[3] = {0, j, k};
  source s = {.beta_number = c->beta,
              .scale = v->scale,
              .inner = 1 / (v->A->grid.h * v->A->grid.h),
              .free = to->free,
              .held = to->held,
              .inverse = to->inverse,
              .last = l->box.n[0] - 1};
  for (int a = 0; a < l->dim; ++a) {
    const int last = l->box.n[a] - 1;
    const bool around = v->A->level[0].axis[a].periodic, low = at[a] == 0, high = a == 0 || at[a] == last;
    s.low[a] = low && !around ? 0 : s.inner;
    s.high[a] = high && !around ? 0 : s.inner;
    s.low_wall[a] = low && !around ? (double)v->lo[a][0] : 0;
    s.high_wall[a] = high && !around ? (double)v->hi[a][last] : 0;
    s.stride[a] = l->box.stride[a];
    s.beta[a] = c->beta_at != NULL ? c->beta_at->at[a] + p : NULL;
    s.c[a] = to->c[a];
  }
  return s;
}

/* No cell of the level bears a mark. */
bool cf_open_is_bare(const cf_coupled *l) { return l->tiles == NULL && !l->has_band && l->odds == 0; }

static void take(cf_coupled *l, const int flags) {
  l->is_open = !(flags & CLOSED);
  l->is_gentle = flags & HEAVY;
  l->is_fixed = flags & FIXED;
}

int cf_open_fill_row(const cf_varied *v, const cf_coefficients *c, const int j, const int k,
                     const cf_open_row *to) {
  const cf_coupled *l = &v->level[0];
  const source s = source_of(v, c, j, k, to);
  fill_free(l->box.n[0], c->alpha_at != NULL ? c->alpha_at->at + cf_box_at(&l->box, 0, j, k) : NULL, c->alpha,
            v->scale, s.free);
  return fill_row_of(l, &s);
}

bool cf_open_take(cf_varied *v, const int flags) {
  take(&v->level[0], flags);
  return v->level[0].is_open;
}

bool cf_open_fill(cf_varied *v, const cf_coefficients *c) {
  cf_coupled *l = &v->level[0];
  l->is_open = false;
  if (v->region != NULL || !cf_open_is_bare(l)) return false;
  int flags = 0;
#pragma omp parallel for schedule(static) num_threads(cf_coupled_threads(l)) reduction(| : flags)
  for (ptrdiff_t r = 0; r < l->rows; ++r)
    CF_TILE_ROWS (l, r, j, k) {
      const ptrdiff_t p = cf_box_at(&l->box, 0, j, k);
      const cf_open_row to = {{l->c[0] + p, l->c[1] + p, l->dim == 3 ? l->c[2] + p : NULL},
                              l->free + p,
                              l->held + p,
                              l->inverse + p};
      flags |= cf_open_fill_row(v, c, j, k, &to);
    }
  take(l, flags);
  for (int a = 0; a < l->dim && l->is_open; ++a) cf_coupled_wrap_axis(l, a, l->c[a]);
  return l->is_open;
}

/* --- from a level to the next ------------------------------------------------------------------------- */

/* to[I] += both values above it, or the one. */
CF_CLONES static void add_pairs(const int n, const float *fine, float *to) {
  CF_ROW_LOOP
  for (int i = 0; i < n; ++i) to[i] = to[i] + fine[2 * i] + fine[2 * i + 1];
}

CF_CLONES static void add_single(const int n, const float *fine, float *to) {
  CF_ROW_LOOP
  for (int i = 0; i < n; ++i) to[i] += fine[i];
}

/* Couplings through faces in series with half of what lies below and above (coarsen.h), and the weights of the cells there. */
CF_CLONES static void join(const int n, const float *low, const float *face, const float *high, float *both,
                           unsigned char *above, unsigned char *below) {
  CF_ROW_LOOP
  for (int i = 0; i < n; ++i) {
    const float l = low[i], f = face[i], h = high[i];
    const float share = f / (l * h + 0.5f * f * (l + h));
    both[i] = l * h * share;
    const float over = 128 * l * share + 0.5f, under = 128 * h * share + 0.5f;
    above[i] = (unsigned char)(over < 255 ? over : 255);
    below[i] = (unsigned char)(under < 255 ? under : 255);
  }
}

/* The same along the row, for every other face, which lies between coarse cells. */
CF_CLONES static void join_along(const int n, const float *c, float *to, unsigned char *weight) {
  CF_ROW_LOOP
  for (int i = 0; i < n; ++i) {
    const float l = c[2 * i - 1], f = c[2 * i], h = c[2 * i + 1];
    const float share = f / (l * h + 0.5f * f * (l + h));
    to[i] += l * h * share;
    const float over = 128 * l * share + 0.5f, under = 128 * h * share + 0.5f;
    weight[2 * i] = (unsigned char)(over < 255 ? over : 255);
    weight[2 * i - 1] = (unsigned char)(under < 255 ? under : 255);
  }
}

/* A coarse row and the fine ones that it is made of. */
typedef struct rows {
  const cf_coupled *l, *coarse;
  int at[3], count;
  ptrdiff_t p[4], to;
} rows;

static void add_row(const rows *r, const float *fine, float *to) {
  (r->l->coarsened[0] ? add_pairs : add_single)(r->coarse->box.n[0], fine, to);
}

/* Faces of an axis across the row, of one of the lines of fine cells above them. */
static void add_faces(const rows *r, const int a, const ptrdiff_t p) {
  const cf_coupled *l = r->l;
  const int x = l->coarsened[0], n = l->box.n[0];
  const ptrdiff_t s = l->box.stride[a], q = r->at[a] > 0 ? p - s : p + (l->box.n[a] - 1) * s;
  float both[PIECE], *to = r->coarse->c[a] + r->to;
  for (int from = 0; from < n; from += PIECE) {
    const int m = CF_MIN(PIECE, n - from);
    const float *c = l->c[a] + from;
    join(m, c + q, c + p, c + p + s, both, l->weight[a] + p + from, l->weight[a] + q + from);
    (x ? add_pairs : add_single)(x ? m / 2 : m, both, to + (from >> x));
  }
}

static void fill_across(const rows *r, const int a) {
  const cf_coupled *l = r->l;
  float *to = r->coarse->c[a] + r->to;
  memset(to, 0, (size_t)r->coarse->box.n[0] * sizeof *to);
  if (r->coarse->box.n[a] == 1 || (r->at[a] == 0 && !l->periodic[a])) return;
  for (int v = 0; v < r->count; ++v) {
    const ptrdiff_t p = r->p[v];
    if (!l->coarsened[a])
      add_row(r, l->c[a] + p, to);
    else if (a == 1 ? v % 2 == 0 : v < r->count - r->count / 2)
      add_faces(r, a, p); /* of the low cells of the block */
  }
}

static void fill_along(const rows *r) {
  const cf_coupled *l = r->l;
  const int n = r->coarse->box.n[0], first = l->periodic[0] ? 0 : 1;
  float *to = r->coarse->c[0] + r->to;
  memset(to, 0, (size_t)n * sizeof *to);
  for (int v = 0; v < r->count && n > 1; ++v) {
    const float *c = l->c[0] + r->p[v];
    unsigned char *w = l->weight[0] + r->p[v];
    if (!l->coarsened[0]) {
      add_single(n - first, c + first, to + first);
      continue;
    }
    join_along(n - 1, c + 2, to + 1, w + 2);
    if (first == 1) continue;
    const ptrdiff_t last = 2 * n - 1; /* across the seam */
    float both;
    join(1, c + last, c, c + 1, &both, w, w + last);
    to[0] += both;
  }
}

static void fill_row(const rows *r, const float held_share) {
  const cf_coupled *l = r->l;
  const int n = r->coarse->box.n[0];
  float *free = r->coarse->free + r->to, *held = r->coarse->held + r->to;
  memset(free, 0, (size_t)n * sizeof *free);
  memset(held, 0, (size_t)n * sizeof *held);
  for (int v = 0; v < r->count; ++v) {
    add_row(r, l->free + r->p[v], free);
    add_row(r, l->held + r->p[v], held);
  }
  for (int i = 0; i < n; ++i) held[i] *= held_share;
  fill_along(r);
  for (int a = 1; a < l->dim; ++a) fill_across(r, a);
}

/* 1/diagonal, from couplings that are complete. */
CF_KERNEL void invert(const int dim, const int n, const source *s, int *flags) {
  int heavy = 0;
#pragma omp simd reduction(| : heavy)
  for (int i = 0; i < n; ++i) {
    float sum = s->free[i] + s->held[i];
    CF_AXIS_LOOP
    for (int a = 0; a < dim; ++a) sum += s->c[a][i] + s->c[a][i + s->stride[a]];
    s->inverse[i] = sum > 0 ? 1 / sum : 0;
    heavy |= s->free[i] * s->inverse[i] > 0.3f;
  }
  *flags = heavy ? HEAVY : 0;
}
CF_CLONED(invert, const source *, int *)

static int invert_row(const cf_coupled *l, const ptrdiff_t p) {
  const source s = {.free = l->free + p,
                    .held = l->held + p,
                    .inverse = l->inverse + p,
                    .c = {l->c[0] + p, l->c[1] + p, l->dim == 3 ? l->c[2] + p : NULL},
                    .stride = {l->box.stride[0], l->box.stride[1], l->box.stride[2]}};
  int flags;
  invert_by_dim(l->dim, l->box.n[0], &s, &flags);
  return flags;
}

static bool can_coarsen(const cf_coupled *l, const cf_coupled *coarse) {
  if (!l->is_open || !cf_open_is_bare(l) || !cf_open_is_bare(coarse) || coarse->excess[0] != 0 ||
      coarse->excess[1] != 0)
    return false;
  for (int a = 0; a < l->dim; ++a)
    if (l->coarsened[a] && l->box.n[a] % 2 == 1) return false;
  return true;
}

void cf_open_finish(cf_coupled *coarse) {
  int flags = 0;
  for (int a = 0; a < coarse->dim; ++a) cf_coupled_wrap_axis(coarse, a, coarse->c[a]);
#pragma omp parallel for schedule(static) num_threads(cf_coupled_threads(coarse)) reduction(| : flags)
  for (ptrdiff_t v = 0; v < coarse->rows; ++v)
    CF_TILE_ROWS (coarse, v, J, K) flags |= invert_row(coarse, cf_box_at(&coarse->box, 0, J, K));
  take(coarse, flags);
}

bool cf_open_coarsen(cf_coupled *l, cf_coupled *coarse) {
  coarse->is_open = false;
  if (!can_coarsen(l, coarse)) return false;
  const int y = l->coarsened[1], z = l->dim == 3 && l->coarsened[2];
  bool all = true;
  for (int a = 0; a < l->dim; ++a) all = all && (l->coarsened[a] || l->box.n[a] == 1);
  const float held_share = all ? 0.5f : 1;
  CF_PARALLEL_COUPLED (coarse, v)
    CF_TILE_ROWS (coarse, v, J, K) {
      rows r = {l, coarse, {0, J, K}, 0, {0}, cf_box_at(&coarse->box, 0, J, K)};
      for (int kk = 0; kk <= z; ++kk)
        for (int jj = 0; jj <= y; ++jj) r.p[r.count++] = cf_box_at(&l->box, 0, (J << y) + jj, (K << z) + kk);
      fill_row(&r, held_share);
    }
  cf_open_finish(coarse);
  return true;
}
