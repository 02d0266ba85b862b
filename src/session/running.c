/* SPDX-License-Identifier: MIT
 *
 * The loop of a run: a step, its row in the metrics, its frame, a checkpoint if one is due; and the ways out of it:
 * the end, a limit of the caller, a request to stop, a failure that no smaller step can mend.
 */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "session/output.h"
#include "session/session_part.h"

/* --- what the caller is told ------------------------------------------------------------------------------ */

static bool report(const cf_session *s, const bool finished) {
  const cf_sim *sim = s->sim;
  if (s->o.progress == NULL) return true;
  cf_progress p = {.step = sim->step,
                   .frame = sim->frame,
                   .frames = cf_sim_frames(sim),
                   .time = sim->time,
                   .end = s->o.until > 0 ? fmin(s->o.until, sim->end) : sim->end,
                   .dt = sim->dt,
                   .iterations = sim->report.solve.iterations,
                   .seconds = cf_session_clock() - s->started,
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
    cf_session_say(s, CF_LINE_WARNING, line);
  }
  if (!r->solve.converged && s->stalls++ == 0) {
    snprintf(
        line, sizeof line,
        "warning: the solver did not reach its tolerance in step %lld (residual %.3g after %d iterations); "
        "going on, as solver.on_stall says",
        (long long)s->sim->step, r->solve.residual, r->solve.iterations);
    cf_session_say(s, CF_LINE_WARNING, line);
  }
}

/* A failure in mid-run names what is left to go on from, and how. */
static cf_status explain_failure(cf_session *s, const cf_status status) {
  char why[CF_SENTENCE_MAX], left[CF_PATH_MAX + 64], next[CF_PATH_MAX + 64] = "", word[CF_PATH_MAX];
  const bool retries = status == CF_NOT_FINITE || status == CF_NOT_CONVERGED;
  snprintf(why, sizeof why, "%s", cf_status_sentence());
  if (s->last_checkpoint >= 0)
    snprintf(left, sizeof left, "last good checkpoint: %.300s/checkpoint_%06lld.h5", s->folder.path.text,
             (long long)s->last_checkpoint);
  else
    snprintf(left, sizeof left, "there is no checkpoint yet");
  if (retries && s->scene->time.retry == 0)
    snprintf(next, sizeof next, "; time.retry makes a run go back by itself and take smaller steps");
  else if (retries && s->scene->time.retry <= s->sim->retries)
    snprintf(next, sizeof next, "; time.retry is used up");
  cf_path_quote(s->folder.path.text, word, sizeof word);
  if (status == CF_CANNOT_WRITE || status == CF_NO_MEMORY)
    snprintf(next, sizeof next, "; when that is mended: cattaneo resume %.300s", word);
  cf_fail(status, "%.640s; %s%s", why, left, next);
  (void)cf_folder_log(&s->folder, "error: %s", cf_status_sentence());
  return status;
}

/* --- stopping --------------------------------------------------------------------------------------------- */

static bool reached(const cf_session *s) {
  const cf_sim *sim = s->sim;
  if (cf_sim_finished(sim)) return true;
  if (s->o.until > 0 && sim->time >= s->o.until * (1 - 1e-12)) return true;
  return s->o.steps > 0 && sim->step - s->first_step >= s->o.steps;
}

/* Whether another step and the checkpoint after it may take longer than is left: as long as the longest so far. */
static bool time_is_up(const cf_session *s) {
  const double used = cf_session_clock() - s->started;
  return s->o.seconds > 0 && used + s->longest_step + s->longest_write > s->o.seconds;
}

static cf_status stop(cf_session *s, const char *why) {
  char line[CF_PATH_MAX + 256], word[CF_PATH_MAX];
  const cf_status status = cf_session_write_checkpoint(s, false);
  if (status != CF_OK) return explain_failure(s, status);
  cf_path_quote(s->folder.path.text, word, sizeof word);
  snprintf(line, sizeof line, "%s at step %lld (t = %g s); go on with: cattaneo resume %s", why,
           (long long)s->sim->step, s->sim->time, word);
  (void)cf_folder_log(&s->folder, "%s", line);
  return cf_fail(CF_STOPPED, "%s", line);
}

/* --- running ---------------------------------------------------------------------------------------------- */

static cf_status take_step(cf_session *s) {
  bool on_frame;
  CF_TRY(cf_sim_step(s->sim, &on_frame));
  tell_warnings(s);
  CF_TRY(cf_session_write_metrics(s));
  return on_frame ? cf_output_frame(s->sim, s->folder.path.text) : CF_OK;
}

static cf_status one_step(cf_session *s) {
  const double began = cf_session_clock();
  const cf_status status = take_step(s);
  s->longest_step = fmax(s->longest_step, cf_session_clock() - began);
  if (status != CF_OK) return cf_session_try_again(s, status);
  return cf_session_checkpoint_is_due(s) ? cf_session_write_checkpoint(s, true) : CF_OK;
}

cf_status cf_session_run(cf_session *s) {
  char line[128];
  if (s->was_finished) return CF_OK;
  if (s->o.until > 0 && reached(s)) {
    snprintf(line, sizeof line, "nothing to compute: t = %g s is not before the %g s to go to", s->sim->time,
             s->o.until);
    cf_session_say(s, CF_LINE_NOTE, line);
    return CF_OK;
  }
  while (!reached(s)) {
    const cf_status status = one_step(s);
    if (status != CF_OK) return explain_failure(s, status);
    if (!report(s, false)) return stop(s, "stopped");
    if (time_is_up(s) && !reached(s)) return stop(s, "the time limit is reached: stopped");
  }
  if (s->last_checkpoint != s->sim->step) {
    const cf_status status = cf_session_write_checkpoint(s, false);
    if (status != CF_OK) return explain_failure(s, status);
  }
  (void)report(s, true);
  snprintf(line, sizeof line, "%s at step %lld, t = %g s", cf_sim_finished(s->sim) ? "finished" : "paused",
           (long long)s->sim->step, s->sim->time);
  (void)cf_folder_log(&s->folder, "%s", line);
  return CF_OK;
}
