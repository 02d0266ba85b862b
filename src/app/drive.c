/* SPDX-License-Identifier: MIT
 *
 * From an open session to its last word; see drive.h.
 */
#define _GNU_SOURCE
#include "app/drive.h"

#include <errno.h>
#include <limits.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "app/command.h"
#include "app/stop.h"

enum { LINE = 512 };

cf_session_options cf_drive_options(const cf_arguments *a, cf_teller *teller) {
  return (cf_session_options){
      .folder = a->output,
      .force = a->force,
      .threads = a->threads,
      .until = a->until,
      .steps = a->steps,
      .memory = a->memory,
      .progress = cf_teller_progress,
      .say = cf_teller_say,
      .context = teller,
  };
}

/* "; go on with: cattaneo resume 'my run'", ready to be pasted into a shell. */
static void advice_text(const char *folder, char *text, const size_t size) {
  const bool plain = folder[strcspn(folder, " \t\n'\"\\$&|;<>()*?[]{}#~`!")] == '\0' && *folder != '\0';
  const char *quote = plain ? "" : strchr(folder, '\'') == NULL ? "'" : "\"";
  snprintf(text, size, "go on with: " CF_PROGRAM " resume %s%s%s", quote, folder, quote);
}

/* How far a run got. */
static void state_text(const cf_sim *sim, char *text, const size_t size) {
  snprintf(text, size, "step %lld, t = %.6g s", (long long)sim->step, sim->time);
}

static void tell_end(cf_teller *t, const cf_session *s, const bool was_finished) {
  char line[LINE], state[96], advice[LINE / 2];
  const cf_sim *sim = cf_session_sim(s);
  const char *folder = cf_session_folder(s);
  state_text(sim, state, sizeof state);
  if (was_finished)
    snprintf(line, sizeof line, "finished already: %s; nothing to do in %.200s", state, folder);
  else if (sim->time >= sim->scene->time.end)
    snprintf(line, sizeof line, "done: %s; frames 0 to %lld in %.200s", state, (long long)sim->frame, folder);
  else {
    advice_text(folder, advice, sizeof advice);
    snprintf(line, sizeof line, "paused at %s; %s", state, advice);
  }
  cf_teller_last(t, was_finished || sim->time >= sim->scene->time.end ? "done" : "paused", line);
}

static void tell_stop(cf_teller *t, const cf_session *s) {
  char line[LINE], state[96], advice[LINE / 2];
  state_text(cf_session_sim(s), state, sizeof state);
  advice_text(cf_session_folder(s), advice, sizeof advice);
  snprintf(line, sizeof line, "stopped at %s, with a checkpoint; %s", state, advice);
  cf_teller_last(t, "stopped", line);
}

cf_status cf_drive(cf_arguments *a, cf_teller *teller, cf_session *s, const cf_status opened) {
  cf_status status = opened;
  if (status == CF_OK && !cf_session_was_finished(s)) status = cf_session_run(s);
  a->told = status != CF_OK;
  if (status == CF_OK) {
    if (a->progress != CF_PROGRESS_NONE) tell_end(teller, s, cf_session_was_finished(s));
    cf_teller_end(teller);
    printf("%s\n", cf_session_folder(s));
  } else if (status == CF_STOPPED) {
    tell_stop(teller, s);
  } else {
    cf_teller_failure(teller, status);
  }
  cf_session_close(s);
  return status;
}

cf_status cf_sister_start(char **argv) {
  char path[PATH_MAX];
  const ssize_t length = readlink("/proc/self/exe", path, sizeof path - 1);
  if (length <= 0)
    return cf_fail(CF_FAILED, "the place of this program is not known: run " CF_SISTER " itself");
  path[length] = '\0';
  char *name = strrchr(path, '/') + 1;
  if ((size_t)(name - path) + sizeof CF_SISTER > sizeof path)
    return cf_fail(CF_FAILED, "the path of this program is too long: run " CF_SISTER " itself");
  memcpy(name, CF_SISTER, sizeof CF_SISTER);
  fflush(NULL);
  execv(path, argv);
  return cf_fail(CF_FAILED, "the program for the other precision, %.400s, cannot be run: %s", path,
                 strerror(errno));
}
