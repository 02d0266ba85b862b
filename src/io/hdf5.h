/* SPDX-License-Identifier: MIT
 *
 * The little of HDF5 that frames and checkpoints need, with our errors and our rules:
 *
 *   - A file is written aside and appears when it is whole (io/folder.h).
 *   - Nothing in it depends on the hour: no time stamps, so the same values give the same bytes.
 *   - HDF5 prints nothing; the reason ("No space left on device") goes into our sentence.
 *   - The library is not built for threads: one file is open at a time in the process; a second opener waits.
 *
 * Paths of objects begin with "/" and name the groups they lie in, which must be there. Types in the file are
 * little-endian whatever the machine.
 */
#ifndef CF_IO_HDF5_H
#define CF_IO_HDF5_H

#include <hdf5.h>

#include "io/folder.h"
#include "io/parts.h"

typedef struct cf_hdf5 {
  cf_draft draft; /* draft.path is what errors name */
  hid_t file;
  bool writing;
  int error;         /* of the system, while writing (io/hdf5_driver.h) */
  H5E_auto2_t print; /* what the caller's process does with HDF5's errors, put back at the end */
  void *print_context;
} cf_hdf5;

/* `head` bytes stay free before the HDF5 part (0, or a power of two from 512). CF_CANNOT_WRITE. */
cf_status cf_hdf5_create(cf_hdf5 *h, const char *path, size_t head);

/* For reading. CF_BAD_FILE. */
cf_status cf_hdf5_open(cf_hdf5 *h, const char *path);

/* Closes the file, and passes `so_far` on. If that or the closing failed and the file was being written, it
 * is removed; if all went well it waits under draft.temporary for cf_draft_keep. Every create and open needs
 * one close. */
cf_status cf_hdf5_close(cf_hdf5 *h, cf_status so_far);

/* --- writing -------------------------------------------------------------------------------------------- */

cf_status cf_hdf5_group(cf_hdf5 *h, const char *path);

/* Attributes of the object at `path`. */
cf_status cf_hdf5_set_text(cf_hdf5 *h, const char *path, const char *name, const char *text);
cf_status cf_hdf5_set_numbers(cf_hdf5 *h, const char *path, const char *name, int count,
                              const double *values);
cf_status cf_hdf5_set_integers(cf_hdf5 *h, const char *path, const char *name, int count,
                               const int64_t *values);

/* Where the values of an array lie in the file, and their checksum. */
typedef struct cf_extent {
  uint64_t offset, bytes, checksum;
} cf_extent;

/* A whole array from memory; `extent` may be NULL. */
cf_status cf_hdf5_write(cf_hdf5 *h, const char *path, const cf_array *a, const void *values,
                        cf_extent *extent);

/* A field or an attribute of particles; compression 0 (none) to 9. `extent` (NULL unless uncompressed) as above. */
cf_status cf_hdf5_write_slabs(cf_hdf5 *h, const char *path, const cf_slabs *s, int compression,
                              cf_extent *extent);

/* A part of the state (io/parts.h), with its unit. */
cf_status cf_hdf5_write_part(cf_hdf5 *h, const char *path, const cf_part *p, int compression,
                             cf_extent *extent);

/* --- reading ------------------------------------------------------------------------------------------ */

bool cf_hdf5_has(const cf_hdf5 *h, const char *path);

/* Attributes; texts longer than size - 1 are cut. CF_BAD_FILE. */
cf_status cf_hdf5_get_text(cf_hdf5 *h, const char *path, const char *name, char *text, size_t size);
cf_status cf_hdf5_get_numbers(cf_hdf5 *h, const char *path, const char *name, int count, double *values);
cf_status cf_hdf5_get_integers(cf_hdf5 *h, const char *path, const char *name, int count, int64_t *values);

/* Rank and extents of an array. CF_BAD_FILE: none there, or a rank above 4, or not of numbers. */
cf_status cf_hdf5_shape(cf_hdf5 *h, const char *path, cf_array *a);

/* The values of an array of that shape (checked). */
cf_status cf_hdf5_read(cf_hdf5 *h, const char *path, const cf_array *a, void *values);
cf_status cf_hdf5_read_slabs(cf_hdf5 *h, const char *path, const cf_slabs *s);
cf_status cf_hdf5_read_part(cf_hdf5 *h, const char *path, const cf_part *p);

/* One component of an array of vectors (or its only one) into a field; CF_MAGNITUDE (-1) the length. */
cf_status cf_hdf5_read_component(cf_hdf5 *h, const char *path, const cf_slabs *s, int components,
                                 int component);

/* Calls `visit` with every name in a group, in the order of the alphabet, until it fails. */
cf_status cf_hdf5_each(cf_hdf5 *h, const char *path,
                       cf_status (*visit)(void *context, cf_hdf5 *h, const char *name), void *context);

/* --- for the two files that implement this ------------------------------------------------------------ */

/* "PATH: cannot WHAT NAME: REASON", CF_CANNOT_WRITE or CF_BAD_FILE as the file is written or read. */
cf_status cf_hdf5_fail(const cf_hdf5 *h, const char *what, const char *name);
hid_t cf_hdf5_memory_type(cf_element e);
hid_t cf_hdf5_file_type(cf_element e);

/* A part of an array, in the file and in memory. */
typedef struct cf_hdf5_window {
  hid_t file, memory;
  bool good;
} cf_hdf5_window;
cf_hdf5_window cf_hdf5_window_open(hid_t set, int rank, const uint64_t *start, const uint64_t *count);
void cf_hdf5_window_close(const cf_hdf5_window *w);

#endif
