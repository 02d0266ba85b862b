/* SPDX-License-Identifier: MIT
 *
 * The readers that are fuzzed; see targets.c.
 */
#ifndef CF_TESTS_FUZZ_TARGETS_H
#define CF_TESTS_FUZZ_TARGETS_H

#include <stddef.h>
#include <stdint.h>

#define TARGETS(T) \
  T(scene) T(override) T(expression) T(unit) T(checkpoint) T(frame) T(ply) T(obj) T(image) T(npy) T(atlas)

typedef struct target {
  const char *name;
  void (*read)(const uint8_t *bytes, size_t size);
} target;

extern const target targets[]; /* ends with a row without a name */

#endif
