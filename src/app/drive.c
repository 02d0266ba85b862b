/* SPDX-License-Identifier: MIT
 *
 * From an open session to its last word; see drive.h.
 */
#include "app/drive.h"

#include <stdio.h>
#include <string.h>

#include "app/command.h"
#include "io/folder.h"

enum { LINE = 512 };

cf_session_options cf_drive_options(const cf_arguments *a, cf_teller *teller) {
  return (cf_session_options){
      .folder = a->output,
      .force = a->force,
      .threads = a->threads,
      .until = a->until,
      .steps = a->steps,
      .memory = a->memory,
      .seconds = a->seconds,
      .progress = cf_teller_progress,
      .say = cf_teller_say,
      .context = teller,
  };
}

/* How far a run got. */
static void state_text(const cf_sim *sim, char *text, const size_t size) {
  snprintf(text, size, "step %lld, t = %.6g s", (long long)sim->step, sim->time);
}

static void tell_end(cf_teller *t, const cf_session *s) {
  char line[2 * LINE], state[96], word[LINE];
  const cf_sim *sim = cf_session_sim(s);
  const char *folder = cf_session_folder(s);
  const bool done = cf_sim_finished(sim);
  state_text(sim, state, sizeof state);
  if (cf_session_was_finished(s)) {
    snprintf(line, sizeof line, "finished already: %s; nothing to do in %.400s", state, folder);
  } else if (done) {
    snprintf(line, sizeof line, "done: %s; frames 0 to %lld in %.400s", state, (long long)sim->frame, folder);
  } else {
    cf_path_quote(folder, word, sizeof word);
    snprintf(line, sizeof line, "paused at %s; go on with: " CF_PROGRAM " resume %s", state, word);
  }
  cf_teller_last(t, done ? "done" : "paused", line);
}

cf_status cf_drive(cf_arguments *a, cf_teller *teller, cf_session *s, const cf_status opened) {
  cf_status status = opened;
  if (status == CF_OK && !cf_session_was_finished(s)) status = cf_session_run(s);
  a->told = status != CF_OK;
  if (status == CF_OK) {
    if (a->progress != CF_PROGRESS_NONE) tell_end(teller, s);
    cf_teller_end(teller);
    printf("%s\n", cf_session_folder(s));
  } else if (status == CF_STOPPED) {
    cf_teller_last(teller, "stopped", cf_status_sentence());
  } else {
    cf_teller_failure(teller, status);
  }
  cf_session_close(s);
  return status;
}
