/* SPDX-License-Identifier: MIT
 *
 * Every implicit equation of the project is
 *
 *     (alpha - div beta grad) x = b        on cells, in a box with walls,
 *
 * alpha >= 0 a number or a cell field, beta >= 0 a number or a face field. This is that operator with the
 * multigrid hierarchy that solves it:
 *
 *     cf_helmholtz_create(&A, grid, walls, levels);
 *     cf_helmholtz_set(A, &(cf_coefficients){.alpha = 1, .beta = dt * k});
 *     cf_helmholtz_solve(A, b, &options, x, &report);
 *
 * The values on held walls belong to the right side b (cf_helmholtz_add_walls). With alpha = 0 and no held
 * wall the solution is known up to a constant: b is made to sum to zero and x keeps the mean it came with.
 *
 * The solver is flexible conjugate gradients (Polak-Ribiere) around one V(1,1) cycle: red-black Gauss-Seidel in
 * the same colour order before and after the coarse correction, mildly over-relaxed where there is much to
 * smooth, which takes fewer cycles than the symmetric order (McAdams, Sifakis, Teran 2010 use the latter).
 */
#ifndef CF_SOLVE_HELMHOLTZ_H
#define CF_SOLVE_HELMHOLTZ_H

#include <stdbool.h>

#include "base/walls.h"
#include "grid/field.h"
#include "grid/grid.h"
#include "grid/wall.h"

typedef struct cf_helmholtz cf_helmholtz;

typedef struct cf_coefficients {
  double alpha, beta;      /* used where the fields below are NULL; beta in m^2 (times alpha's unit) */
  const cf_cell *alpha_at; /* fields on the grid's box, owned by the caller, alive while solving */
  const cf_face *beta_at;
} cf_coefficients;

typedef struct cf_solve_options {
  double tolerance;   /* on |b - A x| / |b| */
  int max_iterations; /* of conjugate gradients */
} cf_solve_options;

typedef struct cf_solve_report {
  int iterations;  /* of conjugate gradients, one V-cycle each */
  int levels;      /* that the cycle went through */
  double residual; /* |b - A x| / |b| at the end */
  bool converged;
} cf_solve_report;

/* levels: 0 for as many as the equation needs, otherwise at most that many (1: no coarse grids).
 * `walls` gives kinds only. CF_NO_MEMORY. */
cf_status cf_helmholtz_create(cf_helmholtz **A, const cf_grid *g, const cf_walls *walls, int levels);
void cf_helmholtz_destroy(cf_helmholtz *A); /* NULL is fine */

/* Coefficients may change from step to step. beta's faces on the high side of a periodic axis are set to those
 * on its low side. Fields cost the hierarchy their own memory, taken when first
 * seen: CF_NO_MEMORY. CF_BAD_ARGUMENT: negative or not finite numbers. */
cf_status cf_helmholtz_set(cf_helmholtz *A, const cf_coefficients *c);

/* y = A x. x's ghosts on periodic walls are filled. */
void cf_helmholtz_apply(cf_helmholtz *A, cf_cell x, cf_cell y);

/* |b - A x| / |b|, computed afresh. */
double cf_helmholtz_residual(cf_helmholtz *A, cf_cell x, cf_cell b);

/* b += what the values of held walls contribute, beta phi_wall 2/h^2. */
void cf_helmholtz_add_walls(const cf_helmholtz *A, const cf_wall_values *walls, cf_cell b);

/* x comes as the initial guess. Not converging is a report, not a failure. b is overwritten where the system is
 * singular (made to sum to 0), otherwise kept. CF_NOT_FINITE: b or x holds a value that is not finite. */
cf_status cf_helmholtz_solve(cf_helmholtz *A, cf_cell b, const cf_solve_options *o, cf_cell x,
                             cf_solve_report *report);

#endif
