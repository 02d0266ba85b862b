/* SPDX-License-Identifier: MIT
 *
 * What the files that write frames share.
 */
#ifndef CF_IO_FRAME_PART_H
#define CF_IO_FRAME_PART_H

#include "io/frame.h"
#include "io/hdf5.h"

typedef struct cf_frame_job {
  const cf_registry *r;
  const cf_frame_plan *plan;
  const cf_stamp *stamp;
  int64_t frame;
} cf_frame_job;

/* Stamp and group /VTKHDF of that type, with the time where VTK's readers look for it. */
cf_status cf_frame_root(cf_hdf5 *h, const cf_frame_job *j, const char *type);

/* Writes WORD_<frame>.vtkhdf with what `fill` puts into it, and lists it in its series. */
typedef cf_status (*cf_frame_fill)(cf_hdf5 *h, const cf_frame_job *j, const void *what);
cf_status cf_frame_file(const char *folder, const cf_frame_job *j, const char *word, cf_frame_fill fill,
                        const void *what);

cf_status cf_frame_particles(const char *folder, const cf_frame_job *j, const cf_entry *e);

#endif
