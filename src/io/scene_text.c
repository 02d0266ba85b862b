/* SPDX-License-Identifier: MIT
 *
 * A text that grows while it is written. See scene_text.h.
 */
#include "io/scene_text.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include "base/mem.h"

void cf_writing_add_bytes(cf_writing *writing, const char *text, const size_t count) {
  if (writing->status != CF_OK) return;
  if (writing->length + count + 1 > writing->room) {
    char *fresh;
    const size_t room = 2 * (writing->length + count) + 1024;
    writing->status = CF_NEW(&fresh, room);
    if (writing->status != CF_OK) return;
    if (writing->length > 0) memcpy(fresh, writing->text, writing->length);
    cf_free(writing->text);
    writing->text = fresh;
    writing->room = room;
  }
  memcpy(writing->text + writing->length, text, count);
  writing->length += count;
  writing->text[writing->length] = '\0';
}

void cf_writing_add(cf_writing *writing, const char *format, ...) {
  char piece[1024];
  va_list values;
  va_start(values, format);
  const int n = vsnprintf(piece, sizeof piece, format, values);
  va_end(values);
  if (n > 0) cf_writing_add_bytes(writing, piece, (size_t)n < sizeof piece ? (size_t)n : sizeof piece - 1);
}

cf_status cf_writing_end(cf_writing *writing, char **text) {
  cf_writing_add_bytes(writing, "", 0);
  *text = writing->status == CF_OK ? writing->text : NULL;
  if (writing->status != CF_OK) cf_free(writing->text);
  writing->text = NULL;
  return writing->status;
}
