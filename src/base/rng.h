/* SPDX-License-Identifier: MIT
 *
 * Counted random numbers: not drawn one after another from a state, but a function of what they are for,
 *
 *     cf_random(seed, stream, step, cell)   in [0, 1),
 *
 * so they are the same for any number of threads, for any order of cells, and after a stop and a resume. Every
 * number passes each count through the finalizer of SplitMix64 (Steele, Lea, Flood 2014). Not for secrets.
 */
#ifndef CF_BASE_RNG_H
#define CF_BASE_RNG_H

#include <stdint.h>

/* Every bit of v reaches every bit of the result; one to one. */
static inline uint64_t cf_random_mix(uint64_t v) {
  v += UINT64_C(0x9e3779b97f4a7c15);
  v = (v ^ (v >> 30)) * UINT64_C(0xbf58476d1ce4e5b9);
  v = (v ^ (v >> 27)) * UINT64_C(0x94d049bb133111eb);
  return v ^ (v >> 31);
}

/* The part of a number that cells have in common. */
static inline uint64_t cf_random_key(const uint64_t seed, const uint64_t stream, const uint64_t step) {
  return cf_random_mix(cf_random_mix(cf_random_mix(seed) ^ stream) ^ step);
}

/* In [0, 1), a multiple of 2^-53. */
static inline double cf_random_at(const uint64_t key, const uint64_t cell) {
  return (double)(cf_random_mix(key ^ cell) >> 11) * 0x1p-53;
}

static inline uint64_t cf_random_bits(const uint64_t seed, const uint64_t stream, const uint64_t step,
                                      const uint64_t cell) {
  return cf_random_mix(cf_random_key(seed, stream, step) ^ cell);
}

static inline double cf_random(const uint64_t seed, const uint64_t stream, const uint64_t step,
                               const uint64_t cell) {
  return cf_random_at(cf_random_key(seed, stream, step), cell);
}

#endif
