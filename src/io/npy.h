/* SPDX-License-Identifier: MIT
 *
 * Arrays for numpy, one a file, in C order and the precision of the state:
 *
 *   fields_000012_phi.npy               a cell field: (nz, ny, nx), or (ny, nx) in 2D
 *   fields_000012_q_x.npy, _y, _z       a face field: one more along its axis
 *   particles_000012_position.npy       an attribute of particles: (N), or (N, components); _id: 64-bit integers
 *
 * numpy.load(..., mmap_mode="r") maps them.
 */
#ifndef CF_IO_NPY_H
#define CF_IO_NPY_H

#include "io/parts.h"

/* Writes what is chosen (numbers and counters are passed over). CF_BAD_ARGUMENT: no such entry; CF_CANNOT_WRITE. */
cf_status cf_npy_write(const char *folder, int64_t frame, const cf_registry *r, const cf_choice *choice);

/* Reads an array of 2 or 3 axes of 32 or 64 bit floats, little endian, in C order: n[0] is the last axis, whose values
 * lie next to each other; n[2] = 1 where there are two. *values is the caller's: cf_free. CF_BAD_FILE: no such file or
 * array, or a value that is not finite; CF_NO_MEMORY. */
cf_status cf_npy_read(const char *path, int *axes, int n[3], float **values);

#endif
