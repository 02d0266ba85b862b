/* SPDX-License-Identifier: MIT */
#include "io/info_part.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include "base/mem.h"

static cf_status make_room(cf_report *r, const size_t wanted) {
  char *larger;
  if (wanted <= r->room) return CF_OK;
  CF_TRY(CF_NEW(&larger, 2 * wanted));
  if (r->length > 0) memcpy(larger, r->text, r->length);
  cf_free(r->text);
  r->text = larger;
  r->room = 2 * wanted;
  return CF_OK;
}

cf_status cf_report_say(cf_report *r, const char *format, ...) {
  char line[2 * CF_SENTENCE_MAX];
  va_list values;
  va_start(values, format);
  vsnprintf(line, sizeof line, format, values);
  va_end(values);
  const size_t more = strlen(line);
  CF_TRY(make_room(r, r->length + more + 1));
  memcpy(r->text + r->length, line, more + 1);
  r->length += more;
  return CF_OK;
}
