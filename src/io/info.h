/* SPDX-License-Identifier: MIT
 *
 * What a file or folder of ours is, as text for a person: scene, version, times; of every field least,
 * largest, sum and checksum. The sum of a cell field is its integral over the domain, as in metrics.csv; of
 * anything else the plain sum. The checksum is of the values in C order (io/checksum.h): equal checksums,
 * equal bits.
 */
#ifndef CF_IO_INFO_H
#define CF_IO_INFO_H

#include "base/status.h"

/* `path`: a frame, a checkpoint, a surface (.ply, .obj), a volume (.vdb), or the folder of a run. The text is the caller's: cf_free. CF_BAD_FILE. */
cf_status cf_info_text(const char *path, char **text);

#endif
