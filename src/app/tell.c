/* SPDX-License-Identifier: MIT
 *
 * Lines for stderr; see tell.h.
 */
#define _GNU_SOURCE
#include "app/tell.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include "app/command.h"
#include "app/stop.h"

/* Least seconds between two lines: rewritten ones, plain ones, plain ones without a new frame, objects. */
#define REWRITE_EVERY 0.1
#define PLAIN_EVERY   1.0
#define QUIET_EVERY   5.0
#define JSON_EVERY    0.2

enum { LINE = 256 };

cf_teller cf_teller_begin(const cf_progress_kind kind) {
  const char *terminal = getenv("TERM");
  const bool clever = terminal != NULL && strcmp(terminal, "dumb") != 0;
  return (cf_teller){
      .kind = kind, .rewrites = kind == CF_PROGRESS_AUTO && clever && isatty(STDERR_FILENO), .frame = -1};
}

void cf_duration_text(const double seconds, char *text, const size_t size) {
  if (!(seconds >= 0 && seconds < 1e9)) {
    snprintf(text, size, "?");
    return;
  }
  const long long whole = llround(seconds);
  if (whole < 60)
    snprintf(text, size, "%lld s", whole);
  else if (whole < 3600)
    snprintf(text, size, "%lld min %02lld s", whole / 60, whole % 60);
  else if (whole < 48 * 3600)
    snprintf(text, size, "%lld h %02lld min", whole / 3600, whole % 3600 / 60);
  else
    snprintf(text, size, "%lld d %02lld h", whole / 86400, whole % 86400 / 3600);
}

/* --- json ------------------------------------------------------------------------------------------------- */

static void json_text(const char *text) {
  putc('"', stderr);
  for (const unsigned char *c = (const unsigned char *)text; *c != '\0'; ++c) {
    if (*c == '"' || *c == '\\')
      fprintf(stderr, "\\%c", *c);
    else if (*c == '\n')
      fputs("\\n", stderr);
    else if (*c < 0x20)
      fprintf(stderr, "\\u%04x", *c);
    else
      putc(*c, stderr);
  }
  putc('"', stderr);
}

static void json_message(const char *event, const char *text) {
  fprintf(stderr, "{\"event\": \"%s\", \"text\": ", event);
  json_text(text);
  fputs("}\n", stderr);
}

/* JSON has no words for what is not finite. */
static void json_number(const char *name, const double value) {
  fprintf(stderr, isfinite(value) ? ", \"%s\": %.17g" : ", \"%s\": null", name, value);
}

static void json_progress(const cf_progress *p, const double rate) {
  fprintf(stderr,
          "{\"event\": \"progress\", \"step\": %lld, \"frame\": %lld, \"frames\": %lld, \"iterations\": %d",
          (long long)p->step, (long long)p->frame, (long long)p->frames, p->iterations);
  json_number("time", p->time);
  json_number("end", p->end);
  json_number("dt", p->dt);
  json_number("seconds", p->seconds);
  json_number("left", p->left >= 0 ? p->left : NAN);
  json_number("steps_per_second", rate);
  fprintf(stderr, ", \"finished\": %s}\n", p->finished ? "true" : "false");
}

/* --- lines ------------------------------------------------------------------------------------------------ */

static void progress_text(const cf_progress *p, const double rate, char *text) {
  char left[32], pace[32];
  cf_duration_text(p->left, left, sizeof left);
  if (rate >= 1)
    snprintf(pace, sizeof pace, "%.3g steps/s", rate);
  else
    snprintf(pace, sizeof pace, "%.3g s/step", 1 / rate);
  snprintf(text, LINE, "step %lld   t = %.4g of %.4g s   frame %lld of %lld   %s   %s left   %d iteration%s",
           (long long)p->step, p->time, p->end, (long long)p->frame, (long long)p->frames - 1, pace, left,
           p->iterations, p->iterations == 1 ? "" : "s");
}

/* Columns of the terminal; a line that is wider cannot be rewritten. */
static int terminal_width(void) {
  struct winsize size;
  return ioctl(STDERR_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 1 ? size.ws_col - 1 : 79;
}

static bool is_due(const cf_teller *t, const cf_progress *p) {
  const double since = p->seconds - t->told;
  if (p->finished) return p->step != t->step || t->kind == CF_PROGRESS_JSON;
  const bool new_frame = p->frame != t->frame;
  if (t->rewrites) return since >= REWRITE_EVERY;
  if (t->kind == CF_PROGRESS_JSON) return new_frame || since >= JSON_EVERY;
  return since >= (new_frame ? PLAIN_EVERY : QUIET_EVERY);
}

static void tell(cf_teller *t, const cf_progress *p) {
  char text[LINE];
  const double rate = (double)(p->step - t->first_step) / fmax(p->seconds, 1e-9);
  if (t->kind == CF_PROGRESS_JSON) {
    json_progress(p, rate);
  } else {
    progress_text(p, rate, text);
    if (t->rewrites)
      fprintf(stderr, "\r%.*s\033[K", terminal_width(), text);
    else
      fprintf(stderr, "%s\n", text);
    t->open = t->rewrites;
  }
  fflush(stderr);
}

bool cf_teller_progress(void *context, const cf_progress *p) {
  cf_teller *t = context;
  const bool first = !t->began;
  if (first) t->first_step = p->step - 1;
  t->began = true;
  const bool moved = p->step > t->first_step;
  if (t->kind != CF_PROGRESS_NONE && moved && (first || is_due(t, p))) {
    tell(t, p);
    t->told = p->seconds;
    t->frame = p->frame;
    t->step = p->step;
  }
  return !cf_stop_asked();
}

void cf_teller_end(cf_teller *t) {
  if (t->open) fputs("\n", stderr);
  t->open = false;
}

void cf_teller_say(void *context, const cf_line_kind kind, const char *line) {
  cf_teller *t = context;
  if (t->kind == CF_PROGRESS_NONE && kind == CF_LINE_NOTE) return;
  if (t->kind == CF_PROGRESS_JSON) {
    json_message("message", line);
    return;
  }
  if (t->open) fputs("\r\033[K", stderr); /* the progress is written again below */
  t->open = false;
  fprintf(stderr, "%s\n", line);
}

void cf_teller_last(cf_teller *t, const char *event, const char *line) {
  cf_teller_end(t);
  if (t->kind == CF_PROGRESS_JSON)
    json_message(event, line);
  else
    fprintf(stderr, "%s\n", line);
}

void cf_teller_failure(cf_teller *t, const cf_status status) {
  cf_teller_end(t);
  if (t->kind == CF_PROGRESS_JSON)
    json_message("failed", cf_status_sentence());
  else
    cf_tell_failure(status);
}

void cf_tell_failure(const cf_status status) {
  const char *sentence = cf_status_sentence();
  const size_t length = strlen(sentence);
  const char *end = length > 0 && sentence[length - 1] == '\n' ? "" : "\n";
  /* What a scene has wrong starts with its place, as compilers have it. */
  fprintf(stderr, "%s%s%s", status == CF_BAD_SCENE ? "" : CF_PROGRAM ": ", sentence, end);
}
