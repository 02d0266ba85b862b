/* SPDX-License-Identifier: MIT
 *
 * Shared by the files with the stages on segments: the pieces that a strip has of a row, and sums over the cells inside.
 */
#ifndef CF_SOLVE_STAGES_PIECES_H
#define CF_SOLVE_STAGES_PIECES_H

#include "solve/segments.h"
#include "solve/stages_apply.h"
#include "solve/stages_edge.h"

/* A piece of a segment: the part of the strip that it takes, and the halves of its row. */
typedef struct cf_piece {
  const cf_segment *segment;
  cf_strip strip; /* of that row alone */
  int edge;       /* 0 or 1 */
} cf_piece;

/* Segment v as far as it lies in the strip; false: not at all. */
CF_KERNEL int cf_piece_of(const cf_segments *g, const cf_strip *t, const int j, const ptrdiff_t v,
                          cf_piece *q) {
  q->segment = &g->segment[v];
  q->strip = *t;
  q->strip.j = j;
  q->strip.end = j + 1;
  q->strip.next_j = t->next_j + j - t->j;
  q->strip.from = CF_MAX(t->from, q->segment->from);
  q->strip.to = CF_MIN(t->to, q->segment->to);
  q->edge = q->segment->table >= 0;
  return q->strip.from < q->strip.to;
}

#define CF_FOR_PIECES(s, t, j, q)                                                  \
  for (ptrdiff_t v_ = (s)->segments->first[cf_segments_row(s, j, (t)->k)],         \
                 end_v_ = (s)->segments->first[cf_segments_row(s, j, (t)->k) + 1]; \
       v_ < end_v_; ++v_)                                                          \
    if (cf_piece_of((s)->segments, t, j, v_, &(q)))

/* Where the sums of a row with segments go. */
CF_KERNEL double *cf_piece_sums(const cf_pass *p, const cf_strip *t, const int j) {
  const ptrdiff_t row = p->at->segments->number[cf_segments_row(p->at, j, t->k)];
  return p->rows + row * t->sum_step + t->sum % t->sum_step;
}

/* Bytes of both halves in the order of cells. */
CF_KERNEL void cf_weave(const int pairs, const unsigned char *even, const unsigned char *odd,
                        unsigned char *line) {
  for (int m = 0; m < pairs; m += CF_SPLIT_LANES) {
    const cf_sixteen_bytes a = *(const cf_sixteen_bytes *)(even + m),
                           b = *(const cf_sixteen_bytes *)(odd + m);
    *(cf_sixteen_bytes *)(line + 2 * m) = CF_SIXTEEN_WOVEN_LOW(a, b);
    *(cf_sixteen_bytes *)(line + 2 * m + CF_SPLIT_LANES) = CF_SIXTEEN_WOVEN_HIGH(a, b);
  }
}

/* The faces of the cells of a piece in their order; NULL where all are inside. */
CF_KERNEL const unsigned char *cf_piece_faces(const cf_segments *g, const cf_piece *q, unsigned char *line) {
  if (!q->edge) return NULL;
  const ptrdiff_t even = cf_segment_entry(q->segment, 0, q->strip.from);
  const ptrdiff_t odd = cf_segment_entry(q->segment, 1, q->strip.from);
  cf_weave(q->strip.to - q->strip.from, g->faces + even, g->faces + odd, line);
  return line;
}

/* The sum of f and of its squares where a cell is inside; faces NULL: everywhere. As cf_sum_row does it. */
CF_KERNEL void cf_add_inside(const int n, const cf_real *f, const unsigned char *faces, double *sum,
                             double *squares) {
  double own, of_squares;
  if (faces != NULL) {
    cf_eight here = {0}, square = {0};
    double lane[CF_SUM_LANES], squared[CF_SUM_LANES];
    int i = 0;
    for (; i + CF_SUM_LANES <= n; i += CF_SUM_LANES) {
      const cf_eight_bits open = CF_EIGHT_OF_BYTES(faces + i);
      /* + 0: gcc 12 breaks down over a conversion that is masked */
      const cf_eight all = CF_EIGHT_OF(f + i), v = CF_EIGHT_WHERE(open, CF_FACES_INSIDE, all + 0);
      here += v;
      square += v * v;
    }
    memcpy(lane, &here, sizeof lane);
    memcpy(squared, &square, sizeof squared);
    for (int l = 0; i < n; ++i, ++l) {
      const double v = faces[i] & CF_FACES_INSIDE ? (double)f[i] : 0;
      lane[l] += v;
      squared[l] += v * v;
    }
    own = cf_sum_lanes(lane);
    of_squares = cf_sum_lanes(squared);
  } else {
    cf_sum_row(n, f, &own, &of_squares);
  }
  *sum += own;
  *squares += of_squares;
}

#endif
