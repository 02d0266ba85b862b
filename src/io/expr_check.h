/* SPDX-License-Identifier: MIT
 *
 * The text of an expression, checked before the parser sees it. Inside io only.
 */
#ifndef CF_IO_EXPR_CHECK_H
#define CF_IO_EXPR_CHECK_H

#include <stdbool.h>
#include <stddef.h>

#include "base/status.h"
#include "io/expr.h"

/* Longer texts are refused: the parser's C interface has buffers of 2048 bytes that it does not check. */
#define CF_EXPR_TEXT_MAX 2000

extern const char cf_expr_variable_names[4]; /* x, y, z, t */

/* What is found about the names in a text. */
typedef struct cf_expr_names {
  bool any_variable, time;
} cf_expr_names;

/* CF_BAD_ARGUMENT: the sentence says what is wrong, `place` (may be NULL) where. */
cf_status cf_expr_check(const char *text, const cf_expr_constants *constants, cf_expr_variables variables,
                        cf_expr_names *names, cf_expr_place *place);

/* Sets the place of an error whose sentence is already kept, and returns CF_BAD_ARGUMENT. */
cf_status cf_expr_fail_in(cf_expr_place *place, ptrdiff_t at, ptrdiff_t length);

#endif
