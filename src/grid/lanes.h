/* SPDX-License-Identifier: MIT
 *
 * Vectors of fixed length, for sums along a row and for weaving two rows into one. A sum kept in so many lanes has the
 * same bits on every machine, but left to itself the compiler keeps an array of lanes in memory, or takes it apart; these
 * stay in registers, however many of them the machine needs for one. They are for local variables: as arguments they would
 * depend on the machine.
 */
#ifndef CF_GRID_LANES_H
#define CF_GRID_LANES_H

#include <stdint.h>

#include "base/real.h"

typedef double cf_eight __attribute__((vector_size(64)));
typedef float cf_sixteen __attribute__((vector_size(64)));
typedef int64_t cf_eight_bits __attribute__((vector_size(64))); /* what a comparison of cf_eight gives */

typedef float cf_eight_in_floats __attribute__((vector_size(32)));

/* The same in memory, anywhere. */
typedef double cf_eight_doubles __attribute__((vector_size(64), aligned(8), may_alias));
typedef float cf_four_floats __attribute__((vector_size(16), aligned(4), may_alias));
typedef float cf_eight_floats __attribute__((vector_size(32), aligned(4), may_alias));
typedef float cf_sixteen_floats __attribute__((vector_size(64), aligned(4), may_alias));

#define CF_EIGHT_OF_DOUBLES(p)     (*(const cf_eight_doubles *)(p))
#define CF_EIGHT_OF_FLOATS(p)      __builtin_convertvector(*(const cf_eight_floats *)(p), cf_eight)
#define CF_SIXTEEN_OF(p)           (*(const cf_sixteen_floats *)(p))
#define CF_EIGHT_INTO_FLOATS(p, v) (*(cf_eight_floats *)(p) = __builtin_convertvector(v, cf_eight_floats))
/* As many of cf_real. */
#ifdef CF_SINGLE
#define CF_EIGHT_OF   CF_EIGHT_OF_FLOATS
#define CF_EIGHT_INTO CF_EIGHT_INTO_FLOATS
#else
#define CF_EIGHT_OF         CF_EIGHT_OF_DOUBLES
#define CF_EIGHT_INTO(p, v) (*(cf_eight_doubles *)(p) = (v))
#endif

/* Bytes beside them, as integers, and those values whose byte has a bit, 0 for the others, whatever theirs are. Left to itself the
 * compiler takes as many elements at once as bytes make a vector, and does rows shorter than that one by one. */
typedef int32_t cf_sixteen_ints __attribute__((vector_size(64)));
typedef unsigned char cf_eight_bytes __attribute__((vector_size(8), aligned(1), may_alias));
typedef unsigned char cf_sixteen_bytes __attribute__((vector_size(16), aligned(1), may_alias));

/* Step by step: at once, bytes would be taken one after the other. */
typedef uint16_t cf_eight_words __attribute__((vector_size(16)));
typedef uint32_t cf_eight_halves __attribute__((vector_size(32)));
typedef uint16_t cf_sixteen_words __attribute__((vector_size(32)));
#define CF_EIGHT_OF_BYTES(p)                                                                         \
  __builtin_convertvector(                                                                           \
      __builtin_convertvector(__builtin_convertvector(*(const cf_eight_bytes *)(p), cf_eight_words), \
                              cf_eight_halves),                                                      \
      cf_eight_bits)
#define CF_SIXTEEN_OF_BYTES(p)                                                                       \
  __builtin_convertvector(__builtin_convertvector(*(const cf_sixteen_bytes *)(p), cf_sixteen_words), \
                          cf_sixteen_ints)
#define CF_EIGHT_WHERE(ints, bit, value)   ((cf_eight)((cf_eight_bits)(value) & (((ints) & (bit)) != 0)))
#define CF_SIXTEEN_WHERE(ints, bit, value) ((cf_sixteen)((cf_sixteen_ints)(value) & (((ints) & (bit)) != 0)))

/* a0 b0 a1 b1 ...: the first half of them, and the second. */
#define CF_EIGHT_WOVEN_LOW(a, b)  __builtin_shufflevector(a, b, 0, 8, 1, 9, 2, 10, 3, 11)
#define CF_EIGHT_WOVEN_HIGH(a, b) __builtin_shufflevector(a, b, 4, 12, 5, 13, 6, 14, 7, 15)
#define CF_SIXTEEN_WOVEN_LOW(a, b) \
  __builtin_shufflevector(a, b, 0, 16, 1, 17, 2, 18, 3, 19, 4, 20, 5, 21, 6, 22, 7, 23)
#define CF_SIXTEEN_WOVEN_HIGH(a, b) \
  __builtin_shufflevector(a, b, 8, 24, 9, 25, 10, 26, 11, 27, 12, 28, 13, 29, 14, 30, 15, 31)
/* Of sixteen in a row, a and then b, those with even places, and those with odd ones. */
#define CF_EIGHT_EVEN(a, b) __builtin_shufflevector(a, b, 0, 2, 4, 6, 8, 10, 12, 14)
#define CF_EIGHT_ODD(a, b)  __builtin_shufflevector(a, b, 1, 3, 5, 7, 9, 11, 13, 15)

#endif
