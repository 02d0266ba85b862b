/* SPDX-License-Identifier: MIT */
#define _GNU_SOURCE
#include "io/npy.h"

#include <errno.h>
#include <inttypes.h>
#include <stdio.h>
#include <string.h>

#include "base/mem.h"
#include "io/folder.h"
#include "io/slabs.h"

#define HEAD_ALIGN 64 /* the values begin on a multiple of this */

/* Magic, version 1.0, length of the description, and the description padded with blanks up to a newline. */
static bool write_head(FILE *file, const int rank, const int64_t *shape) {
  char text[256];
  int length = snprintf(text, sizeof text, "{'descr': '<f%d', 'fortran_order': False, 'shape': (",
                        (int)sizeof(cf_real));
  for (int d = 0; d < rank; ++d)
    length += snprintf(text + length, sizeof text - (size_t)length, "%" PRId64 "%s", shape[d],
                       rank == 1      ? ","
                       : d + 1 < rank ? ", "
                                      : "");
  length += snprintf(text + length, sizeof text - (size_t)length, "), }");
  const int padded = (10 + length + HEAD_ALIGN) / HEAD_ALIGN * HEAD_ALIGN - 10;
  const unsigned char magic[10] = {
      0x93, 'N', 'U', 'M', 'P', 'Y', 1, 0, (unsigned char)padded, (unsigned char)(padded >> 8)};
  return fwrite(magic, 1, 10, file) == 10 && fprintf(file, "%-*s\n", padded - 1, text) == padded;
}

typedef struct array {
  int rank;
  int64_t shape[3];
  const cf_slabs *slabs; /* of a field */
  const cf_real *values; /* else: all in one piece */
} array;

static bool write_slabs(FILE *file, const cf_slabs *s, cf_real *buffer) {
  cf_slab piece;
  for (int64_t i = 0; cf_slabs_piece(s, i, &piece); ++i) {
    const size_t size = cf_slab_size(s, piece);
    cf_slab_gather(s, piece, buffer);
    if (fwrite(buffer, sizeof *buffer, size, file) != size) return false;
  }
  return true;
}

static bool write_values(FILE *file, const array *a, cf_real *buffer) {
  if (a->slabs != NULL) return write_slabs(file, a->slabs, buffer);
  const size_t size = (size_t)(a->shape[0] * (a->rank == 2 ? a->shape[1] : 1));
  return size == 0 || fwrite(a->values, sizeof *a->values, size, file) == size;
}

static cf_status write_file(const cf_draft *draft, const array *a, cf_real *buffer) {
  FILE *file = fopen(draft->temporary.text, "wbe");
  if (file == NULL)
    return cf_fail(CF_CANNOT_WRITE, "%s: cannot be written: %s", draft->path.text, strerror(errno));
  const bool good = write_head(file, a->rank, a->shape) && write_values(file, a, buffer) && fflush(file) == 0;
  const int reason = errno;
  if (fclose(file) != 0 || !good) {
    cf_draft_drop(draft);
    return cf_fail(CF_CANNOT_WRITE, "%s: cannot be written: %s", draft->path.text,
                   strerror(good ? errno : reason));
  }
  return cf_draft_keep(draft);
}

static cf_status write_array(const cf_path *path, const array *a) {
  cf_draft draft;
  cf_real *buffer = NULL;
  CF_TRY(cf_draft_begin(&draft, path->text));
  if (a->slabs != NULL) CF_TRY(CF_NEW(&buffer, cf_slabs_room(a->slabs)));
  const cf_status s = write_file(&draft, a, buffer);
  cf_free(buffer);
  return s;
}

/* In 2D the z axis of the slabs (one plane) is left out. */
static cf_status write_field(const cf_path *path, const cf_slabs *s) {
  array a = {.rank = s->box->dim, .slabs = s};
  for (int d = 0; d < a.rank; ++d) a.shape[d] = s->n[a.rank - 1 - d];
  return write_array(path, &a);
}

static cf_status write_faces(const char *folder, const int64_t frame, const cf_registry *r,
                             const cf_entry *e) {
  for (int axis = 0; axis < r->grid->box.dim; ++axis) {
    const cf_slabs s = cf_slabs_of_face(&r->grid->box, &e->face, axis);
    cf_path path;
    CF_TRY(cf_path_make(&path, "%s/fields_%06" PRId64 "_%s_%c.npy", folder, frame, e->name, "xyz"[axis]));
    CF_TRY(write_field(&path, &s));
  }
  return CF_OK;
}

/* SET.ATTRIBUTE: one file an attribute. */
static cf_status write_particles(const char *folder, const int64_t frame, const cf_entry *e) {
  const char *dot = strchr(e->name, '.');
  const array a = {
      .rank = e->components > 1 ? 2 : 1, .shape = {*e->count, e->components}, .values = *e->particles};
  cf_path path;
  if (dot == NULL)
    CF_TRY(cf_path_make(&path, "%s/particles_%06" PRId64 "_%s.npy", folder, frame, e->name));
  else
    CF_TRY(cf_path_make(&path, "%s/%.*s_%06" PRId64 "_%s.npy", folder, (int)(dot - e->name), e->name, frame,
                        dot + 1));
  return write_array(&path, &a);
}

static cf_status write_entry(const char *folder, const int64_t frame, const cf_registry *r,
                             const cf_entry *e) {
  cf_path path;
  if (e->kind == CF_KIND_FACE) return write_faces(folder, frame, r, e);
  if (e->kind == CF_KIND_PARTICLE) return write_particles(folder, frame, e);
  if (e->kind != CF_KIND_CELL) return CF_OK;
  const cf_slabs s = cf_slabs_of_cell(&r->grid->box, e->cell);
  CF_TRY(cf_path_make(&path, "%s/fields_%06" PRId64 "_%s.npy", folder, frame, e->name));
  return write_field(&path, &s);
}

/* Whether the entry is meant by a name: its own, or that of its set of particles. */
static bool is_meant(const cf_entry *e, const char *name) {
  const size_t length = strlen(name);
  if (strcmp(e->name, name) == 0) return true;
  return e->kind == CF_KIND_PARTICLE && strncmp(e->name, name, length) == 0 && e->name[length] == '.';
}

cf_status cf_npy_write(const char *folder, const int64_t frame, const cf_registry *r, const int count,
                       const char *const *names) {
  for (int i = 0; i < count; ++i) {
    int meant = 0;
    for (int e = 0; e < r->count; ++e) {
      if (!is_meant(&r->entry[e], names[i])) continue;
      ++meant;
      CF_TRY(write_entry(folder, frame, r, &r->entry[e]));
    }
    if (meant == 0) return cf_fail(CF_BAD_ARGUMENT, "there is no field \"%s\" to write", names[i]);
  }
  return CF_OK;
}
