/* SPDX-License-Identifier: MIT
 *
 * The finest level of an equation whose coefficients are fields, where no face is closed but walls of the box, in the form of
 * split.h: rows apart by colour, so that a half sweep is a loop over neighbouring elements. Equation and letters are those of
 * coupled.h,
 *
 *     (A e)_p = fixed_p e_p + sum over axes of  c_p (e_p - e_{p-a}) + c_{p+a} (e_p - e_{p+a}),
 *
 * and so are the levels below it, which lie in natural order: a coarse cell has the place in its row that both of its children
 * have in their halves.
 *
 *     even half of a row    cells 0 2 4 ..    low face along x: c_0 c_2 ..; the high one is the odd cell's low one
 *     odd half              cells 1 3 5 ..    low face along x: c_1 c_3 ..; the high one is the next even cell's low one
 *
 * Across a seam in x the first padding of the even half has the coupling of cell 0; those in y and z are found around it.
 * It takes boxes of an even number of cells, at least four, along every axis; all others go the way of coupled.h and
 * varied_cycles.c, to the same solution.
 */
#ifndef CF_SOLVE_FIELDS_H
#define CF_SOLVE_FIELDS_H

#include "solve/coupled.h"
#include "solve/split.h"
#include "solve/wave.h"

struct cf_varied;

/* Halves of rows that a thread has room for. */
#define CF_FIELDS_LINES 14

typedef struct cf_fields {
  const struct cf_varied *of; /* whose equation it is; NULL: not made yet */
  cf_split split;             /* shape, e and r */
  cf_wave wave;
  float *c[3], *inverse, *fixed; /* couplings on low faces; 1/diagonal, and its part that is no coupling */
  unsigned char *weight[3];      /* of interpolation, in units of 1/256 */
  float *line;                   /* a thread's rows in natural order */
  double *rows;                  /* sums of pieces of rows */
  ptrdiff_t sums;
  bool is_even;   /* `fixed` is the same everywhere: one row of it stands for all */
  bool is_gentle; /* alpha holds some cells so much that they must not be over-relaxed */
  double jacobi; /* the most that couplings have of a diagonal: Jacobi's iteration damps every wave so much */
  double radius; /* the same of a wave, which sees more cells than one */
  bool alone;    /* half sweeps do without a level below */
} cf_fields;

/* Whether a level has the extents for it. */
bool cf_fields_suit(const cf_coupled *l);

/* Shapes it on `plain`, the same level of the box. CF_NO_MEMORY; what was made is freed by destroy. */
cf_status cf_fields_create(cf_fields *f, const struct cf_varied *of, const cf_level *plain);
void cf_fields_destroy(cf_fields *f); /* a zeroed one is fine */

#endif
