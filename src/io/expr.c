/* SPDX-License-Identifier: MIT
 *
 * Expressions by muParser through its C interface; see expr.h.
 *
 * What that library does by itself and what is done about it here: its _pi is wrong in the 13th digit (pi is
 * defined from M_PI, and no other name gets through); it takes `x = 3` for an assignment and `1, 2` for two values
 * (both refused); it finds errors only when it evaluates (done once at creation); its messages go into one static
 * buffer of 2048 bytes, unchecked (so texts are shorter, and only codes and tokens are asked for, behind a lock);
 * its bulk mode changes the number of OpenMP threads of the caller (not used: one call a point costs the same).
 * Names are looked up first (expr_check.c), so that unknown ones are reported with their place.
 *
 * A parser keeps its variables inside. Threads that evaluate one expression at the same time get one parser
 * each, made at need and kept.
 */
#define _GNU_SOURCE
#include "io/expr.h"

#include <math.h>
#include <muParserDLL.h>
#include <pthread.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "base/real.h"
#include "io/expr_check.h"

/* One parser with the places its variables are read from. */
typedef struct cf_parser {
  muParserHandle_t handle;
  double variable[4];
  struct cf_parser *next;
} cf_parser;

struct cf_expr {
  cf_fn fn;
  char *text;
  int constants;
  char **name;
  double *value;
  pthread_mutex_t lock; /* of `idle` */
  pthread_cond_t given_back;
  cf_parser *idle;
};

static pthread_mutex_t library_lock = PTHREAD_MUTEX_INITIALIZER;

/* --- parsers ---------------------------------------------------------------------------------- */

static void define_all(const cf_expr *expr, cf_parser *parser) {
  const muParserHandle_t handle = parser->handle;
  mupDefineConst(handle, "pi", M_PI);
  for (int i = 0; i < expr->constants; ++i) mupDefineConst(handle, expr->name[i], expr->value[i]);
  for (int i = 0; i < 4; ++i) {
    const char name[2] = {cf_expr_variable_names[i], '\0'};
    mupDefineVar(handle, name, &parser->variable[i]);
  }
  mupDefineFun1(handle, "floor", floor, 1);
  mupDefineFun1(handle, "ceil", ceil, 1);
  mupDefineFun1(handle, "erf", erf, 1);
  mupDefineFun1(handle, "erfc", erfc, 1);
  mupDefineFun2(handle, "fmod", fmod, 1);
  mupDefineFun2(handle, "hypot", hypot, 1);
}

static void parser_destroy(cf_parser *parser) {
  if (parser == NULL) return;
  if (parser->handle != NULL) mupRelease(parser->handle);
  cf_free(parser);
}

static cf_status parser_create(cf_parser **parser, const cf_expr *expr) {
  CF_TRY(CF_NEW(parser, 1));
  pthread_mutex_lock(&library_lock);
  (*parser)->handle = mupCreate(muBASETYPE_FLOAT);
  if ((*parser)->handle != NULL) {
    define_all(expr, *parser);
    mupSetExpr((*parser)->handle, expr->text);
  }
  pthread_mutex_unlock(&library_lock);
  if ((*parser)->handle != NULL) return CF_OK;
  parser_destroy(*parser);
  *parser = NULL;
  return cf_fail(CF_NO_MEMORY, "no memory for an expression");
}

/* What the library found wrong, in our words: its codes (see its error list) and the token it stopped at. */
static void say_error(const int code, const char *token) {
  enum { ENDS = 2, TOO_MANY = 14, TOO_FEW = 15, NO_ELSE = 33, LOST_COLON = 34 };
  if (code == ENDS)
    cf_fail(CF_BAD_ARGUMENT, "the expression ends too early");
  else if (code == TOO_MANY || code == TOO_FEW)
    cf_fail(CF_BAD_ARGUMENT, "the function has the wrong number of arguments");
  else if (code == NO_ELSE || code == LOST_COLON)
    cf_fail(CF_BAD_ARGUMENT, "a choice is written condition ? this : that");
  else if (isinf(strtod(token, NULL)))
    cf_fail(CF_BAD_ARGUMENT, "%s is more than a number can be, 1.8e308", token);
  else if (token[0] != '\0')
    cf_fail(CF_BAD_ARGUMENT, "`%s` may not stand here", token);
  else
    cf_fail(CF_BAD_ARGUMENT, "this is not an expression");
}

static cf_status syntax_error(cf_parser *parser, const char *text, cf_expr_place *place) {
  char token[80];
  const int at = mupGetErrorPos(parser->handle), code = mupGetErrorCode(parser->handle);
  snprintf(token, sizeof token, "%s", mupGetErrorToken(parser->handle));
  mupErrorReset(parser->handle);
  token[strcspn(token, " ")] = '\0';
  say_error(code, token);
  const ptrdiff_t length = (ptrdiff_t)strlen(text), token_length = (ptrdiff_t)strlen(token);
  const bool inside = at >= 0 && at < length;
  const bool there = inside && token_length > 0 && strncmp(text + at, token, (size_t)token_length) == 0;
  return cf_expr_fail_in(place, inside ? at : CF_MAX(length - 1, 0), there ? token_length : 1);
}

/* Evaluates once, which is when the library finds its errors. */
static cf_status first_value(cf_parser *parser, const char *text, double *value, cf_expr_place *place) {
  int count = 0;
  pthread_mutex_lock(&library_lock);
  const double *values = mupEvalMulti(parser->handle, &count);
  cf_status status = CF_OK;
  if (mupError(parser->handle) || values == NULL) {
    status = syntax_error(parser, text, place);
  } else if (count != 1) {
    cf_fail(CF_BAD_ARGUMENT, "these are %d values, one is wanted", count);
    status = cf_expr_fail_in(place, 0, (ptrdiff_t)strlen(text));
  } else {
    *value = values[0];
  }
  pthread_mutex_unlock(&library_lock);
  return status;
}

/* --- evaluation ------------------------------------------------------------------------------- */

static cf_parser *parser_take(cf_expr *expr) {
  pthread_mutex_lock(&expr->lock);
  cf_parser *parser = expr->idle;
  if (parser != NULL) expr->idle = parser->next;
  pthread_mutex_unlock(&expr->lock);
  if (parser != NULL || parser_create(&parser, expr) == CF_OK) return parser;
  /* No memory for another: wait for one that is in use. */
  pthread_mutex_lock(&expr->lock);
  while (expr->idle == NULL) pthread_cond_wait(&expr->given_back, &expr->lock);
  parser = expr->idle;
  expr->idle = parser->next;
  pthread_mutex_unlock(&expr->lock);
  return parser;
}

static void parser_give_back(cf_expr *expr, cf_parser *parser) {
  pthread_mutex_lock(&expr->lock);
  parser->next = expr->idle;
  expr->idle = parser;
  pthread_cond_signal(&expr->given_back);
  pthread_mutex_unlock(&expr->lock);
}

static void eval_row(const void *context, const int n, const double *x, const double *y, const double *z,
                     const double t, double *out) {
  cf_expr *expr = (cf_expr *)(uintptr_t)context; /* the idle parsers change, the function does not */
  cf_parser *parser = parser_take(expr);
  parser->variable[3] = t;
  for (int i = 0; i < n; ++i) {
    parser->variable[0] = x[i];
    parser->variable[1] = y[i];
    parser->variable[2] = z[i];
    out[i] = mupEval(parser->handle);
  }
  parser_give_back(expr, parser);
}

/* --- create and destroy ----------------------------------------------------------------------- */

static cf_status keep_constants(cf_expr *expr, const cf_expr_constants *constants) {
  CF_TRY(CF_NEW(&expr->name, constants->count));
  CF_TRY(CF_NEW(&expr->value, constants->count));
  for (int i = 0; i < constants->count; ++i) {
    CF_TRY(cf_new_text(&expr->name[i], constants->name[i], strlen(constants->name[i])));
    expr->value[i] = constants->value[i];
    expr->constants = i + 1;
  }
  return CF_OK;
}

static cf_status build(cf_expr *expr, const char *text, const cf_expr_constants *constants,
                       const cf_expr_names *names, cf_expr_place *place) {
  double value = 0.0;
  CF_TRY(cf_new_text(&expr->text, text, strlen(text)));
  for (char *c = expr->text; *c != '\0'; ++c)
    if (*c == '\n' || *c == '\t') *c = ' ';
  CF_TRY(keep_constants(expr, constants));
  CF_TRY(parser_create(&expr->idle, expr));
  CF_TRY(first_value(expr->idle, text, &value, place));
  if (names->any_variable)
    expr->fn = (cf_fn){.eval = eval_row, .context = expr, .in_time = names->time};
  else
    expr->fn = cf_fn_constant(value);
  return CF_OK;
}

cf_status cf_expr_create(cf_expr **expr, const char *text, const cf_expr_constants *constants,
                         const cf_expr_variables variables, cf_expr_place *place) {
  const cf_expr_constants none = {0};
  cf_expr_names names;
  *expr = NULL;
  if (place != NULL) *place = (cf_expr_place){0, (int)strlen(text)};
  if (constants == NULL) constants = &none;
  CF_TRY(cf_expr_check(text, constants, variables, &names, place));
  cf_expr *fresh;
  CF_TRY(CF_NEW(&fresh, 1));
  pthread_mutex_init(&fresh->lock, NULL);
  pthread_cond_init(&fresh->given_back, NULL);
  const cf_status status = build(fresh, text, constants, &names, place);
  if (status != CF_OK) {
    cf_expr_destroy(fresh);
    return status;
  }
  *expr = fresh;
  return CF_OK;
}

void cf_expr_destroy(cf_expr *expr) {
  if (expr == NULL) return;
  for (cf_parser *parser = expr->idle, *next; parser != NULL; parser = next) {
    next = parser->next;
    parser_destroy(parser);
  }
  for (int i = 0; i < expr->constants; ++i) cf_free(expr->name[i]);
  cf_free(expr->name);
  cf_free(expr->value);
  cf_free(expr->text);
  pthread_mutex_destroy(&expr->lock);
  pthread_cond_destroy(&expr->given_back);
  cf_free(expr);
}

cf_fn cf_expr_fn(const cf_expr *expr) { return expr->fn; }
