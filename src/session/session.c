/* SPDX-License-Identifier: MIT
 *
 * The order of things makes a run safe to stop anywhere: run.yaml is there before anything else; a step is
 * followed by its row in metrics.csv, then by its frame, then by a checkpoint if one is due. On resume all
 * that is younger than the checkpoint is cut and written again, so both ways give the same files.
 */
#define _GNU_SOURCE
#include "session/session.h"

#include <math.h>
#include <omp.h>
#include <stdio.h>
#include <string.h>
#include <time.h>

#include "base/mem.h"
#include "base/version.h"
#include "io/checkpoint.h"
#include "io/folder.h"
#include "io/frame.h"
#include "io/table.h"
#include "session/output.h"

struct cf_session {
  cf_session_options o;
  cf_scene *scene;
  char *scene_text; /* resolved: what run.yaml holds below its head, and every checkpoint */
  cf_sim *sim;
  cf_folder folder;
  cf_table *metrics;
  bool was_finished, warned;
  int64_t first_step, last_checkpoint; /* steps at this start, and of the newest checkpoint; -1: none */
  int64_t stalls;
  double started, checkpoint_clock, time_at_start;
};

static double clock_now(void) {
  struct timespec t;
  clock_gettime(CLOCK_MONOTONIC, &t);
  return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

/* To log.txt, and to the terminal through the caller. A log that cannot be written does not stop a run. */
static void say(cf_session *s, const char *line) {
  (void)cf_folder_log(&s->folder, "%s", line);
  if (s->o.say != NULL) s->o.say(s->o.context, line);
}

/* --- memory -----------------------------------------------------------------------------------------------
 */

double cf_session_memory(const cf_scene *scene) { return cf_model_of(scene->model)->memory(scene); }

static cf_status check_memory(const cf_session *s) {
  const double needed = cf_session_memory(s->scene);
  if (s->o.memory > 0 && needed > s->o.memory)
    return cf_fail(
        CF_OVER_LIMIT,
        "the scene needs up to %.3g GB and the limit is %.3g GB: use fewer cells, single precision, or "
        "raise --mem-limit",
        needed / 1e9, s->o.memory / 1e9);
  return CF_OK;
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

static cf_status open_metrics(cf_session *s, const bool resume, const int64_t last) {
  cf_metric column[CF_METRICS_MAX];
  const char *names[CF_METRICS_MAX];
  const int count = cf_sim_metric_names(s->sim, column);
  for (int i = 0; i < count; ++i) names[i] = column[i].name;
  cf_path path;
  CF_TRY(cf_path_make(&path, "%s/metrics.csv", s->folder.path.text));
  return resume ? cf_table_resume(&s->metrics, path.text, count, names, last, NULL)
                : cf_table_create(&s->metrics, path.text, count, names);
}

static cf_status write_metrics(const cf_session *s) {
  double values[CF_METRICS_MAX];
  cf_sim_metrics(s->sim, values);
  return cf_table_row(s->metrics, values);
}

static cf_status write_checkpoint(cf_session *s) {
  const cf_stamp stamp = {
      .title = s->scene->title, .scene = s->scene_text, .time = s->sim->time, .step = s->sim->step};
  CF_TRY(cf_table_sync(s->metrics));
  CF_TRY(cf_checkpoint_write(s->folder.path.text, &s->sim->registry, &stamp,
                             (int)s->scene->output.checkpoint.keep));
  s->last_checkpoint = s->sim->step;
  s->checkpoint_clock = clock_now();
  return CF_OK;
}

static bool checkpoint_is_due(const cf_session *s) {
  const cf_interval *every = &s->scene->output.checkpoint.every;
  if (every->every <= 0) return false;
  if (every->in_steps) return s->sim->step % (int64_t)every->every == 0;
  return clock_now() - s->checkpoint_clock >= every->every;
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

static cf_status make_sim(cf_session *s) {
  CF_TRY(check_memory(s));
  CF_TRY(cf_scene_write(s->scene, &s->scene_text));
  CF_TRY(cf_sim_create(&s->sim, s->scene, threads_of(&s->o)));
  return cf_output_check(s->sim);
}

static void note_start(cf_session *s) {
  s->first_step = s->sim->step;
  s->time_at_start = s->sim->time;
  s->started = s->checkpoint_clock = clock_now();
}

/* How the model computes, once in the log of a run. */
static void say_plans(cf_session *s) {
  const cf_model *model = s->sim->model;
  char line[CF_SENTENCE_MAX];
  for (int i = 0; model->describe != NULL && model->describe(s->sim->state, i, line, sizeof line); ++i)
    say(s, line);
}

static cf_status write_first_frame(cf_session *s) {
  CF_TRY(write_metrics(s));
  return cf_output_frame(s->sim, s->folder.path.text);
}

static cf_status start(cf_session *s, const char *scene, const int overrides, const char *const *set) {
  cf_path folder;
  CF_TRY(cf_scene_read(&s->scene, scene, overrides, set));
  CF_TRY(make_sim(s));
  if (s->o.folder != NULL)
    CF_TRY(cf_path_make(&folder, "%s", s->o.folder));
  else
    CF_TRY(default_folder(scene, &folder));
  CF_TRY(cf_folder_create(&s->folder, folder.text, s->o.force));
  CF_TRY(write_run_yaml(s));
  CF_TRY(open_metrics(s, false, 0));
  note_start(s);
  say_plans(s);
  return write_first_frame(s);
}

/* The state of the newest checkpoint, or that of time 0. */
static cf_status restore(cf_session *s) {
  cf_checkpoint_found newest;
  char line[2 * CF_SENTENCE_MAX + 128];
  CF_TRY(cf_checkpoint_newest(s->folder.path.text, &newest));
  if (newest.passed_over[0] != '\0') {
    snprintf(line, sizeof line, "passed over: %s", newest.passed_over);
    say(s, line);
  }
  if (!newest.found) {
    say(s, "no checkpoint: starting again from run.yaml");
    CF_TRY(cf_frame_cut(s->folder.path.text, -1));
    CF_TRY(open_metrics(s, false, 0));
    return write_first_frame(s);
  }
  cf_checkpoint_facts facts;
  char *scene;
  CF_TRY(cf_checkpoint_describe(newest.path.text, &facts, &scene));
  const bool same = scene != NULL && strcmp(scene, s->scene_text) == 0;
  cf_free(scene);
  if (!same)
    return cf_fail(
        CF_BAD_FILE,
        "%s belongs to another scene than %s/run.yaml: put run.yaml back as it was, or start a new run "
        "in another folder",
        newest.path.text, s->folder.path.text);
  CF_TRY(cf_checkpoint_read(newest.path.text, &s->sim->registry, NULL));
  CF_TRY(cf_sim_restored(s->sim));
  s->last_checkpoint = s->sim->step;
  CF_TRY(cf_checkpoint_cut(s->folder.path.text, s->sim->step));
  CF_TRY(cf_frame_cut(s->folder.path.text, s->sim->frame));
  CF_TRY(open_metrics(s, true, s->sim->step));
  snprintf(line, sizeof line, "resumed from %s (step %lld, t = %g s)", newest.path.text,
           (long long)s->sim->step, s->sim->time);
  say(s, line);
  return CF_OK;
}

static cf_status resume(cf_session *s, const char *folder) {
  cf_path path;
  CF_TRY(cf_folder_open(&s->folder, folder));
  CF_TRY(cf_path_make(&path, "%s/run.yaml", folder));
  CF_TRY(cf_scene_read(&s->scene, path.text, 0, NULL));
  CF_TRY(make_sim(s));
  CF_TRY(restore(s));
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

/* --- running ----------------------------------------------------------------------------------------------
 */

static bool report(const cf_session *s, const bool finished) {
  const cf_sim *sim = s->sim;
  if (s->o.progress == NULL) return true;
  cf_progress p = {.step = sim->step,
                   .frame = sim->frame,
                   .frames = cf_sim_frames(sim),
                   .time = sim->time,
                   .end = s->o.until > 0 ? s->o.until : sim->end,
                   .dt = sim->dt,
                   .iterations = sim->report.solve.iterations,
                   .seconds = clock_now() - s->started,
                   .left = -1,
                   .finished = finished};
  if (sim->time > s->time_at_start) p.left = p.seconds * (p.end - sim->time) / (sim->time - s->time_at_start);
  return s->o.progress(s->o.context, &p);
}

static void tell_warnings(cf_session *s) {
  const cf_step_report *r = &s->sim->report;
  char line[CF_SENTENCE_MAX];
  if (r->warning[0] != '\0' && !s->warned) {
    s->warned = true;
    snprintf(line, sizeof line, "warning: %s", r->warning);
    say(s, line);
  }
  if (!r->solve.converged && s->stalls++ == 0) {
    snprintf(
        line, sizeof line,
        "warning: the solver did not reach its tolerance in step %lld (residual %.3g after %d iterations); "
        "going on, as solver.on_stall says",
        (long long)s->sim->step, r->solve.residual, r->solve.iterations);
    say(s, line);
  }
}

/* A failure in mid-run names the checkpoint that is left to go on from. */
static cf_status explain_failure(cf_session *s, const cf_status status) {
  char why[CF_SENTENCE_MAX];
  snprintf(why, sizeof why, "%s", cf_status_sentence());
  if (s->last_checkpoint >= 0)
    cf_fail(status, "%.700s; last good checkpoint: %s/checkpoint_%06lld.h5", why, s->folder.path.text,
            (long long)s->last_checkpoint);
  else
    cf_fail(status, "%.900s; there is no checkpoint yet", why);
  (void)cf_folder_log(&s->folder, "error: %s", cf_status_sentence());
  return status;
}

static cf_status one_step(cf_session *s) {
  bool on_frame;
  CF_TRY(cf_sim_step(s->sim, &on_frame));
  tell_warnings(s);
  CF_TRY(write_metrics(s));
  if (on_frame) CF_TRY(cf_output_frame(s->sim, s->folder.path.text));
  if (checkpoint_is_due(s)) CF_TRY(write_checkpoint(s));
  return CF_OK;
}

static bool reached(const cf_session *s) {
  const cf_sim *sim = s->sim;
  if (cf_sim_finished(sim)) return true;
  if (s->o.until > 0 && sim->time >= s->o.until * (1 - 1e-12)) return true;
  return s->o.steps > 0 && sim->step - s->first_step >= s->o.steps;
}

cf_status cf_session_run(cf_session *s) {
  char line[CF_PATH_MAX + 256];
  if (s->was_finished) return CF_OK;
  while (!reached(s)) {
    const cf_status status = one_step(s);
    if (status != CF_OK) return explain_failure(s, status);
    if (report(s, false)) continue;
    CF_TRY(write_checkpoint(s));
    snprintf(line, sizeof line, "stopped at step %lld (t = %g s); go on with: cattaneo resume %s",
             (long long)s->sim->step, s->sim->time, s->folder.path.text);
    say(s, line);
    return cf_fail(CF_STOPPED, "%s", line);
  }
  if (s->last_checkpoint != s->sim->step) CF_TRY(write_checkpoint(s));
  (void)report(s, true);
  snprintf(line, sizeof line, "%s at step %lld, t = %g s", cf_sim_finished(s->sim) ? "finished" : "paused",
           (long long)s->sim->step, s->sim->time);
  (void)cf_folder_log(&s->folder, "%s", line);
  return CF_OK;
}

bool cf_session_was_finished(const cf_session *s) { return s->was_finished; }
const cf_sim *cf_session_sim(const cf_session *s) { return s->sim; }
const char *cf_session_folder(const cf_session *s) { return s->folder.path.text; }
