/* SPDX-License-Identifier: MIT
 *
 * For every model that the program has, on a small scene of its own in tests/bits: the files of a run are the same
 * bytes for 1, 2 and 3 threads, when it is run again, and when it is stopped at any of several steps and resumed with
 * another number of threads. And NaN put into any part of its state ends the run with a sentence that names it (or is
 * overwritten without a trace), and the run can be gone on with to the same bytes. Further scenes, of what else models
 * can hold, are held to the same bytes.
 */
#include <math.h>
#include <string.h>
#include <unistd.h>

#include "base/mem.h"
#include "folders.h"
#include "session/session.h"

/* What must be the same: everything but the log and run.yaml, which say how many threads there were. */
static const char *const compared[] = {"metrics", "fields", "particles", "mesh",
                                       "preview", "flakes", "final",     NULL};

typedef struct sick {
  cf_session *session;
  int entry;    /* of the registry; -1: none */
  int64_t step; /* after which the NaN is put there */
  char name[CF_NAME_MAX];
  bool done, number;
} sick;

static void poison_row(cf_real *values, const ptrdiff_t count) {
  if (count > 0) values[count / 2] = (cf_real)NAN;
}

/* NaN in the middle of an entry; false where none can be (a whole number, an empty set). */
static bool poison(cf_entry *e, const cf_box *b) {
  const ptrdiff_t middle = cf_box_at(b, b->n[0] / 2, b->n[1] / 2, b->n[2] / 2);
  if (e->kind == CF_KIND_CELL) e->cell.at[middle] = (cf_real)NAN;
  if (e->kind == CF_KIND_FACE) e->face.at[b->dim - 1][middle] = (cf_real)NAN;
  if (e->kind == CF_KIND_NUMBER) e->number[0] = NAN;
  if (e->kind == CF_KIND_PARTICLES && e->particles->count > 0)
    poison_row(e->particles->attribute[CF_PARTICLE_POSITION].at[0], (ptrdiff_t)e->particles->count);
  return e->kind == CF_KIND_CELL || e->kind == CF_KIND_FACE || e->kind == CF_KIND_NUMBER ||
         (e->kind == CF_KIND_PARTICLES && e->particles->count > 0);
}

static bool infect(void *context, const cf_progress *p) {
  sick *s = context;
  if (p->step != s->step || s->entry < 0 || s->done) return true;
  const cf_sim *sim = cf_session_sim(s->session);
  if (s->entry >= sim->registry.count) return true;
  cf_entry *e = &sim->registry.entry[s->entry];
  snprintf(s->name, sizeof s->name, "%s", e->name);
  s->number = e->kind == CF_KIND_NUMBER;
  s->done = poison(e, &sim->grid.box);
  return true;
}

/* --- runs ------------------------------------------------------------------------------------------------- */

/* The last checkpoint under a name that does not tell how the run came there. */
static void keep_last(const char *folder, const int64_t step) {
  char from[1200], to[1200];
  snprintf(from, sizeof from, "%s/checkpoint_%06lld.h5", folder, (long long)step);
  snprintf(to, sizeof to, "%s/final", folder);
  (void)remove(to);
  assert_int_equal(link(from, to), 0);
}

static cf_status finish(cf_session *s, const char *folder) {
  const cf_status status = cf_session_run(s);
  if (status == CF_OK && cf_sim_finished(cf_session_sim(s)))
    keep_last(folder, cf_sim_step_count(cf_session_sim(s)));
  cf_session_close(s);
  return status;
}

static cf_status run(const char *scene, const char *folder, const int threads, const int64_t steps,
                     sick *ill) {
  const cf_session_options o = {.folder = folder,
                                .force = true,
                                .threads = threads,
                                .steps = steps,
                                .progress = ill != NULL ? infect : NULL,
                                .context = ill};
  cf_session *s;
  OK(cf_session_start(&s, scene, 0, NULL, &o));
  if (ill != NULL) ill->session = s;
  return finish(s, folder);
}

static void go_on(const char *folder, const int threads) {
  const cf_session_options o = {.threads = threads};
  cf_session *s;
  OK(cf_session_resume(&s, folder, &o));
  OK(finish(s, folder));
}

static void same(const char *whole, const char *folder, const char *why) {
  const int count = folders_compare(whole, folder, compared);
  if (count < 3 || count != folders_compare(folder, whole, compared)) fail_msg("%s: other files", why);
}

static void scene_of(const char *model, char path[1024]) {
  snprintf(path, 1024, CF_SOURCE_DIR "/tests/bits/%s.yaml", model);
  if (access(path, R_OK) != 0) fail_msg("%s has no scene %s", model, path);
}

/* --- tests ------------------------------------------------------------------------------------------------ */

static int64_t steps_of(const char *scene) {
  cf_session *s;
  const cf_session_options o = {.folder = folder_fresh("bits-count"), .force = true, .threads = 1};
  OK(cf_session_start(&s, scene, 0, NULL, &o));
  OK(cf_session_run(s));
  const int64_t steps = cf_sim_step_count(cf_session_sim(s));
  cf_session_close(s);
  return steps;
}

static void a_model_gives_the_same_bytes(const char *model) {
  char scene[1024], whole[512], other[512], why[128];
  scene_of(model, scene);
  snprintf(whole, sizeof whole, "%s", folder_fresh("bits-whole"));
  OK(run(scene, whole, 1, 0, NULL));
  for (int threads = 1; threads <= 3; ++threads) {
    snprintf(other, sizeof other, "%s", folder_fresh("bits-threads"));
    snprintf(why, sizeof why, "%s with %d threads", model, threads);
    OK(run(scene, other, threads, 0, NULL));
    same(whole, other, why);
  }
  const int64_t steps = steps_of(scene);
  assert_true(steps >= 6);
  const int64_t stop[] = {1, 2, steps / 2, steps - 1};
  for (int i = 0; i < 4; ++i) {
    snprintf(other, sizeof other, "%s", folder_fresh("bits-stop"));
    snprintf(why, sizeof why, "%s stopped at step %lld", model, (long long)stop[i]);
    OK(run(scene, other, 1 + i % 3, stop[i], NULL));
    go_on(other, 1 + (i + 1) % 3);
    same(whole, other, why);
  }
}

/* A cell, a face, a particle or a number; a cause stands with those that are found after the step. */
static bool says_where(const char *sentence) {
  if (strstr(sentence, "on face (") != NULL) return true;
  if (strstr(sentence, "look for an expression") == NULL && strstr(sentence, "time.dt") == NULL) return false;
  return strstr(sentence, " in cell (") != NULL || strstr(sentence, " at the particle of id ") != NULL ||
         strstr(sentence, " (number ") != NULL;
}

static void a_model_notices_what_is_not_finite(const char *model) {
  char scene[1024], whole[512], other[512], why[256];
  int found = 0;
  scene_of(model, scene);
  snprintf(whole, sizeof whole, "%s", folder_fresh("sick-whole"));
  snprintf(other, sizeof other, "%s", folder_fresh("sick"));
  OK(run(scene, whole, 2, 0, NULL));
  for (sick ill = {.step = 4};; ++ill.entry) {
    ill.done = false;
    ill.name[0] = '\0';
    const cf_status status = run(scene, other, 2, 0, &ill);
    if (ill.name[0] == '\0') break; /* past the last entry */
    if (!ill.done || strcmp(ill.name, "time") == 0 || strcmp(ill.name, "dt") == 0) continue;
    snprintf(why, sizeof why, "%s with NaN in %s", model, ill.name);
    if (status == CF_OK) { /* computed afresh in every step (a number: or compared with, and not true) */
      if (!ill.number) same(whole, other, why);
      continue;
    }
    ++found;
    if (status != CF_NOT_FINITE) fail_msg("%s: %s: %s", why, cf_status_name(status), cf_status_sentence());
    if (strstr(cf_status_sentence(), "step 5") == NULL ||
        strstr(cf_status_sentence(), "checkpoint_000003.h5") == NULL)
      fail_msg("%s: %s", why, cf_status_sentence());
    if (!says_where(cf_status_sentence())) fail_msg("%s: %s", why, cf_status_sentence());
    go_on(other, 1);
    same(whole, other, why);
  }
  print_message("%s: %d entries of the state stop a run\n", model, found);
  assert_true(found > 0);
}

#define BITS(upper, lower)                                       \
  static void lower##_gives_the_same_bytes(void **state) {       \
    (void)state, a_model_gives_the_same_bytes(#lower);           \
  }                                                              \
  static void lower##_notices_what_is_not_finite(void **state) { \
    (void)state, a_model_notices_what_is_not_finite(#lower);     \
  }
CF_MODEL_WORDS(BITS)

#define FURTHER(F) F(tracer_around) F(tracer_sparse) F(snowfall_around)
#define FURTHER_BITS(scene)                                \
  static void scene##_gives_the_same_bytes(void **state) { \
    (void)state, a_model_gives_the_same_bytes(#scene);     \
  }
FURTHER(FURTHER_BITS)

int main(void) {
#define TESTS(upper, lower) \
  cmocka_unit_test(lower##_gives_the_same_bytes), cmocka_unit_test(lower##_notices_what_is_not_finite),
#define FURTHER_TESTS(scene) cmocka_unit_test(scene##_gives_the_same_bytes),
  const struct CMUnitTest tests[] = {CF_MODEL_WORDS(TESTS) FURTHER(FURTHER_TESTS)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
