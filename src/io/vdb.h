/* SPDX-License-Identifier: MIT
 *
 * Volumes for Blender, Houdini and others: fields_000012.vdb, sparse, with h and the origin of the scene.
 *
 *   density   the first cell field that is written, unless one has that name; others keep their names
 *   vel       the face field `velocity`, as vectors on the low faces of voxels (staggered); other face fields, such as
 *             fluxes, likewise under their names
 *
 * Every grid says what we call it (`field`) and its unit; the file has title, time (s), step, and the number of frames
 * a second, so that a renderer can make motion blur of a velocity in m/s. In 2D fields are one voxel thick.
 *
 * OpenVDB is C++; this needs a build that found it (cf_vdb_built).
 */
#ifndef CF_IO_VDB_H
#define CF_IO_VDB_H

#include "io/parts.h"
#include "io/stamp.h"
#include "io/vdb_shim.h"

typedef struct cf_vdb_plan {
  cf_choice choice; /* particles, numbers and counters are passed over */
  bool half;        /* values of 16 bits */
  double prune;     /* voxels below prune times the largest value, in size, are left out */
  double rate;      /* frames a second; 0: none */
} cf_vdb_plan;

bool cf_vdb_built(void);

/* CF_CANNOT_WRITE with path and reason; CF_BAD_USAGE where OpenVDB was not there when this was built. A choice without
 * fields writes nothing. */
cf_status cf_vdb_write(const char *folder, int64_t frame, const cf_registry *r, const cf_vdb_plan *plan,
                       const cf_stamp *stamp);

/* Shows the words and grids of a file, ours or not. CF_BAD_FILE, also where OpenVDB was not there. */
cf_status cf_vdb_look(const char *path, const cf_vdb_viewer *viewer);

#endif
