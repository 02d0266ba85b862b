/* SPDX-License-Identifier: MIT
 *
 * Expressions: values, what they depend on, errors with their place, threads, memory.
 */
#define _GNU_SOURCE /* M_PI */
#include "io/expr.h"

#include <math.h>
#include <pthread.h>
#include <string.h>

#include "base/mem.h"
#include "testing.h"

static const char *const names[] = {"H", "speed"};
static const double values[] = {2.0, 0.1};
static const cf_expr_constants constants = {2, names, values};

/* The value at x = 0.5, y = 0.25, z = 0.125, t = 3. */
static double value(const char *text) {
  cf_expr *expr;
  OK(cf_expr_create(&expr, text, &constants, CF_EXPR_SPACE_TIME, NULL));
  const cf_fn fn = cf_expr_fn(expr);
  const double result = cf_fn_at(&fn, 0.5, 0.25, 0.125, 3.0);
  cf_expr_destroy(expr);
  return result;
}

static void expr_computes(void **state) {
  (void)state;
  CLOSE(value("1/24"), 1.0 / 24, 0);
  CLOSE(value("x + 2*y - z/t"), 1.0 - 0.125 / 3, 1e-16);
  CLOSE(value("-2^2"), -4, 0);
  CLOSE(value("2^3^2"), 512, 0);
  CLOSE(value("x < 1 ? 2 : 3"), 2, 0);
  CLOSE(value("x < 1 && y > 1 || z == 0.125"), 1, 0);
  CLOSE(value("1e-3*1E3"), 1, 0);
  CLOSE(value("H*speed"), 0.2, 1e-17);
  CLOSE(value("\n  x\t"), 0.5, 0);
}

static void expr_knows_functions_and_pi(void **state) {
  (void)state;
  CLOSE(value("pi"), M_PI, 0);
  CLOSE(value("erf(x) + erfc(x)"), 1, 1e-16);
  CLOSE(value("fmod(5, 3)"), 2, 0);
  CLOSE(value("hypot(3, 4)"), 5, 0);
  CLOSE(value("floor(1.5) + ceil(1.5)"), 3, 0);
  CLOSE(value("log(exp(1))"), 1, 1e-16);
  CLOSE(value("atan2(1, 1)"), M_PI / 4, 1e-16);
  CLOSE(value("min(3, 1, 2) + max(3, 1, 2)"), 4, 0);
}

static cf_fn kind(const char *text) {
  cf_expr *expr;
  OK(cf_expr_create(&expr, text, &constants, CF_EXPR_SPACE_TIME, NULL));
  const cf_fn fn = cf_expr_fn(expr);
  cf_expr_destroy(expr);
  return fn;
}

static void expr_without_variables_is_a_constant(void **state) {
  (void)state;
  const cf_fn constant = kind("2*pi*H"), place = kind("x + 0*y"), time = kind("sin(t)");
  assert_true(cf_fn_is_constant(&constant) && !constant.in_time);
  CLOSE(cf_fn_at(&constant, 0, 0, 0, 0), 4 * M_PI, 1e-15);
  assert_true(!cf_fn_is_constant(&place) && !place.in_time);
  assert_true(!cf_fn_is_constant(&time) && time.in_time);
}

static void expr_fills_a_row(void **state) {
  (void)state;
  enum { N = 1000 };
  static double x[N], y[N], z[N], out[N];
  cf_expr *expr;
  OK(cf_expr_create(&expr, "x*y + z^2 - t", NULL, CF_EXPR_SPACE_TIME, NULL));
  const cf_fn fn = cf_expr_fn(expr);
  for (int i = 0; i < N; ++i) {
    x[i] = i;
    y[i] = 1.0 / (1 + i);
    z[i] = 0.5 * i;
  }
  cf_fn_row(&fn, N, x, y, z, 7.0, out);
  for (int i = 0; i < N; ++i) CLOSE(out[i], x[i] * y[i] + z[i] * z[i] - 7, 1e-9);
  cf_expr_destroy(expr);
}

static void refused(const char *text, const cf_expr_variables variables, const char *sentence, const int at,
                    const int length) {
  cf_expr *expr = (cf_expr *)&expr;
  cf_expr_place place;
  assert_int_equal(cf_expr_create(&expr, text, &constants, variables, &place), CF_BAD_ARGUMENT);
  assert_null(expr);
  assert_string_equal(cf_status_sentence(), sentence);
  if (place.at != at || place.length != length)
    fail_msg("%s: the error is placed at %d+%d, not %d+%d", text, place.at, place.length, at, length);
}

static void expr_error_has_a_place(void **state) {
  (void)state;
  refused("1 + sine(x)", CF_EXPR_SPACE_TIME, "sine is not known: did you mean sin?", 4, 4);
  refused("1 + sped", CF_EXPR_SPACE_TIME, "sped is not known: did you mean speed?", 4, 4);
  refused("wombat", CF_EXPR_SPACE_TIME, "wombat is not known (names for numbers go under let)", 0, 6);
  refused("wombat(1)", CF_EXPR_SPACE_TIME, "there is no function wombat", 0, 6);
  refused("(1 + (x)", CF_EXPR_SPACE_TIME, "this parenthesis is not closed", 0, 1);
  refused("1)", CF_EXPR_SPACE_TIME, "this parenthesis was not opened", 1, 1);
  refused("1 2", CF_EXPR_SPACE_TIME, "`2` may not stand here", 2, 1);
  refused("2x", CF_EXPR_SPACE_TIME, "`x` may not stand here", 1, 1);
  refused("x +", CF_EXPR_SPACE_TIME, "the expression ends too early", 2, 1);
  refused("sin()", CF_EXPR_SPACE_TIME, "the function has the wrong number of arguments", 4, 1);
  refused("x \u00B7 y", CF_EXPR_SPACE_TIME, "`\u00B7` may not stand in an expression", 2, 1);
  refused("", CF_EXPR_SPACE_TIME, "there is nothing here", 0, 1);
}

static void expr_refuses_what_the_parser_would_take(void **state) {
  (void)state;
  refused("x = 3", CF_EXPR_SPACE_TIME, "= is not for expressions (to compare: ==)", 2, 1);
  refused("1, 2", CF_EXPR_SPACE_TIME, "these are 2 values, one is wanted", 0, 4);
  refused("_pi", CF_EXPR_SPACE_TIME, "_pi is not known (names for numbers go under let)", 0, 3);
  refused("x**2", CF_EXPR_SPACE_TIME, "** is not known: powers are written ^", 1, 1);
  refused("5 % 3", CF_EXPR_SPACE_TIME, "% is not known: the remainder is fmod(a, b)", 2, 1);
  refused("\"x\"", CF_EXPR_SPACE_TIME, "`\"` may not stand in an expression", 0, 1);
}

static void expr_variables_may_be_forbidden(void **state) {
  (void)state;
  refused("x + t", CF_EXPR_SPACE, "t may not stand here: an expression in x, y, z is wanted", 4, 1);
  refused("2*y", CF_EXPR_NO_VARIABLES, "y may not stand here: a number is wanted", 2, 1);
}

static void expr_names_for_constants_are_checked(void **state) {
  (void)state;
  assert_int_equal(cf_expr_name_check("H_c2"), CF_OK);
  const char *const bad[] = {"", "2H", "a-b", "x", "t", "pi", "sin", "avg", "\u00E9"};
  for (size_t i = 0; i < sizeof bad / sizeof bad[0]; ++i)
    assert_int_equal(cf_expr_name_check(bad[i]), CF_BAD_ARGUMENT);
}

static void expr_of_any_size_does_no_harm(void **state) {
  (void)state;
  static char text[20001];
  cf_expr *expr;
  const char *const pieces[] = {"(", "-", "x+", "sin(", "1e", "?",    "x?", "1,",
                                ".", "a", "^",  " ",    "1 ", "min(", "))"};
  for (size_t p = 0; p < sizeof pieces / sizeof pieces[0]; ++p)
    for (size_t length = 1; length < sizeof text; length = 3 * length + 7) {
      for (size_t i = 0; i < length; ++i) text[i] = pieces[p][i % strlen(pieces[p])];
      text[length] = '\0';
      const cf_status status = cf_expr_create(&expr, text, &constants, CF_EXPR_SPACE_TIME, NULL);
      assert_true(status == CF_OK || status == CF_BAD_ARGUMENT);
      cf_expr_destroy(expr);
    }
}

/* A thread that evaluates a shared function. */
typedef struct worker {
  pthread_t thread;
  const cf_fn *fn;
  double number, error;
} worker;

static void *evaluate_often(void *argument) {
  worker *w = argument;
  for (int i = 0; i < 2000; ++i) {
    const double x = w->number + i;
    w->error = fmax(w->error, fabs(cf_fn_at(w->fn, x, 1, 0, w->number) - (x * x + 1 - w->number)));
  }
  return NULL;
}

static void expr_may_be_evaluated_from_several_threads(void **state) {
  (void)state;
  cf_expr *expr;
  worker workers[4];
  OK(cf_expr_create(&expr, "x^2 + y - t", NULL, CF_EXPR_SPACE_TIME, NULL));
  const cf_fn fn = cf_expr_fn(expr);
  for (int i = 0; i < 4; ++i) {
    workers[i] = (worker){.fn = &fn, .number = i};
    pthread_create(&workers[i].thread, NULL, evaluate_often, &workers[i]);
  }
  for (int i = 0; i < 4; ++i) {
    pthread_join(workers[i].thread, NULL);
    CLOSE(workers[i].error, 0, 0);
  }
  cf_expr_destroy(expr);
}

static void expr_survives_every_failed_allocation(void **state) {
  (void)state;
  cf_expr *expr;
  cf_status status = CF_NO_MEMORY;
  for (int n = 1; status != CF_OK; ++n) {
    cf_mem_fail_at(n);
    status = cf_expr_create(&expr, "H*x + speed*t", &constants, CF_EXPR_SPACE_TIME, NULL);
    cf_mem_fail_at(0);
    assert_true(status == CF_OK ? n > 5 : status == CF_NO_MEMORY && expr == NULL);
  }
  cf_expr_destroy(expr);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(expr_computes),
      cmocka_unit_test(expr_knows_functions_and_pi),
      cmocka_unit_test(expr_without_variables_is_a_constant),
      cmocka_unit_test(expr_fills_a_row),
      cmocka_unit_test(expr_error_has_a_place),
      cmocka_unit_test(expr_refuses_what_the_parser_would_take),
      cmocka_unit_test(expr_variables_may_be_forbidden),
      cmocka_unit_test(expr_names_for_constants_are_checked),
      cmocka_unit_test(expr_of_any_size_does_no_harm),
      cmocka_unit_test(expr_may_be_evaluated_from_several_threads),
      cmocka_unit_test(expr_survives_every_failed_allocation),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
