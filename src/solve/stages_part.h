/* SPDX-License-Identifier: MIT
 *
 * Shared by the files that hold the stages: one half of a row, the sum over its neighbours, and the names of what
 * the dispatcher in stages.c calls. A stage takes a whole strip, so that what a row needs is looked up inside
 * the loop that was compiled for this machine's vectors.
 */
#ifndef CF_SOLVE_STAGES_PART_H
#define CF_SOLVE_STAGES_PART_H

#include <string.h>

#include "grid/lanes.h"
#include "grid/sweep.h"
#include "solve/stages.h"

/* Its e and r; the other half from the low neighbour of the first cell on (the high neighbour of every cell is the
 * low one of the next); tables and couplings. */
typedef struct cf_half {
  float *e, *r;
  float *side;
  const float *lo, *hi, *inverse, *diagonal;
  ptrdiff_t y[2], z[2]; /* to the rows below and above */
  float lo_y, hi_y, lo_z, hi_z, alpha, coupling;
  int parity;
} cf_half;

/* The row below row i of an axis, and the one above it: next to a seam those at the other end. */
CF_KERNEL ptrdiff_t cf_step_down(const cf_split *s, const int a, const int i, const ptrdiff_t stride) {
  return s->wraps[a] && i == 0 ? (s->n[a] - 1) * stride : -stride;
}
CF_KERNEL ptrdiff_t cf_step_up(const cf_split *s, const int a, const int i, const ptrdiff_t stride) {
  return s->wraps[a] && i == s->n[a] - 1 ? -(s->n[a] - 1) * stride : stride;
}

CF_KERNEL cf_half cf_half_of(const int dim, const cf_split *s, const int j, const int k, const int colour) {
  const int parity = (j + k + colour) & 1;
  const int kind = s->kind[1][j] * CF_SPLIT_KINDS + (dim == 3 ? s->kind[2][k] : 0);
  const ptrdiff_t at = j * s->row + k * s->plane, off = parity ? s->odd : 0;
  float *row = s->e + at;
  return (cf_half){
      .e = row + off,
      .r = s->r + at + off,
      .side = parity ? row : row + s->odd - 1,
      .lo = s->lo[0] + off,
      .hi = s->hi[0] + off,
      .inverse = s->inverse[kind] + off,
      .diagonal = s->diagonal[kind] + off,
      .y = {cf_step_down(s, 1, j, s->row), cf_step_up(s, 1, j, s->row)},
      .z = {dim == 3 ? cf_step_down(s, 2, k, s->plane) : 0, dim == 3 ? cf_step_up(s, 2, k, s->plane) : 0},
      .lo_y = s->lo[1][j],
      .hi_y = s->hi[1][j],
      .lo_z = dim == 3 ? s->lo[2][k] : 0,
      .hi_z = dim == 3 ? s->hi[2][k] : 0,
      .alpha = s->alpha,
      .coupling = s->coupling,
      .parity = parity};
}

#define CF_FOR_ROWS(j, t) for (int j = (t)->j; j < (t)->end; ++j)

/* A piece of a half has whole vectors, which the compiler cannot know. */
#define CF_FOR_PIECE(m, t)                                                                          \
  const int begin_ = (t)->from;                                                                     \
  const int end_ = begin_ + (int)(((unsigned)(t)->to - (unsigned)begin_) & ~(CF_SPLIT_LANES - 1u)); \
  CF_ROW_LOOP                                                                                       \
  for (int m = begin_; m < end_; ++m)

/* sum of couplings times neighbours. `even`: they are all the same, and what lies beyond a wall is 0. */
CF_KERNEL float cf_around(const int dim, const int even, const cf_half *h, const int m) {
  const float *e = h->e + m, *side = h->side + m;
  if (even) {
    const float plane = (side[0] + side[1]) + (e[h->y[0]] + e[h->y[1]]);
    return h->coupling * (dim == 3 ? plane + (e[h->z[0]] + e[h->z[1]]) : plane);
  }
  float sum = (h->lo[m] * side[0] + h->hi[m] * side[1]) + (h->lo_y * e[h->y[0]] + h->hi_y * e[h->y[1]]);
  if (dim == 3) sum += h->lo_z * e[h->z[0]] + h->hi_z * e[h->z[1]];
  return sum;
}

/* After the half has changed: its ghost behind the seam in x, beside which the other half's end cell lies. The last piece
 * of a row, whose padding the ghost of an even half is in, sets it as well as the piece with the cell that it shows. */
CF_KERNEL void cf_half_join(const cf_split *s, const cf_strip *t, const cf_half *h) {
  if (!s->wraps[0]) return;
  if (h->parity == 1 && t->to == s->width) h->e[-1] = h->e[s->half[1] - 1];
  if (h->parity == 0 && (t->from == 0 || t->to == s->width)) h->e[s->half[0]] = h->e[0];
}

/* e = omega r / d on one half of a row. */
CF_KERNEL void cf_first_half(const cf_split *s, const cf_half *of, const cf_strip *t, const float omega) {
  const cf_half h = *of;
  CF_FOR_PIECE(m, t) h.e[m] = omega * h.inverse[m] * h.r[m];
  cf_half_join(s, t, of);
}

/* Asks for the piece of both halves of a row that starts at `row` to come into the cache. */
CF_KERNEL void cf_fetch_halves(const cf_split *s, const cf_strip *t, const float *row) {
  for (int m = t->from; m < t->to; m += CF_ALIGN / (int)sizeof(float)) {
    __builtin_prefetch(row + m, 1);
    __builtin_prefetch(row + s->odd + m, 1);
  }
}

/* Where row j of the strip's successor begins. */
CF_KERNEL ptrdiff_t cf_next_row(const cf_split *s, const cf_strip *t, const int j) {
  return (t->next_j + j - t->j) * s->row + t->next_k * s->plane;
}

/* Cells of the strip in their natural order: from 2 from on, as many as there are. */
static inline int cf_natural_count(const cf_split *s, const cf_strip *t) {
  return CF_MIN(2 * t->to, s->n[0]) - 2 * t->from;
}

/* Where the sums of row j go; those of the next kind are p->sums further. */
static inline double *cf_sums_of(const cf_pass *p, const cf_strip *t, const int j) {
  return p->rows + t->sum + (j - t->j) * t->sum_step;
}

/* The sum of f and of its squares along a row. */
CF_KERNEL void cf_sum_row(const int n, const cf_real *f, double *sum, double *squares) {
  cf_eight sums = {0}, of_squares = {0};
  int i = 0;
  for (; i + CF_SUM_LANES <= n; i += CF_SUM_LANES) {
    const cf_eight v = CF_EIGHT_OF(f + i);
    sums += v;
    of_squares += v * v;
  }
  double lane[CF_SUM_LANES], square[CF_SUM_LANES];
  memcpy(lane, &sums, sizeof lane);
  memcpy(square, &of_squares, sizeof square);
  for (int l = 0; i < n; ++i, ++l) {
    lane[l] += (double)f[i];
    square[l] += (double)f[i] * (double)f[i];
  }
  *sum = cf_sum_lanes(lane);
  *squares = cf_sum_lanes(square);
}

/* --- stages ------------------------------------------------------------------------------------------- */

void cf_stage_first(const cf_split *s, const cf_strip *t, float omega);
void cf_stage_second(const cf_split *s, const cf_strip *t, float omega);
void cf_stage_relax(const cf_split *s, const cf_strip *t, int colour, float omega);
void cf_stage_clear(const cf_split *s, const cf_strip *t);

void cf_stage_form(const cf_pass *p, const cf_strip *t);
void cf_stage_last(const cf_split *s, const cf_strip *t, float omega);
void cf_stage_update(const cf_pass *p, const cf_strip *t, float omega);
void cf_stage_residual(const cf_split *s, const cf_strip *t);

void cf_stage_form_on_segments(const cf_pass *p, const cf_strip *t);
void cf_stage_form_on_fields(const cf_pass *p, const cf_strip *t);
void cf_stage_on_fields(const cf_pass *p, int number, const cf_strip *t, float omega);
void cf_stage_on_segments(const cf_pass *p, int number, const cf_strip *t, float omega);

void cf_stage_restrict(const cf_pass *p, const cf_strip *t, bool red_alone);
void cf_stage_prolong(const cf_pass *p, const cf_strip *t, bool black_alone);

/* Images behind the walls in x of those cells of a half row that meet them: factor times s->image times e. They are
 * set (1) a stage before a residual is taken on this half and cleared (0) where neighbours are summed again. */
CF_KERNEL void cf_half_set_images(const cf_split *s, const cf_strip *t, const cf_half *h,
                                  const float factor) {
  if (s->image[0] != 0 && t->from == 0 && h->parity == 0) h->side[0] = factor * s->image[0] * h->e[0];
  if (s->image[1] != 0 && t->to == s->width && h->parity == ((s->n[0] - 1) & 1)) {
    const int last = s->half[h->parity] - 1;
    h->side[last + 1] = factor * s->image[1] * h->e[last];
  }
}

#endif
