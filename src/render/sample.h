/* SPDX-License-Identifier: MIT
 *
 * Where a pixel's samples lie: pairs of numbers in [0, 1), the same for any number of threads, because sample i of
 * pixel p is a function of (p, i) and of what the pair is for (pixel, lens, light ...).
 *
 * Each pair is the first two dimensions of Sobol's sequence (1967), scrambled as Owen does (1995) by hashing bits from
 * the top down (Laine, Karras 2011; Burley 2020), with the order of the samples scrambled as well, so that different
 * pairs know nothing of each other. Any 2^m samples are spread evenly, in every pair.
 */
#ifndef CF_RENDER_SAMPLE_H
#define CF_RENDER_SAMPLE_H

#include <stdint.h>

#include "base/rng.h"
#include "render/vec.h"

typedef struct cf_dice {
  uint64_t pixel;
  uint32_t sample;
  uint32_t pair; /* counts the pairs taken */
} cf_dice;

static inline uint32_t cf_bits_turned(uint32_t v) {
  v = (v >> 16) | (v << 16);
  v = (v & 0x00ff00ffu) << 8 | (v & 0xff00ff00u) >> 8;
  v = (v & 0x0f0f0f0fu) << 4 | (v & 0xf0f0f0f0u) >> 4;
  v = (v & 0x33333333u) << 2 | (v & 0xccccccccu) >> 2;
  return (v & 0x55555555u) << 1 | (v & 0xaaaaaaaau) >> 1;
}

/* Owen's scrambling of a number in [0, 2^32): every bit is flipped or not by a hash of the bits above it. On turned
 * numbers that is a hash in which bits act upwards only: products with even numbers and sums. */
static inline uint32_t cf_bits_scrambled(uint32_t v, const uint32_t seed) {
  v = cf_bits_turned(v);
  v ^= v * 0x3d20adeau;
  v += seed;
  v *= (seed >> 16) | 1;
  v ^= v * 0x05526c56u;
  v ^= v * 0x53a22864u;
  return cf_bits_turned(v);
}

/* The second dimension of Sobol's sequence; its matrix is Pascal's triangle modulo 2. */
static inline uint32_t cf_sobol_second(uint32_t i) {
  uint32_t v = 1u << 31, sum = 0;
  for (; i != 0; i >>= 1, v ^= v >> 1)
    if (i & 1) sum ^= v;
  return sum;
}

/* The next pair of this sample. */
static inline void cf_dice_pair(cf_dice *d, float at[2]) {
  const uint64_t seed = cf_random_mix(d->pixel ^ (uint64_t)d->pair++ << 40);
  const uint32_t i = cf_bits_scrambled(d->sample, (uint32_t)seed);
  const uint32_t x = cf_bits_scrambled(cf_bits_turned(i), (uint32_t)(seed >> 32));
  const uint32_t y = cf_bits_scrambled(cf_sobol_second(i), (uint32_t)cf_random_mix(seed));
  at[0] = (float)(x >> 8) * 0x1p-24f;
  at[1] = (float)(y >> 8) * 0x1p-24f;
}

static inline float cf_dice_one(cf_dice *d) {
  float at[2];
  cf_dice_pair(d, at);
  return at[0];
}

/* A pair as a point of the unit disc, areas kept (Shirley, Chiu 1997). */
static inline void cf_sample_disc(const float at[2], float disc[2]) {
  const float a = 2 * at[0] - 1, b = 2 * at[1] - 1;
  if (a == 0 && b == 0) {
    disc[0] = disc[1] = 0;
    return;
  }
  const int flat = fabsf(a) > fabsf(b);
  const float r = flat ? a : b, quarter = 0.785398163f;
  const float angle = flat ? quarter * (b / a) : 2 * quarter - quarter * (a / b);
  disc[0] = r * cosf(angle);
  disc[1] = r * sinf(angle);
}

/* A pair as a direction about n, with the cosine's density. */
static inline cf_vec cf_sample_cosine(const float at[2], const cf_vec n) {
  float disc[2];
  cf_vec s, t;
  cf_sample_disc(at, disc);
  cf_vec_frame(n, &s, &t);
  const float up = sqrtf(fmaxf(0, 1 - disc[0] * disc[0] - disc[1] * disc[1]));
  return cf_vec_along(cf_vec_along(cf_vec_scale(up, n), disc[0], s), disc[1], t);
}

#endif
