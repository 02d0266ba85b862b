/* SPDX-License-Identifier: MIT
 *
 * Fifth-order weighted reconstruction, WENO5-Z (Jiang, Shu 1996; weights of Borges, Carmona, Costa, Don 2008):
 * from the mean values a b c d e of five cells in a row, the value on the face between c and d as seen from c.
 *
 *     v_0 = (2a - 7b + 11c)/6,   v_1 = (-b + 5c + 2d)/6,   v_2 = (2c + 5d - e)/6
 *     s_0 = 13/12 (a - 2b + c)^2 + (a - 4b + 3c)^2/4       and so on: how rough each three are
 *     w_i = g_i (1 + (T/s_i)^2),  g = 1/10, 6/10, 3/10,  T = |s_0 - s_2|;      v = sum w v / sum w
 *
 * Smooth data give w = g and fifth order; at a jump the three cells that see it lose their say. New extrema of
 * a few per cent remain possible. The value seen from the other side of the face, from d, comes from the same
 * function with the cells in the opposite order: cf_weno5(f, e, d, c, b).
 *
 * What keeps T/s finite is a share of s_0 + s_1 + s_2, not a fixed number, so that v(c f) = c v(f) and the same
 * line serves float and double; and since v is c plus a mean of differences, v(f + c) = v(f) + c to round-off.
 */
#ifndef CF_STENCIL_WENO_H
#define CF_STENCIL_WENO_H

#include "grid/sweep.h"

#ifdef CF_SINGLE
#define CF_WENO_SHARE 1e-6f
#define CF_WENO_LEAST 1e-36f
#else
#define CF_WENO_SHARE 1e-20
#define CF_WENO_LEAST 1e-300
#endif

CF_KERNEL cf_real cf_weno5(const cf_real a, const cf_real b, const cf_real c, const cf_real d,
                           const cf_real e) {
  const cf_real curve = (cf_real)(13.0 / 12.0), quarter = (cf_real)0.25, sixth = (cf_real)(1.0 / 6.0);
  const cf_real ab = b - a, bc = c - b, cd = d - c, de = e - d; /* all there is to know, but for c */
  const cf_real k0 = bc - ab, k1 = cd - bc, k2 = de - cd;
  const cf_real t0 = 3 * bc - ab, t1 = bc + cd, t2 = 3 * cd - de;
  const cf_real s0 = curve * k0 * k0 + quarter * t0 * t0;
  const cf_real s1 = curve * k1 * k1 + quarter * t1 * t1;
  const cf_real s2 = curve * k2 * k2 + quarter * t2 * t2;
  const cf_real least = CF_WENO_SHARE * (s0 + s1 + s2) + CF_WENO_LEAST;
  const cf_real T = s0 > s2 ? s0 - s2 : s2 - s0;
  const cf_real r0 = T / (s0 + least), r1 = T / (s1 + least), r2 = T / (s2 + least);
  const cf_real w0 = 1 + r0 * r0, w1 = 6 * (1 + r1 * r1), w2 = 3 * (1 + r2 * r2);
  const cf_real v0 = 5 * bc - 2 * ab, v1 = bc + 2 * cd, v2 = 4 * cd - de;
  return c + (w0 * v0 + w1 * v1 + w2 * v2) / (w0 + w1 + w2) * sixth;
}

#endif
