/* SPDX-License-Identifier: MIT
 *
 * Expressions by muParser through its C interface; see expr.h.
 *
 * What that library does by itself and what is done about it here: its _pi is wrong in the 13th digit (pi is
 * defined from M_PI, and no other name gets through); it takes `x = 3` for an assignment and `1, 2` for two values
 * (both refused); it finds errors only when it evaluates (done once at creation); its messages go into one static
 * buffer of 2048 bytes, unchecked (so texts are shorter, and only codes and tokens are asked for, behind a lock);
 * its bulk mode changes the number of OpenMP threads of the caller (not used: one call a point costs the same).
 * Names are looked up here first, so that unknown ones are reported with their place.
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
#include <string.h>

#include "base/mem.h"
#include "base/param.h"
#include "base/real.h"

enum { NAME_MAX_LENGTH = 63, TEXT_MAX = 2000, NEST_MAX = 200 };

static const char variable_names[4] = {'x', 'y', 'z', 't'};

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

/* What is found about the names in a text. */
typedef struct cf_names {
  bool any_variable, time;
} cf_names;

static pthread_mutex_t library_lock = PTHREAD_MUTEX_INITIALIZER;

static cf_status fail_in(cf_expr_place *place, const ptrdiff_t at, const ptrdiff_t length) {
  if (place != NULL) *place = (cf_expr_place){(int)at, (int)length};
  return CF_BAD_ARGUMENT;
}

/* --- names ---------------------------------------------------------------------------------------------- */

/* Letters and digits of ASCII, whatever the locale of the caller. */
static bool is_digit(const char c) { return c >= '0' && c <= '9'; }
static bool is_start(const char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_'; }
static bool is_name(const char c) { return is_start(c) || is_digit(c); }

static bool listed(const char *list, const char *name, const size_t length) {
  for (const char *at = list; *at != '\0';) {
    const size_t n = strcspn(at, " ");
    if (n == length && memcmp(at, name, n) == 0) return true;
    at += n + (at[n] == ' ' ? 1 : 0);
  }
  return false;
}

static int variable_index(const char *name, const size_t length) {
  for (int i = 0; i < 4; ++i)
    if (length == 1 && name[0] == variable_names[i]) return i;
  return -1;
}

static bool is_constant(const cf_expr_constants *constants, const char *name, const size_t length) {
  if (length == 2 && memcmp(name, "pi", 2) == 0) return true;
  for (int i = 0; i < constants->count; ++i)
    if (strlen(constants->name[i]) == length && memcmp(constants->name[i], name, length) == 0) return true;
  return false;
}

cf_status cf_expr_name_check(const char *name) {
  const size_t length = strlen(name);
  if (length == 0 || !is_start(name[0])) return cf_fail(CF_BAD_ARGUMENT, "a name starts with a letter");
  for (size_t i = 0; i < length; ++i)
    if (!is_name(name[i])) return cf_fail(CF_BAD_ARGUMENT, "a name is made of letters, digits and _");
  if (length > NAME_MAX_LENGTH)
    return cf_fail(CF_BAD_ARGUMENT, "a name has at most %d letters", NAME_MAX_LENGTH);
  if (variable_index(name, length) >= 0) return cf_fail(CF_BAD_ARGUMENT, "x, y, z and t are place and time");
  const cf_expr_constants none = {0};
  if (is_constant(&none, name, length)) return cf_fail(CF_BAD_ARGUMENT, "pi has its value");
  if (listed(CF_EXPR_FUNCTIONS, name, length)) return cf_fail(CF_BAD_ARGUMENT, "%s is a function", name);
  return CF_OK;
}

static const char *nearest_constant(const cf_expr_constants *constants, const char *name) {
  const char *best = NULL;
  int least = 0;
  for (int i = 0; i < constants->count; ++i) {
    const int distance = cf_param_distance(name, constants->name[i]);
    if (distance < 0 || (best != NULL && distance >= least)) continue;
    best = constants->name[i];
    least = distance;
  }
  return best;
}

/* The function that is most like `name`, written to `best`. */
static const char *nearest_function(const char *name, char *best) {
  int least = -1;
  for (const char *at = CF_EXPR_FUNCTIONS; *at != '\0';) {
    char each[NAME_MAX_LENGTH + 1];
    const size_t n = strcspn(at, " ");
    memcpy(each, at, n);
    each[n] = '\0';
    const int distance = cf_param_distance(name, each);
    if (distance >= 0 && (least < 0 || distance < least)) {
      memcpy(best, each, n + 1);
      least = distance;
    }
    at += n + (at[n] == ' ' ? 1 : 0);
  }
  return least >= 0 ? best : NULL;
}

/* A name with a parenthesis behind it was meant as a function, any other as a constant. */
static cf_status unknown_name(const cf_expr_constants *constants, const char *name, const size_t length) {
  char copy[NAME_MAX_LENGTH + 1], function[NAME_MAX_LENGTH + 1];
  if (length > NAME_MAX_LENGTH) return cf_fail(CF_BAD_ARGUMENT, "%.60s... is not known", name);
  memcpy(copy, name, length);
  copy[length] = '\0';
  const bool called = name[length + strspn(name + length, " ")] == '(';
  const char *meant = called ? nearest_function(copy, function) : nearest_constant(constants, copy);
  if (meant != NULL) return cf_fail(CF_BAD_ARGUMENT, "%s is not known: did you mean %s?", copy, meant);
  if (called) return cf_fail(CF_BAD_ARGUMENT, "there is no function %s", copy);
  return cf_fail(CF_BAD_ARGUMENT, "%s is not known (names for numbers go under let)", copy);
}

static cf_status check_name(const char *text, const size_t at, const size_t length,
                            const cf_expr_constants *constants, const cf_expr_variables variables,
                            cf_names *names) {
  const char *name = text + at;
  const int variable = variable_index(name, length);
  if (variable < 0) {
    if (is_constant(constants, name, length) || listed(CF_EXPR_FUNCTIONS, name, length)) return CF_OK;
    return unknown_name(constants, name, length);
  }
  if (variables == CF_EXPR_NO_VARIABLES)
    return cf_fail(CF_BAD_ARGUMENT, "%c may not stand here: a number is wanted", *name);
  if (variable == 3 && variables == CF_EXPR_SPACE)
    return cf_fail(CF_BAD_ARGUMENT, "t may not stand here: an expression in x, y, z is wanted");
  names->any_variable = true;
  if (variable == 3) names->time = true;
  return CF_OK;
}

/* --- the text, before the library sees it
 * ------------------------------------------------------------------- */

/* A single '=' would assign. */
static bool assigns(const char *text, const size_t i) {
  if (text[i] != '=') return false;
  const bool compared = i > 0 && strchr("=<>!", text[i - 1]) != NULL;
  return !compared && text[i + 1] != '=';
}

/* The parentheses that are open at a place of the text. */
typedef struct cf_nest {
  int depth;
  size_t opened[NEST_MAX];
} cf_nest;

static cf_status check_nest(const char c, const size_t i, cf_nest *nest) {
  if (c == ')' && nest->depth == 0) return cf_fail(CF_BAD_ARGUMENT, "this parenthesis was not opened");
  if (c == ')') --nest->depth;
  if (c != '(') return CF_OK;
  if (nest->depth == NEST_MAX)
    return cf_fail(CF_BAD_ARGUMENT, "more than %d parentheses inside each other", NEST_MAX);
  nest->opened[nest->depth++] = i;
  return CF_OK;
}

static cf_status check_character(const char *text, const size_t i, cf_nest *nest) {
  const char c = text[i];
  if (assigns(text, i)) return cf_fail(CF_BAD_ARGUMENT, "= is not for expressions (to compare: ==)");
  if (c == '*' && text[i + 1] == '*')
    return cf_fail(CF_BAD_ARGUMENT, "** is not known: powers are written ^");
  if (c == '%') return cf_fail(CF_BAD_ARGUMENT, "%% is not known: the remainder is fmod(a, b)");
  if (strchr(" \t\n+-*/^()<>=!&|?:,.", c) == NULL) {
    int length = 1; /* of a character of several bytes */
    while (((unsigned char)text[i + (size_t)length] & 0xC0u) == 0x80u) ++length;
    return cf_fail(CF_BAD_ARGUMENT, "`%.*s` may not stand in an expression", length, text + i);
  }
  return check_nest(c, i, nest);
}

static size_t number_length(const char *text) {
  size_t n = strspn(text, "0123456789.");
  if (text[n] == 'e' || text[n] == 'E') {
    const size_t sign = text[n + 1] == '+' || text[n + 1] == '-' ? 1 : 0;
    const size_t digits = strspn(text + n + 1 + sign, "0123456789");
    if (digits > 0) n += 1 + sign + digits;
  }
  return n;
}

static cf_status check_text(const char *text, const cf_expr_constants *constants,
                            const cf_expr_variables variables, cf_names *names, cf_expr_place *place) {
  const size_t length = strlen(text);
  cf_nest nest = {.depth = 0};
  *names = (cf_names){false, false};
  if (text[strspn(text, " \t\n")] == '\0') {
    cf_fail(CF_BAD_ARGUMENT, "there is nothing here");
    return fail_in(place, 0, 1);
  }
  if (length > TEXT_MAX) {
    cf_fail(CF_BAD_ARGUMENT, "an expression has at most %d letters", TEXT_MAX);
    return fail_in(place, 0, 1);
  }
  for (size_t i = 0, n; i < length; i += n) {
    cf_status status = CF_OK;
    n = 1;
    if (is_start(text[i])) {
      while (is_name(text[i + n])) ++n;
      status = check_name(text, i, n, constants, variables, names);
    } else if (is_digit(text[i]) || (text[i] == '.' && is_digit(text[i + 1]))) {
      n = number_length(text + i);
    } else {
      status = check_character(text, i, &nest);
    }
    if (status != CF_OK) return fail_in(place, (ptrdiff_t)i, (ptrdiff_t)n);
  }
  if (nest.depth == 0) return CF_OK;
  cf_fail(CF_BAD_ARGUMENT, "this parenthesis is not closed");
  return fail_in(place, (ptrdiff_t)nest.opened[nest.depth - 1], 1);
}

/* --- parsers
 * -------------------------------------------------------------------------------------------------- */

static void define_all(const cf_expr *expr, cf_parser *parser) {
  const muParserHandle_t handle = parser->handle;
  mupDefineConst(handle, "pi", M_PI);
  for (int i = 0; i < expr->constants; ++i) mupDefineConst(handle, expr->name[i], expr->value[i]);
  for (int i = 0; i < 4; ++i) {
    const char name[2] = {variable_names[i], '\0'};
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
  return fail_in(place, inside ? at : CF_MAX(length - 1, 0), there ? token_length : 1);
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
    status = fail_in(place, 0, (ptrdiff_t)strlen(text));
  } else {
    *value = values[0];
  }
  pthread_mutex_unlock(&library_lock);
  return status;
}

/* --- evaluation
 * ------------------------------------------------------------------------------------------------ */

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

/* --- create and destroy
 * ---------------------------------------------------------------------------------------- */

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
                       const cf_names *names, cf_expr_place *place) {
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
  cf_names names;
  *expr = NULL;
  if (place != NULL) *place = (cf_expr_place){0, (int)strlen(text)};
  if (constants == NULL) constants = &none;
  CF_TRY(check_text(text, constants, variables, &names, place));
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
