/* SPDX-License-Identifier: MIT
 *
 * table.csv of a sweep: one line a run, with its name, the values of the grid, the exit code (empty: has not ended
 * yet) and the last line of its metrics.csv. The columns of metrics are those of the first run that has any; what a
 * run does not have stays empty.
 */
#ifndef CF_APP_SWEEP_TABLE_H
#define CF_APP_SWEEP_TABLE_H

#include "app/children.h"
#include "app/combine.h"
#include "io/folder.h"

/* CF_CANNOT_WRITE, CF_NO_MEMORY. */
cf_status cf_sweep_table_write(const cf_combinations *runs, const cf_path *folder, const cf_child *child,
                               const char *file);

#endif
