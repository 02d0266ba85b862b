/* SPDX-License-Identifier: MIT
 *
 * Levels of couplings where no face is closed but walls of the box: filled whole rows at a time, nothing being looked for.
 * What comes out is what varied_fill.c, coupled.c and coarsen.c make cell by cell, to round-off: a coupling in series takes one
 * division here, and five there.
 */
#ifndef CF_SOLVE_OPEN_H
#define CF_SOLVE_OPEN_H

#include "solve/varied_part.h"

/* Fills and finishes the finest level from coefficients that hold in all of the box; false: some face is closed (or nearly),
 * or cells bear marks of an earlier equation, and it is to be done in the other way. */
bool cf_open_fill(cf_varied *v, const cf_coefficients *c);

/* The same for a level and the next coarser one, without alpha and beta that differ there (coarse->excess). */
bool cf_open_coarsen(cf_coupled *l, cf_coupled *coarse);

#endif
