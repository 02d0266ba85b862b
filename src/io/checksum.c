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

static void add_round(uint64_t lane[4], const unsigned char *bytes) {
  uint64_t word[4];
  memcpy(word, bytes, ROUND);
  for (int l = 0; l < 4; ++l) lane[l] = step(lane[l], word[l], odd[l]);
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

uint64_t cf_checksum_of(const void *bytes, const size_t count) {
  cf_checksum c;
  cf_checksum_start(&c);
  cf_checksum_add(&c, bytes, count);
  return cf_checksum_end(&c);
}
