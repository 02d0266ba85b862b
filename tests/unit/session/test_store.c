/* SPDX-License-Identifier: MIT
 *
 * cf_sim_save and cf_sim_load: a loaded simulation goes on with the same bits, files that do not fit change nothing,
 * and threads that each have their own simulation do not disturb each other.
 */
/* also in single precision */
#include <math.h>
#include <pthread.h>
#include <string.h>

#include "base/mem.h"
#include "folders.h"
#include "model/sim.h"
#include "session/session.h"
#include "testing.h"

static const char *const scene_text =
    "cattaneo: 1\n"
    "model: tracer\n"
    "title: two scalars in a vortex\n"
    "domain: {size: [1, 0.75], cells: [32, 24]}\n"
    "time: {end: 0.1, dt: 0.004}\n"
    "diffusion: {k: 0.02, tau: 0.3}\n"
    "fields:\n"
    "  phi: {initial: 'exp(-((x-.4)^2+(y-.3)^2)/.005)'}\n"
    "  dye: {initial: 'x > 0.5 ? 1 : 0', diffusion: {f_t: 0.3}}\n"
    "velocity: ['sin(pi*x)*cos(pi*y/.75)*(1+t)', '-.75*cos(pi*x)*sin(pi*y/.75)*(1+t)']\n"
    "sources:\n"
    "  - {field: phi, shape: sphere, center: [.7, .4], radius: .1, rate: '5*sin(20*t)'}\n";

typedef struct one {
  cf_scene *scene;
  cf_sim *sim;
} one;

static one open_at(const char *folder, const int overrides, const char *const *set) {
  char path[1024];
  one o;
  snprintf(path, sizeof path, "%s/scene.yaml", folder);
  OK(cf_scene_read(&o.scene, path, overrides, set));
  OK(cf_sim_create(&o.sim, o.scene, 2));
  return o;
}

static void close_one(const one *o) {
  cf_sim_destroy(o->sim);
  cf_scene_destroy(o->scene);
}

static const char *folder_with_scene(const char *name) {
  const char *folder = folder_fresh(name);
  file_write(folder, "scene.yaml", scene_text);
  return folder;
}

static bool same_state(const one *a, const one *b) {
  const char *name;
  bool same =
      cf_sim_time(a->sim) == cf_sim_time(b->sim) && cf_sim_step_count(a->sim) == cf_sim_step_count(b->sim);
  for (int f = 0; (name = cf_sim_field_name(a->sim, f)) != NULL; ++f)
    for (int c = 0; c < 2; ++c) {
      cf_view v, w;
      if (cf_sim_field(a->sim, name, c, &v) != CF_OK) continue;
      OK(cf_sim_field(b->sim, name, c, &w));
      for (int j = 0; j < v.shape[1]; ++j)
        same = same && memcmp(v.at + j * v.stride[1], w.at + j * w.stride[1],
                              (size_t)v.shape[0] * sizeof(cf_real)) == 0;
    }
  double here[CF_METRICS_MAX], there[CF_METRICS_MAX];
  cf_metric names[CF_METRICS_MAX];
  const int count = cf_sim_metric_names(a->sim, names);
  cf_sim_metrics(a->sim, here);
  cf_sim_metrics(b->sim, there);
  for (int i = 5; i < count; ++i) same = same && here[i] == there[i];
  return same;
}

static void goes_on(const char *setting) {
  const char *folder = folder_with_scene("store");
  const one whole = open_at(folder, 1, &setting), other = open_at(folder, 1, &setting);
  char path[1024];
  snprintf(path, sizeof path, "%s/state.h5", folder);
  for (int i = 0; i < 7; ++i) OK(cf_sim_step(whole.sim, NULL));
  OK(cf_sim_save(whole.sim, path));
  assert_false(same_state(&whole, &other));
  OK(cf_sim_load(other.sim, path));
  assert_true(same_state(&whole, &other));
  OK(cf_sim_run(whole.sim, INFINITY, NULL, NULL));
  OK(cf_sim_run(other.sim, INFINITY, NULL, NULL));
  assert_true(same_state(&whole, &other));
  OK(cf_sim_load(whole.sim, path)); /* and back */
  assert_int_equal(cf_sim_step_count(whole.sim), 7);
  close_one(&whole);
  close_one(&other);
}

static void a_loaded_simulation_goes_on_with_the_same_bits(void **state) {
  (void)state;
  goes_on("time.dt=0.004");
  goes_on("velocity=[0.1, 0]");
}

/* The step is chosen by a velocity that changes in time. */
static void so_it_does_where_the_step_is_automatic(void **state) {
  (void)state;
  goes_on("time={end: 0.1, dt: auto, cfl: 0.01}");
}

static void checkpoints_of_a_run_can_be_loaded(void **state) {
  (void)state;
  const char *folder = folder_with_scene("store-run");
  char scene[1024], path[1024];
  snprintf(scene, sizeof scene, "%s/scene.yaml", folder);
  snprintf(path, sizeof path, "%s/run", folder);
  cf_session *s;
  const cf_session_options o = {.folder = path, .threads = 1, .steps = 5};
  OK(cf_session_start(&s, scene, 0, NULL, &o));
  OK(cf_session_run(s));
  cf_session_close(s);
  const one ours = open_at(folder, 0, NULL), loaded = open_at(folder, 0, NULL);
  snprintf(path, sizeof path, "%s/run/checkpoint_000005.h5", folder);
  for (int i = 0; i < 5; ++i) OK(cf_sim_step(ours.sim, NULL));
  OK(cf_sim_load(loaded.sim, path));
  assert_true(same_state(&ours, &loaded));
  close_one(&ours);
  close_one(&loaded);
}

static void a_file_of_another_scene_changes_nothing(void **state) {
  (void)state;
  static const char *const set[] = {"diffusion.tau=0.4"};
  const char *folder = folder_with_scene("store-other");
  const one a = open_at(folder, 1, set), b = open_at(folder, 0, NULL), fresh = open_at(folder, 0, NULL);
  char path[1024];
  snprintf(path, sizeof path, "%s/state.h5", folder);
  OK(cf_sim_step(a.sim, NULL));
  OK(cf_sim_save(a.sim, path));
  assert_int_equal(cf_sim_load(b.sim, path), CF_BAD_FILE);
  assert_non_null(strstr(cf_status_sentence(), "another scene"));
  assert_non_null(strstr(cf_status_sentence(), "which says `  tau: 0.4` where this one says `  tau: "));
  assert_true(same_state(&b, &fresh));
  close_one(&a);
  close_one(&b);
  close_one(&fresh);
}

static void how_a_scene_is_called_and_shown_may_change(void **state) {
  (void)state;
  static const char *const set[] = {"title=Other", "render.samples=3", "output.preview.field=phi"};
  const char *folder = folder_with_scene("store-shown");
  const one a = open_at(folder, 0, NULL), b = open_at(folder, 3, set);
  char path[1024];
  snprintf(path, sizeof path, "%s/state.h5", folder);
  OK(cf_sim_step(a.sim, NULL));
  OK(cf_sim_save(a.sim, path));
  OK(cf_sim_load(b.sim, path));
  assert_true(same_state(&a, &b));
  close_one(&a);
  close_one(&b);
}

static void a_damaged_file_changes_nothing(void **state) {
  (void)state;
  const char *folder = folder_with_scene("store-damaged");
  const one a = open_at(folder, 0, NULL), fresh = open_at(folder, 0, NULL);
  char path[1024];
  snprintf(path, sizeof path, "%s/state.h5", folder);
  assert_int_equal(cf_sim_load(a.sim, path), CF_BAD_FILE); /* not there */
  OK(cf_sim_step(a.sim, NULL));
  OK(cf_sim_save(a.sim, path));
  FILE *f = fopen(path, "r+b");
  assert_non_null(f);
  fseek(f, -100, SEEK_END);
  fputc(0x5a, f);
  fclose(f);
  assert_int_equal(cf_sim_load(fresh.sim, path), CF_BAD_FILE);
  assert_int_equal(cf_sim_step_count(fresh.sim), 0);
  assert_int_equal(cf_sim_save(a.sim, "/nowhere/state.h5"), CF_CANNOT_WRITE);
  close_one(&a);
  close_one(&fresh);
}

/* --- threads ---------------------------------------------------------------------------------------------- */

typedef struct worker {
  const char *folder;
  int number;
  double sum;
  cf_status status;
} worker;

static cf_status work(worker *w) {
  char scene[1024], path[1024];
  cf_scene *s;
  cf_sim *sim;
  double values[CF_METRICS_MAX];
  snprintf(scene, sizeof scene, "%s/scene.yaml", w->folder);
  snprintf(path, sizeof path, "%s/state-%d.h5", w->folder, w->number);
  CF_TRY(cf_scene_read(&s, scene, 0, NULL));
  CF_TRY(cf_sim_create(&sim, s, 1));
  CF_TRY(cf_sim_run(sim, 0.02, NULL, NULL));
  CF_TRY(cf_sim_save(sim, path));
  CF_TRY(cf_sim_run(sim, INFINITY, NULL, NULL));
  CF_TRY(cf_sim_load(sim, path));
  CF_TRY(cf_sim_run(sim, INFINITY, NULL, NULL));
  cf_sim_metrics(sim, values);
  w->sum = values[5];
  cf_sim_destroy(sim);
  cf_scene_destroy(s);
  return CF_OK;
}

static void *work_in_thread(void *context) {
  worker *w = context;
  w->status = work(w);
  return NULL;
}

#define WORKERS 4

static void threads_with_simulations_of_their_own_agree(void **state) {
  (void)state;
  const char *folder = folder_with_scene("store-threads");
  worker w[WORKERS];
  pthread_t thread[WORKERS];
  for (int i = 0; i < WORKERS; ++i) {
    w[i] = (worker){.folder = folder, .number = i};
    assert_int_equal(pthread_create(&thread[i], NULL, work_in_thread, &w[i]), 0);
  }
  for (int i = 0; i < WORKERS; ++i) pthread_join(thread[i], NULL);
  for (int i = 0; i < WORKERS; ++i) {
    assert_int_equal(w[i].status, CF_OK);
    assert_true(w[i].sum == w[0].sum);
  }
}

/* --- memory ----------------------------------------------------------------------------------------------- */

static void saving_and_loading_survive_any_allocation_that_fails(void **state) {
  (void)state;
  const char *folder = folder_with_scene("store-memory");
  const one a = open_at(folder, 0, NULL), b = open_at(folder, 0, NULL);
  char path[1024];
  snprintf(path, sizeof path, "%s/state.h5", folder);
  OK(cf_sim_step(a.sim, NULL));
  for (int load = 0; load < 2; ++load) {
    cf_status s = CF_NO_MEMORY;
    long n = 1;
    for (; s == CF_NO_MEMORY && n < 1000; ++n) {
      cf_mem_fail_at(n);
      s = load ? cf_sim_load(b.sim, path) : cf_sim_save(a.sim, path);
      cf_mem_fail_at(0);
    }
    OK(s);
    assert_true(n > 3);
  }
  assert_true(same_state(&a, &b));
  close_one(&a);
  close_one(&b);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(a_loaded_simulation_goes_on_with_the_same_bits),
      cmocka_unit_test(so_it_does_where_the_step_is_automatic),
      cmocka_unit_test(checkpoints_of_a_run_can_be_loaded),
      cmocka_unit_test(a_file_of_another_scene_changes_nothing),
      cmocka_unit_test(how_a_scene_is_called_and_shown_may_change),
      cmocka_unit_test(a_damaged_file_changes_nothing),
      cmocka_unit_test(threads_with_simulations_of_their_own_agree),
      cmocka_unit_test(saving_and_loading_survive_any_allocation_that_fails),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
