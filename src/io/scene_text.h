/* SPDX-License-Identifier: MIT
 *
 * A text that grows while it is written. Adding never fails in the face of the writer: the first failure is
 * kept, later additions do nothing, and cf_writing_end reports it.
 */
#ifndef CF_IO_SCENE_TEXT_H
#define CF_IO_SCENE_TEXT_H

#include <stddef.h>

#include "base/status.h"

typedef struct cf_writing {
  char *text; /* from cf_new_array; NULL at first */
  size_t length, room;
  cf_status status;
} cf_writing;

void cf_writing_add(cf_writing *writing, const char *format, ...) CF_PRINTF(2, 3);

/* `count` bytes of `text` as they are. */
void cf_writing_add_bytes(cf_writing *writing, const char *text, size_t count);

/* Hands the text over ("" if nothing was added), or frees it and returns the failure. */
cf_status cf_writing_end(cf_writing *writing, char **text);

#endif
