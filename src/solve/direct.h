/* SPDX-License-Identifier: MIT
 *
 * The direct solution on a level where a cycle has no strength or no sense: on a line (one axis with more than
 * one cell; smoothing in the other axes is what makes a cycle good) and on few cells.
 *
 * Both eliminate cell by cell without a subtraction: what is kept of a cell is its couplings c to the cells
 * left and its surplus s (alpha and held walls), with the diagonal d = s + sum c, and eliminating cell j adds
 *
 *     c_ik += c_ij c_jk / d_j,     s_i += c_ij s_j / d_j
 *
 * (Grassmann, Taksar, Heyman 1985). So the pivots keep all their digits however small alpha is beside beta, and
 * a pivot is 0 exactly where the rest of a region has no equation that fixes its level: x is 0 there.
 */
#ifndef CF_SOLVE_DIRECT_H
#define CF_SOLVE_DIRECT_H

#include "solve/level.h"

/* So few that the elimination costs less than the sweeps of a few more levels. */
#define CF_FEW_CELLS 64

typedef struct cf_direct {
  double *coupling;          /* of cells i and j at i * CF_FEW_CELLS + j; above the diagonal as eliminated */
  double *surplus, *pivot;   /* one a cell */
  double *volume, *solution; /* one a cell */
} cf_direct;

cf_status cf_direct_create(cf_direct *d); /* CF_NO_MEMORY */
void cf_direct_destroy(cf_direct *d);     /* a zeroed one is fine */

bool cf_level_is_few(const cf_level *l);

/* Eliminates the level's present coefficients. */
void cf_direct_factor(const cf_level *l, cf_direct *d);

/* x with A x = b for the coefficients last factored. */
void cf_direct_solve(const cf_level *l, const cf_direct *d, cf_cell b, cf_cell x);

/* Whether at most one axis of the level has more than one cell. */
bool cf_level_is_line(const cf_level *l);

/* x with A x = b on a line. work: 5 numbers a cell. */
void cf_level_solve_line(const cf_level *l, cf_cell b, double *work, cf_cell x);

#endif
