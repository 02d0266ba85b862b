/* SPDX-License-Identifier: MIT */
#include "io/checksum.h"

#include <string.h>

#include "base/real.h"

#define ROUND 32

/* Odd numbers with well spread bits. */
static const uint64_t odd[4] = {0x9fb21c651e98df25u, 0xa24baed4963ee407u, 0xd6e8feb86659fd93u,
                                0xc2b2ae3d27d4eb4fu};

static uint64_t step(const uint64_t h, const uint64_t word, const uint64_t factor) {
  const uint64_t mixed = (h ^ word) * factor;
  return mixed ^ (mixed >> 29);
}

/* Little-endian whatever the machine; compilers make one load of it. */
static uint64_t word_at(const unsigned char *b) {
  uint64_t word = 0;
  for (int i = 0; i < 8; ++i) word |= (uint64_t)b[i] << 8 * i;
  return word;
}

static void add_round(uint64_t lane[4], const unsigned char *bytes) {
  for (int l = 0; l < 4; ++l) lane[l] = step(lane[l], word_at(bytes + 8 * l), odd[l]);
}

void cf_checksum_start(cf_checksum *c) {
  *c = (cf_checksum){.bytes = 0};
  for (int l = 0; l < 4; ++l) c->lane[l] = odd[3 - l];
}

void cf_checksum_add(cf_checksum *c, const void *bytes, size_t count) {
  const unsigned char *at = bytes;
  const size_t held = (size_t)(c->bytes % ROUND);
  c->bytes += count;
  if (held > 0) {
    const size_t some = CF_MIN(count, ROUND - held);
    memcpy(c->rest + held, at, some);
    if (held + some < ROUND) return;
    add_round(c->lane, c->rest);
    at += some;
    count -= some;
  }
  uint64_t lane[4]; /* kept in registers */
  memcpy(lane, c->lane, sizeof lane);
  for (; count >= ROUND; at += ROUND, count -= ROUND) add_round(lane, at);
  memcpy(c->lane, lane, sizeof lane);
  if (count > 0) memcpy(c->rest, at, count);
}

uint64_t cf_checksum_end(const cf_checksum *c) {
  uint64_t lane[4];
  memcpy(lane, c->lane, sizeof lane);
  unsigned char last[ROUND] = {0};
  memcpy(last, c->rest, (size_t)(c->bytes % ROUND));
  add_round(lane, last);
  uint64_t h = c->bytes;
  for (int l = 0; l < 4; ++l) h = step(h, lane[l], odd[l]);
  h ^= h >> 32;
  h *= odd[0];
  return h ^ (h >> 31);
}

void cf_checksum_add_values(cf_checksum *c, const void *values, const size_t count, const size_t size) {
#if __BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__
  cf_checksum_add(c, values, count * size);
#else
  const unsigned char *at = values;
  for (size_t i = 0; i < count; ++i, at += size) {
    unsigned char turned[8];
    for (size_t b = 0; b < size; ++b) turned[b] = at[size - 1 - b];
    cf_checksum_add(c, turned, size);
  }
#endif
}

uint64_t cf_checksum_of(const void *values, const size_t count, const size_t size) {
  cf_checksum c;
  cf_checksum_start(&c);
  cf_checksum_add_values(&c, values, count, size);
  return cf_checksum_end(&c);
}
