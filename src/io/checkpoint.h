/* SPDX-License-Identifier: MIT
 *
 * Checkpoints: all of the registry in one file, checkpoint_000100.h5 for step 100, such that a run that goes
 * on from it has the same bits as one that never stopped.
 *
 * The file is HDF5: below /state what io/parts.h lists, and /scene, the resolved scene. Before the HDF5 part stands a page of
 * text (HDF5 calls it a user block) with the format's version, the length and checksum of all that follows,
 * and place and checksum of every array. A reader checks it before it lets the HDF5 library see the file: a
 * damaged file is told from a whole one by plain arithmetic, and it can say which array is damaged.
 *
 * Nothing in the registry is touched before the whole file has been checked against it.
 */
#ifndef CF_IO_CHECKPOINT_H
#define CF_IO_CHECKPOINT_H

#include "grid/registry.h"
#include "io/folder.h"
#include "io/stamp.h"

#define CF_CHECKPOINT_FORMAT 1

/* Writes checkpoint_<step>.h5 into the folder, then removes all but the newest `keep` (at least 1) of the
 * checkpoints up to this step. CF_CANNOT_WRITE with path and reason; the earlier checkpoints are as they
 * were. */
cf_status cf_checkpoint_write(const char *folder, const cf_registry *r, const cf_stamp *stamp, int keep);

/* The same into a file of any name, and nothing is removed. */
cf_status cf_checkpoint_write_to(const char *path, const cf_registry *r, const cf_stamp *stamp);

/* Reads everything into the registry; sets of particles get room for as many as there are. CF_BAD_FILE: the file is damaged, or does not fit (precision, shape, an entry missing or unknown), and says
 * what was expected and what was found; the state is as it was. */
cf_status cf_checkpoint_read(const char *path, const cf_registry *r);

/* Whether the file is whole. CF_BAD_FILE with a sentence that says what is wrong. */
cf_status cf_checkpoint_check(const char *path);

typedef struct cf_checkpoint_facts {
  char title[256], version[64], precision[16];
  int dim, n[3];
  double h, origin[3], time;
  int64_t step;
} cf_checkpoint_facts;

/* What the (whole) file says about itself. `scene`, if not NULL, gets the resolved scene: cf_free.
 * CF_BAD_FILE. */
cf_status cf_checkpoint_describe(const char *path, cf_checkpoint_facts *facts, char **scene);

typedef struct cf_checkpoint_found {
  bool found;
  cf_path path;
  int64_t step;
  char passed_over[CF_SENTENCE_MAX]; /* why newer ones were not taken, a line each; "" if the newest was good
                                      */
} cf_checkpoint_found;

/* The newest whole checkpoint of a folder; none is not a failure. */
cf_status cf_checkpoint_newest(const char *folder, cf_checkpoint_found *found);

/* Removes the checkpoints after `step`: they belong to a course of the run that was given up. */
cf_status cf_checkpoint_cut(const char *folder, int64_t step);

#endif
