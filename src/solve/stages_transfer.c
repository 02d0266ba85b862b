/* SPDX-License-Identifier: MIT
 *
 * Between a level and the next coarser one.
 */
#include <string.h>

#include "solve/stages_part.h"

/* --- to the coarse level ------------------------------------------------------------------------------ */

/* What a fine row leaves to its coarse row: sum[m] (+)= weight (share of even cell m times its residual, and the
 * same of odd cell m). */
enum {
  UNEVEN,
  EVEN,
  BOTH_COLOURS,
  RED_UNEVEN,
  RED_EVEN,
  FORMS
}; /* stencils for both colours; red cells alone */

CF_KERNEL void gather(const int dim, const int form, const bool fresh, const cf_split *s, const cf_strip *t,
                      const int j, const int k, const float weight, float *sum) {
  const cf_half red = cf_half_of(dim, s, j, k, 0), black = cf_half_of(dim, s, j, k, 1);
  const float *share_red = s->share + (red.parity ? s->odd : 0);
  const float *share_black = s->share + (red.parity ? 0 : s->odd);
  const float left_red = 1 - s->omega[0], left_black = (1 - s->omega[1]) / s->omega[1];
  CF_FOR_PIECE(m, t) {
    if (form >= RED_UNEVEN) {
      const float rest = red.r[m] - (red.diagonal[m] * red.e[m] - cf_around(dim, form == RED_EVEN, &red, m));
      sum[m] = fresh ? weight * (share_red[m] * rest) : sum[m] + weight * (share_red[m] * rest);
      continue;
    }
    float from_red, from_black;
    if (form == BOTH_COLOURS) {
      from_red = red.r[m] - (red.diagonal[m] * red.e[m] - cf_around(dim, 0, &red, m));
      from_black = black.r[m] - (black.diagonal[m] * black.e[m] - cf_around(dim, 0, &black, m));
    } else {
      from_red = left_red * red.r[m] + cf_around(dim, form, &red, m);
      from_black = left_black * (black.diagonal[m] * black.e[m]);
    }
    const float part = weight * (share_red[m] * from_red + share_black[m] * from_black);
    sum[m] = fresh ? part : sum[m] + part;
  }
}

/* Sums of fine pairs, in natural order, become the halves of a coarse row. */
CF_KERNEL void split_row(const int pairs, const float *line, float *even, float *odd) {
  CF_ROW_LOOP
  for (int q = 0; q < pairs; ++q) {
    even[q] = line[2 * q];
    odd[q] = line[2 * q + 1];
  }
}

/* What the coarse level starts from: its first half sweep, or 0 where that would not do. */
CF_KERNEL void start_coarse(const int dim, const cf_split *c, const cf_strip *t) {
  if (c->odd_seam) {
    cf_stage_clear(c, t);
    return;
  }
  const cf_half red = cf_half_of(dim, c, t->j, t->k, 0);
  cf_first_half(c, &red, t, c->omega[0]);
}

/* The first child of the parent of i along an axis; -1 if i is not its last child. */
CF_KERNEL int first_child(const cf_split *s, const int a, const int i) {
  const int *parent = s->plain->pairing[a].parent;
  if (i + 1 < s->n[a] && parent[i + 1] == parent[i]) return -1;
  int low = i;
  while (low > 0 && parent[low - 1] == parent[i]) --low;
  return low;
}

/* The coarse row whose children are rows [j0, j] of planes [k0, t->k]: all of them are ready. */
CF_KERNEL void restrict_row(const int dim, const int form, const cf_pass *p, const cf_strip *t, const int j0,
                            const int j, const int k0) {
  const cf_split *s = p->at, *c = p->coarse;
  const cf_pairing *y = &s->plain->pairing[1], *z = &s->plain->pairing[2];
  const bool ends = t->to == s->width;
  float *sum = t->scratch;
  memset(sum + t->to, 0, 2 * CF_SPLIT_LANES * sizeof(float));
  for (int child_k = k0; child_k <= t->k; ++child_k)
    for (int child_j = j0; child_j <= j; ++child_j) {
      const float weight = (float)(y->share[child_j] * (dim == 3 ? z->share[child_k] : 1));
      if (child_k == k0 && child_j == j0)
        gather(dim, form, true, s, t, child_j, child_k, weight, sum);
      else
        gather(dim, form, false, s, t, child_j, child_k, weight, sum);
    }
  /* The last cell of a triple stands alone at the end. */
  if (ends && s->n[0] > 2 * c->n[0]) sum[c->n[0] - 1] += sum[c->n[0]], sum[c->n[0]] = 0;
  cf_strip coarse = {.j = y->parent[j], .k = dim == 3 ? z->parent[t->k] : 0, .from = t->from / 2};
  coarse.end = coarse.j + 1;
  coarse.to = ends ? c->width : t->to / 2;
  float *r = c->r + coarse.j * c->row + coarse.k * c->plane + coarse.from;
  split_row(coarse.to - coarse.from, sum + t->from, r, r + c->odd);
  start_coarse(dim, c, &coarse);
}

CF_KERNEL void restrict_rows(const int dim, const int form, const cf_pass *p, const cf_strip *t) {
  const int k0 = dim == 3 ? first_child(p->at, 2, t->k) : 0;
  if (k0 < 0) return;
  CF_FOR_ROWS(j, t) {
    const int j0 = first_child(p->at, 1, j);
    if (j0 >= 0) restrict_row(dim, form, p, t, j0, j, k0);
  }
}

#define RESTRICT(name, dim, form) \
  CF_CLONES static void name(const cf_pass *p, const cf_strip *t) { restrict_rows(dim, form, p, t); }
RESTRICT(uneven_2d, 2, UNEVEN)
RESTRICT(uneven_3d, 3, UNEVEN)
RESTRICT(even_2d, 2, EVEN)
RESTRICT(even_3d, 3, EVEN)
RESTRICT(both_2d, 2, BOTH_COLOURS)
RESTRICT(both_3d, 3, BOTH_COLOURS)
RESTRICT(red_uneven_2d, 2, RED_UNEVEN)
RESTRICT(red_uneven_3d, 3, RED_UNEVEN)
RESTRICT(red_even_2d, 2, RED_EVEN)
RESTRICT(red_even_3d, 3, RED_EVEN)

void cf_stage_restrict(const cf_pass *p, const cf_strip *t, const bool red_alone) {
  static void (*const by_form[FORMS][2])(const cf_pass *, const cf_strip *) = {{uneven_2d, uneven_3d},
                                                                               {even_2d, even_3d},
                                                                               {both_2d, both_3d},
                                                                               {red_uneven_2d, red_uneven_3d},
                                                                               {red_even_2d, red_even_3d}};
  const int even = p->at->even_couplings;
  const int form = p->at->odd_seam ? BOTH_COLOURS : red_alone ? RED_UNEVEN + even : even;
  by_form[form][p->at->dim - 2](p, t);
}

/* --- from the coarse level ---------------------------------------------------------------------------- */

/* A coarse row mixed of up to four, in natural order from cell 2 q0 on; whole vectors, which may go beyond the row. */
typedef struct mixture {
  const float *row[4];
  float weight[4];
} mixture;

CF_KERNEL void mix(const int rows, const mixture *x, const int vectors, const ptrdiff_t odd, float *line) {
  const float a = x->weight[0], b = x->weight[1], c = x->weight[2], d = x->weight[3];
  const float *p = x->row[0], *q = x->row[1], *r = x->row[2], *s = x->row[3];
  CF_ROW_LOOP
  for (int i = 0; i < vectors * CF_SPLIT_LANES; ++i) {
    float even = a * p[i] + b * q[i], other = a * p[odd + i] + b * q[odd + i];
    if (rows == 4) {
      even += c * r[i] + d * s[i];
      other += c * r[odd + i] + d * s[odd + i];
    }
    line[2 * i] = even;
    line[2 * i + 1] = other;
  }
}

/* e += own line[m] + away line[m -+ 1] for the cells of one half, 2m or 2m + 1. */
CF_KERNEL void spread(const cf_half *h, const cf_split *s, const cf_strip *t, const float *line) {
  const ptrdiff_t off = h->parity ? s->odd : 0;
  const float *own = s->own + off, *away = s->away + off, *next = line + (h->parity ? 1 : -1);
  float *e = h->e;
  CF_FOR_PIECE(m, t) e[m] += own[m] * line[m] + away[m] * next[m];
  cf_half_join(s, t, h);
}

/* Of an axis of the coarse level: a place that may lie behind a seam. */
CF_KERNEL int place_of(const cf_split *c, const int a, const int i) {
  if (!c->plain->axis[a].periodic) return i;
  return i < 0 ? i + c->n[a] : i >= c->n[a] ? i - c->n[a] : i;
}

/* In y and z first (a fine row has up to four coarse ones: parent and other along either axis), then along x. Red cells
 * are left alone where the half sweep that follows does not ask for them. */
CF_KERNEL void prolong_rows(const int dim, const cf_pass *p, const cf_strip *t, const bool black_alone) {
  const cf_split *s = p->at, *c = p->coarse;
  const cf_pairing *y = &s->plain->pairing[1], *z = &s->plain->pairing[2];
  const int q0 = t->from / 2 - 1, pairs = (t->to - t->from) / 2 + 2;
  const int vectors = (pairs + CF_SPLIT_LANES - 1) / CF_SPLIT_LANES;
  float *line = t->scratch;
  CF_FOR_ROWS(j, t) {
    mixture x;
    if (t->next_k >= 0) {
      cf_fetch_halves(s, t, s->e + cf_next_row(s, t, j));
      cf_fetch_halves(s, t, s->r + cf_next_row(s, t, j));
    }
    for (int v = 0; v < 2 * (dim - 1); ++v) {
      const int row = place_of(c, 1, v % 2 == 0 ? y->parent[j] : y->other[j]);
      const int plane = dim == 2 ? 0 : place_of(c, 2, v < 2 ? z->parent[t->k] : z->other[t->k]);
      x.row[v] = c->e + row * c->row + plane * c->plane + q0;
      x.weight[v] = (float)(y->weight[v % 2][j] * (dim == 2 ? 1 : z->weight[v / 2][t->k]));
    }
    mix(2 * (dim - 1), &x, vectors, c->odd, line);
    const cf_half red = cf_half_of(dim, s, j, t->k, 0), black = cf_half_of(dim, s, j, t->k, 1);
    if (!black_alone) spread(&red, s, t, line - 2 * q0);
    spread(&black, s, t, line - 2 * q0);
  }
}
CF_CLONES static void prolong_rows_2d(const cf_pass *p, const cf_strip *t, const bool black_alone) {
  prolong_rows(2, p, t, black_alone);
}
CF_CLONES static void prolong_rows_3d(const cf_pass *p, const cf_strip *t, const bool black_alone) {
  prolong_rows(3, p, t, black_alone);
}

void cf_stage_prolong(const cf_pass *p, const cf_strip *t, const bool black_alone) {
  (p->at->dim == 3 ? prolong_rows_3d : prolong_rows_2d)(p, t, black_alone);
}
