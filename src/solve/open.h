/* SPDX-License-Identifier: MIT
 *
 * Levels of couplings where no face is closed but walls of the box: filled whole rows at a time, nothing being looked for.
 * What comes out is what varied_fill.c, coupled.c and coarsen.c make cell by cell, to round-off: a coupling in series takes one
 * division here, and five there.
 */
#ifndef CF_SOLVE_OPEN_H
#define CF_SOLVE_OPEN_H

#include "solve/varied_part.h"

/* A row of the finest level: couplings on low faces, alpha, what walls hold, and 1/diagonal. */
typedef struct cf_open_row {
  float *c[3], *free, *held, *inverse;
} cf_open_row;

/* Fills row (j, k), and returns what it is like; take: what all rows together are like is set down in the level, and whether nothing
 * is closed is returned. */
int cf_open_fill_row(const cf_varied *v, const cf_coefficients *c, int j, int k, const cf_open_row *to);
bool cf_open_take(cf_varied *v, int flags);

/* 1/diagonal of a coarse level from the rest of it. */
void cf_open_finish(cf_coupled *coarse);

/* No cell of the level bears a mark. */
bool cf_open_is_bare(const cf_coupled *l);

/* Fills and finishes the finest level from coefficients that hold in all of the box; false: some face is closed (or nearly),
 * or cells bear marks of an earlier equation, and it is to be done in the other way. */
bool cf_open_fill(cf_varied *v, const cf_coefficients *c);

/* The same for a level and the next coarser one, without alpha and beta that differ there (coarse->excess). */
bool cf_open_coarsen(cf_coupled *l, cf_coupled *coarse);

/* --- apart by colour (fields_fill.c) -------------------------------------------------------------------- */

/* Fills the finest level, and alpha and held of the level below; false: some face is closed, or nearly. */
bool cf_fields_fill(cf_varied *v, const cf_coefficients *c);

/* Couplings of the level below, and the weights of interpolation from it. */
void cf_fields_coarsen(cf_varied *v);

#endif
