/* SPDX-License-Identifier: MIT
 *
 * A region that fills a small part of its box is solved in a box of its own, a window on the large one:
 *
 *     +-----------------------------+
 *     |          +---------+        |        cells inside (#), one cell more on every side, whose kinds matter, and from there
 *     |          |  ####   |        |        outwards to the next multiple of CF_WINDOW_STEP cells, so that a drop that moves a
 *     |          | ######  |        |        cell mostly keeps its window
 *     |          |  ####   |        |
 *     |          +---------+        |
 *     +-----------------------------+
 *
 * Fields of the large box have rows as far apart as it is wide; a drop's rows lie in a page each, half empty. In the window
 * they follow each other. Kinds and coefficients are copied when coefficients are set, b and x at every solution, in and
 * out, where cells are inside. No cell inside lies at an end of the window that is none of the box, so such an end is
 * insulated. A periodic axis at whose seam the region lies is taken whole and stays periodic.
 *
 * Which window it is, and whether there is one, follows from the kinds alone: neither from what has been before, so that a
 * run goes on after a stop with the same bits, nor from tiles, so that the region has the same bits with and without them.
 */
#ifndef CF_SOLVE_WINDOW_H
#define CF_SOLVE_WINDOW_H

#include "grid/region.h"
#include "solve/helmholtz.h"

#define CF_WINDOW_STEP 8

typedef struct cf_window cf_window;

/* Whether the region of c had better be solved in a window: it has at most half of the box's cells, and the region fills
 * enough of it. */
bool cf_window_pays(const cf_grid *g, const cf_walls *walls, const cf_coefficients *c);

/* Takes coefficients, for which a window pays; *w NULL: makes one; levels: as for cf_helmholtz_create. Where the same have been
 * set before nothing is done. After a failure *w is NULL. CF_NO_MEMORY; as cf_helmholtz_set. */
cf_status cf_window_set(cf_window **w, const cf_grid *g, const cf_walls *walls, int levels,
                        const cf_coefficients *c);
void cf_window_destroy(cf_window *w); /* NULL is fine */

/* As the functions of the same name in cattaneo.h. apply: y is 0 where it may be written and no cell is inside. */
cf_status cf_window_solve(cf_window *w, cf_cell b, const cf_solve_options *o, cf_cell x,
                          cf_solve_report *report);
void cf_window_apply(cf_window *w, cf_cell x, cf_cell y);
double cf_window_residual(cf_window *w, cf_cell x, cf_cell b);

/* b += what held cells of the region contribute. */
void cf_window_add_held(const cf_window *w, cf_cell b);

/* beta on a face of a wall of the box, beside cell p: 0 where that is not inside. */
double cf_window_wall_beta(const cf_window *w, int axis, ptrdiff_t p, ptrdiff_t face);

/* How it solves. */
const char *cf_window_method(const cf_window *w);

#endif
