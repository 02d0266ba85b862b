/* SPDX-License-Identifier: MIT
 *
 * How fast a velocity on faces empties cells: with c = u dt/h, - and + for the low and high face of a cell,
 *
 *   K = max over cells and axes d of max(c_d+, 0) + max(-c_d-, 0) + sum over e != d of max(c_e+ - c_e-, 0)
 *
 * is the share of a cell's contents that sweeps along the axes can at most have carried off, in any order. It
 * is linear in dt. Staggered volumes have the mean velocity of two cells, so their K is no larger; for those
 * on walls the ghost cells beside the box count as well.
 */
#ifndef CF_STENCIL_COURANT_H
#define CF_STENCIL_COURANT_H

#include <stdbool.h>

#include "grid/field.h"
#include "grid/grid.h"

/* Fills one layer of ghosts of u, corners included. Periodic axes wrap (the high wall's faces become the
 * image of the low wall's). Beyond other walls the tangential components are those beside the wall and the
 * normal one goes on linearly: mirrored at a closed wall, free of divergence at an open one. */
void cf_courant_ghosts(const cf_grid *g, const bool wrap[3], cf_face u);

/* Whether u is 0 on every face across `axis`. */
bool cf_courant_still(const cf_grid *g, cf_face u, int axis);

/* K/dt in 1/s. CF_NOT_FINITE with the place where a velocity is not finite. */
cf_status cf_courant_rate(const cf_grid *g, cf_face u, double *rate);

#endif
