/* SPDX-License-Identifier: MIT
 */
#define _GNU_SOURCE
#include <float.h>
#include <math.h>
#include <signal.h>
#include <sys/resource.h>

#include "io/table.h"
#include "output_case.h"

static const char *const names[] = {"step", "time", "sum_phi"};
static cf_path folder, path;

static int setup(void **state) {
  char text[] = "/tmp/cattaneo-test-XXXXXX";
  (void)state;
  assert_non_null(mkdtemp(text));
  assert_int_equal(cf_path_make(&folder, "%s", text), CF_OK);
  assert_int_equal(cf_path_make(&path, "%s/metrics.csv", text), CF_OK);
  return 0;
}

static int teardown(void **state) {
  (void)state;
  folder_remove(folder.text);
  return 0;
}

static void assert_text(const char *wanted) {
  char *text;
  size_t size;
  assert_int_equal(cf_file_read(path.text, 1 << 20, &text, &size), CF_OK);
  assert_string_equal(text, wanted);
  cf_free(text);
}

/* Rows for the steps 0 to last. */
static void write_rows(const int last) {
  cf_table *t;
  assert_int_equal(cf_table_create(&t, path.text, 3, names), CF_OK);
  for (int step = 0; step <= last; ++step)
    assert_int_equal(cf_table_row(t, (double[]){step, step / 10.0, 1.0 / 3 + step}), CF_OK);
  assert_int_equal(cf_table_sync(t), CF_OK);
  cf_table_close(t);
}

static void append_text(const char *text) {
  FILE *file = fopen(path.text, "a");
  assert_non_null(file);
  fputs(text, file);
  fclose(file);
}

static void numbers_keep_all_their_digits(void **state) {
  (void)state;
  write_rows(1);
  assert_text("step,time,sum_phi\n0,0,0.33333333333333331\n1,0.10000000000000001,1.3333333333333333\n");
  cf_table *t;
  char *text;
  size_t size;
  const double values[3] = {-DBL_MAX / 3, -DBL_MIN / 3, -5e-324};
  assert_int_equal(cf_table_create(&t, path.text, 3, names), CF_OK);
  assert_int_equal(cf_table_row(t, values), CF_OK);
  assert_int_equal(cf_table_row(t, (double[]){NAN, -INFINITY, -NAN}), CF_OK);
  cf_table_close(t);
  assert_int_equal(cf_file_read(path.text, 1 << 20, &text, &size), CF_OK);
  char *at = strchr(text, '\n') + 1;
  for (int i = 0; i < 3; ++i) {
    assert_true(strtod(at, &at) == values[i]);
    ++at;
  }
  cf_free(text);
}

static void resume_cuts_what_came_after_the_step(void **state) {
  cf_table *t;
  int64_t found;
  (void)state;
  write_rows(5);
  assert_int_equal(cf_table_resume(&t, path.text, 3, names, 1, &found), CF_OK);
  assert_int_equal(found, 1);
  assert_int_equal(cf_table_row(t, (double[]){2, 7, 8}), CF_OK);
  cf_table_close(t);
  assert_text(
      "step,time,sum_phi\n0,0,0.33333333333333331\n1,0.10000000000000001,1.3333333333333333\n2,7,8\n");
}

static void a_half_line_is_cut(void **state) {
  static const char *const halves[] = {"2",    "2,0.2", "2,0.2,2.3", "2,0.2,\n",  "2,0.2,1,5\n", "x,1,2\n",
                                       ",,\n", "\n",    "2.5,1,1\n", "nan,1,1\n", "1 ,2,3\n",    "0x2,1,1\n"};
  (void)state;
  for (size_t i = 0; i < sizeof halves / sizeof halves[0]; ++i) {
    cf_table *t;
    int64_t found;
    write_rows(1);
    append_text(halves[i]);
    append_text(i % 2 == 0 ? "" : "3,1,1\n");
    const cf_status s = cf_table_resume(&t, path.text, 3, names, i == 11 ? 1 : 9, &found);
    assert_int_equal(s, CF_OK);
    assert_int_equal(found, 1);
    cf_table_close(t);
    assert_text("step,time,sum_phi\n0,0,0.33333333333333331\n1,0.10000000000000001,1.3333333333333333\n");
  }
}

static void other_columns_are_refused(void **state) {
  cf_table *t;
  const char *const other[] = {"step", "time", "min_phi"};
  (void)state;
  write_rows(1);
  assert_int_equal(cf_table_resume(&t, path.text, 3, other, 1, NULL), CF_BAD_FILE);
  assert_null(t);
  assert_says("has other columns than this run");
  assert_int_equal(cf_table_resume(&t, path.text, 2, names, 1, NULL), CF_BAD_FILE);
  assert_text("step,time,sum_phi\n0,0,0.33333333333333331\n1,0.10000000000000001,1.3333333333333333\n");
}

static void a_missing_table_is_started(void **state) {
  cf_table *t;
  int64_t found = 7;
  (void)state;
  assert_int_equal(cf_table_resume(&t, path.text, 3, names, 1, &found), CF_OK);
  assert_int_equal(found, -1);
  cf_table_close(t);
  assert_text("step,time,sum_phi\n");
}

static void bad_names_are_refused(void **state) {
  static const char *const bad[] = {"", "a,b", "a\"", "a\n"};
  cf_table *t;
  (void)state;
  for (int i = 0; i < 4; ++i) assert_int_equal(cf_table_create(&t, path.text, 1, &bad[i]), CF_BAD_ARGUMENT);
  assert_int_equal(cf_table_create(&t, path.text, 0, bad), CF_BAD_ARGUMENT);
  assert_int_equal(cf_table_create(&t, "/no/such/folder/metrics.csv", 3, names), CF_CANNOT_WRITE);
  assert_says("/no/such/folder/metrics.csv: cannot be written: No such file or directory");
}

static void a_full_disk_leaves_whole_rows(void **state) {
  struct rlimit old;
  cf_table *t;
  (void)state;
  write_rows(1);
  assert_int_equal(cf_table_resume(&t, path.text, 3, names, 9, NULL), CF_OK);
  signal(SIGXFSZ, SIG_IGN);
  assert_int_equal(getrlimit(RLIMIT_FSIZE, &old), 0);
  const struct rlimit limit = {90, old.rlim_max};
  assert_int_equal(setrlimit(RLIMIT_FSIZE, &limit), 0);
  const cf_status s = cf_table_row(t, (double[]){2, 1.0 / 3, 1.0 / 7});
  assert_int_equal(setrlimit(RLIMIT_FSIZE, &old), 0);
  assert_int_equal(s, CF_CANNOT_WRITE);
  assert_text("step,time,sum_phi\n0,0,0.33333333333333331\n1,0.10000000000000001,1.3333333333333333\n");
  assert_int_equal(cf_table_row(t, (double[]){2, 3, 4}), CF_OK);
  cf_table_close(t);
  assert_text(
      "step,time,sum_phi\n0,0,0.33333333333333331\n1,0.10000000000000001,1.3333333333333333\n2,3,4\n");
}

static void failing_memory_leaks_nothing(void **state) {
  cf_status s = CF_NO_MEMORY;
  (void)state;
  write_rows(1);
  for (long n = 1; s != CF_OK; ++n) {
    cf_table *t;
    cf_mem_fail_at(n);
    s = cf_table_resume(&t, path.text, 3, names, 9, NULL);
    cf_mem_fail_at(0);
    assert_true(s == CF_OK || (s == CF_NO_MEMORY && t == NULL));
    cf_table_close(t);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test_setup_teardown(numbers_keep_all_their_digits, setup, teardown),
      cmocka_unit_test_setup_teardown(resume_cuts_what_came_after_the_step, setup, teardown),
      cmocka_unit_test_setup_teardown(a_half_line_is_cut, setup, teardown),
      cmocka_unit_test_setup_teardown(other_columns_are_refused, setup, teardown),
      cmocka_unit_test_setup_teardown(a_missing_table_is_started, setup, teardown),
      cmocka_unit_test_setup_teardown(bad_names_are_refused, setup, teardown),
      cmocka_unit_test_setup_teardown(a_full_disk_leaves_whole_rows, setup, teardown),
      cmocka_unit_test_setup_teardown(failing_memory_leaks_nothing, setup, teardown),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
