/* SPDX-License-Identifier: MIT
 *
 * Lying snow as a layer on columns: depth d(i, j) >= 0 on a base b(i, j) (the ground and the tops of what stands on
 * it), both in m, columns h wide, periodic sideways like the wind that brings it. Its top is b + d.
 *
 *     landing    volume is shared by the four columns around the place with linear weights, or by all within a radius a
 *                with weights (1 - (d/a)^2)^2 over their sum: the sum is exact
 *     slumping   where the top is steeper than the angle of repose, snow slides to the lower neighbour:
 *                    flux = min(SHARE max(|top_i - top_j| - h tan(repose), 0), d_i/4)       out of the higher one
 *                from old values, so a sweep keeps the sum to round-off and no column gives more than it has, and
 *                the order of columns does not matter
 *
 * Snow does not sinter, melt or blow away again.
 */
#ifndef CF_PHYSICS_SNOWPACK_H
#define CF_PHYSICS_SNOWPACK_H

#include "base/real.h"

typedef struct cf_snowpack {
  int n[2];           /* columns in x and y */
  double h, place[2]; /* width of a column; centre of column (0, 0), m */
  double steepest;    /* tan of the angle of repose */
  cf_real *base;      /* the caller's arrays of n[0] n[1] values, x fastest */
  cf_real *depth;
  cf_real *change; /* scratch of the same size */
} cf_snowpack;

/* Adds a volume, m^3, at (x, y), over a disc of radius `wide` where that is more than a column. */
void cf_snowpack_land(const cf_snowpack *s, double x, double y, double wide, double volume);

/* The top at (x, y), interpolated; m. */
double cf_snowpack_top(const cf_snowpack *s, double x, double y);

/* One sweep of slumping; same bits for any number of threads. */
void cf_snowpack_slump(const cf_snowpack *s, int threads);

/* Volume of the layer, m^3, summed row by row. */
double cf_snowpack_volume(const cf_snowpack *s);

#endif
