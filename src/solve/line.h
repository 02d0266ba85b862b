/* SPDX-License-Identifier: MIT
 *
 * The direct solution on a level that has shrunk to a line (one axis with more than one cell): tridiagonal
 * elimination, with the two corner entries of a periodic line as a rank-one change (Sherman and Morrison 1950).
 * In one dimension a V-cycle loses its strength (smoothing in the other axes is what makes it good), and
 * elimination is cheaper than any cycle.
 */
#ifndef CF_SOLVE_LINE_H
#define CF_SOLVE_LINE_H

#include "solve/level.h"

/* Whether at most one axis of the level has more than one cell. */
bool cf_level_is_line(const cf_level *l);

/* x with A x = b. work: 5 numbers a cell. singular: b sums to zero and x gets mean zero. */
void cf_level_solve_line(const cf_level *l, bool singular, cf_cell b, double *work, cf_cell x);

#endif
