/* SPDX-License-Identifier: MIT
 *
 * From coefficients to the finest level apart by colour, and to the level below it: what open.c does in natural order.
 */
#include <math.h>
#include <omp.h>
#include <string.h>

#include "grid/lanes.h"
#include "solve/open.h"

/* Halves of rows that a thread has room for. */
#define LINES CF_FIELDS_LINES

/* The diagonals are scaled by what a sample tells of them: some may be so many times what was thought. */
#define FAR_ABOVE 16.0f

/* Cells of a row, and all rows of a coarse one, that are a block: no wave sees less. But a block of few strong cells is not to be
 * taken for a weak one: its mean counts up to so many times the least cell. */
#define BLOCK  16
#define SPREAD 1.5f

/* --- the finest level --------------------------------------------------------------------------------- */

CF_CLONES static void part(const int pairs, const float *line, float *even, float *odd) {
  CF_ROW_LOOP
  for (int m = 0; m < pairs; ++m) {
    even[m] = line[2 * m];
    odd[m] = line[2 * m + 1];
  }
}

/* to[m] += both children's. */
CF_CLONES static void add_pairs(const int n, const float *fine, float *to) {
  CF_ROW_LOOP
  for (int m = 0; m < n; ++m) to[m] = to[m] + fine[2 * m] + fine[2 * m + 1];
}

/* The least share of what is no coupling in a diagonal, of a cell and of a block of cells on average; and the least 1/diagonal. */
typedef struct least {
  float share, of_block, inverse;
} least;

/* free += held; shares[i] += what cell i has. */
CF_CLONES static least fix(const int n, const float *held, const float *inverse, float *free, float *shares) {
  float share = 1, all = INFINITY;
#pragma omp simd reduction(min : share, all)
  for (int i = 0; i < n; ++i) {
    const float fixed = free[i] + held[i], here = fixed * inverse[i];
    free[i] = fixed;
    shares[i] += here;
    share = here < share ? here : share;
    all = inverse[i] < all ? inverse[i] : all;
  }
  return (least){share, 1, all};
}

/* The least mean of BLOCK cells in a row; the last ones may be among those before them too. */
CF_CLONES static float least_mean(const int n, const int rows, const float *shares) {
  float all = 1;
  for (int from = 0; from < n; from += BLOCK) {
    const int low = CF_MAX(CF_MIN(from, n - BLOCK), 0), high = CF_MIN(low + BLOCK, n);
    float sum = 0;
    for (int i = low; i < high; ++i) sum += shares[i];
    all = CF_MIN(all, sum / (float)(rows * (high - low)));
  }
  return all;
}

static int fill_row(const cf_varied *v, const cf_coefficients *c, const int j, const int k, float *line,
                    const ptrdiff_t coarse_row, least *of) {
  const cf_fields *f = &v->fields;
  const cf_coupled *coarse = &v->level[1];
  const cf_split *s = &f->split;
  const int n = s->n[0], pairs = n / 2;
  const ptrdiff_t at = j * s->row + k * s->plane, step = 2 * (ptrdiff_t)s->width;
  const cf_open_row row = {
      {line, line + step, line + 2 * step}, line + 3 * step, line + 4 * step, line + 5 * step};
  const int flags = cf_open_fill_row(v, c, j, k, &row);
  for (int a = 0; a < s->dim; ++a) part(pairs, row.c[a], f->c[a] + at, f->c[a] + at + s->odd);
  part(pairs, row.inverse, f->inverse + at, f->inverse + at + s->odd);
  add_pairs(pairs, row.free, coarse->free + coarse_row);
  add_pairs(pairs, row.held, coarse->held + coarse_row);
  const least here = fix(n, row.held, row.inverse, row.free, line + 6 * step);
  *of = (least){CF_MIN(of->share, here.share), of->of_block, CF_MIN(of->inverse, here.inverse)};
  if (!f->is_even) part(pairs, row.free, f->fixed + at, f->fixed + at + s->odd);
  if (s->wraps[0]) f->c[0][at + s->half[0]] = f->c[0][at];
  return flags;
}

/* Whether `fixed` is the same everywhere; then its row. */
static bool fill_even(const cf_varied *v, const cf_coefficients *c) {
  const cf_fields *f = &v->fields;
  const cf_split *s = &f->split;
  if (c->alpha_at != NULL) return false;
  for (int a = 0; a < s->dim; ++a)
    for (int side = 0; side < 2; ++side)
      if (cf_wall_is_held(v->A->walls.kind[a][side])) return false;
  for (int i = 0; i < s->n[0]; ++i) f->fixed[cf_split_at(s, i)] = (float)(v->scale * c->alpha);
  return true;
}

bool cf_fields_fill(cf_varied *v, const cf_coefficients *c) {
  cf_fields *f = &v->fields;
  const cf_split *s = &f->split;
  const cf_coupled *coarse = &v->level[1];
  const int deep = s->dim == 3, pairs = s->n[0] / 2;
  int flags = 0;
  float share = 1, of_block = 1, inverse = INFINITY;
  f->is_even = fill_even(v, c);
#pragma omp parallel for schedule(static) num_threads(cf_coupled_threads(coarse)) reduction(|        \
                                                                                            : flags) \
    reduction(min                                                                                    \
              : share, of_block, inverse)
  for (ptrdiff_t q = 0; q < coarse->rows; ++q)
    CF_TILE_ROWS (coarse, q, J, K) {
      float *line = f->line + LINES * (ptrdiff_t)s->width * omp_get_thread_num();
      const ptrdiff_t to = cf_box_at(&coarse->box, 0, J, K);
      float *shares = line + 12 * (ptrdiff_t)s->width;
      least of = {share, of_block, inverse};
      memset(shares, 0, (size_t)s->n[0] * sizeof *shares);
      memset(coarse->free + to, 0, (size_t)pairs * sizeof(float));
      memset(coarse->held + to, 0, (size_t)pairs * sizeof(float));
      for (int k = K << deep; k < (K + 1) << deep; ++k)
        for (int j = 2 * J; j < 2 * J + 2; ++j) flags |= fill_row(v, c, j, k, line, to, &of);
      for (int m = 0; m < pairs; ++m) coarse->held[to + m] *= 0.5f;
      share = of.share, inverse = of.inverse;
      of_block = CF_MIN(of_block, least_mean(s->n[0], 2 << deep, shares));
    }
  f->jacobi = 1 - (double)CF_MAX(share, 0);
  f->radius = 1 - (double)CF_MAX(CF_MIN(of_block, SPREAD * share), 0);
  return cf_open_take(v, flags) && inverse > 1 / FAR_ABOVE;
}

/* --- the level below ---------------------------------------------------------------------------------- */

/* Of numbers from 0 on; what is above a byte's largest counts as that. */
CF_KERNEL void put_bytes(unsigned char *to, const cf_sixteen *value) {
  const cf_sixteen_ints v = __builtin_convertvector(*value, cf_sixteen_ints),
                        most = (cf_sixteen_ints){0} + 255;
  const cf_sixteen_ints held = (v & (v < most)) | (most & (v >= most));
  *(cf_sixteen_bytes *)to =
      __builtin_convertvector(__builtin_convertvector(held, cf_sixteen_words), cf_sixteen_bytes);
}

/* Couplings through faces in series with half of what lies below and above (coarsen.h), added to those of the coarse row, and the
 * weights of the cells there. The padding has none. */
CF_CLONES static void join(const int n, const float *low, const float *face, const float *high, float *to,
                           unsigned char *above, unsigned char *below) {
  for (int m = 0; m < n; m += CF_SPLIT_LANES) {
    const cf_sixteen l = CF_SIXTEEN_OF(low + m), f = CF_SIXTEEN_OF(face + m), h = CF_SIXTEEN_OF(high + m);
    const cf_sixteen product = l * h, all = product + 0.5f * f * (l + h);
    const cf_sixteen_ints none = all == 0;
    const cf_sixteen share = f / (all - __builtin_convertvector(none, cf_sixteen));
    const cf_sixteen over = 128 * l * share + 0.5f, under = 128 * h * share + 0.5f;
    *(cf_sixteen_floats *)(to + m) = CF_SIXTEEN_OF(to + m) + product * share;
    put_bytes(above + m, &over);
    put_bytes(below + m, &under);
  }
}

/* A coarse row and the fine rows that it is made of. */
typedef struct rows {
  const cf_fields *f;
  int at[3]; /* the coarse row */
  int count;
  ptrdiff_t p[4]; /* fine ones, y before z */
} rows;

/* Faces along the row, every other of which lies between coarse cells. */
static void fill_along(const rows *r, float *to) {
  const cf_fields *f = r->f;
  const cf_split *s = &f->split;
  for (int v = 0; v < r->count; ++v) {
    const float *even = f->c[0] + r->p[v], *odd = even + s->odd;
    unsigned char *w = f->weight[0] + r->p[v], *last = w + s->odd + s->half[1] - 1;
    join(s->width, odd - 1, even, odd, to, w, w + s->odd - 1);
    *last = 0;
    if (!s->wraps[0]) continue;
    float ends[3][CF_SPLIT_LANES] = {{odd[s->half[1] - 1]}, {even[0]}, {odd[0]}};
    unsigned char above[CF_SPLIT_LANES], below[CF_SPLIT_LANES];
    join(1, ends[0], ends[1], ends[2], to, above, below);
    w[0] = above[0];
    *last = below[0];
  }
}

/* Those of an axis across the row. */
static void fill_across(const rows *r, const int a, float *to) {
  const cf_fields *f = r->f;
  const cf_split *s = &f->split;
  const ptrdiff_t stride = a == 1 ? s->row : s->plane;
  if (r->at[a] == 0 && !s->wraps[a]) return;
  for (int v = 0; v < r->count; ++v) {
    if (a == 1 ? v % 2 == 1 : v >= r->count / 2) continue; /* not at the low side of the block */
    for (int parity = 0; parity < 2; ++parity) {
      const ptrdiff_t p = r->p[v] + (parity ? s->odd : 0),
                      q = p + (r->at[a] > 0 ? -stride : (s->n[a] - 1) * stride);
      const float *c = f->c[a];
      join(s->width, c + q, c + p, c + p + stride, to, f->weight[a] + p, f->weight[a] + q);
    }
  }
}

void cf_fields_coarsen(cf_varied *v) {
  const cf_fields *f = &v->fields;
  const cf_split *s = &f->split;
  cf_coupled *coarse = &v->level[1];
  const int deep = s->dim == 3;
  CF_PARALLEL_COUPLED (coarse, q)
    CF_TILE_ROWS (coarse, q, J, K) {
      rows r = {f, {0, J, K}, 0, {0}};
      float *to = f->line + LINES * (ptrdiff_t)s->width * omp_get_thread_num();
      for (int k = K << deep; k < (K + 1) << deep; ++k)
        for (int j = 2 * J; j < 2 * J + 2; ++j) r.p[r.count++] = j * s->row + k * s->plane;
      for (int a = 0; a < s->dim; ++a) {
        memset(to, 0, (size_t)s->width * sizeof *to);
        if (a == 0)
          fill_along(&r, to);
        else
          fill_across(&r, a, to);
        memcpy(coarse->c[a] + cf_box_at(&coarse->box, 0, J, K), to, (size_t)s->half[1] * sizeof *to);
      }
    }
  cf_open_finish(coarse);
}
