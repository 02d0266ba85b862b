/* SPDX-License-Identifier: MIT
 *
 * Arrays for numpy, one a file, in C order and the precision of the state:
 *
 *   fields_000012_phi.npy               a cell field: (nz, ny, nx), or (ny, nx) in 2D
 *   fields_000012_q_x.npy, _y, _z       a face field: one more along its axis
 *   particles_000012_age.npy            an attribute of the set `particles`: (N), or (N, components)
 *
 * numpy.load(..., mmap_mode="r") maps them.
 */
#ifndef CF_IO_NPY_H
#define CF_IO_NPY_H

#include "grid/registry.h"

/* Writes the entries of those names (numbers and counters are passed over). CF_BAD_ARGUMENT: no such entry;
 * CF_CANNOT_WRITE. */
cf_status cf_npy_write(const char *folder, int64_t frame, const cf_registry *r, int count,
                       const char *const *names);

#endif
