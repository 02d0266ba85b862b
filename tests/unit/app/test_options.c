/* SPDX-License-Identifier: MIT
 *
 * The command line, read without running anything: values, order, and what a refusal says.
 */
#include "testing.h"

#include <string.h>

#include "app/command.h"
#include "app/options.h"
#include "app/tell.h"
#include "base/mem.h"

#define ALL ((1u << CF_OPTIONS) - 1)

/* Reads the words (a command first) into *a; the words are the caller's. */
static cf_status read(cf_arguments *a, char **words) {
  int count = 0;
  while (words[count] != NULL) ++count;
  return cf_arguments_read(a, count, words, ALL);
}

#define WORDS(...) ((char *[]){"run", __VA_ARGS__, NULL})

static void options_may_stand_anywhere(void **state) {
  (void)state;
  cf_arguments a;
  assert_int_equal(read(&a, WORDS("a.yaml", "--threads", "3", "-o", "dir", "--force", "--until=2.5")), CF_OK);
  assert_int_equal(a.operands, 1);
  assert_string_equal(a.operand[0], "a.yaml");
  assert_int_equal(a.threads, 3);
  assert_string_equal(a.output, "dir");
  assert_true(a.force);
  assert_true(a.until == 2.5);
  cf_arguments_clear(&a);
}

static void what_is_not_given_is_zero(void **state) {
  (void)state;
  cf_arguments a;
  assert_int_equal(read(&a, WORDS("a.yaml")), CF_OK);
  assert_null(a.output);
  assert_int_equal(a.sets + a.threads + (int)a.steps, 0);
  assert_true(a.until == 0 && a.memory == 0);
  assert_false(a.force || a.help || a.manual || a.other);
  assert_int_equal(a.progress, CF_PROGRESS_AUTO);
  cf_arguments_clear(&a);
}

static void overrides_keep_their_order(void **state) {
  (void)state;
  cf_arguments a;
  assert_int_equal(read(&a, WORDS("--set", "a=1", "x.yaml", "--set=b=c=2")), CF_OK);
  assert_int_equal(a.sets, 2);
  assert_string_equal(a.set[0], "a=1");
  assert_string_equal(a.set[1], "b=c=2");
  cf_arguments_clear(&a);
}

static void two_dashes_end_the_options(void **state) {
  (void)state;
  cf_arguments a;
  assert_int_equal(read(&a, WORDS("--", "--threads")), CF_OK);
  assert_string_equal(a.operand[0], "--threads");
  cf_arguments_clear(&a);
}

static void the_other_precision_is_told_from_the_own(void **state) {
  (void)state;
  cf_arguments a;
  assert_int_equal(read(&a, WORDS("--precision", "single")), CF_OK);
  assert_true(a.other);
  cf_arguments_clear(&a);
  assert_int_equal(read(&a, WORDS("--precision", "double")), CF_OK);
  assert_false(a.other);
  cf_arguments_clear(&a);
}

static void sizes_are_powers_of_1024(void **state) {
  (void)state;
  static const struct {
    const char *text;
    double bytes;
  } good[] = {
      {"1", 1},      {"512M", 512 * 1048576.0}, {"2G", 2147483648.0}, {"1.5k", 1536},     {"1KiB", 1024},
      {"3KB", 3072}, {"1T", 1099511627776.0},   {"100B", 100},        {"1e3K", 1024000.0}};
  double bytes;
  for (size_t i = 0; i < sizeof good / sizeof good[0]; ++i) {
    assert_int_equal(cf_size_read(good[i].text, &bytes), CF_OK);
    assert_true(bytes == good[i].bytes);
  }
  static const char *const bad[] = {"", "G", "-1", "0", "0.1", "2X", "2GG", "nan", "inf", "1e400", "2 G"};
  for (size_t i = 0; i < sizeof bad / sizeof bad[0]; ++i)
    assert_int_equal(cf_size_read(bad[i], &bytes), CF_BAD_USAGE);
}

static void a_refusal_frees_what_it_took(void **state) {
  (void)state;
  cf_arguments a;
  assert_int_equal(read(&a, WORDS("--set", "a=1", "--threads", "none")), CF_BAD_USAGE);
  assert_null(a.set);
  assert_non_null(strstr(cf_status_sentence(), "--threads none"));
}

static void no_memory_is_told(void **state) {
  (void)state;
  cf_arguments a;
  cf_mem_fail_at(1);
  assert_int_equal(read(&a, WORDS("x.yaml")), CF_NO_MEMORY);
  cf_mem_fail_at(0);
  assert_null(a.set);
}

static void every_command_of_the_table_is_whole(void **state) {
  (void)state;
  for (const cf_command *c = cf_commands; c->name != NULL; ++c) {
    assert_ptr_equal(cf_command_find(c->name), c);
    assert_true(c->least <= c->most && c->run != NULL);
    assert_true(c->summary[0] != '\0' && c->summary[strlen(c->summary) - 1] != '.');
    assert_true((c->options & 1u << CF_OPTION_HELP) != 0);
  }
}

static void durations_read_like_speech(void **state) {
  (void)state;
  static const struct {
    double seconds;
    const char *text;
  } cases[] = {{0, "0 s"},          {59.4, "59 s"},       {59.6, "1 min 00 s"},
               {200, "3 min 20 s"}, {7260, "2 h 01 min"}, {200000, "2 d 07 h"},
               {-1, "?"},           {1e300, "?"}};
  char text[32];
  for (size_t i = 0; i < sizeof cases / sizeof cases[0]; ++i) {
    cf_duration_text(cases[i].seconds, text, sizeof text);
    assert_string_equal(text, cases[i].text);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(options_may_stand_anywhere),
      cmocka_unit_test(what_is_not_given_is_zero),
      cmocka_unit_test(overrides_keep_their_order),
      cmocka_unit_test(two_dashes_end_the_options),
      cmocka_unit_test(the_other_precision_is_told_from_the_own),
      cmocka_unit_test(sizes_are_powers_of_1024),
      cmocka_unit_test(a_refusal_frees_what_it_took),
      cmocka_unit_test(no_memory_is_told),
      cmocka_unit_test(every_command_of_the_table_is_whole),
      cmocka_unit_test(durations_read_like_speech),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
