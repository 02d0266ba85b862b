/* SPDX-License-Identifier: MIT
 *
 * How HDF5 reaches the disk: through a driver of ours that never tells it of a failure.
 *
 * When a write fails (a full disk), or the closing of any file, HDF5 keeps what it has of the file, tries again when the
 * program ends, and brings it down then. So the driver notes the first error of the system, lets every later write pass
 * as done, and whoever closes the file looks at the error and throws the file away. What cannot be read reads as zeros;
 * that a file which was only read cannot be closed is of no importance.
 */
#ifndef CF_IO_HDF5_DRIVER_H
#define CF_IO_HDF5_DRIVER_H

#include <hdf5.h>

/* Makes files of this access list go through the driver. *error is 0 or the errno of the first failure; it
 * must outlive the file. Negative: HDF5 could not. */
herr_t cf_hdf5_driver_use(hid_t access, int *error);

#endif
