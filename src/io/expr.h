/* SPDX-License-Identifier: MIT
 *
 * Expressions: text such as "0.5*(1 + sin(pi*x)) * (t < 2 ? 1 : 0)" made into a cf_fn of x, y, z and t.
 *
 * What may stand in one: numbers, + - * / ^, comparisons, && ||, C ? A : B, parentheses, the constant pi, the
 * constants handed in, and the functions of CF_EXPR_FUNCTIONS. No assignment, one value only.
 *
 * An expression in which no variable stands becomes a constant cf_fn. Evaluation goes by rows and may go on in several
 * threads at the same time. About 40 ns a point: sample what does not depend on t once (cf_fn.in_time says).
 */
#ifndef CF_IO_EXPR_H
#define CF_IO_EXPR_H

#include <stdbool.h>

#include "base/fn.h"
#include "base/status.h"

#define CF_EXPR_FUNCTIONS                                                                         \
  "sin cos tan asin acos atan atan2 sinh cosh tanh asinh acosh atanh exp log2 log10 log ln sqrt " \
  "sign rint abs floor ceil erf erfc fmod hypot min max sum avg"

/* The names that stand for numbers. */
typedef struct cf_expr_constants {
  int count;
  const char *const *name;
  const double *value;
} cf_expr_constants;

typedef struct cf_expr cf_expr;

/* Which variables an expression may use. */
typedef enum cf_expr_variables { CF_EXPR_NO_VARIABLES, CF_EXPR_SPACE, CF_EXPR_SPACE_TIME } cf_expr_variables;

/* Where in the text an error is (bytes from its start). */
typedef struct cf_expr_place {
  int at, length;
} cf_expr_place;

/* Compiles `text`. CF_BAD_ARGUMENT: the sentence says what is wrong with it, `place` (may be NULL) where. */
cf_status cf_expr_create(cf_expr **expr, const char *text, const cf_expr_constants *constants,
                         cf_expr_variables variables, cf_expr_place *place);
void cf_expr_destroy(cf_expr *expr); /* NULL is fine */

/* The function; it lives as long as the expression (a constant one needs nothing any more). */
cf_fn cf_expr_fn(const cf_expr *expr);

/* Whether `name` may be the name of a constant: letters, digits, _, not starting with a digit, and none of
 * the variables, functions and pi. CF_BAD_ARGUMENT says why not. */
cf_status cf_expr_name_check(const char *name);

#endif
