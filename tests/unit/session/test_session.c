/* SPDX-License-Identifier: MIT
 *
 * A run and its folder: the same bytes for any number of threads, for a rerun, and for a run that was stopped
 * anywhere and resumed; folders that are in use are refused; nothing is written for a bad scene.
 */
#include "session/session.h"

#include "base/mem.h"
#include "folders.h"
#include "testing.h"

static const char *const scene_text =
    "cattaneo: 1\n"
    "title: two scalars in a vortex\n"
    "model: tracer\n"
    "domain: {size: [1, 0.75], cells: [128, 96], walls: {x-: insulated, x+: insulated, y-: {value: "
    "'x*(1-x)*cos(t)'}, "
    "y+: open}}\n"
    "time: {end: 0.1, dt: 0.004, frames: 50}\n"
    "diffusion: {k: 0.02, tau: 0.3}\n"
    "fields:\n"
    "  phi: {initial: 'exp(-((x-.4)^2+(y-.3)^2)/.005)'}\n"
    "  dye: {initial: 'x > 0.5 ? 1 : 0', diffusion: {f_t: 0.3, k: '0.01*(1+x)', flux_rate: material}}\n"
    "velocity: ['sin(pi*x)*cos(pi*y)*(1+t)', '-cos(pi*x)*sin(pi*y)*(1+t)']\n"
    "sources:\n"
    "  - {field: phi, shape: sphere, center: [.7, .4], radius: .1, rate: '5*sin(20*t)'}\n"
    "  - {field: dye, at: [.2, .6], amount: 0.3}\n"
    "  - {field: phi, shape: box, center: [.2, .2], half: [.05, .05], value: 0.5}\n"
    "output: {formats: [vtkhdf, png, npy], fields: [phi, q, dye, velocity], checkpoint: {every: 7 steps, "
    "keep: 2}}\n";

/* What must be equal: frames, pictures and the table; run.yaml names the threads. */
static const char *const compared[] = {"fields", "preview", "metrics", NULL};

static int steps_left;
static bool stop_after(void *context, const cf_progress *p) {
  (void)context;
  (void)p;
  return --steps_left != 0;
}

static cf_session_options options(const char *folder, const int threads) {
  return (cf_session_options){.folder = folder, .threads = threads, .force = true};
}

static void run_whole(const char *scene, const char *folder, const int threads) {
  cf_session *s;
  const cf_session_options o = options(folder, threads);
  OK(cf_session_start(&s, scene, 0, NULL, &o));
  OK(cf_session_run(s));
  cf_session_close(s);
}

static const char *scene_file(const char *folder) {
  static char path[1024];
  file_write(folder, "scene.yaml", scene_text);
  snprintf(path, sizeof path, "%s/scene.yaml", folder);
  return path;
}

static void same_bytes_for_any_number_of_threads_and_again(void **state) {
  (void)state;
  const char *one = folder_fresh("threads-1"), *scene = scene_file(folder_fresh("threads-scene"));
  run_whole(scene, one, 1);
  for (int run = 1; run <= 3; ++run) {
    const char *other = folder_fresh("threads-n");
    run_whole(scene, other, run);
    assert_int_equal(folders_compare(one, other, compared), folders_compare(other, one, compared));
  }
  assert_true(folders_compare(one, one, compared) > 40);
}

/* Stopped by the callback at every step in turn (each stop writes a checkpoint), resumed each time. */
static void stop_and_resume_equals_an_unbroken_run(void **state) {
  (void)state;
  const char *whole = folder_fresh("resume-whole"), *broken = folder_fresh("resume-broken");
  const char *scene = scene_file(folder_fresh("resume-scene"));
  run_whole(scene, whole, 2);
  cf_session *s;
  cf_session_options o = options(broken, 2);
  o.progress = stop_after;
  steps_left = 1;
  OK(cf_session_start(&s, scene, 0, NULL, &o));
  cf_status status = cf_session_run(s);
  cf_session_close(s);
  int resumes = 0;
  for (; status == CF_STOPPED; ++resumes) {
    steps_left = 1 + resumes % 3;
    OK(cf_session_resume(&s, broken, &o));
    status = cf_session_run(s);
    cf_session_close(s);
  }
  OK(status);
  assert_true(resumes > 8);
  assert_int_equal(folders_compare(whole, broken, compared), folders_compare(broken, whole, compared));
}

/* A run that died (here: was closed) without a last checkpoint goes on from an older one; what is younger is cut. */
static void a_run_that_died_goes_on_from_the_newest_checkpoint(void **state) {
  (void)state;
  const char *whole = folder_fresh("died-whole"), *died = folder_fresh("died");
  const char *scene = scene_file(folder_fresh("died-scene"));
  run_whole(scene, whole, 1);
  for (int steps = 1; steps <= 19; steps += 6) { /* before the first checkpoint, after it, after the second */
    cf_session *s;
    cf_session_options o = options(died, 1);
    o.steps = steps;
    OK(cf_session_start(&s, scene, 0, NULL, &o));
    OK(cf_session_run(s)); /* leaves a checkpoint at its end: remove it */
    cf_session_close(s);
    char last[1100];
    snprintf(last, sizeof last, "%s/checkpoint_%06d.h5", died, steps);
    assert_int_equal(remove(last), 0);
    o.steps = 0;
    OK(cf_session_resume(&s, died, &o));
    assert_false(cf_session_was_finished(s));
    OK(cf_session_run(s));
    cf_session_close(s);
    assert_int_equal(folders_compare(whole, died, compared), folders_compare(died, whole, compared));
  }
}

static void a_finished_run_says_so_and_stays_as_it_is(void **state) {
  (void)state;
  const char *folder = folder_fresh("finished"), *scene = scene_file(folder_fresh("finished-scene"));
  run_whole(scene, folder, 1);
  cf_session *s;
  const cf_session_options o = options(folder, 1);
  const long before = file_size(folder, "metrics.csv");
  OK(cf_session_resume(&s, folder, &o));
  assert_true(cf_session_was_finished(s));
  OK(cf_session_run(s));
  cf_session_close(s);
  assert_int_equal(file_size(folder, "metrics.csv"), before);
}

static void a_folder_that_holds_a_run_is_refused_unless_forced(void **state) {
  (void)state;
  const char *folder = folder_fresh("refused"), *scene = scene_file(folder_fresh("refused-scene"));
  run_whole(scene, folder, 1);
  cf_session *s;
  cf_session_options o = options(folder, 1);
  o.force = false;
  assert_int_equal(cf_session_start(&s, scene, 0, NULL, &o), CF_BAD_USAGE);
  assert_null(s);
  assert_non_null(strstr(cf_status_sentence(), "--force"));
}

static void a_bad_scene_leaves_nothing_behind(void **state) {
  (void)state;
  const char *scene = scene_file(folder_fresh("bad-scene"));
  const char *const sets[][1] = {{"diffusion.tau=-1"},
                                 {"output.fields=[phi, heat]"},
                                 {"fields.dye.walls=insulated"},
                                 {"output.preview.map=rainbow"},
                                 {"diffusion.k='x - 0.5'"}};
  for (size_t i = 0; i < sizeof sets / sizeof *sets; ++i) {
    char folder[1100];
    cf_session *s;
    snprintf(folder, sizeof folder, "%s/new", folder_fresh("bad"));
    cf_session_options o = options(folder, 1);
    const char *set[] = {sets[i][0], "velocity=[0, 1]"}; /* the second matters to the third case only */
    assert_int_equal(cf_session_start(&s, scene, i == 2 ? 2 : 1, set, &o), CF_BAD_SCENE);
    assert_int_equal(file_size(folder, "."), -1);
  }
}

static void a_run_over_the_memory_limit_is_refused_with_the_numbers(void **state) {
  (void)state;
  const char *scene = scene_file(folder_fresh("memory-scene"));
  const char *set[] = {"domain.cells=[4096, 3072]"};
  cf_session *s;
  cf_session_options o = options(folder_fresh("memory"), 1);
  o.memory = 1e9;
  assert_int_equal(cf_session_start(&s, scene, 1, set, &o), CF_OVER_LIMIT);
  assert_non_null(strstr(cf_status_sentence(), "1 GB"));
}

static void the_ledger_closes_to_round_off(void **state) {
  (void)state;
  const char *scene = scene_file(folder_fresh("ledger-scene"));
  cf_session *s;
  const cf_session_options o = options(folder_fresh("ledger"), 2);
  OK(cf_session_start(&s, scene, 0, NULL, &o));
  OK(cf_session_run(s));
  const cf_sim *sim = cf_session_sim(s);
  cf_metric names[CF_METRICS_MAX];
  double values[CF_METRICS_MAX];
  const int count = cf_sim_metric_names(sim, names);
  cf_sim_metrics(sim, values);
  int errors = 0;
  for (int i = 0; i < count; ++i)
    if (strncmp(names[i].name, "error_", 6) == 0) {
      BELOW(values[i] < 0 ? -values[i] : values[i], sizeof(cf_real) == 8 ? 1e-13 : 1e-5);
      ++errors;
    }
  assert_int_equal(errors, 2);
  cf_session_close(s);
}

/* Long steps that the solver cannot do in 8 iterations; a quarter of them it can. */
static const char *const stiff_text =
    "cattaneo: 1\n"
    "model: tracer\n"
    "domain: {size: [1, 0.75], cells: [64, 48]}\n"
    "time: {end: 0.4, dt: 0.1, frames: 10, retry: 3}\n"
    "diffusion: {k: '1 + 10*x', scheme: sdirk2, tau: 0.01}\n"
    "fields: {phi: {initial: 'exp(-((x-.4)^2+(y-.3)^2)/.005)'}}\n"
    "solver: {max_iterations: 8, tolerance: 1e-9, on_stall: stop}\n"
    "output: {checkpoint: {every: 1 steps}}\n";

static void a_step_that_fails_is_tried_again_in_halves(void **state) {
  (void)state;
  if (sizeof(cf_real) == sizeof(float)) return; /* whose round-off is above that tolerance */
  const char *whole = folder_fresh("retry"), *parts = folder_fresh("retry-parts");
  char scene[1100];
  file_write(whole, "scene.yaml", stiff_text);
  snprintf(scene, sizeof scene, "%s/scene.yaml", whole);
  cf_session *s;
  cf_session_options o = options(whole, 1);
  OK(cf_session_start(&s, scene, 0, NULL, &o));
  OK(cf_session_run(s));
  assert_int_equal(cf_session_sim(s)->retries, 2);
  assert_int_equal(cf_session_sim(s)->step, 16);
  cf_session_close(s);
  /* That steps are short is state like any other. */
  o = options(parts, 1);
  o.steps = 5;
  OK(cf_session_start(&s, scene, 0, NULL, &o));
  OK(cf_session_run(s));
  cf_session_close(s);
  o.steps = 0;
  OK(cf_session_resume(&s, parts, &o));
  OK(cf_session_run(s));
  cf_session_close(s);
  assert_int_equal(folders_compare(whole, parts, compared), folders_compare(parts, whole, compared));
}

static void a_step_that_fails_too_often_ends_the_run(void **state) {
  (void)state;
  const char *folder = folder_fresh("retry-used-up"), *set[] = {"solver.max_iterations=2"};
  char scene[1100];
  file_write(folder, "scene.yaml", stiff_text);
  snprintf(scene, sizeof scene, "%s/scene.yaml", folder);
  cf_session *s;
  const cf_session_options o = options(folder, 1);
  OK(cf_session_start(&s, scene, 1, set, &o));
  assert_int_equal(cf_session_run(s), CF_NOT_CONVERGED);
  assert_non_null(strstr(cf_status_sentence(), "time.retry is used up"));
  cf_session_close(s);
}

/* The n-th allocation fails, for every n until none is left to fail: always a status, never a crash or a leak. */
static void every_failed_allocation_is_a_status(void **state) {
  (void)state;
  const char *scene = scene_file(folder_fresh("allocation-scene"));
  const char *set[] = {"domain.cells=[8, 6]", "time.end=0.004"};
  const char *folder = folder_fresh("allocation");
  long n = 1;
  for (cf_status status = CF_NO_MEMORY; status != CF_OK; ++n) {
    cf_session *s = NULL;
    const cf_session_options o = options(folder, 1);
    cf_mem_fail_at(n);
    status = cf_session_start(&s, scene, 2, set, &o);
    if (status == CF_OK) status = cf_session_run(s);
    cf_mem_fail_at(0);
    cf_session_close(s);
    if (status != CF_OK && status != CF_NO_MEMORY)
      fail_msg("allocation %ld: %s: %s", n, cf_status_name(status), cf_status_sentence());
    assert_true(n < 5000);
  }
  assert_true(n > 50);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(same_bytes_for_any_number_of_threads_and_again),
      cmocka_unit_test(stop_and_resume_equals_an_unbroken_run),
      cmocka_unit_test(a_run_that_died_goes_on_from_the_newest_checkpoint),
      cmocka_unit_test(a_finished_run_says_so_and_stays_as_it_is),
      cmocka_unit_test(a_folder_that_holds_a_run_is_refused_unless_forced),
      cmocka_unit_test(a_bad_scene_leaves_nothing_behind),
      cmocka_unit_test(a_run_over_the_memory_limit_is_refused_with_the_numbers),
      cmocka_unit_test(the_ledger_closes_to_round_off),
      cmocka_unit_test(a_step_that_fails_is_tried_again_in_halves),
      cmocka_unit_test(a_step_that_fails_too_often_ends_the_run),
      cmocka_unit_test(every_failed_allocation_is_a_status),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
/* also in single precision */
