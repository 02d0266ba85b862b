/* SPDX-License-Identifier: MIT
 *
 * Checkpoints of a session: writing them, going on from one, and going back to one after a step that failed.
 *
 * A retry (time.retry) starts from a checkpoint and not from the state before the step that failed: a value that
 * overflows was wrong many steps earlier. The first retry takes the newest checkpoint, the second the one before it,
 * and so on to the start of the run; each halves the step for the rest of the run. For the same bits after a stop as
 * without one, the checkpoints it goes back to are those that the scene's interval in steps asked for; one that was
 * made because the run stopped is removed when the next regular one comes, and takes no one's place among those kept.
 */
#include <inttypes.h>
#include <limits.h>
#include <math.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "base/mem.h"
#include "io/checkpoint.h"
#include "io/frame.h"
#include "session/session_part.h"

/* --- writing ---------------------------------------------------------------------------------------------- */

static bool is_regular(const cf_session *s, const int64_t step) {
  const cf_interval *every = &s->scene->output.checkpoint.every;
  if (!every->in_steps) return true; /* of the clock: nothing tells them apart */
  return every->every > 0 && step % (int64_t)every->every == 0;
}

bool cf_session_checkpoint_is_due(const cf_session *s) {
  const cf_interval *every = &s->scene->output.checkpoint.every;
  if (every->every <= 0) return false;
  if (every->in_steps) return is_regular(s, s->sim->step);
  return cf_session_clock() - s->checkpoint_clock >= every->every;
}

/* The steps of the checkpoints, ascending; the list is the caller's. */
static cf_status list_checkpoints(const cf_session *s, int *count, int64_t **steps) {
  return cf_folder_numbers(s->folder.path.text, "checkpoint", "h5", count, steps);
}

static cf_status name_checkpoint(const cf_session *s, const int64_t step, cf_path *path) {
  return cf_path_make(path, "%s/checkpoint_%06" PRId64 ".h5", s->folder.path.text, step);
}

/* With a regular checkpoint on the disk: removes those of stops, and the oldest regular ones beyond the number to keep. */
static cf_status tidy(const cf_session *s) {
  int count, left = (int)s->scene->output.checkpoint.keep;
  int64_t *steps;
  cf_path path;
  CF_TRY(list_checkpoints(s, &count, &steps));
  for (int i = count - 1; i >= 0; --i) {
    const bool stays = is_regular(s, steps[i]) && left-- > 0;
    if (!stays && name_checkpoint(s, steps[i], &path) == CF_OK) unlink(path.text);
  }
  cf_free(steps);
  return CF_OK;
}

cf_status cf_session_write_checkpoint(cf_session *s, const bool due) {
  const double began = cf_session_clock();
  const cf_stamp stamp = {
      .title = s->scene->title, .scene = s->scene_text, .time = s->sim->time, .step = s->sim->step};
  const bool retries = s->scene->time.retry > 0;
  CF_TRY(cf_table_sync(s->metrics));
  CF_TRY(cf_checkpoint_write(s->folder.path.text, &s->sim->registry, &stamp,
                             retries ? INT_MAX : (int)s->scene->output.checkpoint.keep));
  if (retries && due) CF_TRY(tidy(s));
  s->last_checkpoint = s->sim->step;
  s->checkpoint_clock = cf_session_clock();
  s->longest_write = CF_MAX(s->longest_write, s->checkpoint_clock - began);
  return CF_OK;
}

/* --- going on --------------------------------------------------------------------------------------------- */

/* At time 0, as if nothing had been. */
static cf_status begin_again(cf_session *s) {
  s->last_checkpoint = -1;
  CF_TRY(cf_frame_cut(s->folder.path.text, -1));
  CF_TRY(cf_session_open_metrics(s, false, 0));
  return cf_session_write_first(s);
}

static cf_status load(cf_session *s, const char *path) {
  CF_TRY(cf_sim_load(s->sim, path));
  s->last_checkpoint = s->sim->step;
  CF_TRY(cf_checkpoint_cut(s->folder.path.text, s->sim->step));
  CF_TRY(cf_frame_cut(s->folder.path.text, s->sim->frame));
  return cf_session_open_metrics(s, true, s->sim->step);
}

cf_status cf_session_restore(cf_session *s) {
  cf_checkpoint_found newest;
  char line[2 * CF_SENTENCE_MAX + 128], word[CF_PATH_MAX];
  cf_path_quote(s->folder.path.text, word, sizeof word);
  CF_TRY(cf_checkpoint_newest(s->folder.path.text, &newest));
  if (!newest.found && newest.passed_over[0] != '\0')
    return cf_fail(CF_BAD_FILE,
                   "%s: none of its checkpoints can be gone on from (%.600s); nothing was changed; to start "
                   "the run anew: "
                   "cattaneo run --force -o %.200s %.200s/run.yaml",
                   s->folder.path.text, newest.passed_over, word, word);
  if (newest.passed_over[0] != '\0') {
    snprintf(line, sizeof line, "passed over: %s", newest.passed_over);
    cf_session_say(s, CF_LINE_WARNING, line);
  }
  if (!newest.found) {
    cf_session_say(s, CF_LINE_WARNING, "no checkpoint: starting again from run.yaml");
    return begin_again(s);
  }
  CF_TRY(load(s, newest.path.text));
  snprintf(line, sizeof line, "resumed from %s (step %" PRId64 ", t = %g s)", newest.path.text, s->sim->step,
           s->sim->time);
  cf_session_say(s, CF_LINE_NOTE, line);
  return CF_OK;
}

/* --- going back ------------------------------------------------------------------------------------------- */

/* The `back`-th newest regular checkpoint that is whole; an empty path: there are not so many. */
static cf_status find_earlier(const cf_session *s, int64_t back, cf_path *path) {
  int count;
  int64_t *steps;
  cf_path candidate;
  path->text[0] = '\0';
  CF_TRY(list_checkpoints(s, &count, &steps));
  for (int i = count - 1; i >= 0 && back > 0; --i) {
    if (!is_regular(s, steps[i]) || name_checkpoint(s, steps[i], &candidate) != CF_OK) continue;
    if (cf_checkpoint_check(candidate.text) == CF_OK && --back == 0) *path = candidate;
  }
  cf_free(steps);
  return CF_OK;
}

static cf_status go_back(cf_session *s, const int64_t retries) {
  cf_path path;
  CF_TRY(find_earlier(s, retries, &path));
  cf_table_close(s->metrics);
  s->metrics = NULL;
  cf_sim_destroy(s->sim);
  s->sim = NULL;
  CF_TRY(cf_session_make_sim(s));
  if (path.text[0] != '\0') {
    CF_TRY(load(s, path.text));
  } else {
    CF_TRY(cf_checkpoint_cut(s->folder.path.text, -1));
    CF_TRY(begin_again(s));
  }
  s->sim->retries = retries;
  return CF_OK;
}

cf_status cf_session_try_again(cf_session *s, const cf_status failure) {
  char line[2 * CF_SENTENCE_MAX];
  const int64_t retries = s->sim->retries + 1;
  if (failure != CF_NOT_FINITE && failure != CF_NOT_CONVERGED) return failure;
  if (retries > s->scene->time.retry) return failure;
  int n = snprintf(line, sizeof line, "warning: %s", cf_status_sentence());
  CF_TRY(go_back(s, retries));
  snprintf(line + n, sizeof line - (size_t)n,
           "; going on from step %" PRId64 " with 1/%g of the step (retry %" PRId64 " of %ld)", s->sim->step,
           ldexp(1, (int)retries), retries, s->scene->time.retry);
  cf_session_say(s, CF_LINE_WARNING, line);
  return CF_OK;
}
