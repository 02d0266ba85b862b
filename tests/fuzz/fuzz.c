/* SPDX-License-Identifier: MIT
 *
 * One of the readers under libFuzzer: compiled once for each, with -DFUZZ_TARGET="scene".
 */
#include <string.h>

#include "targets.h"

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size);
const char *__lsan_default_suppressions(void);

/* The parser of udunits2 forgets a word or two of a unit that it does not understand; HDF5 1.10 what it had read of a file
 * that it gives up on; libfyaml 0.7 the list of pieces of a text in single quotes that has five quotes in it (the tests
 * have no such text, and watch for what we forget of a document ourselves). */
const char *__lsan_default_suppressions(void) { return "leak:libudunits2\nleak:libhdf5\nleak:libfyaml\n"; }

int LLVMFuzzerTestOneInput(const uint8_t *bytes, const size_t size) {
  for (const target *t = targets; t->name != NULL; ++t)
    if (strcmp(t->name, FUZZ_TARGET) == 0) t->read(bytes, size);
  return 0;
}
