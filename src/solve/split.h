/* SPDX-License-Identifier: MIT
 *
 * A level of the hierarchy in the form that the fast path works on: residual and correction in single
 * precision, every row split into its even and its odd cells.
 *
 *     row (j, k):   [ cells 0 2 4 6 ...          ][ gap ][ cells 1 3 5 7 ...          ]
 *                     even half, `width` elements          odd half, `width` elements
 *
 * One colour of a red-black sweep (the parity of i + j + k) is then one half of every row: a loop over
 * neighbouring elements in which no lane of a vector is idle, whose neighbours in y and z have the same index and
 * those in x the same and the next one of the other half. The gap holds the ghosts of both halves: its first
 * element continues the even half, its last one precedes the odd half.
 *
 * The equation is scaled so that the diagonal in the middle of the finest level is 1:
 *
 *     A' = A / D,  D = alpha + sum over axes of 2 beta/h^2        (in double, so that any sigma fits a float)
 *
 * Halves are padded to a whole number of vectors. Tables are 0 in the padding, which keeps values there 0, so no
 * loop has a tail. What lies beyond a wall stays 0: couplings through an insulated wall are 0 where differences
 * are taken, and do not matter where neighbours are summed.
 */
#ifndef CF_SOLVE_SPLIT_H
#define CF_SOLVE_SPLIT_H

#include <stdbool.h>

#include "solve/level.h"

#define CF_SPLIT_LANES 16 /* floats of the widest vector, to which halves are padded */
#define CF_SPLIT_KINDS \
  4 /* at most so many different couplings along an axis: first, middle, last but one, last */

typedef struct cf_split {
  const cf_level *plain; /* the same level of the plain path: extents, pairings, halo rules */
  int dim, n[3], threads;
  int half[2], width;                 /* cells of the even and odd half; elements of either with padding */
  ptrdiff_t odd;                      /* from the even half of a row to its odd half */
  ptrdiff_t row, plane;               /* strides */
  ptrdiff_t first, size;              /* elements before cell (0, 0, 0); of the array */
  float *e, *r;                       /* correction and residual, at cell (0, 0, 0) */
  const struct cf_segments *segments; /* NULL: the whole box */
  const struct cf_fields *fields;     /* NULL: coefficients are numbers */
  bool has_seam;                      /* some axis is periodic */
  bool odd_seam; /* ... with an odd number of cells: neighbours across the seam share a colour */
  bool wraps
      [3]; /* periodic axes whose seam the stages cross by themselves; not next to an odd one, nor with segments */
  bool even_couplings; /* the same in all axes and places, but for walls */

  float alpha, coupling;  /* scaled; coupling: in the middle of the box */
  float omega[4];         /* of the half sweeps before the coarse correction (red, black) and after it */
  float image[2];         /* of the cell at a wall in x, behind it: 1 insulated, -1 held, 0 periodic */
  float *lo[3], *hi[3];   /* couplings; x: in the layout of a row */
  unsigned char *kind[3]; /* y, z: which of the different sums lo + hi */
  int kinds[3];
  float *inverse[CF_SPLIT_KINDS * CF_SPLIT_KINDS]; /* 1/diagonal by kind in y and z: rows */
  float *diagonal[CF_SPLIT_KINDS * CF_SPLIT_KINDS];
  float *share; /* of restriction along x: a row */
  float *own,
      *away; /* of prolongation along x from the coarse cell of the same index and the one beyond: rows */
} cf_split;

/* Shapes the level and makes its tables; e and r are pages, 0 and untouched, large ones if `dense`. CF_NO_MEMORY. */
cf_status cf_split_create(cf_split *s, const cf_level *plain, bool dense);
void cf_split_destroy(cf_split *s); /* a zeroed one is fine */

/* Coefficients alpha and beta over `scale`; omega of the half sweeps. */
void cf_split_set(cf_split *s, double alpha, double beta, double scale, const double omega[4]);

/* Ghosts of periodic axes, as those read them who do not cross seams by themselves. */
void cf_split_fill_seams(const cf_split *s, float *f);

/* Whether ghosts have to be filled between stages. */
static inline bool cf_split_needs_ghosts(const cf_split *s) {
  return s->has_seam && !s->wraps[0] && !s->wraps[1] && !s->wraps[2];
}

/* Where cell i of a row lies. */
static inline ptrdiff_t cf_split_at(const cf_split *s, const int i) {
  return (i & 1) * s->odd + (i - (i & 1)) / 2;
}

#endif
