/* SPDX-License-Identifier: MIT
 *
 * Quadratic B-splines: the weights of a particle on the three nodes around it on one axis. Nodes are the centres of
 * cells; with f in [-1/2, 1/2] the distance from the middle node to the particle, over h,
 *
 *     w = (1/2 - f)^2/2,  3/4 - f^2,  (1/2 + f)^2/2        sum w = 1,  sum w (x_i - x) = 0,
 *                                                            sum w (x_i - x)^2 = h^2/4
 *
 * whatever f is, so that D = sum w (x_i - x)(x_i - x)^T = (h^2/4) I (Jiang, Schroeder, Teran 2017) and moments about a
 * particle need no inverse.
 */
#ifndef CF_STENCIL_BSPLINE_H
#define CF_STENCIL_BSPLINE_H

#include "base/lanes.h"

/* 1/D, times h^2. */
#define CF_BSPLINE_INERTIA 4

/* Eight particles: at = (x - origin)/h, 0 <= at < 2^31. cell: the one it is in, which is the middle node; w[i] and
 * d[i] = (x_i - x)/h of its three nodes. */
CF_SMALL void cf_bspline(const cf_lanes *at, int *cell, cf_lanes *w, cf_lanes *d) {
  cf_lanes low;
  CF_SMALL_LOOP
  for (int l = 0; l < CF_WIDE; ++l) {
    cell[l] = (int)(*at)[l];
    low[l] = (cf_real)cell[l];
  }
  const cf_lanes f = *at - low - (cf_real)0.5;
  w[0] = (cf_real)0.5 * ((cf_real)0.5 - f) * ((cf_real)0.5 - f);
  w[1] = (cf_real)0.75 - f * f;
  w[2] = (cf_real)0.5 * ((cf_real)0.5 + f) * ((cf_real)0.5 + f);
  d[0] = -1 - f;
  d[1] = -f;
  d[2] = 1 - f;
}

#endif
