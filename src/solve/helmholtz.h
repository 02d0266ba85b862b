/* SPDX-License-Identifier: MIT
 *
 * The one operator, (alpha - div beta grad), and its solution: cf_helmholtz_* of cattaneo.h. Here is what only
 * the library's own equations need.
 *
 * The cycle is V(1,1): red-black Gauss-Seidel in the same colour order before and after the coarse correction,
 * mildly over-relaxed where there is much to smooth, which takes fewer cycles than the symmetric order
 * (McAdams, Sifakis, Teran 2010 use the latter).
 */
#ifndef CF_SOLVE_HELMHOLTZ_H
#define CF_SOLVE_HELMHOLTZ_H

#include <stdbool.h>

#include "base/walls.h"
#include "grid/field.h"
#include "grid/grid.h"
#include "grid/wall.h"

/* A residual that is round-off passes for convergence up to the root of this (5e-7; in single precision 1e-2), not
 * beyond. */
#define CF_ROUNDING_PASSES (1024 * CF_REAL_EPSILON)

/* How equations with the present coefficients are solved: "sor" (half sweeps on one level), "multigrid" (stationary
 * V-cycles), "multigrid-pcg" (conjugate gradients around V-cycles), or by elimination: "line", "direct" (few cells). */
const char *cf_helmholtz_method(const cf_helmholtz *A);

/* From now on regions are not solved in windows of their box (window.h). */
void cf_helmholtz_forbid_windows(cf_helmholtz *A);

/* b += what the values of held walls contribute, beta phi_wall 2/h^2. */
void cf_helmholtz_add_walls(const cf_helmholtz *A, const cf_wall_values *walls, cf_cell b);

#endif
