/* SPDX-License-Identifier: MIT
 *
 * What the program tells a person (or, with --progress json, a program) while it works: progress, lines of the
 * run, why it failed. All of it goes to stderr.
 *
 *   a terminal  one line that is rewritten; other lines are put above it
 *   plain       a line at most once a second, for log files
 *   json        one object a line: {"event": "progress", ...}, also "message", "done", "stopped", "failed"
 *   none        warnings and failures only
 */
#ifndef CF_APP_TELL_H
#define CF_APP_TELL_H

#include <stdbool.h>
#include <stdint.h>

#include "app/options.h"
#include "session/session.h"

typedef struct cf_teller {
  cf_progress_kind kind;
  bool rewrites; /* kind is AUTO and stderr is a terminal */
  bool open;     /* a line stands there without its end */
  bool began;
  double told;                     /* wall-clock second of the last line */
  int64_t frame, step, first_step; /* of the last line; before the first step of this start */
} cf_teller;

cf_teller cf_teller_begin(cf_progress_kind kind);

/* Callbacks of cf_session_options, `context` a cf_teller. The first returns false once a signal has asked
 * for an end (app/stop.h). */
bool cf_teller_progress(void *context, const cf_progress *p);
void cf_teller_say(void *context, cf_line_kind kind, const char *line);

/* Ends a line that stands open. */
void cf_teller_end(cf_teller *t);

/* A last word: `event` "done" or "stopped". */
void cf_teller_last(cf_teller *t, const char *event, const char *line);

/* Why the program failed, from the sentence of this thread. */
void cf_teller_failure(cf_teller *t, cf_status status);
void cf_tell_failure(cf_status status);

/* "3 min 20 s" */
void cf_duration_text(double seconds, char *text, size_t size);

#endif
