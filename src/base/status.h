/* SPDX-License-Identifier: MIT
 *
 * How a function says that it failed: a code from one list, and a sentence with the values.
 *
 *     return cf_fail(CF_BAD_ARGUMENT, "tau = %g s: must be >= 0", tau);
 *     CF_TRY(cf_cell_create(&phi, &grid->box));           // passes a failure up
 *
 * The codes, and how a caller reads the sentence, are in cattaneo.h. It is kept per thread, like errno.
 */
#ifndef CF_BASE_STATUS_H
#define CF_BASE_STATUS_H

#include "cattaneo.h"

#define CF_SENTENCE_MAX 1024

#if defined(__GNUC__)
#define CF_PRINTF(text, first) __attribute__((format(printf, text, first)))
#else
#define CF_PRINTF(text, first)
#endif

/* Keeps the sentence for this thread and returns `code`. */
cf_status cf_fail(cf_status code, const char *format, ...) CF_PRINTF(2, 3);

#define CF_TRY(call)                      \
  do {                                    \
    const cf_status cf_try_ = (call);     \
    if (cf_try_ != CF_OK) return cf_try_; \
  } while (0)

#endif
