/* SPDX-License-Identifier: MIT
 *
 * Slope limiters, written with min and max alone so that a row of them becomes vector instructions. Both are
 * odd in their arguments and symmetric between them to the last bit, so a mirrored field gives a mirrored
 * result.
 */
#ifndef CF_STENCIL_LIMIT_H
#define CF_STENCIL_LIMIT_H

#include "base/real.h"

/* Monotonised central difference (van Leer 1977): sign min(2|a|, 2|b|, |a + b|/2), 0 where the signs differ.
 */
static inline cf_real cf_limit_mc(const cf_real a, const cf_real b) {
  const cf_real zero = 0, low = 2 * CF_MIN(a, b), high = 2 * CF_MAX(a, b), mean = (a + b) / 2;
  const cf_real up = CF_MIN(low, mean), down = CF_MAX(high, mean);
  return CF_MAX(up, zero) + CF_MIN(down, zero);
}

/* The part of a that lies between 0 and b. */
static inline cf_real cf_limit_between(const cf_real a, const cf_real b) {
  const cf_real zero = 0, low = CF_MIN(a, b), high = CF_MAX(a, b);
  return CF_MAX(low, zero) + CF_MIN(high, zero);
}

#endif
