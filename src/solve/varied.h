/* SPDX-License-Identifier: MIT
 *
 * The path of cf_helmholtz_solve for coefficients that vary and for regions: conjugate gradients in the precision of the
 * state around one V-cycle in single precision over levels of couplings (coupled.h); before that, where no face is closed,
 * stationary cycles (varied_cycles.c), which mostly suffice; or, where diffusion adds little to the diagonal, half sweeps
 * alone (varied_sweeps.c).
 *
 * Where no alpha and no known value fixes the level of a part of the region, that part is a pocket: its right side is made
 * to sum to zero and its solution keeps the mean it came with, each pocket for itself.
 *
 * On a region that has tiles everything here visits their runs only, and fields have memory only there.
 */
#ifndef CF_SOLVE_VARIED_H
#define CF_SOLVE_VARIED_H

#include "grid/region.h"
#include "solve/helmholtz.h"

typedef struct cf_varied cf_varied;

/* Empty: memory is taken when coefficients are set. CF_NO_MEMORY. */
cf_status cf_varied_create(cf_varied **v, const cf_helmholtz *A);
void cf_varied_destroy(cf_varied *v); /* NULL is fine */

/* Takes coefficients: at least one of them a field, or a region. CF_NO_MEMORY; CF_BAD_ARGUMENT: the region is of
 * another grid. */
cf_status cf_varied_set(cf_varied *v, const cf_helmholtz *A, const cf_coefficients *c);

/* Whether these coefficients are numbers in a region and what v has been given last. */
bool cf_varied_has(const cf_varied *v, const cf_coefficients *c);

/* Whether the coefficients set last were those before and nothing had changed in their region, which has no tiles. */
bool cf_varied_stood(const cf_varied *v);

/* As the functions of the same name in cattaneo.h. */
cf_status cf_varied_solve(cf_varied *v, cf_cell b, const cf_solve_options *o, cf_cell x,
                          cf_solve_report *report);
void cf_varied_apply(cf_varied *v, cf_cell x, cf_cell y);
double cf_varied_residual(cf_varied *v, cf_cell x, cf_cell b);

/* b += what held cells of the region contribute. */
void cf_varied_add_held(const cf_varied *v, cf_cell b);

/* beta on a face of a wall of the box: 0 where the cell beside it (p) is not inside. */
double cf_varied_wall_beta(const cf_varied *v, int axis, ptrdiff_t face);

/* Levels in use, and "sor", "pcg" or "multigrid-pcg". */
int cf_varied_depth(const cf_varied *v);
const char *cf_varied_method(const cf_varied *v);

#endif
