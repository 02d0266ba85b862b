/* SPDX-License-Identifier: MIT
 *
 * The part of a split level (split.h) where an equation with numbers for coefficients holds, as a list of segments: vectors of
 * sixteen cells of either half of a row, some of which are inside.
 *
 *     row (j, k):   ..........[ 71 ][ 0 ][ 0 ][ 72 ].......[ 73 ]..........      segments and their tables
 *
 * The list goes along rows, planes after rows, so what a stage visits is a stretch of it: one loop over segments, whatever rows
 * they lie in. Short rows would otherwise wait, each anew, for what says where they begin and end.
 *
 * What differs from cell to cell stands in tables, one for a segment: 1/diagonal, which faces are open, and how the cells
 * take part in the transfers. Segments whose cells are all inside, as are all around them, share a table with others of
 * their kind: what walls of the box they meet tells all about them. Any other one has its own, so a ball reads tables at the
 * ends of its rows only. Those and the ones beside them in the row stand in a second list as well, that of the edges: where
 * the coarse correction is not as good as elsewhere. Without their neighbours smaller balls take a cycle more.
 *
 * e and r are 0 where there is no cell inside, hence sums over neighbours need no asking for faces; only differences do.
 *
 * Segments follow from the kinds of the cells alone: the same ones with and without tiles.
 */
#ifndef CF_SOLVE_SEGMENTS_H
#define CF_SOLVE_SEGMENTS_H

#include <stdint.h>

#include "grid/region.h"
#include "solve/split.h"

/* Elements of a half that a segment has, and cells. */
#define CF_SEGMENT       CF_SPLIT_LANES
#define CF_SEGMENT_CELLS (2 * CF_SEGMENT)

/* What faces holds of a cell: bit 2 a + side: the face is open; and: */
#define CF_FACES_TRANSFER \
  64 /* the cell takes part in restriction and interpolation as others of its block do */
#define CF_FACES_INSIDE 128

/* What held holds: what known values add to the diagonal, in couplings (2 a face), and CF_HELD_COUNT times all that it has
 * besides alpha. */
#define CF_HELD_BITS  4
#define CF_HELD_COUNT (1 << CF_HELD_BITS)
#define CF_HELD_MASK  (CF_HELD_COUNT - 1)

/* A weight of interpolation where nothing is special: a quarter. */
#define CF_LINEAR 64

/* What there is to know of a segment: of its cells in the even half, then of those in the odd one. */
typedef struct cf_segment_table {
  _Alignas(CF_ALIGN) float inverse[CF_SEGMENT_CELLS];            /* 1/diagonal (0: no cell inside) */
  unsigned char faces[CF_SEGMENT_CELLS], held[CF_SEGMENT_CELLS]; /* see above */
  unsigned char weight[3][CF_SEGMENT_CELLS]; /* of interpolation, in units of 1/256 (coupled.h) */
  int low, high; /* of its cells, in their order: from the first one inside to the last */
} cf_segment_table;

/* Tables that are shared: bit 2 a + side of the number: cells at that wall of the box (of x on the high side: the end of the
 * row, whether a wall is there or a seam). In those below CF_INNER_TABLES all cells have all faces open. */
#define CF_REGULAR_TABLES 64
#define CF_INNER_TABLES   1

/* Where it is in e and r: the element of the even half, over CF_SEGMENT and times 4, and two bits. */
#define CF_PLACE_PARITY 1 /* of j + k */
#define CF_PLACE_FIRST  2 /* none of the rows before with the same coarse row has a segment here */
typedef struct cf_segment {
  uint32_t place;
  int32_t table;
} cf_segment;

static inline ptrdiff_t cf_segment_at(const cf_segment *q) { return (ptrdiff_t)(q->place >> 2) * CF_SEGMENT; }

/* A list, and where in it the segments of a piece of a row begin (wave.h): piece + pieces (j + n[1] k), and one more. */
typedef struct cf_segment_list {
  ptrdiff_t count, room, *first;
  cf_segment *at;
} cf_segment_list;

typedef struct cf_segments {
  cf_segment_list all, edges;
  int pieces;            /* of a row */
  ptrdiff_t rows, cells; /* rows that have segments; cells inside */
  int low[3], high[3];   /* rows and planes that have any; axis 0 is not used */
  ptrdiff_t *number;     /* of row j + n[1] k among those that have segments */
  ptrdiff_t tables, tables_room;
  cf_segment_table *table;
  bool any_held; /* some known value holds a cell of a segment with a table of its own */
} cf_segments;

/* Makes segments for the cells inside of r, with the coefficients that s has been given and known values on walls of the
 * box as its plain level has them. CF_NO_MEMORY; what was made is freed by destroy. */
cf_status cf_segments_find(cf_segments *g, const cf_split *s, const cf_region *r);
void cf_segments_destroy(cf_segments *g); /* a zeroed one is fine */

/* e = r = 0 on all segments, with the ghosts beside them. */
void cf_segments_clear(const cf_segments *g, const cf_split *s);

/* The table of the segment that has the cell `at`, and there is one. */
cf_segment_table *cf_segments_table_at(const cf_segments *g, const cf_split *s, const int at[3]);

/* Where a table has cell i of a row. */
static inline int cf_lane_of(const int i) { return (i & 1) * CF_SEGMENT + i / 2 % CF_SEGMENT; }

static inline ptrdiff_t cf_segments_row(const cf_split *s, const int j, const int k) {
  return j + (ptrdiff_t)s->n[1] * k;
}

/* The segments q of row (j, k) in a list. */
#define CF_FOR_ROW_SEGMENTS(g, list, s, j, k, q)                                                          \
  for (const cf_segment *q = (list)->at + (list)->first[cf_segments_row(s, j, k) * (g)->pieces],          \
                        *end_ = (list)->at + (list)->first[(cf_segments_row(s, j, k) + 1) * (g)->pieces]; \
       q < end_; ++q)

/* The first cell of a segment of row (j, k). */
static inline int cf_segment_cell(const cf_split *s, const cf_segment *q, const int j, const int k) {
  return 2 * (int)(cf_segment_at(q) - (j * s->row + k * s->plane));
}

#endif
