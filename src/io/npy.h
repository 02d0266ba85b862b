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

#endif
