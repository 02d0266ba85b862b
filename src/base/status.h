/* SPDX-License-Identifier: MIT
 *
 * How a function says that it failed: a code from one list, and a sentence with the values.
 *
 *     return cf_fail(CF_BAD_ARGUMENT, "tau = %g s: must be >= 0", tau);
 *     CF_TRY(cf_cell_create(&phi, &grid->box));           // passes a failure up
 *
 * The sentence is kept per thread, like errno, and is read with cf_status_sentence() by whoever
 * talks to the user. The library itself never prints and never exits.
 */
#ifndef CF_BASE_STATUS_H
#define CF_BASE_STATUS_H

/* name, exit code of the program, what it means */
#define CF_STATUS_LIST(S)                                                 \
  S(OK, 0, "done")                                                        \
  S(FAILED, 1, "an operation failed")                                     \
  S(BAD_ARGUMENT, 2, "a value was out of range or did not fit")           \
  S(BAD_SCENE, 2, "the scene has an error")                               \
  S(BAD_USAGE, 2, "the command line has an error")                        \
  S(NOT_CONVERGED, 3, "the solver did not converge")                      \
  S(NOT_FINITE, 4, "a value stopped being finite")                        \
  S(NO_MEMORY, 5, "memory or address space ran out")                      \
  S(OVER_LIMIT, 5, "a limit set by the user or the machine was reached")  \
  S(BAD_FILE, 1, "a file could not be read, or is not what it should be") \
  S(CANNOT_WRITE, 1, "a file could not be written")                       \
  S(STOPPED, 130, "stopped on request")

typedef enum cf_status {
#define CF_STATUS_ENUM(name, exit_code, meaning) CF_##name,
  CF_STATUS_LIST(CF_STATUS_ENUM)
#undef CF_STATUS_ENUM
} cf_status;

#define CF_SENTENCE_MAX 1024

#if defined(__GNUC__)
#define CF_PRINTF(text, first) __attribute__((format(printf, text, first)))
#else
#define CF_PRINTF(text, first)
#endif

/* Keeps the sentence for this thread and returns `code`. */
cf_status cf_fail(cf_status code, const char *format, ...) CF_PRINTF(2, 3);

/* The sentence of this thread's latest failure; "" if there was none. */
const char *cf_status_sentence(void);

const char *cf_status_name(cf_status code);
int cf_status_exit_code(cf_status code);

#define CF_TRY(call)                      \
  do {                                    \
    const cf_status cf_try_ = (call);     \
    if (cf_try_ != CF_OK) return cf_try_; \
  } while (0)

#endif
