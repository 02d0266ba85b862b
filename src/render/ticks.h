/* SPDX-License-Identifier: MIT
 *
 * Round numbers for axes and colour bars: steps of 1, 2 or 5 times a power of ten, and how they are written. Very
 * large and very small numbers share a power of ten, written once.
 */
#ifndef CF_RENDER_TICKS_H
#define CF_RENDER_TICKS_H

#define CF_TICKS_MAX 24

typedef struct cf_ticks {
  int count;
  double at[CF_TICKS_MAX];
  char label[CF_TICKS_MAX][24];
  char factor[24]; /* "×10^-6", or "" */
} cf_ticks;

/* About `wanted` (at most CF_TICKS_MAX) round numbers between low and high. */
cf_ticks cf_ticks_between(double low, double high, double wanted);

#endif
