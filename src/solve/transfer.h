/* SPDX-License-Identifier: MIT
 *
 * Between a level and the next coarser one.
 *
 * Restriction averages: r_c = sum over the children of (volume of the child / volume of the cell) r_f, so its
 * weights sum to 1, as a point-scaled operator needs. Prolongation is linear interpolation between cell
 * centres along each axis in turn; towards an insulated wall it is constant, towards a held wall it falls to
 * 0 on the wall.
 */
#ifndef CF_SOLVE_TRANSFER_H
#define CF_SOLVE_TRANSFER_H

#include "solve/level.h"

/* Cells of the coarser axis. Where the count is odd the last cell stays alone, unless it is narrower than the others: then it makes
 * a triple with the two before it. So the last cell is half as wide as the others up to one and three eighths times. */
int cf_axis_coarse_count(const cf_axis *fine);

/* Fills the pairing of `fine` towards an axis of `coarse`, and makes the coarse axis itself.
 * CF_NO_MEMORY; what was allocated is freed with cf_axis_clear and cf_pairing_clear. */
cf_status cf_axis_coarsen(const cf_axis *fine, bool coarsened, double h, cf_pairing *pairing,
                          cf_axis *coarse);

/* The axis of a fine grid: n cells of width 1 (times h metres). */
cf_status cf_axis_create(cf_axis *axis, int n, double h, const cf_wall wall[2]);
void cf_axis_clear(cf_axis *axis);
void cf_pairing_clear(cf_pairing *pairing);

/* b_c = R r_f. `scratch` holds threads * (n_f + 2) numbers. */
void cf_level_restrict(const cf_level *fine, cf_cell r, const cf_level *coarse, cf_cell b, cf_real *scratch);

/* x_f += P x_c. x_c's periodic ghosts are filled first. */
void cf_level_prolong(const cf_level *coarse, cf_cell x_c, const cf_level *fine, cf_cell x_f,
                      cf_real *scratch);

#endif
