/* SPDX-License-Identifier: MIT
 *
 * The odds of a level: cells whose parent is not the coarse cell around them. Where closed faces cut the cells of a block
 * into pieces, the coarse cell is the largest piece (coarsen.h); the cells of the others are found here, find a coarse
 * cell next to their own to join, in rounds of which each sees what the one before has settled, and bring with them what
 * they are coupled to. A piece that no open face leads out of is an island: its constant is solved for by itself.
 */
#ifndef CF_SOLVE_ODDS_H
#define CF_SOLVE_ODDS_H

#include "solve/coupled.h"

/* Finds the odds of l in the blocks of the part w of `coarse`; others stay. CF_NO_MEMORY. */
cf_status cf_odds_find(cf_coupled *l, const cf_coupled *coarse, const cf_part *w);

/* Adds to coarse cells of w what odds bring: their part of the diagonal and couplings through faces on the way to other
 * coarse cells. held_share: of known values (coarsen.c). */
void cf_odds_add(const cf_coupled *l, const cf_coupled *coarse, const cf_part *w, float held_share);

static inline bool cf_odds_has(const cf_coupled *l, const ptrdiff_t p) { return l->mark[p] & CF_MARK_ODD; }

#endif
