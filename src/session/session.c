/* SPDX-License-Identifier: MIT
 *
 * The order of things makes a run safe to stop anywhere: run.yaml is there before anything else; a step is
 * followed by its row in metrics.csv, then by its frame, then by a checkpoint if one is due. On resume all
 * that is younger than the checkpoint is cut and written again, so both ways give the same files.
 */
#define _GNU_SOURCE
#include "session/session.h"

#include <omp.h>
#include <stdio.h>
#include <string.h>
#include <time.h>

#include "base/mem.h"
#include "base/version.h"
#include "session/output.h"
#include "session/session_part.h"
#include "session/space.h"

double cf_session_clock(void) {
  struct timespec t;
  clock_gettime(CLOCK_MONOTONIC, &t);
  return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

/* A log that cannot be written does not stop a run. */
void cf_session_say(cf_session *s, const cf_line_kind kind, const char *line) {
  (void)cf_folder_log(&s->folder, "%s", line);
  if (s->o.say != NULL) s->o.say(s->o.context, kind, line);
}

/* --- files ------------------------------------------------------------------------------------------------
 */

static cf_status write_run_yaml(cf_session *s) {
  cf_path path;
  char *text;
  const char *format =
      "# This run, with every default filled in. `cattaneo resume` reads it; so can `cattaneo run`.\n"
      "# cattaneo %s, commit %s, %s\n# threads: %d\n%s";
  const int threads = s->sim->grid.threads;
  const int length =
      snprintf(NULL, 0, format, cf_version(), cf_git_hash(), cf_build(), threads, s->scene_text);
  CF_TRY(cf_path_make(&path, "%s/run.yaml", s->folder.path.text));
  CF_TRY(cf_new_array((void **)&text, (size_t)length + 1, 1));
  snprintf(text, (size_t)length + 1, format, cf_version(), cf_git_hash(), cf_build(), threads, s->scene_text);
  const cf_status status = cf_file_write(path.text, text, (size_t)length);
  cf_free(text);
  return status;
}

cf_status cf_session_open_metrics(cf_session *s, const bool resume, const int64_t last) {
  cf_metric column[CF_METRICS_MAX];
  const char *names[CF_METRICS_MAX];
  const int count = cf_sim_metric_names(s->sim, column);
  for (int i = 0; i < count; ++i) names[i] = column[i].name;
  cf_path path;
  CF_TRY(cf_path_make(&path, "%s/metrics.csv", s->folder.path.text));
  return resume ? cf_table_resume(&s->metrics, path.text, count, names, last, NULL)
                : cf_table_create(&s->metrics, path.text, count, names);
}

cf_status cf_session_write_metrics(const cf_session *s) {
  double values[CF_METRICS_MAX];
  cf_sim_metrics(s->sim, values);
  return cf_table_row(s->metrics, values);
}

/* --- opening ----------------------------------------------------------------------------------------------
 */

static int threads_of(const cf_session_options *o) {
  return o->threads > 0 ? o->threads : omp_get_num_procs();
}

/* out/<name of the scene file without its ending>. */
static cf_status default_folder(const char *scene, cf_path *folder) {
  const char *slash = strrchr(scene, '/'), *name = slash != NULL ? slash + 1 : scene;
  const char *dot = strrchr(name, '.');
  const int length = dot != NULL && dot > name ? (int)(dot - name) : (int)strlen(name);
  return cf_path_make(folder, "out/%.*s", length, name);
}

cf_status cf_session_make_sim(cf_session *s) {
  CF_TRY(cf_sim_create(&s->sim, s->scene, threads_of(&s->o)));
  CF_TRY(cf_output_check(s->sim));
  return cf_sim_check_finite(s->sim);
}

static cf_status read_scene(cf_session *s, const char *path, const int overrides, const char *const *set) {
  CF_TRY(cf_scene_read(&s->scene, path, overrides, set));
  CF_TRY(cf_space_check_memory(s->scene, s->o.memory));
  CF_TRY(cf_scene_write(s->scene, &s->scene_text));
  return cf_session_make_sim(s);
}

static void note_start(cf_session *s) {
  s->first_step = s->sim->step;
  s->time_at_start = s->sim->time;
  s->started = s->checkpoint_clock = cf_session_clock();
}

/* How the model computes, once in the log of a run. */
static void say_plans(cf_session *s) {
  const cf_model *model = s->sim->model;
  char line[CF_SENTENCE_MAX];
  for (int i = 0; model->describe != NULL && model->describe(s->sim->state, i, line, sizeof line); ++i)
    cf_session_say(s, CF_LINE_NOTE, line);
  cf_space_text(s->sim, s->folder.path.text, line, sizeof line);
  cf_session_say(s, CF_LINE_NOTE, line);
}

cf_status cf_session_write_first(cf_session *s) {
  CF_TRY(cf_session_write_metrics(s));
  return cf_output_frame(s->sim, s->folder.path.text);
}

static cf_status start(cf_session *s, const char *scene, const int overrides, const char *const *set) {
  cf_path folder;
  CF_TRY(read_scene(s, scene, overrides, set));
  if (s->o.folder != NULL)
    CF_TRY(cf_path_make(&folder, "%s", s->o.folder));
  else
    CF_TRY(default_folder(scene, &folder));
  CF_TRY(cf_folder_create(&s->folder, folder.text, s->o.force));
  CF_TRY(cf_space_check_disk(s->sim, s->folder.path.text));
  CF_TRY(write_run_yaml(s));
  CF_TRY(cf_session_open_metrics(s, false, 0));
  note_start(s);
  say_plans(s);
  return cf_session_write_first(s);
}

static cf_status resume(cf_session *s, const char *folder) {
  cf_path path;
  CF_TRY(cf_folder_open(&s->folder, folder));
  CF_TRY(cf_path_make(&path, "%s/run.yaml", folder));
  CF_TRY(read_scene(s, path.text, 0, NULL));
  CF_TRY(cf_session_restore(s));
  s->was_finished = cf_sim_finished(s->sim);
  note_start(s);
  return CF_OK;
}

static cf_status open(cf_session **s, const cf_session_options *o, cf_session **fresh) {
  *s = NULL;
  CF_TRY(CF_NEW(fresh, 1));
  (*fresh)->o = *o;
  (*fresh)->last_checkpoint = -1;
  return CF_OK;
}

static cf_status hand_over(const cf_status status, cf_session *fresh, cf_session **s) {
  if (status == CF_OK)
    *s = fresh;
  else
    cf_session_close(fresh);
  return status;
}

cf_status cf_session_start(cf_session **s, const char *scene, const int overrides, const char *const *set,
                           const cf_session_options *o) {
  cf_session *fresh;
  CF_TRY(open(s, o, &fresh));
  return hand_over(start(fresh, scene, overrides, set), fresh, s);
}

cf_status cf_session_resume(cf_session **s, const char *folder, const cf_session_options *o) {
  cf_session *fresh;
  CF_TRY(open(s, o, &fresh));
  return hand_over(resume(fresh, folder), fresh, s);
}

void cf_session_close(cf_session *s) {
  if (s == NULL) return;
  cf_table_close(s->metrics);
  cf_folder_close(&s->folder);
  cf_sim_destroy(s->sim);
  cf_scene_destroy(s->scene);
  cf_free(s->scene_text);
  cf_free(s);
}

bool cf_session_was_finished(const cf_session *s) { return s->was_finished; }
const cf_sim *cf_session_sim(const cf_session *s) { return s->sim; }
const char *cf_session_folder(const cf_session *s) { return s->folder.path.text; }
