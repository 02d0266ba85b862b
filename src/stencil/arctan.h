/* SPDX-License-Identifier: MIT
 *
 * The arc tangent for row kernels: no call, no branch, one division, the same bits for every vector width. The
 * argument is brought into |x| <= tan(pi/8) by atan x = pi/2 - atan(1/x) or pi/4 + atan((x - 1)/(x + 1)), where a
 * polynomial that interpolates atan(x)/x in x^2 at the 12 Chebyshev points is good to 2.3e-16 of the value.
 */
#ifndef CF_STENCIL_ARCTAN_H
#define CF_STENCIL_ARCTAN_H

#include "base/real.h"

static inline __attribute__((always_inline)) cf_real cf_arctan(const cf_real x) {
  const cf_real size = x < 0 ? -x : x;
  const cf_real small = (cf_real)0.41421356237309503, large = (cf_real)2.4142135623730949;
  const cf_real above = size > large ? -1 : size - 1, below = size > large ? size : size + 1;
  const cf_real start = size > large ? (cf_real)1.5707963267948966 : (cf_real)0.78539816339744828;
  const cf_real y = size > small ? above / below : size, from = size > small ? start : 0;
  const cf_real z = y * y;
  cf_real s = (cf_real)-0.017805397205419446;
  s = s * z + (cf_real)0.03796525745386593;
  s = s * z - (cf_real)0.05035102456601552;
  s = s * z + (cf_real)0.05846878297330872;
  s = s * z - (cf_real)0.06662951813629191;
  s = s * z + (cf_real)0.07692045330902225;
  s = s * z - (cf_real)0.09090896809064027;
  s = s * z + (cf_real)0.11111110744919658;
  s = s * z - (cf_real)0.14285714279250245;
  s = s * z + (cf_real)0.19999999999940893;
  s = s * z - (cf_real)0.3333333333333312;
  const cf_real angle = from + (y + y * (z * s));
  return x < 0 ? -angle : angle;
}

#endif
