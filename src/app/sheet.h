/* SPDX-License-Identifier: MIT
 *
 * A contact sheet: the last frames of several runs side by side, in one scale with one colour bar.
 */
#ifndef CF_APP_SHEET_H
#define CF_APP_SHEET_H

#include "base/status.h"

typedef struct cf_sheet {
  int count;
  const char *const *folder;
  const char *const *caption; /* NULL: the title of each scene */
  int columns;                /* 0: what makes it as wide as high */
  const char *field;          /* NULL: that of the previews */
  const char *file;           /* PNG */
} cf_sheet;

/* Of the fields where the runs wrote them (vtkhdf), else of their previews. Folders without a frame are left out.
 * CF_BAD_FILE: none has one. */
cf_status cf_sheet_write(const cf_sheet *s);

#endif
