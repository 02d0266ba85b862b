/* SPDX-License-Identifier: MIT
 *
 * FORM on segments: r = (b - A x) / scale in double, face by face, eight cells at a time.
 */
#include "solve/stages_vectors.h"

/* What FORM adds up along a row, in lanes. */
typedef struct forming_sums {
  cf_eight rr, b, bb, x, xx;
} forming_sums;

/* A segment: x, b at its first cell, strides of the box, faces and what holds its cells in their order, where b - A x goes. */
typedef struct forming {
  const cf_real *x, *b;
  ptrdiff_t y, z;
  double alpha, coupling;
  unsigned char faces[CF_SEGMENT_CELLS], held[CF_SEGMENT_CELLS];
  double residual[CF_SEGMENT_CELLS];
} forming;

CF_KERNEL void add_up(const cf_eight *r, const cf_eight *b, const cf_eight *x, forming_sums *sums) {
  sums->rr += *r * *r;
  sums->b += *b;
  sums->bb += *b * *b;
  sums->x += *x;
  sums->xx += *x * *x;
}

CF_KERNEL void form_eight(const int dim, const int i, forming *f, forming_sums *sums) {
  const cf_real *x = f->x + i;
  const cf_eight_bits open = CF_EIGHT_OF_BYTES(f->faces + i);
  const cf_eight c = CF_EIGHT_OF(x), b = CF_EIGHT_OF(f->b + i);
  const cf_eight known = __builtin_convertvector(CF_EIGHT_OF_BYTES(f->held + i) & CF_HELD_MASK, cf_eight);
  cf_eight sum =
      CF_EIGHT_WHERE(open, 1, c - CF_EIGHT_OF(x - 1)) - CF_EIGHT_WHERE(open, 2, CF_EIGHT_OF(x + 1) - c);
  sum +=
      CF_EIGHT_WHERE(open, 4, c - CF_EIGHT_OF(x - f->y)) - CF_EIGHT_WHERE(open, 8, CF_EIGHT_OF(x + f->y) - c);
  if (dim == 3)
    sum += CF_EIGHT_WHERE(open, 16, c - CF_EIGHT_OF(x - f->z)) -
           CF_EIGHT_WHERE(open, 32, CF_EIGHT_OF(x + f->z) - c);
  const cf_eight Ax = f->alpha * c + f->coupling * (sum + known * c);
  const cf_eight r = CF_EIGHT_WHERE(open, CF_FACES_INSIDE, b - Ax);
  /* + 0: gcc 12 breaks down over a conversion that is masked */
  const cf_eight own_b = CF_EIGHT_WHERE(open, CF_FACES_INSIDE, b + 0),
                 own_x = CF_EIGHT_WHERE(open, CF_FACES_INSIDE, c + 0);
  *(cf_eight_doubles *)(f->residual + i) = r;
  add_up(&r, &own_b, &own_x, sums);
}

/* Cell i of the eight at the end of a row. */
CF_KERNEL void form_one(const int dim, const int i, forming *f, forming_sums *sums) {
  const cf_real *x = f->x + i;
  const int open = f->faces[i], lane = i % CF_SUM_LANES;
  const double c = (double)x[0];
  if (!(open & CF_FACES_INSIDE)) return;
  double sum = (open & 1 ? c - (double)x[-1] : 0) - (open & 2 ? (double)x[1] - c : 0);
  sum += (open & 4 ? c - (double)x[-f->y] : 0) - (open & 8 ? (double)x[f->y] - c : 0);
  if (dim == 3) sum += (open & 16 ? c - (double)x[-f->z] : 0) - (open & 32 ? (double)x[f->z] - c : 0);
  const double Ax = f->alpha * c + f->coupling * (sum + (double)(f->held[i] & CF_HELD_MASK) * c);
  cf_eight r = {0}, own_b = {0}, own_x = {0};
  r[lane] = f->residual[i] = (double)f->b[i] - Ax;
  own_b[lane] = (double)f->b[i];
  own_x[lane] = c;
  add_up(&r, &own_b, &own_x, sums);
}

CF_KERNEL void form_row(const int dim, const cf_pass *p, const cf_strip *t, const int j, forming_sums *sums) {
  const cf_split *s = p->at;
  const cf_box *box = &s->plain->box;
  const ptrdiff_t row = j * s->row + t->k * s->plane, at = cf_box_at(box, 0, j, t->k);
  forming f = {.y = box->stride[1],
               .z = box->stride[2],
               .alpha = p->alpha,
               .coupling = p->beta * s->plain->axis[0].lo1[1]};
  cf_ahead ahead = cf_ahead_of(s, t, j);
  CF_FOR_SEGMENTS_OF (&s->segments->all, s, t, j, t->k, q) {
    const cf_segment_table *table = &s->segments->table[q->table];
    const int from = 2 * (int)(cf_segment_at(q) - row), n = CF_MIN(CF_SEGMENT_CELLS, s->n[0] - from);
    float *r = s->r + cf_segment_at(q);
    f.x = p->x + at + from;
    f.b = p->b + at + from;
    cf_fetch_cells(&ahead, p->x);
    cf_fetch_cells(&ahead, p->b);
    cf_fetch_segment(s, &ahead);
    ++ahead.at;
    cf_weave(table->faces, f.faces);
    cf_weave(table->held, f.held);
    int i = 0;
    for (; i + CF_SUM_LANES <= n; i += CF_SUM_LANES) form_eight(dim, i, &f, sums);
    for (int c = i; c < CF_SEGMENT_CELLS; ++c) f.residual[c] = 0;
    for (; i < n; ++i) form_one(dim, i, &f, sums);
    cf_split_scaled(CF_SEGMENT, 1 / p->scale, f.residual, r, r + s->odd);
  }
}

CF_KERNEL void form(const int dim, const cf_pass *p, const cf_strip *t) {
  CF_FOR_ROWS(j, t) {
    forming_sums sums = {0};
    if (!cf_has_segments(p->at, t, j)) continue;
    form_row(dim, p, t, j, &sums);
    double *to = cf_segment_sums(p, t, j);
    to[CF_SUM_RESIDUAL * p->sums] = cf_sum_eight(&sums.rr);
    to[CF_SUM_B * p->sums] = cf_sum_eight(&sums.b);
    to[CF_SUM_B2 * p->sums] = cf_sum_eight(&sums.bb);
    to[CF_SUM_X * p->sums] = cf_sum_eight(&sums.x);
    to[CF_SUM_X2 * p->sums] = cf_sum_eight(&sums.xx);
  }
}

CF_CLONES static void form_2d(const cf_pass *p, const cf_strip *t) { form(2, p, t); }
CF_CLONES static void form_3d(const cf_pass *p, const cf_strip *t) { form(3, p, t); }

void cf_stage_form_on_segments(const cf_pass *p, const cf_strip *t) {
  (p->at->dim == 3 ? form_3d : form_2d)(p, t);
}
