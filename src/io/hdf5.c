/* SPDX-License-Identifier: MIT
 *
 * Opening, closing, errors and writing. (Reading: hdf5_read.c.)
 */
#define _GNU_SOURCE
#include "io/hdf5.h"

#include <errno.h>
#include <pthread.h>
#include <string.h>

#include "base/mem.h"
#include "io/checksum.h"
#include "io/hdf5_driver.h"

#define REASON_MAX 256

static pthread_mutex_t one_at_a_time = PTHREAD_MUTEX_INITIALIZER;

/* --- errors -----------------------------------------------------------------------------------------------
 */

/* The deepest record of the stack says most. */
static herr_t read_record(unsigned n, const H5E_error2_t *record, void *context) {
  char *text = context;
  (void)n;
  if (text[0] == '\0' && record->desc != NULL) snprintf(text, REASON_MAX, "%s", record->desc);
  return 0;
}

cf_status cf_hdf5_fail(const cf_hdf5 *h, const char *what, const char *name) {
  char reason[REASON_MAX] = "";
  H5Ewalk2(H5E_DEFAULT, H5E_WALK_UPWARD, read_record, reason);
  H5Eclear2(H5E_DEFAULT);
  if (h->error != 0) snprintf(reason, sizeof reason, "%s", strerror(h->error));
  return cf_fail(h->writing ? CF_CANNOT_WRITE : CF_BAD_FILE, "%s: cannot %s %s: %s", h->draft.path.text, what,
                 name, reason[0] == '\0' ? "for a reason HDF5 does not give" : reason);
}

/* --- the file ---------------------------------------------------------------------------------------------
 */

static void enter(cf_hdf5 *h) {
  pthread_mutex_lock(&one_at_a_time);
  H5open();
  H5Eget_auto2(H5E_DEFAULT, &h->print, &h->print_context);
  H5Eset_auto2(H5E_DEFAULT, NULL, NULL);
}

static void leave(cf_hdf5 *h) {
  H5Eset_auto2(H5E_DEFAULT, h->print, h->print_context);
  pthread_mutex_unlock(&one_at_a_time);
}

static hid_t access_list(void) {
  const hid_t list = H5Pcreate(H5P_FILE_ACCESS);
  if (list < 0) return list;
  H5Pset_fclose_degree(list, H5F_CLOSE_STRONG);
  H5Pset_file_locking(list, false, true); /* nobody else sees an unfinished file; locks fail on some disks */
  return list;
}

/* HDF5 crashes where an allocation of its own fails: it starts with room for all it takes. */
#define HDF5_ROOM ((size_t)16 << 20)

cf_status cf_hdf5_create(cf_hdf5 *h, const char *path, const size_t head) {
  *h = (cf_hdf5){.file = -1, .writing = true};
  CF_TRY(cf_mem_room(HDF5_ROOM));
  CF_TRY(cf_draft_begin(&h->draft, path));
  enter(h);
  const hid_t access = access_list(), creation = H5Pcreate(H5P_FILE_CREATE);
  if (access >= 0 && creation >= 0 && H5Pset_userblock(creation, head) >= 0 &&
      cf_hdf5_driver_use(access, &h->error) >= 0) {
    H5Pset_obj_track_times(creation, false);
    h->file = H5Fcreate(h->draft.temporary.text, H5F_ACC_TRUNC, creation, access);
  }
  const cf_status s = h->file >= 0 ? CF_OK : cf_hdf5_fail(h, "create", "the file");
  H5Pclose(access);
  H5Pclose(creation);
  if (s != CF_OK) {
    cf_draft_drop(&h->draft);
    leave(h);
  }
  return s;
}

cf_status cf_hdf5_open(cf_hdf5 *h, const char *path) {
  *h = (cf_hdf5){.file = -1};
  CF_TRY(cf_mem_room(HDF5_ROOM));
  CF_TRY(cf_path_make(&h->draft.path, "%s", path));
  FILE *file;
  size_t size;
  CF_TRY(cf_file_open(path, &file, &size)); /* for the system's own words */
  fclose(file);
  enter(h);
  const hid_t access = access_list();
  h->file =
      access < 0 || cf_hdf5_driver_use(access, &h->error) < 0 ? -1 : H5Fopen(path, H5F_ACC_RDONLY, access);
  cf_status s = CF_OK;
  if (h->file < 0) {
    s = cf_hdf5_fail(h, "read", "it");
    if (h->error == 0)
      s = cf_fail(CF_BAD_FILE,
                  "%s: is neither a frame nor a checkpoint, or is damaged: the HDF5 library cannot read it",
                  path);
  }
  H5Pclose(access);
  if (s != CF_OK) leave(h);
  return s;
}

cf_status cf_hdf5_close(cf_hdf5 *h, cf_status so_far) {
  const herr_t closed = H5Fclose(h->file);
  if (so_far == CF_OK && (closed < 0 || h->error != 0))
    so_far = cf_hdf5_fail(h, h->writing ? "write" : "close", "to the end");
  H5Eclear2(H5E_DEFAULT);
  h->file = -1;
  if (so_far != CF_OK && h->writing) cf_draft_drop(&h->draft);
  leave(h);
  return so_far;
}

cf_hdf5_window cf_hdf5_window_open(const hid_t set, const int rank, const uint64_t *start,
                                   const uint64_t *count) {
  hsize_t from[4], extent[4];
  for (int d = 0; d < rank; ++d) from[d] = start[d], extent[d] = count[d];
  cf_hdf5_window w = {.file = H5Dget_space(set), .memory = H5Screate_simple(rank, extent, NULL)};
  w.good = w.file >= 0 && w.memory >= 0 &&
           H5Sselect_hyperslab(w.file, H5S_SELECT_SET, from, NULL, extent, NULL) >= 0;
  return w;
}

void cf_hdf5_window_close(const cf_hdf5_window *w) {
  H5Sclose(w->memory);
  H5Sclose(w->file);
}

/* --- types ------------------------------------------------------------------------------------------------
 */

hid_t cf_hdf5_memory_type(const cf_element e) {
  if (e == CF_ELEMENT_INTEGER) return H5T_NATIVE_INT64;
  if (e == CF_ELEMENT_BYTE) return H5T_NATIVE_UINT8;
  return e == CF_ELEMENT_REAL && sizeof(cf_real) == 4 ? H5T_NATIVE_FLOAT : H5T_NATIVE_DOUBLE;
}

hid_t cf_hdf5_file_type(const cf_element e) {
  if (e == CF_ELEMENT_INTEGER) return H5T_STD_I64LE;
  if (e == CF_ELEMENT_BYTE) return H5T_STD_U8LE;
  return e == CF_ELEMENT_REAL && sizeof(cf_real) == 4 ? H5T_IEEE_F32LE : H5T_IEEE_F64LE;
}

/* --- groups and attributes ---------------------------------------------------------------------------- */

cf_status cf_hdf5_group(cf_hdf5 *h, const char *path) {
  const hid_t creation = H5Pcreate(H5P_GROUP_CREATE);
  if (creation >= 0) H5Pset_obj_track_times(creation, false);
  const hid_t group = H5Gcreate2(h->file, path, H5P_DEFAULT, creation, H5P_DEFAULT);
  const cf_status s = group >= 0 ? CF_OK : cf_hdf5_fail(h, "write", path);
  if (group >= 0) H5Gclose(group);
  H5Pclose(creation);
  return s;
}

static cf_status set_attribute(cf_hdf5 *h, const char *path, const char *name, const hid_t types[2],
                               const hid_t space, const void *values) {
  const hid_t attribute =
      H5Acreate_by_name(h->file, path, name, types[0], space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
  const bool good = attribute >= 0 && H5Awrite(attribute, types[1], values) >= 0;
  const cf_status s = good ? CF_OK : cf_hdf5_fail(h, "write", name);
  if (attribute >= 0) H5Aclose(attribute);
  return s;
}

cf_status cf_hdf5_set_text(cf_hdf5 *h, const char *path, const char *name, const char *text) {
  const size_t length = strlen(text);
  const hid_t type = H5Tcopy(H5T_C_S1), space = H5Screate(H5S_SCALAR);
  H5Tset_size(type, length > 0 ? length : 1);
  H5Tset_strpad(type, H5T_STR_NULLPAD);
  for (size_t i = 0; i < length; ++i)
    if ((unsigned char)text[i] >= 128) H5Tset_cset(type, H5T_CSET_UTF8);
  const cf_status s = set_attribute(h, path, name, (hid_t[2]){type, type}, space, text);
  H5Tclose(type);
  H5Sclose(space);
  return s;
}

static cf_status set_list(cf_hdf5 *h, const char *path, const char *name, const cf_element e, const int count,
                          const void *values) {
  const hsize_t n = (hsize_t)count;
  const hid_t space = count == 1 ? H5Screate(H5S_SCALAR) : H5Screate_simple(1, &n, NULL);
  const cf_status s =
      set_attribute(h, path, name, (hid_t[2]){cf_hdf5_file_type(e), cf_hdf5_memory_type(e)}, space, values);
  H5Sclose(space);
  return s;
}

cf_status cf_hdf5_set_numbers(cf_hdf5 *h, const char *path, const char *name, const int count,
                              const double *values) {
  return set_list(h, path, name, CF_ELEMENT_NUMBER, count, values);
}

cf_status cf_hdf5_set_integers(cf_hdf5 *h, const char *path, const char *name, const int count,
                               const int64_t *values) {
  return set_list(h, path, name, CF_ELEMENT_INTEGER, count, values);
}

/* --- arrays -----------------------------------------------------------------------------------------------
 */

/* Without fill values an array is written once; with chunks they make the padding the same every time. */
static hid_t dataset_list(const int compression, const int rank, const hsize_t *chunk) {
  const hid_t list = H5Pcreate(H5P_DATASET_CREATE);
  if (list < 0) return list;
  H5Pset_obj_track_times(list, false);
  if (compression > 0) {
    H5Pset_chunk(list, rank, chunk);
    H5Pset_shuffle(list);
    H5Pset_deflate(list, (unsigned)compression);
  } else {
    H5Pset_fill_time(list, H5D_FILL_TIME_NEVER);
  }
  return list;
}

static hid_t create_dataset(cf_hdf5 *h, const char *path, const cf_array *a, const hid_t list) {
  hsize_t n[4];
  for (int d = 0; d < a->rank; ++d) n[d] = (hsize_t)a->n[d];
  const hid_t space = H5Screate_simple(a->rank, n, NULL);
  const hid_t set =
      H5Dcreate2(h->file, path, cf_hdf5_file_type(a->element), space, H5P_DEFAULT, list, H5P_DEFAULT);
  H5Sclose(space);
  return set;
}

/* An empty array has no place. */
static void find_place(const hid_t set, const cf_array *a, cf_extent *extent) {
  const haddr_t offset = H5Dget_offset(set);
  extent->bytes = cf_array_bytes(a);
  extent->offset = offset == HADDR_UNDEF ? 0 : (uint64_t)offset;
}

cf_status cf_hdf5_write(cf_hdf5 *h, const char *path, const cf_array *a, const void *values,
                        cf_extent *extent) {
  const hid_t list = dataset_list(0, a->rank, NULL);
  const hid_t set = create_dataset(h, path, a, list);
  bool good = set >= 0;
  if (good && cf_array_bytes(a) > 0)
    good = H5Dwrite(set, cf_hdf5_memory_type(a->element), H5S_ALL, H5S_ALL, H5P_DEFAULT, values) >= 0;
  good = good && h->error == 0;
  const cf_status s = good ? CF_OK : cf_hdf5_fail(h, "write", path);
  if (good && extent != NULL) {
    find_place(set, a, extent);
    extent->checksum = cf_checksum_of(values, (size_t)extent->bytes / cf_element_size(a->element),
                                      cf_element_size(a->element));
  }
  if (set >= 0) H5Dclose(set);
  H5Pclose(list);
  return s;
}

static bool write_piece(const hid_t set, const cf_slabs *s, const cf_slab p, const cf_real *values) {
  uint64_t start[4], count[4];
  cf_slab_window(s, p, start, count);
  const cf_hdf5_window w = cf_hdf5_window_open(set, cf_slabs_array(s).rank, start, count);
  const bool good = w.good && H5Dwrite(set, cf_hdf5_memory_type(CF_ELEMENT_REAL), w.memory, w.file,
                                       H5P_DEFAULT, values) >= 0;
  cf_hdf5_window_close(&w);
  return good;
}

static bool write_pieces(const hid_t set, const cf_slabs *s, cf_real *buffer, cf_checksum *sum) {
  cf_slab piece;
  for (int64_t i = 0; cf_slabs_piece(s, i, &piece); ++i) {
    cf_slab_gather(s, piece, buffer);
    if (!write_piece(set, s, piece, buffer)) return false;
    cf_checksum_add_values(sum, buffer, cf_slab_size(s, piece), sizeof *buffer);
  }
  return true;
}

cf_status cf_hdf5_write_slabs(cf_hdf5 *h, const char *path, const cf_slabs *s, const int compression,
                              cf_extent *extent) {
  const cf_array a = cf_slabs_array(s);
  uint64_t start[4], window[4];
  hsize_t chunk[4];
  cf_real *buffer;
  cf_checksum sum;
  cf_slab_window(s, (cf_slab){.rows = s->rows}, start, window);
  for (int d = 0; d < 4; ++d) chunk[d] = window[d];
  CF_TRY(CF_NEW(&buffer, cf_slabs_room(s)));
  cf_checksum_start(&sum);
  const hid_t list = dataset_list(cf_array_bytes(&a) > 0 ? compression : 0, a.rank, chunk);
  const hid_t set = create_dataset(h, path, &a, list);
  const bool good = set >= 0 && write_pieces(set, s, buffer, &sum) && h->error == 0;
  const cf_status status = good ? CF_OK : cf_hdf5_fail(h, "write", path);
  if (good && extent != NULL) {
    find_place(set, &a, extent);
    extent->checksum = cf_checksum_end(&sum);
  }
  if (set >= 0) H5Dclose(set);
  H5Pclose(list);
  cf_free(buffer);
  return status;
}

cf_status cf_hdf5_write_part(cf_hdf5 *h, const char *path, const cf_part *p, const int compression,
                             cf_extent *extent) {
  if (p->streamed)
    CF_TRY(cf_hdf5_write_slabs(h, path, &p->slabs, compression, extent));
  else
    CF_TRY(cf_hdf5_write(h, path, &p->array, p->values, extent));
  return cf_hdf5_set_text(h, path, "unit", p->unit);
}
