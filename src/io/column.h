/* SPDX-License-Identifier: MIT
 *
 * A column of a table (io/table.h writes them) read back, for curves.
 */
#ifndef CF_IO_COLUMN_H
#define CF_IO_COLUMN_H

#include <stdint.h>

#include "base/status.h"

/* The numbers under `name`, the caller's: cf_free; what is no number is NaN. A last line that is not whole is left out.
 * CF_BAD_FILE: the file cannot be read, or has no such column (the sentence lists those there are). */
cf_status cf_column_read(const char *path, const char *name, int64_t *count, double **values);

#endif
