/* SPDX-License-Identifier: MIT
 *
 * A run with its folder: opens a scene, steps it, writes frames, previews, metrics, checkpoints and the log,
 * and goes on where a stopped run ended.
 */
#ifndef CF_SESSION_SESSION_H
#define CF_SESSION_SESSION_H

#include <stdbool.h>
#include <stdint.h>

#include "base/status.h"
#include "model/sim.h"

typedef struct cf_progress {
  int64_t step, frame, frames; /* frames: of the whole run */
  double time, end, dt;        /* s of the scene */
  int iterations;              /* of the latest step's solves */
  double seconds, left; /* of the wall clock: since this start, and (an estimate) to go; left < 0: unknown */
  bool finished;
} cf_progress;

/* What a line is about: how the run is done, or something that the user should look into. */
typedef enum cf_line_kind { CF_LINE_NOTE, CF_LINE_WARNING } cf_line_kind;

typedef struct cf_session_options {
  const char *folder; /* NULL: out/<name of the scene file> */
  bool force;         /* may overwrite a run */
  int threads;        /* 0: one a processor */
  double until;       /* s; 0: to the scene's end */
  int64_t steps;      /* stop after that many steps of this start; 0: no such limit */
  double memory;      /* bytes the run may take; 0: what the machine has */
  double
      seconds; /* of the wall clock, after which this start ends with a checkpoint: CF_STOPPED; 0: no limit */

  /* Called after every step and once at the end; false stops the run, with a checkpoint: CF_STOPPED. */
  bool (*progress)(void *context, const cf_progress *p);
  /* A line for the terminal (it is in log.txt already): plans, warnings, what was resumed from. */
  void (*say)(void *context, cf_line_kind kind, const char *line);
  void *context;
} cf_session_options;

typedef struct cf_session cf_session;

/* Reads the scene, refuses a folder that holds a run unless forced, plans the memory, writes run.yaml and the
 * state at time 0. Nothing is written when the scene is bad. `set`: KEY=VALUE overrides. */
cf_status cf_session_start(cf_session **s, const char *scene, int overrides, const char *const *set,
                           const cf_session_options *o);

/* Goes on from the newest good checkpoint of a folder, or from its run.yaml where there is none; what was
 * written after that checkpoint is cut. A run that had finished leaves the session finished. */
cf_status cf_session_resume(cf_session **s, const char *folder, const cf_session_options *o);

/* Runs to the end (or to options' until or steps). CF_STOPPED after the progress callback said so or the time was up,
 * with a checkpoint. A failure's sentence ends with what is left to go on from. */
cf_status cf_session_run(cf_session *s);

bool cf_session_was_finished(const cf_session *s); /* before this start */
const cf_sim *cf_session_sim(const cf_session *s);
const char *cf_session_folder(const cf_session *s);
void cf_session_close(cf_session *s); /* NULL is fine */

#endif
