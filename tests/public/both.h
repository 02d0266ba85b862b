/* SPDX-License-Identifier: MIT
 *
 * What the halves of the program both.cpp tell each other; no type of the library, for those depend on precision.
 */
#ifndef CF_TESTS_BOTH_H
#define CF_TESTS_BOTH_H

#include <stdbool.h>
#include <stddef.h>

typedef struct both_result {
  size_t size; /* of cf_real */
  bool ok, refused;
  double x;
  const char *sentence;
} both_result;

#ifdef __cplusplus
extern "C" {
#endif
both_result run_single(void);
both_result run_double(void);
#ifdef __cplusplus
}
#endif

#endif
