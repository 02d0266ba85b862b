/* SPDX-License-Identifier: MIT
 *
 * What is inside a session, for its parts: opening (session.c), running (running.c), going back to a checkpoint
 * (restore.c).
 */
#ifndef CF_SESSION_SESSION_PART_H
#define CF_SESSION_SESSION_PART_H

#include "io/folder.h"
#include "io/table.h"
#include "session/session.h"

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
  double longest_step, longest_write; /* s of the wall clock: of a step with its frame, of a checkpoint */
};

/* Seconds of a clock that never goes back. */
double cf_session_clock(void);

/* To log.txt, and to the caller. */
void cf_session_say(cf_session *s, cf_line_kind kind, const char *line);

/* The simulation at time 0. */
cf_status cf_session_make_sim(cf_session *s);

cf_status cf_session_open_metrics(cf_session *s, bool resume, int64_t last);
cf_status cf_session_write_metrics(const cf_session *s);

/* The first row of the metrics and frame 0. */
cf_status cf_session_write_first(cf_session *s);

/* --- checkpoints (restore.c) ------------------------------------------------------------------------------ */

/* Saves the state. `due`: because the scene asks for it now, not because the run stops. */
cf_status cf_session_write_checkpoint(cf_session *s, bool due);
bool cf_session_checkpoint_is_due(const cf_session *s);

/* The state of the newest good checkpoint into the simulation that was just made, or that of time 0; cuts what was
 * written after it. */
cf_status cf_session_restore(cf_session *s);

/* After a step that failed with `failure`: back to an earlier state with half the step, if time.retry allows; else
 * the failure. */
cf_status cf_session_try_again(cf_session *s, cf_status failure);

#endif
