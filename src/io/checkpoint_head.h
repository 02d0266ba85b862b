/* SPDX-License-Identifier: MIT
 *
 * The page of text before the HDF5 part of a checkpoint, by which a damaged file is known without the HDF5
 * library:
 *
 *     cattaneo checkpoint 1 2048
 *     bytes 1234567
 *     checksum 0123456789abcdef
 *     array phi 4096 1048576 0123456789abcdef
 *     array q/x 1052672 1056768 0123456789abcdef
 *     end 0123456789abcdef
 *
 * The first line ends with the length of this page, zeros fill it up. `bytes` is the length of the file,
 * `checksum` that of all after the page; then every array of the state: place, length, checksum; `end` has
 * the checksum of the lines above it. So every byte of the file is covered.
 */
#ifndef CF_IO_CHECKPOINT_HEAD_H
#define CF_IO_CHECKPOINT_HEAD_H

#include "grid/registry.h"
#include "io/hdf5.h"

typedef struct cf_head_array {
  char name[2 * CF_NAME_MAX];
  cf_extent extent;
} cf_head_array;

typedef struct cf_head {
  size_t size; /* of the page */
  int count, room;
  cf_head_array *array;
} cf_head;

/* Room for that many arrays, and the size of the page they need. */
cf_status cf_head_create(cf_head *head, int arrays);
void cf_head_destroy(cf_head *head);
void cf_head_add(cf_head *head, const char *name, const cf_extent *extent);

/* Writes the page into the finished file `path`; errors name it `name`. CF_CANNOT_WRITE. */
cf_status cf_head_write(const cf_head *head, const char *path, const char *name);

/* Whether every byte of the file is what was written. CF_BAD_FILE with what is wrong: no checkpoint, a format
 * of another program, cut short, which array is damaged. */
cf_status cf_head_check(const char *path);

#endif
