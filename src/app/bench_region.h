/* SPDX-License-Identifier: MIT
 *
 * Parts of a box to solve in:
 *
 *     ball     a ball of radius 0.23 in the middle is wall
 *     slalom   three plates, a cell thick, that leave a quarter open at one end and the other in turn
 *     porous   30 % of the box is wall, in random grains of 4 cells a side
 *     drop     inside is a ball of 2 % of the box, on tiles
 */
#ifndef CF_APP_BENCH_REGION_H
#define CF_APP_BENCH_REGION_H

#include "grid/region.h"

/* The region of that name on g; *tiles is NULL but for `drop`. What was made before a failure is left to be destroyed.
 * CF_BAD_ARGUMENT: no such name; CF_NO_MEMORY. */
cf_status cf_bench_region_create(const char *name, const cf_grid *g, cf_region **r, cf_tiles **tiles);

#endif
