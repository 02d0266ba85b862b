/* SPDX-License-Identifier: MIT
 *
 * All calls happen under the lock of io/hdf5.c. Addresses count from the start of the file.
 */
#define _GNU_SOURCE
#include "io/hdf5_driver.h"

#include <errno.h>
#include <fcntl.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

typedef struct driver_file {
  H5FD_t common; /* HDF5's part, first */
  int file;
  bool writes;
  int *error;
  haddr_t end_of_allocated, end_of_file;
} driver_file;

typedef struct driver_info {
  int *error;
} driver_info;

static void note(const driver_file *f, const int reason) {
  if (*f->error == 0) *f->error = reason != 0 ? reason : EIO;
}

static H5FD_t *open_file(const char *name, const unsigned flags, const hid_t access, const haddr_t most) {
  const driver_info *info = H5Pget_driver_info(access);
  int mode = (flags & H5F_ACC_RDWR) != 0 ? O_RDWR : O_RDONLY;
  (void)most;
  if ((flags & H5F_ACC_CREAT) != 0) mode |= O_CREAT;
  if ((flags & H5F_ACC_TRUNC) != 0) mode |= O_TRUNC;
  if ((flags & H5F_ACC_EXCL) != 0) mode |= O_EXCL;
  driver_file *f = info == NULL ? NULL : calloc(1, sizeof *f); /* HDF5 asks for one to be freed with close */
  if (f == NULL) return NULL;
  *f = (driver_file){
      .file = open(name, mode | O_CLOEXEC, 0666), .writes = mode != O_RDONLY, .error = info->error};
  if (f->file < 0) {
    if ((flags & H5F_ACC_CREAT) != 0) note(f, errno); /* else it only looked whether the file is there */
    free(f);
    return NULL;
  }
  f->end_of_file = (haddr_t)lseek(f->file, 0, SEEK_END);
  return &f->common;
}

static herr_t close_file(H5FD_t *common) {
  driver_file *f = (driver_file *)common;
  if (close(f->file) != 0 && f->writes) note(f, errno);
  free(f);
  return 0;
}

static herr_t query(const H5FD_t *common, unsigned long *flags) {
  (void)common;
  *flags = H5FD_FEAT_AGGREGATE_METADATA | H5FD_FEAT_ACCUMULATE_METADATA | H5FD_FEAT_DATA_SIEVE |
           H5FD_FEAT_AGGREGATE_SMALLDATA | H5FD_FEAT_DEFAULT_VFD_COMPATIBLE;
  return 0;
}

static haddr_t get_eoa(const H5FD_t *common, const H5FD_mem_t type) {
  (void)type;
  return ((const driver_file *)common)->end_of_allocated;
}

static herr_t set_eoa(H5FD_t *common, const H5FD_mem_t type, const haddr_t at) {
  (void)type;
  ((driver_file *)common)->end_of_allocated = at;
  return 0;
}

static haddr_t get_eof(const H5FD_t *common, const H5FD_mem_t type) {
  (void)type;
  return ((const driver_file *)common)->end_of_file;
}

/* What is not there reads as zeros. */
static herr_t read_bytes(H5FD_t *common, const H5FD_mem_t type, const hid_t transfer, haddr_t at, size_t size,
                         void *buffer) {
  driver_file *f = (driver_file *)common;
  char *bytes = buffer;
  (void)type;
  (void)transfer;
  while (size > 0) {
    const ssize_t some = pread(f->file, bytes, size, (off_t)at);
    if (some < 0 && errno == EINTR) continue;
    if (some < 0) note(f, errno);
    if (some <= 0) break;
    bytes += some, at += (haddr_t)some, size -= (size_t)some;
  }
  memset(bytes, 0, size);
  return 0;
}

static herr_t write_bytes(H5FD_t *common, const H5FD_mem_t type, const hid_t transfer, haddr_t at,
                          size_t size, const void *buffer) {
  driver_file *f = (driver_file *)common;
  const char *bytes = buffer;
  (void)type;
  (void)transfer;
  if (f->end_of_file < at + size) f->end_of_file = at + size;
  while (size > 0 && *f->error == 0) {
    const ssize_t some = pwrite(f->file, bytes, size, (off_t)at);
    if (some < 0 && errno == EINTR) continue;
    if (some <= 0)
      note(f, some < 0 ? errno : ENOSPC);
    else
      bytes += some, at += (haddr_t)some, size -= (size_t)some;
  }
  return 0;
}

static herr_t truncate_file(H5FD_t *common, const hid_t transfer, const hbool_t closing) {
  driver_file *f = (driver_file *)common;
  (void)transfer;
  (void)closing;
  if (f->end_of_file == f->end_of_allocated) return 0;
  if (*f->error == 0 && ftruncate(f->file, (off_t)f->end_of_allocated) != 0) note(f, errno);
  f->end_of_file = f->end_of_allocated;
  return 0;
}

/* clang-format off */
static const H5FD_class_t driver = {
    .name = "cattaneo",
    .maxaddr = (haddr_t)INT64_MAX,
    .fc_degree = H5F_CLOSE_STRONG,
    .fapl_size = sizeof(driver_info),
    .open = open_file,
    .close = close_file,
    .query = query,
    .get_eoa = get_eoa,
    .set_eoa = set_eoa,
    .get_eof = get_eof,
    .read = read_bytes,
    .write = write_bytes,
    .truncate = truncate_file,
    .fl_map = H5FD_FLMAP_DICHOTOMY,
};
/* clang-format on */

herr_t cf_hdf5_driver_use(const hid_t access, int *error) {
  static hid_t registered = -1;
  const driver_info info = {error};
  /* Whoever shares HDF5 with us may have closed the library in between, and the driver with it. */
  if (registered < 0 || H5Iget_type(registered) != H5I_VFL) registered = H5FDregister(&driver);
  if (registered < 0) return -1;
  return H5Pset_driver(access, registered, &info);
}
