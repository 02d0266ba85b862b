/* SPDX-License-Identifier: MIT
 *
 * A cloud of points as a density: every point is spread over the 27 (in the plane 9) cells around it with the weights of
 * a quadratic spline, so what is drawn of it has no grain finer than a cell and no trace of the grid.
 */
#ifndef CF_RENDER_CLOUD_H
#define CF_RENDER_CLOUD_H

#include <stdint.h>

#include "grid/field.h"
#include "grid/grid.h"

/* A grid over the same box, with cells so fine that `points` of them are about four a cell where they fill a tenth of it,
 * but no coarser than g's, and at most four times finer. */
void cf_cloud_grid(const cf_grid *g, int64_t points, cf_grid *fine);

/* out: points a cell of g (not of the fine grid); they may lie anywhere. */
void cf_cloud_density(const cf_grid *fine, double cell, int64_t points, const float (*place)[3], cf_cell out);

#endif
