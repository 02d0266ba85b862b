/* SPDX-License-Identifier: MIT
 *
 * The fast path of cf_helmholtz_solve: alpha and beta are numbers. On a box the V-cycle contracts so well (0.1 and
 * better) that conjugate gradients around it gain nothing, and without them a cycle is one sweep through
 * memory over the finest level:
 *
 *     x  in the precision of the state;     r, e  in single precision
 *     r = b - A x                           in double
 *     repeat   e = one V-cycle on A e = r;  x += e;  r -= A e
 *
 * (iterative refinement; r -= A e loses nothing to speak of, see stages.h). r is formed anew where its
 * recursion has gained so much that rounding shows, so any tolerance is reached that x can hold.
 *
 * Where diffusion adds little to the diagonal (sigma up to about 1.5) no coarse level is needed: one
 * pass of half sweeps, over-relaxed as Chebyshev's polynomials ask (Golub and Varga 1961), does it all.
 */
#ifndef CF_SOLVE_BOX_SOLVER_H
#define CF_SOLVE_BOX_SOLVER_H

#include "solve/helmholtz.h"

struct cf_varied;

typedef struct cf_box_solver cf_box_solver;

/* Memory for the levels of A: pages that stay untouched until used. CF_NO_MEMORY. */
cf_status cf_box_solver_create(cf_box_solver **f, const cf_helmholtz *A);
void cf_box_solver_destroy(cf_box_solver *f); /* NULL is fine */

/* Takes A's coefficients. False: this equation is not one for the fast path. */
bool cf_box_solver_set(cf_box_solver *f, const cf_helmholtz *A);

/* The same in the region that v has taken, for numbers alpha and beta: to be set after v. *taken is false where this is
 * no case for it. CF_NO_MEMORY. */
cf_status cf_box_solver_create_around(cf_box_solver **f, const cf_helmholtz *A, struct cf_varied *v);
cf_status cf_box_solver_set_around(cf_box_solver *f, const cf_helmholtz *A, double alpha, double beta,
                                   bool *taken);

/* Solves; *finished = false: it went too slowly, and x, which has only become better, is left for another solver.
 * CF_NOT_FINITE. */
cf_status cf_box_solver_run(cf_box_solver *f, cf_helmholtz *A, cf_cell b, const cf_solve_options *o,
                            cf_cell x, cf_solve_report *report, bool *finished);

/* "sor" or "multigrid". */
const char *cf_box_solver_method(const cf_box_solver *f);

#endif
