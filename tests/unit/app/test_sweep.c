/* SPDX-License-Identifier: MIT
 *
 * Sweeps: which runs they are and what they are called, and the program itself with a small scene: the table, the
 * sheet, going on after a stop.
 */
#include <string.h>
#include <sys/wait.h>

#include "app/combine.h"
#include "base/mem.h"
#include "folders.h"
#include "testing.h"

static char *scenes[] = {"dir/cone.yaml", "ink.v2.yaml", NULL};

static cf_combinations make(const int count, const char *const *grid, const int grids) {
  cf_combinations c;
  OK(cf_combinations_make(&c, count, scenes, grids, grid));
  return c;
}

static void the_last_grid_changes_fastest(void **state) {
  (void)state;
  cf_combinations c = make(1, (const char *const[]){"diffusion.f_t=0, 0.5", "diffusion.tau=1,2,4"}, 2);
  assert_int_equal(c.count, 6);
  assert_string_equal(c.item[0].name, "f_t=0-tau=1");
  assert_string_equal(c.item[2].name, "f_t=0-tau=4");
  assert_string_equal(c.item[3].name, "f_t=0.5-tau=1");
  assert_string_equal(c.item[3].set[0], "diffusion.f_t=0.5");
  assert_string_equal(c.item[3].caption, "f_t = 0.5, tau = 1");
  cf_combinations_clear(&c);
}

static void several_scenes_lead_the_names(void **state) {
  (void)state;
  cf_combinations c = make(2, (const char *const[]){"diffusion.k=1,2"}, 1);
  assert_int_equal(c.count, 4);
  assert_string_equal(c.item[0].name, "cone-k=1");
  assert_string_equal(c.item[3].name, "ink.v2-k=2");
  assert_int_equal(c.item[3].scene, 1);
  cf_combinations_clear(&c);
  c = make(2, NULL, 0);
  assert_int_equal(c.count, 2);
  assert_string_equal(c.item[1].name, "ink.v2");
  cf_combinations_clear(&c);
}

static void commas_in_brackets_and_quotes_belong_to_the_value(void **state) {
  (void)state;
  cf_combinations c = make(1, (const char *const[]){"velocity=[0, 1],[2, \"min(x,1)\"],'a,b'"}, 1);
  assert_int_equal(c.count, 3);
  assert_string_equal(c.item[1].set[0], "velocity=[2, \"min(x,1)\"]");
  assert_string_equal(c.item[2].set[0], "velocity='a,b'");
  assert_string_equal(c.item[0].name, "velocity=_0__1_");
  cf_combinations_clear(&c);
}

static void keys_that_end_alike_are_told_apart(void **state) {
  (void)state;
  cf_combinations c =
      make(1, (const char *const[]){"fields.a.diffusion.k=1,2", "fields.b.diffusion.k=1,2"}, 2);
  assert_string_equal(c.item[1].name, "fields.a.diffusion.k=1-fields.b.diffusion.k=2");
  cf_combinations_clear(&c);
}

static void what_makes_no_sense_is_refused(void **state) {
  (void)state;
  static const char *const bad[][2] = {
      {"k=1,,2", "a value is empty"}, {"k=1,2,1", "there twice"},   {"k=a b,a_b", "would be called k=a_b"},
      {"k=", "a value is empty"},     {"k=1,", "a value is empty"},
  };
  cf_combinations c;
  for (size_t i = 0; i < sizeof bad / sizeof bad[0]; ++i) {
    assert_int_equal(cf_combinations_make(&c, 1, scenes, 1, &bad[i][0]), CF_BAD_USAGE);
    if (strstr(cf_status_sentence(), bad[i][1]) == NULL) fail_msg("%s", cf_status_sentence());
  }
  const char *const twice[] = {"k=1,2", "k=3,4"};
  assert_int_equal(cf_combinations_make(&c, 1, scenes, 2, twice), CF_BAD_USAGE);
}

static void every_failed_allocation_is_a_failure_without_leaks(void **state) {
  (void)state;
  const char *const grid[] = {"k=1,2", "tau=3,4"};
  cf_combinations c;
  for (long n = 1;; ++n) {
    cf_mem_fail_at(n);
    const cf_status status = cf_combinations_make(&c, 2, scenes, 2, grid);
    cf_mem_fail_at(0);
    if (status == CF_OK) break;
    assert_int_equal(status, CF_NO_MEMORY);
  }
  cf_combinations_clear(&c);
}

/* --- the program -------------------------------------------------------------------------------------------- */

static const char *const scene_text =
    "cattaneo: 1\nmodel: tracer\ndomain: {size: [1, 1], cells: [32, 32]}\n"
    "time: {end: 1, dt: 0.01}\ndiffusion: {k: 0.1, tau: 1, f_t: 0.5}\n"
    "fields: {phi: {initial: 'exp(-((x-.5)^2+(y-.5)^2)/.01)'}}\noutput: {checkpoint: {every: 10 steps}}\n";

static int run(const char *folder, const char *before, const char *words) {
  char command[4096];
  snprintf(command, sizeof command,
           "cd '%s' && %s '%s/bin/cattaneo' sweep scene.yaml -o all %s > out.txt 2>&1", folder, before,
           CF_BINARY_DIR, words);
  const int how = system(command);
  return WIFEXITED(how) ? WEXITSTATUS(how) : -1;
}

static int lines_of(const char *folder, const char *name, const char *part) {
  char path[2048], line[8192];
  int count = 0;
  snprintf(path, sizeof path, "%s/%s", folder, name);
  FILE *f = fopen(path, "r");
  assert_non_null(f);
  while (fgets(line, sizeof line, f) != NULL) count += strstr(line, part) != NULL ? 1 : 0;
  fclose(f);
  return count;
}

static void a_sweep_leaves_a_table_and_a_sheet_and_keeps_what_is_finished(void **state) {
  (void)state;
  const char *folder = folder_fresh("sweep");
  file_write(folder, "scene.yaml", scene_text);
  assert_int_equal(run(folder, "", "--grid diffusion.f_t=0,1 --grid 'diffusion.k=0.1,0.2' -j 2"), 0);
  assert_int_equal(lines_of(folder, "all/table.csv", "run,diffusion.f_t,diffusion.k,exit_code,step,time"), 1);
  assert_int_equal(lines_of(folder, "all/table.csv", ",0,100,1,"), 4);
  assert_true(file_size(folder, "all/sheet.png") > 5000);
  const long log = file_size(folder, "all/f_t=0-k=0.1/metrics.csv");
  assert_int_equal(run(folder, "", "--grid diffusion.f_t=0,1,0.5 --grid 'diffusion.k=0.1,0.2' -j 2"), 0);
  assert_int_equal(lines_of(folder, "all/table.csv", ",0,100,1,"), 6);
  assert_int_equal(file_size(folder, "all/f_t=0-k=0.1/metrics.csv"), log);
  assert_int_equal(
      run(folder, "", "--grid diffusion.f_t=0,1 --grid diffusion.k=0.1,0.2 --set diffusion.tau=2"), 2);
  assert_int_equal(lines_of(folder, "out.txt", "another scene"), 1);
}

static void a_wrong_value_is_told_before_anything_runs(void **state) {
  (void)state;
  const char *folder = folder_fresh("sweep-bad");
  file_write(folder, "scene.yaml", scene_text);
  assert_int_equal(run(folder, "", "--grid diffusion.f_t=0,2"), 2);
  assert_int_equal(file_size(folder, "all"), -1);
}

static void a_sweep_that_was_stopped_goes_on(void **state) {
  (void)state;
  const char *folder = folder_fresh("sweep-stop");
  const char *grid = "--grid diffusion.f_t=0,0.5 --set time.dt=2e-6 --set domain.cells=[64,64] -j 2";
  char early[64]; /* but not before the runs have begun */
  snprintf(early, sizeof early, "timeout --foreground -s TERM --preserve-status %d",
           getenv("SANITIZED") != NULL ? 20 : 3);
  file_write(folder, "scene.yaml", scene_text);
  assert_int_equal(run(folder, early, grid), 130);
  assert_int_equal(lines_of(folder, "out.txt", "the same command again goes on"), 1);
  assert_int_equal(lines_of(folder, "all/table.csv", ",130,"), 2);
  assert_int_equal(run(folder, early, grid), 130);
  assert_true(lines_of(folder, "all/f_t=0.5/log.txt", "resumed from") > 0);
}

static void a_run_that_fails_is_told_and_the_others_go_on(void **state) {
  (void)state;
  const char *folder = folder_fresh("sweep-fail");
  file_write(folder, "scene.yaml", scene_text);
  assert_int_equal(run(folder, "", "--grid 'fields.phi.initial=x,1/(x-0.015625)' -j 1"), 1);
  assert_int_equal(lines_of(folder, "out.txt", "1 of 2 runs failed"), 1);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(the_last_grid_changes_fastest),
      cmocka_unit_test(several_scenes_lead_the_names),
      cmocka_unit_test(commas_in_brackets_and_quotes_belong_to_the_value),
      cmocka_unit_test(keys_that_end_alike_are_told_apart),
      cmocka_unit_test(what_makes_no_sense_is_refused),
      cmocka_unit_test(every_failed_allocation_is_a_failure_without_leaks),
      cmocka_unit_test(a_sweep_leaves_a_table_and_a_sheet_and_keeps_what_is_finished),
      cmocka_unit_test(a_wrong_value_is_told_before_anything_runs),
      cmocka_unit_test(a_sweep_that_was_stopped_goes_on),
      cmocka_unit_test(a_run_that_fails_is_told_and_the_others_go_on),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
