/* SPDX-License-Identifier: MIT
 *
 * Conjugate gradients on one level, in the inner product weighted with cell volumes, in which the operator is
 * self-adjoint. Without a preconditioner it solves the coarsest level; around a V-cycle it is the solver of
 * cf_helmholtz_solve.
 */
#ifndef CF_SOLVE_PCG_H
#define CF_SOLVE_PCG_H

#include "solve/helmholtz.h"
#include "solve/level.h"

/* Plain conjugate gradients from x = 0; work is r, p and A p. Returns the iterations taken. */
int cf_pcg_plain(cf_level *l, bool singular, cf_cell b, const cf_solve_options *o, const cf_cell work[3],
                 cf_cell x);

/* x += amount. */
void cf_level_shift(const cf_level *l, double amount, cf_cell x);

/* Subtracts the mean. */
void cf_level_remove_mean(const cf_level *l, cf_cell x);

#endif
