/* SPDX-License-Identifier: MIT
 *
 * WORD.vtkhdf.series: the list of frames and their times that ParaView opens as one data set that moves. A
 * small JSON file, one frame a line, written anew (whole or not at all) with every frame.
 */
#ifndef CF_IO_SERIES_H
#define CF_IO_SERIES_H

#include <stdint.h>

#include "base/status.h"

/* Lists WORD_<frame>.vtkhdf with its time; lines of this and of later frames are dropped. CF_CANNOT_WRITE. */
cf_status cf_series_add(const char *folder, const char *word, int64_t frame, double time);

/* Drops the lines of all frames above `last`; a series that is not there is fine. */
cf_status cf_series_cut(const char *folder, const char *word, int64_t last);

#endif
