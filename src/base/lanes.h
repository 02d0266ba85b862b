/* SPDX-License-Identifier: MIT
 *
 * Eight numbers at a time: a vector type of the compiler, with + - * / element by element and with plain numbers.
 * On a machine with narrower vectors it is done in parts, with the same bits. Two uses: a small vector whose
 * components are different things (a node of the particles' grid), and eight particles side by side.
 *
 * Pass pointers to it, never values: how a value travels depends on the instruction set.
 */
#ifndef CF_BASE_LANES_H
#define CF_BASE_LANES_H

#include <math.h>

#include "base/real.h"

#define CF_WIDE 8

typedef cf_real cf_lanes __attribute__((vector_size(CF_WIDE * sizeof(cf_real)), may_alias));
/* The same at any address of a cf_real. */
typedef cf_real cf_lanes_anywhere
    __attribute__((vector_size(CF_WIDE * sizeof(cf_real)), may_alias, aligned(sizeof(cf_real))));

#define CF_LANES_AT(pointer)     (*(const cf_lanes_anywhere *)(pointer))
#define CF_LANES_AT_PUT(pointer) (*(cf_lanes_anywhere *)(pointer))

#if defined(__clang__)
#define CF_SMALL_LOOP _Pragma("unroll")
#else
#define CF_SMALL_LOOP _Pragma("GCC unroll 27")
#endif
#define CF_SMALL static inline __attribute__((always_inline))

#ifdef CF_SINGLE
#define CF_SQRT(x) sqrtf(x)
#else
#define CF_SQRT(x) sqrt(x)
#endif

CF_SMALL void cf_lanes_fill(const cf_real value, cf_lanes *y) {
  CF_SMALL_LOOP
  for (int l = 0; l < CF_WIDE; ++l) (*y)[l] = value;
}

/* Of numbers >= 0. */
CF_SMALL void cf_lanes_sqrt(cf_lanes *x) {
  CF_SMALL_LOOP
  for (int l = 0; l < CF_WIDE; ++l) (*x)[l] = CF_SQRT((*x)[l]);
}

/* y = max(x, bound). */
CF_SMALL void cf_lanes_at_least(const cf_real bound, cf_lanes *x) {
  CF_SMALL_LOOP
  for (int l = 0; l < CF_WIDE; ++l) (*x)[l] = (*x)[l] > bound ? (*x)[l] : bound;
}

#endif
