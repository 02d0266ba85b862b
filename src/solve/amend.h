/* SPDX-License-Identifier: MIT
 *
 * What a coarse level of couplings needs beyond what its blocks tell (coarsen.h).
 *
 * Around a reentrant corner, the edge of an obstacle that sticks out into the region, fluxes turn in no more room than a cell
 * or two. A coarse cell is too wide for that and lets less pass: a bar of n x n cells that turns by a right angle conducts
 * as its coarse level does once the two coarse couplings that meet at the corner are 1.15 times as large. Among packed grains,
 * where everything smooth has to pass such corners, the coarse correction is a tenth too large without that, for all of it at
 * once. There corners are no further apart than coarse cells, and 1.1 is best; further below, where half of it has been
 * inherited, 1.05.
 *
 * Where alpha and beta are numbers the level below the finest one differs from its own by what its cycle asks for (setting.h).
 */
#ifndef CF_SOLVE_AMEND_H
#define CF_SOLVE_AMEND_H

#include "solve/coupled.h"

/* By what share couplings at corners differ, on the level below the finest one and further below. */
#define CF_CORNER_FIRST 0.1f
#define CF_CORNER_BELOW 0.05f

/* Of the part w of `coarse`, which has just been filled from l; its e, r and rest are scratch. Nothing to do where no face
 * of l is closed, or coarse->excess is 0. */
void cf_amend(const cf_coupled *l, const cf_coupled *coarse, const cf_part *w);

#endif
