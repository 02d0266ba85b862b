/* SPDX-License-Identifier: MIT
 */
#define _GNU_SOURCE
#include <signal.h>
#include <sys/stat.h>
#include <sys/wait.h>

#include "io/checksum.h"
#include "io/folder.h"
#include "output_case.h"

static cf_path root, run;

static int setup(void **state) {
  char text[] = "/tmp/cattaneo-test-XXXXXX";
  (void)state;
  assert_non_null(mkdtemp(text));
  assert_int_equal(cf_path_make(&root, "%s", text), CF_OK);
  assert_int_equal(cf_path_make(&run, "%s/a/b", text), CF_OK);
  return 0;
}

static int teardown(void **state) {
  cf_path middle;
  (void)state;
  folder_remove(run.text);
  assert_int_equal(cf_path_make(&middle, "%s/a", root.text), CF_OK);
  folder_remove(middle.text);
  folder_remove(root.text);
  return 0;
}

static void put(const char *name) {
  cf_path path;
  assert_int_equal(cf_path_make(&path, "%s/%s", run.text, name), CF_OK);
  assert_int_equal(cf_file_write(path.text, "x", 1), CF_OK);
}

static bool is_there(const char *name) {
  cf_path path;
  assert_int_equal(cf_path_make(&path, "%s/%s", run.text, name), CF_OK);
  return access(path.text, F_OK) == 0;
}

static void a_new_folder_is_made_with_those_above(void **state) {
  cf_folder f;
  (void)state;
  assert_int_equal(cf_folder_create(&f, run.text, false), CF_OK);
  assert_int_equal(cf_folder_log(&f, "step %d", 3), CF_OK);
  cf_folder_close(&f);
  char *text;
  size_t size;
  cf_path log;
  assert_int_equal(cf_path_make(&log, "%s/log.txt", run.text), CF_OK);
  assert_int_equal(cf_file_read(log.text, 100, &text, &size), CF_OK);
  assert_string_equal(text, "step 3\n");
  cf_free(text);
}

static void a_folder_with_a_run_is_refused_without_force(void **state) {
  cf_folder f;
  (void)state;
  assert_int_equal(cf_folder_create(&f, run.text, false), CF_OK);
  cf_folder_close(&f);
  static const char *const mine[] = {
      "run.yaml",           "metrics.csv",          "fields_000012.vtkhdf", "fields_000012_phi.npy",
      "preview_000003.png", "checkpoint_000100.h5", "fields.vtkhdf.series"};
  static const char *const theirs[] = {"notes.txt", "photo_000012.png", "fields_12.vtkhdf", "holiday.png",
                                       "data.h5"};
  for (int i = 0; i < 7; ++i) put(mine[i]);
  for (int i = 0; i < 5; ++i) put(theirs[i]);
  assert_int_equal(cf_folder_create(&f, run.text, false), CF_BAD_USAGE);
  assert_says("holds a run already (run.yaml, metrics.csv, 3 frame files, 1 checkpoint)");
  assert_says("--force");
  for (int i = 0; i < 7; ++i) assert_true(is_there(mine[i]));
  assert_int_equal(cf_folder_create(&f, run.text, true), CF_OK);
  cf_folder_close(&f);
  for (int i = 0; i < 7; ++i) assert_false(is_there(mine[i]));
  for (int i = 0; i < 5; ++i) assert_true(is_there(theirs[i]));
}

static void any_trace_of_a_run_counts(void **state) {
  static const char *const traces[] = {"metrics.csv", "checkpoint_000001.h5", "particles_000000.vtkhdf"};
  (void)state;
  for (int i = 0; i < 3; ++i) {
    cf_folder f;
    assert_int_equal(cf_folder_create(&f, run.text, true), CF_OK);
    cf_folder_close(&f);
    cf_path log;
    assert_int_equal(cf_path_make(&log, "%s/log.txt", run.text), CF_OK);
    unlink(log.text);
    put(traces[i]);
    assert_int_equal(cf_folder_create(&f, run.text, false), CF_BAD_USAGE);
  }
}

/* What is left of a run that was killed before it began is in nobody's way. */
static void a_log_alone_is_no_run_and_no_lock_stays(void **state) {
  cf_folder f;
  (void)state;
  for (int turn = 0; turn < 2; ++turn) {
    assert_int_equal(cf_folder_create(&f, run.text, false), CF_OK);
    assert_true(is_there("log.txt") && is_there(".lock"));
    cf_folder_close(&f);
    assert_true(is_there("log.txt") && !is_there(".lock"));
  }
}

static void two_runs_cannot_share_a_folder(void **state) {
  cf_folder first, second;
  (void)state;
  assert_int_equal(cf_folder_create(&first, run.text, false), CF_OK);
  assert_int_equal(cf_folder_create(&second, run.text, true), CF_CANNOT_WRITE);
  assert_says("another run is writing this folder, process ");
  put("run.yaml");
  assert_int_equal(cf_folder_open(&second, run.text), CF_CANNOT_WRITE);
  cf_folder_close(&first);
  assert_int_equal(cf_folder_open(&second, run.text), CF_OK);
  cf_folder_close(&second);
}

static void a_killed_run_leaves_no_lock(void **state) {
  cf_folder f;
  int ready[2];
  char byte;
  (void)state;
  assert_int_equal(pipe(ready), 0);
  const pid_t child = fork();
  if (child == 0) {
    const bool held = cf_folder_create(&f, run.text, false) == CF_OK;
    if (write(ready[1], held ? "y" : "n", 1) == 1) pause();
    _exit(1);
  }
  assert_int_equal(read(ready[0], &byte, 1), 1);
  assert_int_equal(byte, 'y');
  assert_int_equal(cf_folder_create(&f, run.text, true), CF_CANNOT_WRITE);
  kill(child, SIGKILL);
  waitpid(child, NULL, 0);
  assert_int_equal(cf_folder_create(&f, run.text, true), CF_OK);
  cf_folder_close(&f);
}

static void going_on_needs_a_run(void **state) {
  cf_folder f;
  (void)state;
  assert_int_equal(cf_folder_open(&f, run.text), CF_BAD_FILE);
  assert_says("No such file");
  assert_int_equal(cf_folder_create(&f, run.text, false), CF_OK);
  cf_folder_close(&f);
  assert_int_equal(cf_folder_open(&f, run.text), CF_BAD_FILE);
  assert_says("holds no run that could go on: run.yaml");
}

static void what_is_no_folder_is_refused(void **state) {
  cf_folder f;
  cf_path file, below;
  (void)state;
  assert_int_equal(cf_path_make(&file, "%s/file", root.text), CF_OK);
  assert_int_equal(cf_path_make(&below, "%s/file/run", root.text), CF_OK);
  assert_int_equal(cf_file_write(file.text, "x", 1), CF_OK);
  assert_int_equal(cf_folder_create(&f, file.text, true), CF_CANNOT_WRITE);
  assert_says("is there and is not a folder");
  assert_int_equal(cf_folder_create(&f, below.text, false), CF_CANNOT_WRITE);
  assert_int_equal(cf_folder_create(&f, "", false), CF_BAD_USAGE);
}

static void a_folder_is_no_name_for_a_file(void **state) {
  cf_draft d;
  (void)state;
  assert_int_equal(cf_draft_begin(&d, "pictures/"), CF_BAD_ARGUMENT);
  assert_says("pictures/: names a folder, not a file");
}

static void later_frames_are_cut(void **state) {
  cf_folder f;
  int count;
  int64_t *numbers;
  (void)state;
  assert_int_equal(cf_folder_create(&f, run.text, false), CF_OK);
  cf_folder_close(&f);
  static const char *const files[] = {"fields_000009.vtkhdf", "fields_000010.vtkhdf",
                                      "fields_000011.vtkhdf", "fields_1000000.vtkhdf",
                                      "preview_000011.png",   "checkpoint_000011.h5"};
  for (int i = 0; i < 6; ++i) put(files[i]);
  assert_int_equal(cf_folder_cut_frames(run.text, 10), CF_OK);
  assert_int_equal(cf_folder_numbers(run.text, "fields", "vtkhdf", &count, &numbers), CF_OK);
  assert_int_equal(count, 2);
  assert_true(numbers[0] == 9 && numbers[1] == 10);
  cf_free(numbers);
  assert_false(is_there("preview_000011.png"));
  assert_true(is_there("checkpoint_000011.h5"));
}

static void a_draft_replaces_the_file_only_when_kept(void **state) {
  cf_folder f;
  cf_draft d;
  cf_path path;
  char *text;
  size_t size;
  (void)state;
  assert_int_equal(cf_folder_create(&f, run.text, false), CF_OK);
  put("run.yaml");
  assert_int_equal(cf_path_make(&path, "%s/run.yaml", run.text), CF_OK);
  assert_int_equal(cf_draft_begin(&d, path.text), CF_OK);
  FILE *file = fopen(d.temporary.text, "w");
  assert_non_null(file);
  fputs("half", file);
  fclose(file);
  assert_int_equal(cf_file_read(path.text, 100, &text, &size), CF_OK);
  assert_string_equal(text, "x");
  cf_free(text);
  cf_folder_close(&f);
  /* What a killed process leaves is swept away by the next. */
  assert_int_equal(files_in(run.text), 3);
  assert_int_equal(cf_folder_open(&f, run.text), CF_OK);
  assert_int_equal(files_in(run.text), 2);
  cf_folder_close(&f);
}

static void checksum_depends_on_bytes_not_on_pieces(void **state) {
  unsigned char bytes[300];
  (void)state;
  for (int i = 0; i < 300; ++i) bytes[i] = (unsigned char)(i * 37);
  const uint64_t whole = cf_checksum_of(bytes, 300, 1);
  for (size_t cut = 0; cut <= 300; cut += 7) {
    cf_checksum c;
    cf_checksum_start(&c);
    cf_checksum_add(&c, bytes, cut);
    cf_checksum_add(&c, bytes + cut, (300 - cut) / 2);
    cf_checksum_add(&c, bytes + cut + (300 - cut) / 2, 300 - cut - (300 - cut) / 2);
    assert_true(cf_checksum_end(&c) == whole);
  }
  for (int i = 0; i < 300 * 8; ++i) {
    bytes[i / 8] = (unsigned char)(bytes[i / 8] ^ (1 << i % 8));
    assert_true(cf_checksum_of(bytes, 300, 1) != whole);
    bytes[i / 8] = (unsigned char)(bytes[i / 8] ^ (1 << i % 8));
  }
  for (size_t length = 0; length < 300; ++length) assert_true(cf_checksum_of(bytes, length, 1) != whole);
  /* Files keep it: it must never change. */
  assert_true(cf_checksum_of("Cattaneo, Fourier", 17, 1) == UINT64_C(0x4d639da106b0ef5c));
}

static void failing_memory_leaves_no_lock(void **state) {
  cf_folder f;
  cf_status s = CF_NO_MEMORY;
  (void)state;
  for (long n = 1; s != CF_OK; ++n) {
    cf_mem_fail_at(n);
    s = cf_folder_create(&f, run.text, true);
    cf_mem_fail_at(0);
    assert_true(s == CF_OK || s == CF_NO_MEMORY);
  }
  cf_folder_close(&f);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test_setup_teardown(a_new_folder_is_made_with_those_above, setup, teardown),
      cmocka_unit_test_setup_teardown(a_folder_with_a_run_is_refused_without_force, setup, teardown),
      cmocka_unit_test_setup_teardown(a_log_alone_is_no_run_and_no_lock_stays, setup, teardown),
      cmocka_unit_test_setup_teardown(any_trace_of_a_run_counts, setup, teardown),
      cmocka_unit_test_setup_teardown(two_runs_cannot_share_a_folder, setup, teardown),
      cmocka_unit_test_setup_teardown(a_killed_run_leaves_no_lock, setup, teardown),
      cmocka_unit_test_setup_teardown(going_on_needs_a_run, setup, teardown),
      cmocka_unit_test_setup_teardown(what_is_no_folder_is_refused, setup, teardown),
      cmocka_unit_test(a_folder_is_no_name_for_a_file),
      cmocka_unit_test_setup_teardown(later_frames_are_cut, setup, teardown),
      cmocka_unit_test_setup_teardown(a_draft_replaces_the_file_only_when_kept, setup, teardown),
      cmocka_unit_test_setup_teardown(checksum_depends_on_bytes_not_on_pieces, setup, teardown),
      cmocka_unit_test_setup_teardown(failing_memory_leaves_no_lock, setup, teardown),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
