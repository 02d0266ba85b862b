/* SPDX-License-Identifier: MIT */
#include "base/status.h"

#include <stdarg.h>
#include <stdio.h>

static _Thread_local char sentence[CF_SENTENCE_MAX];

static const struct {
  const char *name;
  int exit_code;
} list[] = {
#define CF_STATUS_ROW(name, exit_code, meaning) {#name, exit_code},
    CF_STATUS_LIST(CF_STATUS_ROW)
#undef CF_STATUS_ROW
};

/* A name that is quoted may hold what would steer a terminal. */
static bool is_control(const char c) {
  return ((unsigned char)c < ' ' && c != '\n' && c != '\t') || c == 0x7f;
}

cf_status cf_fail(const cf_status code, const char *format, ...) {
  /* The arguments may contain the sentence of a deeper failure: format aside, then copy. */
  char fresh[CF_SENTENCE_MAX];
  va_list values;
  va_start(values, format);
  vsnprintf(fresh, sizeof fresh, format, values);
  va_end(values);
  for (char *c = fresh; *c != '\0'; ++c)
    if (is_control(*c)) *c = '?';
  snprintf(sentence, sizeof sentence, "%s", fresh);
  return code;
}

const char *cf_status_sentence(void) { return sentence; }

/* A program may hand in what is no code at all. */
static bool known(const cf_status code) { return (unsigned)code < sizeof list / sizeof *list; }

const char *cf_status_name(const cf_status code) { return known(code) ? list[code].name : "unknown"; }

int cf_status_exit_code(const cf_status code) { return known(code) ? list[code].exit_code : 1; }
