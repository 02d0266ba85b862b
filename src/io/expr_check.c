/* SPDX-License-Identifier: MIT
 *
 * The text of an expression, looked through before the parser sees it: every name must be known and every character
 * one that may stand in an expression. What the parser would take for something else (assignment, text in quotes) is
 * refused here, and what is wrong gets its place. See expr_check.h.
 */
#include "io/expr_check.h"

#include <string.h>

#include "base/param.h"

enum { NAME_MAX_LENGTH = 63, NEST_MAX = 200 };

const char cf_expr_variable_names[4] = {'x', 'y', 'z', 't'};

cf_status cf_expr_fail_in(cf_expr_place *place, const ptrdiff_t at, const ptrdiff_t length) {
  if (place != NULL) *place = (cf_expr_place){(int)at, (int)length};
  return CF_BAD_ARGUMENT;
}

/* --- names ------------------------------------------------------------------------------------ */

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
    if (length == 1 && name[0] == cf_expr_variable_names[i]) return i;
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
                            cf_expr_names *names) {
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

/* --- the text, before the library sees it ----------------------------------------------------- */

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

cf_status cf_expr_check(const char *text, const cf_expr_constants *constants,
                        const cf_expr_variables variables, cf_expr_names *names, cf_expr_place *place) {
  const size_t length = strlen(text);
  cf_nest nest = {.depth = 0};
  *names = (cf_expr_names){false, false};
  if (text[strspn(text, " \t\n")] == '\0') {
    cf_fail(CF_BAD_ARGUMENT, "there is nothing here");
    return cf_expr_fail_in(place, 0, 1);
  }
  if (length > CF_EXPR_TEXT_MAX) {
    cf_fail(CF_BAD_ARGUMENT, "an expression has at most %d letters", CF_EXPR_TEXT_MAX);
    return cf_expr_fail_in(place, 0, 1);
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
    if (status != CF_OK) return cf_expr_fail_in(place, (ptrdiff_t)i, (ptrdiff_t)n);
  }
  if (nest.depth == 0) return CF_OK;
  cf_fail(CF_BAD_ARGUMENT, "this parenthesis is not closed");
  return cf_expr_fail_in(place, (ptrdiff_t)nest.opened[nest.depth - 1], 1);
}
