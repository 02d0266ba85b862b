/* SPDX-License-Identifier: MIT
 *
 * Units: factors, what is refused, and the sentences for it.
 */
#define _GNU_SOURCE
#include "base/units.h"

#include <pthread.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "testing.h"

static double scale(const char *given, const char *wanted) {
  cf_unit_change change;
  OK(cf_units_change(given, wanted, &change));
  assert_true(change.offset == 0.0);
  return change.scale;
}

static void units_change_by_a_factor(void **state) {
  (void)state;
  CLOSE(scale("cm^2/s", "m^2/s"), 1e-4, 1e-19);
  CLOSE(scale("m s-1", "m/s"), 1.0, 0.0);
  CLOSE(scale("km/h", "m/s"), 1 / 3.6, 1e-15);
  CLOSE(scale(" min ", "s"), 60.0, 0.0);
  CLOSE(scale("%", ""), 0.01, 1e-17);
  CLOSE(scale("\u00B5m", "m"), 1e-6, 1e-21);
  CLOSE(scale("", ""), 1.0, 0.0);
}

static void units_without_a_wish_become_si(void **state) {
  (void)state;
  CLOSE(scale("cm^2/s", NULL), 1e-4, 1e-19);
  CLOSE(scale("g/cm^3", NULL), 1000.0, 1e-9);
  CLOSE(scale("", NULL), 1.0, 0.0);
}

static void units_with_an_offset_keep_it(void **state) {
  (void)state;
  cf_unit_change change;
  OK(cf_units_change("degC", "K", &change));
  CLOSE(change.scale, 1.0, 1e-12);
  CLOSE(change.offset, 273.15, 1e-9);
}

static void refused(const char *given, const char *wanted, const char *sentence) {
  cf_unit_change change;
  assert_int_equal(cf_units_change(given, wanted, &change), CF_BAD_ARGUMENT);
  assert_string_equal(cf_status_sentence(), sentence);
}

static void units_of_another_dimension_are_refused(void **state) {
  (void)state;
  refused("m/s", "m^2/s", "has unit m/s, expected m^2/s");
  refused("m", "", "has unit m, expected a plain number");
  refused("", "m", "has unit , expected m");
}

static void units_that_are_reciprocals_are_refused(void **state) {
  (void)state;
  refused("Hz", "s", "has unit Hz, expected s");
  refused("s/m", "m/s", "has unit s/m, expected m/s");
}

static void units_that_do_not_exist_are_refused(void **state) {
  (void)state;
  refused("cmm", "m", "has unit cmm: there is no such unit");
  refused("m^0.5", "m", "has unit m^0.5: there is no such unit");
  refused("m/", "m", "has unit m/: there is no such unit");
  refused("0 m", "m", "has unit 0 m: there is no such unit");
  refused("lg(re 1 mW)", NULL, "has unit lg(re 1 mW): there is no such unit");
}

static void units_with_a_number_behind_them_are_refused(void **state) {
  (void)state;
  cf_unit_change change;
  assert_int_equal(cf_units_change("% 3", NULL, &change), CF_BAD_ARGUMENT);
  assert_int_equal(cf_units_change("m 2", "m", &change), CF_BAD_ARGUMENT);
  CLOSE(scale("m s-1", "m/s"), 1.0, 0.0);
  CLOSE(scale("100 m", "m"), 100.0, 0.0);
}

static void units_of_any_length_do_no_harm(void **state) {
  (void)state;
  char text[5000];
  cf_unit_change change;
  for (size_t length = 1; length < sizeof text; length = 2 * length + 1) {
    memset(text, 'm', length);
    text[length] = '\0';
    const cf_status status = cf_units_change(text, "m", &change);
    assert_true(status == CF_OK || status == CF_BAD_ARGUMENT);
  }
}

static void *change_often(void *failures) {
  cf_unit_change change;
  for (int i = 0; i < 200; ++i)
    if (cf_units_change(i % 2 ? "cm" : "km", "m", &change) != CF_OK ||
        change.scale != (i % 2 ? 0.01 : 1000.0))
      ++*(int *)failures;
  return NULL;
}

static void units_never_reach_the_terminal(void **state) {
  (void)state;
  static const char *const broken[] = {"m\n", "\n", "m\ns", "m $ s", "\"", "kg@", "m\\s"};
  cf_unit_change change;
  fflush(stdout);
  FILE *file = tmpfile();
  const int terminal[2] = {dup(1), dup(2)};
  assert_true(file != NULL && terminal[0] >= 0 && terminal[1] >= 0);
  for (int i = 0; i < 2; ++i) assert_true(dup2(fileno(file), 1 + i) >= 0);
  int refused = 0;
  for (size_t i = 0; i < sizeof broken / sizeof *broken; ++i)
    refused += cf_units_change(broken[i], "m", &change) != CF_OK;
  fflush(stdout);
  for (int i = 0; i < 2; ++i) {
    dup2(terminal[i], 1 + i);
    close(terminal[i]);
  }
  assert_int_equal(refused, sizeof broken / sizeof *broken);
  assert_int_equal(lseek(fileno(file), 0, SEEK_END), 0);
  fclose(file);
}

static void units_may_be_asked_from_several_threads(void **state) {
  (void)state;
  pthread_t thread[4];
  int failures[4] = {0};
  for (int i = 0; i < 4; ++i) pthread_create(&thread[i], NULL, change_often, &failures[i]);
  for (int i = 0; i < 4; ++i) {
    pthread_join(thread[i], NULL);
    assert_int_equal(failures[i], 0);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(units_change_by_a_factor),
      cmocka_unit_test(units_without_a_wish_become_si),
      cmocka_unit_test(units_with_an_offset_keep_it),
      cmocka_unit_test(units_of_another_dimension_are_refused),
      cmocka_unit_test(units_that_are_reciprocals_are_refused),
      cmocka_unit_test(units_that_do_not_exist_are_refused),
      cmocka_unit_test(units_with_a_number_behind_them_are_refused),
      cmocka_unit_test(units_of_any_length_do_no_harm),
      cmocka_unit_test(units_never_reach_the_terminal),
      cmocka_unit_test(units_may_be_asked_from_several_threads),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
