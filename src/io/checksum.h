/* SPDX-License-Identifier: MIT
 *
 * A 64-bit checksum of a stream of bytes, against accidents (a flipped bit, a lost block), not against
 * malice.
 *
 * The stream is read as 64-bit words dealt out to four lanes; each lane does
 *
 *     h <- (h xor word) * odd,   h <- h xor (h >> 29)
 *
 * which is one to one in h and in the word: a change within one word can never be lost. The end folds in the
 * length and mixes the lanes. The result depends on the bytes alone, not on the pieces they came in.
 */
#ifndef CF_IO_CHECKSUM_H
#define CF_IO_CHECKSUM_H

#include <stddef.h>
#include <stdint.h>

typedef struct cf_checksum {
  uint64_t lane[4];
  uint64_t bytes;         /* so far */
  unsigned char rest[32]; /* bytes that do not fill a round yet */
} cf_checksum;

void cf_checksum_start(cf_checksum *c);
void cf_checksum_add(cf_checksum *c, const void *bytes, size_t count);
uint64_t cf_checksum_end(const cf_checksum *c); /* may be asked in between */

/* Numbers of `size` bytes (1, 4 or 8), as a little-endian machine has them: the same everywhere. */
void cf_checksum_add_values(cf_checksum *c, const void *values, size_t count, size_t size);

/* Of an array of numbers. */
uint64_t cf_checksum_of(const void *values, size_t count, size_t size);

#endif
