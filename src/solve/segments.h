/* SPDX-License-Identifier: MIT
 *
 * The part of a split level (split.h) where an equation with numbers for coefficients holds: the rows of a region as
 * segments, pieces of both halves that are whole vectors.
 *
 *     row (j, k):   ..........[ plain  ][  edge  ][  edge  ].......[ edge ]..........
 *
 * In a plain segment every cell is inside and has only neighbours inside or a wall of the box, so it is worked on as
 * a row of the whole box is. Cells of an edge segment have what differs from cell to cell in tables: 1/diagonal, which
 * faces are open, and how they take part in the transfers. e and r are 0 where there is no cell inside, hence sums over
 * neighbours need no asking for faces; only differences do.
 *
 * Segments follow from the kinds of the cells alone: the same ones with and without tiles.
 */
#ifndef CF_SOLVE_SEGMENTS_H
#define CF_SOLVE_SEGMENTS_H

#include "grid/region.h"
#include "solve/split.h"

/* Elements of a half that segments are made of. */
#define CF_SEGMENT_STEP CF_SPLIT_LANES

/* What cf_segments.faces holds of a cell: bit 2 a + side: the face is open; and: */
#define CF_FACES_TRANSFER \
  64 /* the cell takes part in restriction and interpolation as others of its block do */
#define CF_FACES_INSIDE 128

/* What cf_segments.held holds: what known values add to the diagonal, in couplings (2 a face), and CF_HELD_COUNT times all that it
 * has besides alpha. */
#define CF_HELD_BITS  4
#define CF_HELD_COUNT (1 << CF_HELD_BITS)
#define CF_HELD_MASK  (CF_HELD_COUNT - 1)

typedef struct cf_segment {
  int from, to;  /* elements of halves */
  int low, high; /* cells: from the first one inside to the last */
  ptrdiff_t
      table; /* -1: plain; else where its tables begin: those of the even half, then those of the odd one */
} cf_segment;

typedef struct cf_segments {
  ptrdiff_t count, room, cells; /* cells inside */
  ptrdiff_t rows;               /* that have segments */
  int low[3], high[3];          /* rows and planes that have any; axis 0 is not used */
  ptrdiff_t *first;             /* of row j + n[1] k, and one more */
  ptrdiff_t *number;            /* of that row among those that have segments */
  cf_segment *segment;
  ptrdiff_t elements, elements_room; /* of tables */
  float *inverse;                    /* 1/diagonal (0: no cell inside) */
  unsigned char *faces, *held;       /* see above */
  bool any_held;                     /* some known value holds a cell of an edge segment */
  unsigned char *weight[3];          /* of interpolation, in units of 1/256 (coupled.h) */
} cf_segments;

/* Makes segments for the cells inside of r, with the coefficients that s has been given and known values on walls of the
 * box as its plain level has them. CF_NO_MEMORY; what was made is freed by destroy. */
cf_status cf_segments_find(cf_segments *g, const cf_split *s, const cf_region *r);
void cf_segments_destroy(cf_segments *g); /* a zeroed one is fine */

/* e = r = 0 on all segments, with the ghosts beside them. */
void cf_segments_clear(const cf_segments *g, const cf_split *s);

/* The segment of row (j, k) that has element m of the halves; NULL: none has. */
const cf_segment *cf_segments_at(const cf_segments *g, const cf_split *s, int j, int k, int m);

/* Where an edge segment has element m of a half (parity 0: even). */
static inline ptrdiff_t cf_segment_entry(const cf_segment *q, const int parity, const int m) {
  return q->table + (parity ? q->to - q->from : 0) + m - q->from;
}

static inline ptrdiff_t cf_segments_row(const cf_split *s, const int j, const int k) {
  return j + (ptrdiff_t)s->n[1] * k;
}

#endif
