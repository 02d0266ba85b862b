/* SPDX-License-Identifier: MIT */
#include "solve/split.h"

#include <math.h>

#include "base/mem.h"

static int round_up(const int n, const int step) { return (n + step - 1) / step * step; }

static void shape(cf_split *s, const cf_level *plain) {
  s->plain = plain;
  s->dim = plain->box.dim;
  s->threads = plain->threads;
  for (int a = 0; a < 3; ++a) s->n[a] = plain->box.n[a];
  s->half[0] = (s->n[0] + 1) / 2;
  s->half[1] = s->n[0] / 2;
  s->width = round_up(s->half[0], CF_SPLIT_LANES);
  s->odd = s->width + CF_SPLIT_LANES;
  s->row = s->odd + s->width;
  s->plane = s->row * (s->n[1] + 2);
  const int depth = s->dim == 3 ? s->n[2] + 2 : 1;
  s->first = CF_SPLIT_LANES + s->row + (s->dim == 3 ? s->plane : 0);
  s->size = s->plane * depth + 2 * CF_SPLIT_LANES;
  for (int a = 0; a < s->dim; ++a) {
    const bool periodic = plain->axis[a].periodic;
    s->has_seam = s->has_seam || periodic;
    s->odd_seam = s->odd_seam || (periodic && s->n[a] % 2 == 1);
  }
  const cf_axis *x = &plain->axis[0];
  for (int side = 0; side < 2; ++side) s->image[side] = x->periodic ? 0 : x->held[side] ? -1 : 1;
}

/* Weights along x in the layout of rows. Even cell 2m is interpolated from coarse cells m and m-1, odd cell 2m+1 from m
 * and m+1; of a triple's last cell (even, m = n_c) the parent is m-1. */
static void fill_transfer(cf_split *s) {
  const cf_pairing *p = &s->plain->pairing[0];
  for (int i = 0; i < s->n[0]; ++i) {
    const ptrdiff_t at = cf_split_at(s, i);
    if (p->parent == NULL || !p->coarsened) {
      s->share[at] = s->own[at] = 1;
      continue;
    }
    const int from[2] = {p->parent[i], p->other[i]};
    s->share[at] = (float)p->share[i];
    for (int v = 0; v < 2; ++v) *(from[v] == i / 2 ? &s->own[at] : &s->away[at]) += (float)p->weight[v][i];
  }
}

static cf_status tables_create(cf_split *s) {
  for (int a = 0; a < s->dim; ++a) {
    const ptrdiff_t n = a == 0 ? s->row : s->n[a];
    CF_TRY(CF_NEW(&s->lo[a], n));
    CF_TRY(CF_NEW(&s->hi[a], n));
    CF_TRY(CF_NEW(&s->kind[a], s->n[a]));
  }
  for (int v = 0; v < CF_SPLIT_KINDS * CF_SPLIT_KINDS; ++v) {
    if (s->dim == 2 && v % CF_SPLIT_KINDS != 0) continue;
    CF_TRY(CF_NEW(&s->inverse[v], s->row));
    CF_TRY(CF_NEW(&s->diagonal[v], s->row));
  }
  CF_TRY(CF_NEW(&s->share, s->row));
  CF_TRY(CF_NEW(&s->own, s->row));
  CF_TRY(CF_NEW(&s->away, s->row));
  fill_transfer(s);
  return CF_OK;
}

static cf_status pages_create(const cf_split *s, const bool dense, float **f) {
  void *pages;
  CF_TRY(cf_pages_reserve(&pages, (size_t)s->size * sizeof(float), dense));
  *f = (float *)pages + s->first;
  return CF_OK;
}

static void pages_destroy(const cf_split *s, float *f) {
  if (f != NULL) cf_pages_release(f - s->first, (size_t)s->size * sizeof(float));
}

cf_status cf_split_create(cf_split *s, const cf_level *plain, const bool dense) {
  *s = (cf_split){0};
  shape(s, plain);
  CF_TRY(tables_create(s));
  CF_TRY(pages_create(s, dense, &s->e));
  return pages_create(s, dense, &s->r);
}

void cf_split_destroy(cf_split *s) {
  for (int a = 0; a < 3; ++a) {
    cf_free(s->lo[a]);
    cf_free(s->hi[a]);
    cf_free(s->kind[a]);
  }
  for (int v = 0; v < CF_SPLIT_KINDS * CF_SPLIT_KINDS; ++v) {
    cf_free(s->inverse[v]);
    cf_free(s->diagonal[v]);
  }
  cf_free(s->share);
  cf_free(s->own);
  cf_free(s->away);
  pages_destroy(s, s->e);
  pages_destroy(s, s->r);
  *s = (cf_split){0};
}

/* Sorts the places of an axis by lo + hi, what the axis adds to the diagonal; sums[] are the different values. */
static void sort_kinds(cf_split *s, const int a, double sums[CF_SPLIT_KINDS]) {
  const cf_axis *axis = &s->plain->axis[a];
  s->kinds[a] = 0;
  for (int i = 0; i < axis->n; ++i) {
    const double sum = axis->lo1[i] + axis->hi1[i];
    int v = 0;
    while (v < s->kinds[a] && fabs(sums[v] - sum) > 1e-9 * sum) ++v;
    if (v == s->kinds[a] && v < CF_SPLIT_KINDS) sums[s->kinds[a]++] = sum;
    s->kind[a][i] = (unsigned char)CF_MIN(v, CF_SPLIT_KINDS - 1);
  }
}

static void fill_diagonals(cf_split *s, const double alpha, const double beta, const double scale) {
  double sums[3][CF_SPLIT_KINDS] = {{0}};
  s->kinds[2] = 1;
  for (int a = 1; a < s->dim; ++a) sort_kinds(s, a, sums[a]);
  const cf_axis *x = &s->plain->axis[0];
  for (int v1 = 0; v1 < s->kinds[1]; ++v1)
    for (int v2 = 0; v2 < s->kinds[2]; ++v2) {
      const int v = v1 * CF_SPLIT_KINDS + v2;
      for (int i = 0; i < s->n[0]; ++i) {
        const double d = (alpha + beta * (x->lo1[i] + x->hi1[i] + sums[1][v1] + sums[2][v2])) / scale;
        s->diagonal[v][cf_split_at(s, i)] = (float)d;
        s->inverse[v][cf_split_at(s, i)] = d > 0 ? (float)(1 / d) : 0;
      }
    }
}

/* Whether all axes couple alike and no cell is wider than the others. */
static bool are_even(const cf_split *s) {
  const double width = s->plain->axis[0].width[0];
  for (int a = 0; a < s->dim; ++a)
    if (s->plain->axis[a].width[0] != width || s->plain->axis[a].width[s->n[a] - 1] != width) return false;
  return true;
}

void cf_split_set(cf_split *s, const double alpha, const double beta, const double scale,
                  const double omega[4]) {
  s->alpha = (float)(alpha / scale);
  for (int a = 0; a < s->dim; ++a)
    s->wraps[a] = s->plain->axis[a].periodic && !s->odd_seam && s->segments == NULL;
  for (int v = 0; v < 4; ++v) s->omega[v] = (float)omega[v];
  for (int a = 0; a < s->dim; ++a)
    for (int i = 0; i < s->n[a]; ++i) {
      const ptrdiff_t at = a == 0 ? cf_split_at(s, i) : i;
      s->lo[a][at] = (float)(beta / scale * s->plain->axis[a].lo1[i]);
      s->hi[a][at] = (float)(beta / scale * s->plain->axis[a].hi1[i]);
    }
  fill_diagonals(s, alpha, beta, scale);
  s->even_couplings = are_even(s);
  for (int a = 0; a < s->dim; ++a)
    if (s->n[a] > 1) s->coupling = (float)(beta / scale * s->plain->axis[a].lo1[1]);
}

/* --- seams -------------------------------------------------------------------------------------------- */

static void copy_row(const cf_split *s, const float *from, float *to) {
  for (ptrdiff_t i = 0; i < s->row; ++i) to[i] = from[i];
}

/* x first, so that the copied rows and planes hold their corners. */
void cf_split_fill_seams(const cf_split *s, float *f) {
  const bool x = s->plain->axis[0].periodic, y = s->plain->axis[1].periodic;
  const bool z = s->dim == 3 && s->plain->axis[2].periodic;
  const int n = s->n[0];
  for (int k = 0; k < s->n[2] && x; ++k)
    for (int j = 0; j < s->n[1]; ++j) {
      float *row = f + j * s->row + k * s->plane;
      row[s->odd - 1] = row[cf_split_at(s, n - 1)]; /* cell -1 */
      row[cf_split_at(s, n)] = row[0];
    }
  for (int k = 0; k < s->n[2] && y; ++k) {
    float *plane = f + k * s->plane;
    copy_row(s, plane + (s->n[1] - 1) * s->row, plane - s->row);
    copy_row(s, plane, plane + s->n[1] * s->row);
  }
  for (int j = -1; j <= s->n[1] && z; ++j) {
    copy_row(s, f + j * s->row + (s->n[2] - 1) * s->plane, f + j * s->row - s->plane);
    copy_row(s, f + j * s->row, f + j * s->row + s->n[2] * s->plane);
  }
}
