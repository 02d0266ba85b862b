/* SPDX-License-Identifier: MIT
 *
 * What stages on segments (segments.h) do to one: sixteen cells of a half, written out as such (grid/lanes.h says why). Where
 * all its faces are open nothing has to be asked cell by cell.
 */
#ifndef CF_SOLVE_STAGES_VECTORS_H
#define CF_SOLVE_STAGES_VECTORS_H

#include "solve/segments.h"
#include "solve/stages_apply.h"

#define CF_INTO_SIXTEEN(p, v) (*(cf_sixteen_floats *)(p) = (v))
#define CF_FLOATS_OF(ints)    __builtin_convertvector(ints, cf_sixteen)

#define CF_SHARES_OF(bytes) ((1.0f / 256) * CF_FLOATS_OF(CF_SIXTEEN_OF_BYTES(bytes)))

/* Where the segments of a strip's row (j, k) begin in a list. */
CF_KERNEL const cf_segment *cf_segments_from(const cf_segment_list *l, const cf_split *s, const cf_strip *t,
                                             const int j, const int k) {
  return l->at + l->first[cf_segments_row(s, j, k) * t->sum_step + t->sum % t->sum_step];
}
CF_KERNEL const cf_segment *cf_segments_to(const cf_segment_list *l, const cf_split *s, const cf_strip *t,
                                           const int j, const int k) {
  return l->at + l->first[cf_segments_row(s, j, k) * t->sum_step + t->sum % t->sum_step + 1];
}

/* The segments q of a row, and those of all rows of a strip, which follow each other where rows are not cut. */
#define CF_FOR_SEGMENTS_OF(l, s, t, j, k, q)                                                               \
  for (const cf_segment *q = cf_segments_from(l, s, t, j, k), *end_of_##q = cf_segments_to(l, s, t, j, k); \
       q < end_of_##q; ++q)
#define CF_FOR_SEGMENTS(l, s, t, q)                                                                    \
  for (int j_ = (t)->j, rows_ = (t)->sum_step > 1 ? 1 : (t)->end - (t)->j; j_ < (t)->end; j_ += rows_) \
    for (const cf_segment *q = cf_segments_from(l, s, t, j_, (t)->k),                                  \
                          *end_of_##q = cf_segments_to(l, s, t, j_ + rows_ - 1, (t)->k);               \
         q < end_of_##q; ++q)

/* The segments that the strip's successor has in the row that stands for row j: asked for in turn with what is done to those of row
 * j, for the machine has room for a few requests only. */
typedef struct cf_ahead {
  const cf_segment *at, *end;
  ptrdiff_t row; /* where in e that row begins */
  ptrdiff_t x;   /* and in fields of the box */
} cf_ahead;

CF_KERNEL cf_ahead cf_ahead_of(const cf_split *s, const cf_strip *t, const int j) {
  if (t->next_k < 0) return (cf_ahead){0};
  const int there = t->next_j + j - t->j;
  return (cf_ahead){.at = cf_segments_from(&s->segments->all, s, t, there, t->next_k),
                    .end = cf_segments_to(&s->segments->all, s, t, there, t->next_k),
                    .row = there * s->row + t->next_k * s->plane,
                    .x = cf_box_at(&s->plain->box, 0, there, t->next_k)};
}

/* Its next one, in a field of the box. */
CF_KERNEL void cf_fetch_cells(const cf_ahead *a, const cf_real *f) {
  if (a->at >= a->end) return;
  const cf_real *from = f + a->x + 2 * (cf_segment_at(a->at) - a->row);
  for (int i = 0; i < CF_SEGMENT_CELLS; i += CF_LANES) __builtin_prefetch(from + i, 1);
}

/* The same in e and r, and its table. */
CF_KERNEL void cf_fetch_segment(const cf_split *s, const cf_ahead *a) {
  if (a->at >= a->end) return;
  const ptrdiff_t at = cf_segment_at(a->at), odd = s->odd;
  const char *table = (const char *)&s->segments->table[a->at->table];
  __builtin_prefetch(s->e + at, 1);
  __builtin_prefetch(s->e + at + odd, 1);
  __builtin_prefetch(s->r + at, 1);
  __builtin_prefetch(s->r + at + odd, 1);
  if (a->at->table < CF_REGULAR_TABLES) return;
  for (size_t v = 0; v < sizeof(cf_segment_table); v += CF_ALIGN) __builtin_prefetch(table + v);
}

CF_KERNEL int cf_has_segments(const cf_split *s, const cf_strip *t, const int j) {
  const cf_segment_list *l = &s->segments->all;
  return cf_segments_from(l, s, t, j, t->k) < cf_segments_to(l, s, t, j, t->k);
}

/* Where the sums of a row go that has segments. */
static inline double *cf_segment_sums(const cf_pass *p, const cf_strip *t, const int j) {
  const ptrdiff_t row = p->at->segments->number[cf_segments_row(p->at, j, t->k)];
  return p->rows + row * t->sum_step + t->sum % t->sum_step;
}

/* Bytes of both halves in the order of cells. */
CF_KERNEL void cf_weave(const unsigned char *of, unsigned char line[CF_SEGMENT_CELLS]) {
  const cf_sixteen_bytes a = *(const cf_sixteen_bytes *)of, b = *(const cf_sixteen_bytes *)(of + CF_SEGMENT);
  *(cf_sixteen_bytes *)line = CF_SIXTEEN_WOVEN_LOW(a, b);
  *(cf_sixteen_bytes *)(line + CF_SEGMENT) = CF_SIXTEEN_WOVEN_HIGH(a, b);
}

/* A sum in lanes. */
CF_KERNEL double cf_sum_eight(const cf_eight *sum) {
  double lane[CF_SUM_LANES];
  memcpy(lane, sum, sizeof lane);
  return cf_sum_lanes(lane);
}

/* What all segments have in common. */
typedef struct cf_ground {
  float *e, *r;
  ptrdiff_t odd, y, z;
  float alpha, coupling;
  const cf_segment_table *table;
} cf_ground;

CF_KERNEL cf_ground cf_ground_of(const int dim, const cf_split *s) {
  return (cf_ground){.e = s->e,
                     .r = s->r,
                     .odd = s->odd,
                     .y = s->row,
                     .z = dim == 3 ? s->plane : 0,
                     .alpha = s->alpha,
                     .coupling = s->coupling,
                     .table = s->segments->table};
}

/* Those cells of a segment that have a colour: e and r, the other half from the low neighbour of the first on, and where they
 * stand in the table. */
typedef struct cf_sixteen_cells {
  float *e, *r;
  const float *side;
  ptrdiff_t y, z; /* to the rows above */
  float alpha, coupling;
  const cf_segment_table *table;
  int lane, inner; /* inner: their faces are all open */
} cf_sixteen_cells;

CF_KERNEL cf_sixteen_cells cf_cells_of(const cf_ground *g, const cf_segment *q, const int colour) {
  const ptrdiff_t parity = (ptrdiff_t)((q->place ^ (uint32_t)colour) & CF_PLACE_PARITY);
  const ptrdiff_t at = cf_segment_at(q), off = at + (-parity & g->odd);
  return (cf_sixteen_cells){.e = g->e + off,
                            .r = g->r + off,
                            .side = g->e + at + ((parity - 1) & (g->odd - 1)),
                            .y = g->y,
                            .z = g->z,
                            .alpha = g->alpha,
                            .coupling = g->coupling,
                            .table = &g->table[q->table],
                            .lane = (int)parity * CF_SEGMENT,
                            .inner = q->table < CF_INNER_TABLES};
}

/* The sum over the neighbours, without the coupling. */
CF_KERNEL void cf_sixteen_around(const int dim, const cf_sixteen_cells *h, cf_sixteen *out) {
  const float *e = h->e, *side = h->side;
  const cf_sixteen plane =
      (CF_SIXTEEN_OF(side) + CF_SIXTEEN_OF(side + 1)) + (CF_SIXTEEN_OF(e - h->y) + CF_SIXTEEN_OF(e + h->y));
  *out = dim == 3 ? plane + (CF_SIXTEEN_OF(e - h->z) + CF_SIXTEEN_OF(e + h->z)) : plane;
}

CF_KERNEL void cf_sixteen_diagonal(const int dim, const cf_sixteen_cells *h, cf_sixteen *out) {
  const unsigned char *held = h->table->held + h->lane;
  if (h->inner)
    *out = (cf_sixteen){0} + (h->alpha + (float)(2 * dim) * h->coupling);
  else
    *out = h->alpha + CF_FLOATS_OF(CF_SIXTEEN_OF_BYTES(held) >> CF_HELD_BITS) * h->coupling;
}

/* A' e, face by face: differences are exact in single precision where e is smooth. */
CF_KERNEL void cf_sixteen_applied(const int dim, const cf_sixteen_cells *h, cf_sixteen *out) {
  const float *e = h->e, *side = h->side;
  const cf_sixteen c = CF_SIXTEEN_OF(e);
  const ptrdiff_t y = h->y, z = h->z;
  if (h->inner) {
    cf_sixteen sum = ((c - CF_SIXTEEN_OF(side)) - (CF_SIXTEEN_OF(side + 1) - c)) +
                     ((c - CF_SIXTEEN_OF(e - y)) - (CF_SIXTEEN_OF(e + y) - c));
    if (dim == 3) sum += (c - CF_SIXTEEN_OF(e - z)) - (CF_SIXTEEN_OF(e + z) - c);
    *out = h->alpha * c + h->coupling * sum;
    return;
  }
  const cf_sixteen_ints faces = CF_SIXTEEN_OF_BYTES(h->table->faces + h->lane);
  const cf_sixteen held = CF_FLOATS_OF(CF_SIXTEEN_OF_BYTES(h->table->held + h->lane) & CF_HELD_MASK);
  cf_sixteen sum = CF_SIXTEEN_WHERE(faces, 1, c - CF_SIXTEEN_OF(side)) -
                   CF_SIXTEEN_WHERE(faces, 2, CF_SIXTEEN_OF(side + 1) - c);
  sum += CF_SIXTEEN_WHERE(faces, 4, c - CF_SIXTEEN_OF(e - y)) -
         CF_SIXTEEN_WHERE(faces, 8, CF_SIXTEEN_OF(e + y) - c);
  if (dim == 3)
    sum += CF_SIXTEEN_WHERE(faces, 16, c - CF_SIXTEEN_OF(e - z)) -
           CF_SIXTEEN_WHERE(faces, 32, CF_SIXTEEN_OF(e + z) - c);
  *out = h->alpha * c + h->coupling * (sum + held * c);
}

/* What takes part in the transfers. */
CF_KERNEL void cf_sixteen_transferred(const cf_segment_table *t, const int lane, cf_sixteen *v) {
  const cf_sixteen_ints faces = CF_SIXTEEN_OF_BYTES(t->faces + lane);
  *v = CF_SIXTEEN_WHERE(faces, CF_FACES_TRANSFER, *v);
}

/* to (`fresh`: 0 in place of what it is) += amount, of the first cells of sixteen at the end of a row. */
CF_KERNEL void cf_add_sixteen(const int count, const int fresh, const cf_sixteen *amount, float *to) {
  if (count >= CF_SEGMENT) {
    const cf_sixteen old = CF_SIXTEEN_OF(to);
    CF_INTO_SIXTEEN(to, fresh ? *amount : old + *amount);
    return;
  }
  float line[CF_SEGMENT];
  memcpy(line, amount, sizeof line);
  for (int i = 0; i < count; ++i) to[i] = fresh ? line[i] : to[i] + line[i];
}

/* A coarse row and its neighbours along y, z and both on the side of the fine row; how much of those along an axis. */
typedef struct cf_mixture {
  const float *own, *y, *z, *yz;
  float of_y, of_z;
} cf_mixture;

/* Linear in y and z: coarse cells from m on. */
CF_KERNEL void cf_sixteen_mixed(const int dim, const cf_mixture *x, const ptrdiff_t m, cf_sixteen *out) {
  const float y = x->of_y, z = x->of_z;
  *out = (1 - y) * (1 - z) * CF_SIXTEEN_OF(x->own + m) + y * (1 - z) * CF_SIXTEEN_OF(x->y + m);
  if (dim == 3) *out += (1 - y) * z * CF_SIXTEEN_OF(x->z + m) + y * z * CF_SIXTEEN_OF(x->yz + m);
}

/* What both halves of a regular segment take from coarse cells from m on: linear along each axis in turn. */
CF_KERNEL void cf_sixteen_linear(const int dim, const cf_mixture *x, const ptrdiff_t m,
                                 const cf_segment_table *t, cf_sixteen out[2]) {
  cf_sixteen below, own, above;
  cf_sixteen_mixed(dim, x, m - 1, &below);
  cf_sixteen_mixed(dim, x, m, &own);
  cf_sixteen_mixed(dim, x, m + 1, &above);
  out[0] = own + CF_SHARES_OF(t->weight[0]) * (below - own);
  out[1] = own + CF_SHARES_OF(t->weight[0] + CF_SEGMENT) * (above - own);
}

/* What those of any other one take: from one neighbour an axis. */
CF_KERNEL void cf_sixteen_spread(const int dim, const cf_mixture *x, const ptrdiff_t m,
                                 const cf_segment_table *t, cf_sixteen out[2]) {
  const cf_sixteen own = CF_SIXTEEN_OF(x->own + m);
  for (int half = 0; half < 2; ++half) {
    const float *next[3] = {x->own + (half ? 1 : -1), x->y, x->z};
    out[half] = own;
    for (int a = 0; a < dim; ++a)
      out[half] += CF_SHARES_OF(t->weight[a] + half * CF_SEGMENT) * (CF_SIXTEEN_OF(next[a] + m) - own);
  }
}

#endif
