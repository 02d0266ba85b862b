/* SPDX-License-Identifier: MIT */
#include <inttypes.h>
#include <math.h>
#include <string.h>

#include "base/mem.h"
#include "io/hdf5.h"

bool cf_hdf5_has(const cf_hdf5 *h, const char *path) {
  /* Every group on the way must be asked for. */
  char part[2 * CF_PATH_MAX];
  for (const char *slash = path; slash != NULL;) {
    slash = strchr(slash + 1, '/');
    snprintf(part, sizeof part, "%.*s", slash == NULL ? (int)strlen(path) : (int)(slash - path), path);
    if (strcmp(part, "/") != 0 && H5Lexists(h->file, part, H5P_DEFAULT) <= 0) return false;
  }
  return true;
}

/* --- attributes ------------------------------------------------------------------------------------------
 */

static hid_t open_attribute(const cf_hdf5 *h, const char *path, const char *name) {
  if (H5Aexists_by_name(h->file, path, name, H5P_DEFAULT) <= 0) return -1;
  return H5Aopen_by_name(h->file, path, name, H5P_DEFAULT, H5P_DEFAULT);
}

static cf_status no_attribute(const cf_hdf5 *h, const char *path, const char *name) {
  H5Eclear2(H5E_DEFAULT);
  return cf_fail(CF_BAD_FILE, "%s: %s has no attribute \"%s\" of the kind that belongs there",
                 h->draft.path.text, path, name);
}

/* A fixed-length text is converted to one of the length that the caller has room for. */
static bool read_text(const hid_t attribute, char *text, const size_t size) {
  const hid_t held = H5Aget_type(attribute);
  bool good = held >= 0 && H5Tget_class(held) == H5T_STRING && H5Tis_variable_str(held) == 0;
  if (good) {
    const hid_t wanted = H5Tcopy(H5T_C_S1);
    const hid_t space = H5Aget_space(attribute);
    good = wanted >= 0 && H5Tset_size(wanted, size) >= 0 && H5Tset_cset(wanted, H5Tget_cset(held)) >= 0 &&
           H5Sget_simple_extent_npoints(space) == 1 && H5Aread(attribute, wanted, text) >= 0;
    text[size - 1] = '\0';
    H5Sclose(space);
    H5Tclose(wanted);
  }
  if (held >= 0) H5Tclose(held);
  return good;
}

cf_status cf_hdf5_get_text(cf_hdf5 *h, const char *path, const char *name, char *text, const size_t size) {
  const hid_t attribute = open_attribute(h, path, name);
  memset(text, 0, size);
  const bool good = attribute >= 0 && read_text(attribute, text, size);
  if (attribute >= 0) H5Aclose(attribute);
  return good ? CF_OK : no_attribute(h, path, name);
}

static cf_status get_list(cf_hdf5 *h, const char *path, const char *name, const cf_element e, const int count,
                          void *values) {
  const hid_t attribute = open_attribute(h, path, name);
  bool good = attribute >= 0;
  if (good) {
    const hid_t space = H5Aget_space(attribute), type = H5Aget_type(attribute);
    const H5T_class_t kind = H5Tget_class(type);
    good = (kind == H5T_FLOAT || kind == H5T_INTEGER) && H5Sget_simple_extent_npoints(space) == count &&
           H5Aread(attribute, cf_hdf5_memory_type(e), values) >= 0;
    H5Tclose(type);
    H5Sclose(space);
    H5Aclose(attribute);
  }
  return good ? CF_OK : no_attribute(h, path, name);
}

cf_status cf_hdf5_get_numbers(cf_hdf5 *h, const char *path, const char *name, const int count,
                              double *values) {
  return get_list(h, path, name, CF_ELEMENT_NUMBER, count, values);
}

cf_status cf_hdf5_get_integers(cf_hdf5 *h, const char *path, const char *name, const int count,
                               int64_t *values) {
  return get_list(h, path, name, CF_ELEMENT_INTEGER, count, values);
}

/* --- arrays -----------------------------------------------------------------------------------------------
 */

static cf_element element_of(const hid_t set) {
  const hid_t type = H5Dget_type(set);
  const H5T_class_t kind = H5Tget_class(type);
  const size_t size = H5Tget_size(type);
  H5Tclose(type);
  if (kind == H5T_FLOAT) return size == sizeof(cf_real) ? CF_ELEMENT_REAL : CF_ELEMENT_NUMBER;
  return size == 1 ? CF_ELEMENT_BYTE : CF_ELEMENT_INTEGER;
}

static bool shape_of(const hid_t set, cf_array *a) {
  const hid_t space = H5Dget_space(set), type = H5Dget_type(set);
  const H5T_class_t kind = H5Tget_class(type);
  const int rank = H5Sget_simple_extent_ndims(space);
  const bool good = rank >= 1 && rank <= 4 && (kind == H5T_FLOAT || kind == H5T_INTEGER);
  hsize_t n[4] = {0};
  if (good) H5Sget_simple_extent_dims(space, n, NULL);
  H5Tclose(type);
  H5Sclose(space);
  *a = (cf_array){.element = element_of(set), .rank = rank};
  for (int d = 0; d < 4; ++d) a->n[d] = (int64_t)n[d];
  return good;
}

/* What deflate makes of zeros is a thousandth of them: a short file cannot ask for much memory. */
static bool is_room_for(const cf_hdf5 *h, const cf_array *a) {
  const double most_packed = 1100;
  double bytes = a->element == CF_ELEMENT_BYTE ? 1 : 8;
  hsize_t size = 0;
  for (int d = 0; d < a->rank; ++d) bytes *= (double)a->n[d];
  return H5Fget_filesize(h->file, &size) >= 0 && bytes <= most_packed * (double)size;
}

cf_status cf_hdf5_shape(cf_hdf5 *h, const char *path, cf_array *a) {
  if (!cf_hdf5_has(h, path)) return cf_fail(CF_BAD_FILE, "%s: has no array %s", h->draft.path.text, path);
  const hid_t set = H5Dopen2(h->file, path, H5P_DEFAULT);
  const bool good = set >= 0 && shape_of(set, a);
  if (set >= 0) H5Dclose(set);
  H5Eclear2(H5E_DEFAULT);
  if (!good) return cf_fail(CF_BAD_FILE, "%s: %s is not an array of numbers", h->draft.path.text, path);
  if (is_room_for(h, a)) return CF_OK;
  return cf_fail(CF_BAD_FILE, "%s: %s says that it is larger than the file can hold", h->draft.path.text,
                 path);
}

static void shape_text(const cf_array *a, char *text, const size_t size) {
  text[0] = '\0';
  for (int d = 0; d < a->rank; ++d) {
    const size_t length = strlen(text);
    snprintf(text + length, size - length, "%s%" PRId64, d > 0 ? " x " : "", a->n[d]);
  }
}

/* Opens an array that must have this shape. */
static cf_status open_array(cf_hdf5 *h, const char *path, const cf_array *wanted, hid_t *set) {
  cf_array found;
  CF_TRY(cf_hdf5_shape(h, path, &found));
  bool same = found.rank == wanted->rank;
  for (int d = 0; d < wanted->rank; ++d) same = same && found.n[d] == wanted->n[d];
  if (!same) {
    char a[96], b[96];
    shape_text(wanted, a, sizeof a);
    shape_text(&found, b, sizeof b);
    return cf_fail(CF_BAD_FILE, "%s: %s has another shape: expected %s, found %s", h->draft.path.text, path,
                   a, b);
  }
  *set = H5Dopen2(h->file, path, H5P_DEFAULT);
  return *set >= 0 ? CF_OK : cf_hdf5_fail(h, "read", path);
}

cf_status cf_hdf5_read(cf_hdf5 *h, const char *path, const cf_array *a, void *values) {
  hid_t set;
  CF_TRY(open_array(h, path, a, &set));
  bool empty = false;
  for (int d = 0; d < a->rank; ++d) empty = empty || a->n[d] == 0;
  cf_status s = CF_OK;
  if (!empty && H5Dread(set, cf_hdf5_memory_type(a->element), H5S_ALL, H5S_ALL, H5P_DEFAULT, values) < 0)
    s = cf_hdf5_fail(h, "read", path);
  H5Dclose(set);
  return s;
}

/* Reads one piece with all its components. */
static bool read_piece(const hid_t set, const cf_slabs *s, const cf_slab p, cf_real *values) {
  uint64_t start[4], count[4];
  cf_slab_window(s, p, start, count);
  const cf_hdf5_window w = cf_hdf5_window_open(set, cf_slabs_array(s).rank, start, count);
  const bool good = w.good && H5Dread(set, cf_hdf5_memory_type(CF_ELEMENT_REAL), w.memory, w.file,
                                      H5P_DEFAULT, values) >= 0;
  cf_hdf5_window_close(&w);
  return good;
}

/* Keeps one component of n vectors, or their length, in place. */
static void pick(const size_t n, const int components, const int component, cf_real *values) {
  if (components == 1) return;
  for (size_t i = 0; i < n; ++i) {
    const cf_real *v = values + i * (size_t)components;
    double square = 0;
    for (int c = 0; c < components; ++c) square += (double)v[c] * (double)v[c];
    values[i] = component < 0 ? (cf_real)sqrt(square) : v[component];
  }
}

/* `wide` has all components of the array, `into` those that are kept. */
static cf_status read_pieces(cf_hdf5 *h, const char *path, const cf_slabs *wide, const cf_slabs *into,
                             const int component) {
  const cf_array a = cf_slabs_array(wide);
  cf_real *buffer;
  cf_slab piece;
  hid_t set;
  CF_TRY(CF_NEW(&buffer, cf_slabs_room(wide)));
  cf_status status = open_array(h, path, &a, &set);
  if (status == CF_OK) {
    for (int64_t i = 0; status == CF_OK && cf_slabs_piece(wide, i, &piece); ++i) {
      if (!read_piece(set, wide, piece, buffer)) {
        status = cf_hdf5_fail(h, "read", path);
        break;
      }
      if (wide != into) pick(cf_slab_size(into, piece), wide->components, component, buffer);
      cf_slab_scatter(into, piece, buffer);
    }
    H5Dclose(set);
  }
  cf_free(buffer);
  return status;
}

cf_status cf_hdf5_read_component(cf_hdf5 *h, const char *path, const cf_slabs *s, const int components,
                                 const int component) {
  cf_slabs wide = *s;
  wide.components = components;
  return read_pieces(h, path, &wide, s, component);
}

cf_status cf_hdf5_read_slabs(cf_hdf5 *h, const char *path, const cf_slabs *s) {
  return read_pieces(h, path, s, s, 0);
}

cf_status cf_hdf5_read_part(cf_hdf5 *h, const char *path, const cf_part *p) {
  return p->streamed ? cf_hdf5_read_slabs(h, path, &p->slabs) : cf_hdf5_read(h, path, &p->array, p->values);
}

/* --- what is in a group --------------------------------------------------------------------------------- */

typedef struct walk {
  cf_hdf5 *h;
  cf_status (*visit)(void *context, cf_hdf5 *h, const char *name);
  void *context;
  cf_status status;
} walk;

static herr_t visit_link(hid_t group, const char *name, const H5L_info_t *info, void *context) {
  walk *w = context;
  (void)group;
  (void)info;
  w->status = w->visit(w->context, w->h, name);
  return w->status == CF_OK ? 0 : 1;
}

cf_status cf_hdf5_each(cf_hdf5 *h, const char *path,
                       cf_status (*visit)(void *context, cf_hdf5 *h, const char *name), void *context) {
  walk w = {h, visit, context, CF_OK};
  if (!cf_hdf5_has(h, path)) return cf_fail(CF_BAD_FILE, "%s: has no group %s", h->draft.path.text, path);
  hsize_t at = 0;
  if (H5Literate_by_name(h->file, path, H5_INDEX_NAME, H5_ITER_INC, &at, visit_link, &w, H5P_DEFAULT) < 0 &&
      w.status == CF_OK)
    return cf_hdf5_fail(h, "list", path);
  return w.status;
}
