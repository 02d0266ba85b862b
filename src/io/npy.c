/* SPDX-License-Identifier: MIT */
#define _GNU_SOURCE
#include "io/npy.h"

#include <inttypes.h>
#include <stdio.h>
#include <string.h>

#include "base/mem.h"
#include "io/folder.h"

#define HEAD_ALIGN 64 /* the values begin on a multiple of this */

/* Magic, version 1.0, length of the description, and the description padded with blanks up to a newline. */
static bool write_head(FILE *file, const cf_array *a) {
  char text[256];
  int length = snprintf(text, sizeof text, "{'descr': '<%c%d', 'fortran_order': False, 'shape': (",
                        a->element == CF_ELEMENT_INTEGER ? 'i' : 'f', (int)cf_element_size(a->element));
  for (int d = 0; d < a->rank; ++d)
    length += snprintf(text + length, sizeof text - (size_t)length, "%" PRId64 "%s", a->n[d],
                       a->rank == 1      ? ","
                       : d + 1 < a->rank ? ", "
                                         : "");
  length += snprintf(text + length, sizeof text - (size_t)length, "), }");
  const int padded = (10 + length + HEAD_ALIGN) / HEAD_ALIGN * HEAD_ALIGN - 10;
  const unsigned char magic[10] = {
      0x93, 'N', 'U', 'M', 'P', 'Y', 1, 0, (unsigned char)padded, (unsigned char)(padded >> 8)};
  return fwrite(magic, 1, 10, file) == 10 && fprintf(file, "%-*s\n", padded - 1, text) == padded;
}

typedef struct job {
  const cf_part *part;
  cf_real *buffer; /* of a piece */
} job;

static bool write_slabs(FILE *file, const cf_slabs *s, cf_real *buffer) {
  cf_slab piece;
  for (int64_t i = 0; cf_slabs_piece(s, i, &piece); ++i) {
    const size_t size = cf_slab_size(s, piece);
    cf_slab_gather(s, piece, buffer);
    if (fwrite(buffer, sizeof *buffer, size, file) != size) return false;
  }
  return true;
}

static bool fill(FILE *file, const void *what) {
  const job *j = what;
  const cf_part *p = j->part;
  const size_t bytes = (size_t)cf_array_bytes(&p->array);
  if (!write_head(file, &p->array)) return false;
  if (p->streamed) return write_slabs(file, &p->slabs, j->buffer);
  return bytes == 0 || fwrite(p->values, 1, bytes, file) == bytes;
}

static cf_status write_array(const cf_path *path, const cf_part *p) {
  job j = {.part = p};
  if (p->streamed) CF_TRY(CF_NEW(&j.buffer, cf_slabs_room(&p->slabs)));
  const cf_status s = cf_file_fill(path->text, fill, &j);
  cf_free(j.buffer);
  return s;
}

static cf_status write_part(const char *folder, const int64_t frame, const cf_registry *r, cf_part *p) {
  const bool particles = p->entry->kind == CF_KIND_PARTICLES;
  char word[2 * CF_NAME_MAX] = "fields", name[2 * CF_NAME_MAX];
  cf_path path;
  if (particles)
    cf_particles_word(r, p->entry->particles, word, sizeof word);
  else if (r->grid->box.dim == 2) { /* the z axis of one plane is left out */
    p->slabs.axes = 2;
    p->array = cf_slabs_array(&p->slabs);
  }
  snprintf(name, sizeof name, "%s", particles ? cf_part_own(p) : p->name);
  for (char *slash = strchr(name, '/'); slash != NULL; slash = strchr(slash, '/')) *slash = '_'; /* q/x */
  CF_TRY(cf_path_make(&path, "%s/%s_%06" PRId64 "_%s.npy", folder, word, frame, name));
  return write_array(&path, p);
}

cf_status cf_npy_write(const char *folder, const int64_t frame, const cf_registry *r,
                       const cf_choice *choice) {
  CF_TRY(cf_choice_check(choice, r));
  for (int e = 0; e < r->count; ++e) {
    const cf_entry *entry = &r->entry[e];
    cf_part part;
    if (entry->kind == CF_KIND_NUMBER || entry->kind == CF_KIND_COUNTER) continue;
    for (int i = 0; cf_part_of(r, entry, i, &part); ++i)
      if (cf_choice_has_part(choice, &part) && !(entry->kind == CF_KIND_PARTICLES && i == CF_PART_NEXT_ID))
        CF_TRY(write_part(folder, frame, r, &part));
  }
  return CF_OK;
}
