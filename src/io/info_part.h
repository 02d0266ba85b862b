/* SPDX-License-Identifier: MIT
 *
 * What the files of `info` share: the report that grows line by line, and who adds to it.
 */
#ifndef CF_IO_INFO_PART_H
#define CF_IO_INFO_PART_H

#include <stddef.h>

#include "base/real.h"
#include "base/status.h"
#include "io/checksum.h"

typedef struct cf_report {
  char *text;
  size_t length, room;
  cf_checksum all; /* of the arrays of a file: of their checksums, in order */
} cf_report;

cf_status cf_report_say(cf_report *r, const char *format, ...) CF_PRINTF(2, 3);

/* A line for a list of values, under the line of columns. */
extern const char cf_report_columns[];
cf_status cf_report_list(cf_report *r, const char *name, const char *unit, int n, const cf_real *values);

/* Files that other programs may have made: a surface, PLY or OBJ; a volume, VDB. CF_BAD_FILE. */
cf_status cf_report_mesh(cf_report *r, const char *path);
cf_status cf_report_volume(cf_report *r, const char *path);

#endif
