/* SPDX-License-Identifier: MIT
 *
 * From a level of couplings to the next coarser one.
 *
 * Coarse cells are blocks of 2 cells an axis (fewer at the end of an odd axis). Where closed faces cut the cells of a block
 * into pieces, the coarse cell is the largest piece; another piece joins the neighbouring coarse cell that it is coupled
 * to most strongly, so that a thin plate stays a plate on every level, wherever it lies. A piece without such a
 * neighbour stays with its block: nothing is ever lost, the sum of residuals is the same on all levels, which is what
 * keeps channels and pockets from going astray.
 *
 * The coupling of two coarse cells is the sum over the fine faces between them of
 *
 *     1 / (1/c_face + 1/(2 c_inner) + 1/(2 c_inner'))
 *
 * the face in series with half of the inner faces on either side: from centre to centre. It is half the face's
 * coupling where nothing varies, as it must be at twice the distance, and it sees a jump of the coefficient wherever in
 * the block it lies; so does the weight of interpolation, the share of that resistance before the fine centre.
 */
#ifndef CF_SOLVE_COARSEN_H
#define CF_SOLVE_COARSEN_H

#include "solve/coupled.h"

/* Shapes `coarse` for l->coarsened. CF_NO_MEMORY. */
cf_status cf_coarsen_create(const cf_coupled *l, cf_coupled *coarse);

/* Tiles of `coarse` over those of l, which may have changed. CF_NO_MEMORY. */
cf_status cf_coarsen_follow(const cf_coupled *l, cf_coupled *coarse);

/* Fills the part w of `coarse` from the couplings of l, and l's ways to it. The result has the same bits whatever else
 * was filled before. CF_NO_MEMORY: everything is to be filled again. */
cf_status cf_coarsen(cf_coupled *l, cf_coupled *coarse, const cf_part *w);

#endif
