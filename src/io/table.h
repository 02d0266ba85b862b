/* SPDX-License-Identifier: MIT
 *
 * A table of numbers that grows by a row a step: metrics.csv.
 *
 * The first line names the columns, the first column is the step. Numbers are written with 17 significant
 * digits, so reading them back gives the same doubles; whole numbers look whole. A row is one write to the
 * end of the file: a killed process leaves whole rows, or at worst (a full disk, a crash of the machine) a
 * last one without its newline, which is cut off when the run goes on.
 */
#ifndef CF_IO_TABLE_H
#define CF_IO_TABLE_H

#include <stdint.h>

#include "base/status.h"

typedef struct cf_table cf_table;

/* Starts a table; a file at `path` is replaced. The names are copied. CF_CANNOT_WRITE, CF_BAD_ARGUMENT (no
 * columns, or a name with a comma, a quote or a line break). */
cf_status cf_table_create(cf_table **t, const char *path, int columns, const char *const *names);

/* Goes on with a table: all rows after the one of step `last` are cut, and everything from the first damaged
 * row on. *found (if not NULL) is the step of the last row that stands, -1 if there is none: less than `last`
 * if rows were lost. CF_BAD_FILE: the file cannot be read, or has other columns. A file that is not there is
 * started. */
cf_status cf_table_resume(cf_table **t, const char *path, int columns, const char *const *names, int64_t last,
                          int64_t *found);

/* Appends one row. CF_CANNOT_WRITE: the row is not there, the earlier ones are. */
cf_status cf_table_row(cf_table *t, const double *values);

/* Brings the rows to the disk: before a checkpoint, so that the table is never behind it. */
cf_status cf_table_sync(cf_table *t);

void cf_table_close(cf_table *t); /* NULL is fine */

#endif
