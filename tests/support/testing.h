/* SPDX-License-Identifier: MIT
 *
 * What every test program includes: cmocka with what it needs, and a deterministic source of numbers.
 */
#ifndef CF_TESTS_TESTING_H
#define CF_TESTS_TESTING_H

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "base/status.h"

/* A call that must succeed; the sentence is shown where it does not. */
#define OK(call)                                                                     \
  do {                                                                               \
    const cf_status ok_ = (call);                                                    \
    if (ok_ != CF_OK) fail_msg("%s: %s", cf_status_name(ok_), cf_status_sentence()); \
  } while (0)

/* |a - b| <= tolerance, said with all digits. */
#define CLOSE(a, b, tolerance)                                                                     \
  do {                                                                                             \
    const double a_ = (double)(a), b_ = (double)(b), t_ = (double)(tolerance);                     \
    if (!(a_ - b_ <= t_ && b_ - a_ <= t_))                                                         \
      fail_msg("%s = %.17g, expected %.17g, off by %.3g (allowed %.3g)", #a, a_, b_, a_ - b_, t_); \
  } while (0)

#define BELOW(a, bound)                                                       \
  do {                                                                        \
    const double a_ = (double)(a), b_ = (double)(bound);                      \
    if (!(a_ <= b_)) fail_msg("%s = %.6g: must be at most %.6g", #a, a_, b_); \
  } while (0)

/* Whether a sanitizer or valgrind watches over memory, and so takes and gives address space of its own. */
static inline int test_memory_is_watched(void) {
#ifdef __SANITIZE_ADDRESS__
  return 1;
#else
  const char *preloaded = getenv("LD_PRELOAD");
  return getenv("SANITIZED") != NULL || (preloaded != NULL && strstr(preloaded, "vgpreload") != NULL);
#endif
}

/* Uniform in [0, 1). */
static inline double test_random(uint64_t *state) {
  *state = *state * 6364136223846793005u + 1442695040888963407u;
  return (double)(*state >> 11) / 9007199254740992.0;
}

#endif
