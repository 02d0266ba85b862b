/* SPDX-License-Identifier: MIT
 *
 *     replay TARGET TURNS FILE...
 *
 * Every file through the reader, then TURNS changes of each: bits flipped, pieces cut out, doubled and exchanged, and
 * numbers replaced by extreme ones. The changes are the same in every run; any compiler will do.
 */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "targets.h"

enum { LARGEST = 1 << 20 };

static uint64_t state = 1;

static size_t below(const size_t n) {
  state = state * 6364136223846793005u + 1442695040888963407u;
  return n > 0 ? (size_t)((state >> 33) % n) : 0;
}

static size_t insert(uint8_t *bytes, const size_t size, const size_t at, const void *what,
                     const size_t length) {
  if (size + length > LARGEST) return size;
  memmove(bytes + at + length, bytes + at, size - at);
  memmove(bytes + at, what, length);
  return size + length;
}

static size_t change(uint8_t *bytes, const size_t size) {
  static const char *const words[] = {"1e999", "-1", "nan",   "0",    "99999999999999999999",
                                      "[[",    "{",  "*a",    "&a",   "\"",
                                      "\n",    ": ", "(",     "?",    "1/0",
                                      "^",     "x",  "m^2/s", "\xff", "-2147483648",
                                      "#"};
  const size_t at = below(size), length = 1 + below(size - at > 64 ? 64 : size - at);
  switch (below(5)) {
    case 0:
      if (size > 0) bytes[at] ^= (uint8_t)(1u << below(8));
      return size;
    case 1:
      if (size < length) return size;
      memmove(bytes + at, bytes + at + length, size - at - length);
      return size - length;
    case 2: {
      uint8_t piece[64];
      if (size < length) return size;
      memcpy(piece, bytes + at, length);
      return insert(bytes, size, below(size), piece, length);
    }
    case 3:
      return size - below(size);
    default: {
      const char *word = words[below(sizeof words / sizeof *words)];
      return insert(bytes, size, at, word, strlen(word));
    }
  }
}

static size_t load(const char *path, uint8_t *bytes) {
  FILE *file = fopen(path, "rb");
  if (file == NULL) {
    fprintf(stderr, "%s: cannot be read\n", path);
    exit(1);
  }
  const size_t size = fread(bytes, 1, LARGEST, file);
  fclose(file);
  return size;
}

int main(const int argc, char **argv) {
  static uint8_t seed[LARGEST], bytes[LARGEST];
  const target *t = targets;
  while (argc > 3 && t->name != NULL && strcmp(t->name, argv[1]) != 0) ++t;
  if (argc < 4 || t->name == NULL) {
    fprintf(stderr, "usage: replay TARGET TURNS FILE...\n");
    return 2;
  }
  const long turns = atol(argv[2]);
  for (int i = 3; i < argc; ++i) {
    const size_t size = load(argv[i], seed);
    t->read(seed, size);
    for (long turn = 0; turn < turns; ++turn) {
      memcpy(bytes, seed, size);
      size_t now = size;
      for (size_t changes = 1 + below(4); changes > 0; --changes) now = change(bytes, now);
      t->read(bytes, now);
    }
  }
  printf("%s: %d files, %ld changes of each\n", t->name, argc - 3, turns);
  return 0;
}
