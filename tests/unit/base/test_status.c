/* SPDX-License-Identifier: MIT
 *
 * Codes, sentences and exit codes.
 */
#include <string.h>

#include "testing.h"

static cf_status inner(const int fails) {
  if (fails) return cf_fail(CF_BAD_FILE, "file %s: %d bytes", "a.h5", 12);
  return CF_OK;
}

static cf_status outer(const int fails, int *reached) {
  CF_TRY(inner(fails));
  *reached = 1;
  return CF_OK;
}

static void a_failure_passes_up_with_its_sentence(void **state) {
  (void)state;
  int reached = 0;
  assert_int_equal(outer(0, &reached), CF_OK);
  assert_int_equal(reached, 1);
  reached = 0;
  assert_int_equal(outer(1, &reached), CF_BAD_FILE);
  assert_int_equal(reached, 0);
  assert_string_equal(cf_status_sentence(), "file a.h5: 12 bytes");
}

static void a_sentence_may_quote_a_deeper_one(void **state) {
  (void)state;
  assert_int_equal(inner(1), CF_BAD_FILE);
  assert_int_equal(cf_fail(CF_FAILED, "frame 3: %s", cf_status_sentence()), CF_FAILED);
  assert_string_equal(cf_status_sentence(), "frame 3: file a.h5: 12 bytes");
}

static void a_long_sentence_is_cut_not_overrun(void **state) {
  (void)state;
  char text[4 * CF_SENTENCE_MAX];
  memset(text, 'x', sizeof text - 1);
  text[sizeof text - 1] = '\0';
  assert_int_equal(cf_fail(CF_FAILED, "%s", text), CF_FAILED);
  assert_int_equal(strlen(cf_status_sentence()), CF_SENTENCE_MAX - 1);
}

static void a_sentence_steers_no_terminal(void **state) {
  (void)state;
  assert_int_equal(cf_fail(CF_BAD_FILE, "%s: not a scene", "\033[2Ja\r\bb\x7f.yaml"), CF_BAD_FILE);
  assert_string_equal(cf_status_sentence(), "?[2Ja??b?.yaml: not a scene");
  assert_int_equal(cf_fail(CF_BAD_FILE, "%s", "f\303\274r\n\tzwei"), CF_BAD_FILE);
  assert_string_equal(cf_status_sentence(),
                      "f\303\274r\n\tzwei"); /* letters of UTF-8, ends of lines and tabs stay */
}

static void sentences_belong_to_their_thread(void **state) {
  (void)state;
  int mixed = 0;
#pragma omp parallel for num_threads(4) reduction(+ : mixed)
  for (int i = 0; i < 64; ++i) {
    char expected[32];
    snprintf(expected, sizeof expected, "number %d", i);
    (void)cf_fail(CF_FAILED, "number %d", i);
    mixed += strcmp(expected, cf_status_sentence()) != 0;
  }
  assert_int_equal(mixed, 0);
}

static void exit_codes_are_the_promised_ones(void **state) {
  (void)state;
  assert_int_equal(cf_status_exit_code(CF_OK), 0);
  assert_int_equal(cf_status_exit_code(CF_FAILED), 1);
  assert_int_equal(cf_status_exit_code(CF_BAD_SCENE), 2);
  assert_int_equal(cf_status_exit_code(CF_BAD_USAGE), 2);
  assert_int_equal(cf_status_exit_code(CF_BAD_ARGUMENT), 2);
  assert_int_equal(cf_status_exit_code(CF_NOT_CONVERGED), 3);
  assert_int_equal(cf_status_exit_code(CF_NOT_FINITE), 4);
  assert_int_equal(cf_status_exit_code(CF_NO_MEMORY), 5);
  assert_int_equal(cf_status_exit_code(CF_OVER_LIMIT), 5);
  assert_int_equal(cf_status_exit_code(CF_STOPPED), 130);
  assert_string_equal(cf_status_name(CF_NOT_FINITE), "NOT_FINITE");
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(a_failure_passes_up_with_its_sentence),
      cmocka_unit_test(a_sentence_may_quote_a_deeper_one),
      cmocka_unit_test(a_long_sentence_is_cut_not_overrun),
      cmocka_unit_test(a_sentence_steers_no_terminal),
      cmocka_unit_test(sentences_belong_to_their_thread),
      cmocka_unit_test(exit_codes_are_the_promised_ones),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
/* also in single precision */
