/* SPDX-License-Identifier: MIT
 *
 * Numbers are 32-bit floats whatever the precision of the state: readers of PLY know no others well.
 */
#define _GNU_SOURCE
#include <inttypes.h>
#include <stdio.h>
#include <string.h>

#include "base/version.h"
#include "io/folder.h"
#include "io/mesh.h"

#define TRIANGLE_BYTES 13

typedef struct job {
  const cf_mesh *mesh;
  const cf_stamp *stamp;
} job;

static unsigned char *put_word(unsigned char *at, const uint32_t word) {
  for (int b = 0; b < 4; ++b) *at++ = (unsigned char)(word >> 8 * b);
  return at;
}

static unsigned char *put_real(unsigned char *at, const cf_real value) {
  const float narrow = (float)value;
  uint32_t word;
  memcpy(&word, &narrow, sizeof word);
  return put_word(at, word);
}

/* A title may have several lines; a comment has one. */
static void write_title(FILE *file, const char *title) {
  fprintf(file, "comment title ");
  for (const char *c = title; *c != '\0'; ++c) fputc((unsigned char)*c < ' ' ? ' ' : *c, file);
  fprintf(file, "\n");
}

static void write_head(FILE *file, const cf_mesh *m, const cf_stamp *stamp) {
  fprintf(file, "ply\nformat binary_little_endian 1.0\ncomment Cattaneo %s, lengths in m\n", cf_version());
  if (stamp->title != NULL) write_title(file, stamp->title);
  fprintf(file, "comment time %.17g s\ncomment step %" PRId64 "\n", stamp->time, stamp->step);
  for (int a = 0; a < m->attributes; ++a)
    fprintf(file, "comment unit of %s: %s\n", m->attribute[a].name,
            m->attribute[a].unit[0] != '\0' ? m->attribute[a].unit : "1");
  fprintf(file, "element vertex %" PRId64 "\nproperty float x\nproperty float y\nproperty float z\n",
          m->vertices);
  if (m->normal != NULL) fprintf(file, "property float nx\nproperty float ny\nproperty float nz\n");
  for (int a = 0; a < m->attributes; ++a) fprintf(file, "property float %s\n", m->attribute[a].name);
  fprintf(file, "element face %" PRId64 "\nproperty list uchar int vertex_indices\nend_header\n",
          m->triangles);
}

static bool fill(FILE *file, const void *what) {
  const job *j = what;
  const cf_mesh *m = j->mesh;
  unsigned char bytes[4 * (6 + CF_MESH_ATTRIBUTES)];
  write_head(file, m, j->stamp);
  for (int64_t v = 0; v < m->vertices; ++v) {
    unsigned char *at = bytes;
    for (int a = 0; a < 3; ++a) at = put_real(at, m->place[v][a]);
    for (int a = 0; m->normal != NULL && a < 3; ++a) at = put_real(at, m->normal[v][a]);
    for (int a = 0; a < m->attributes; ++a) at = put_real(at, m->attribute[a].at[v]);
    if (fwrite(bytes, 1, (size_t)(at - bytes), file) != (size_t)(at - bytes)) return false;
  }
  for (int64_t t = 0; t < m->triangles; ++t) {
    unsigned char *at = bytes;
    *at++ = 3;
    for (int c = 0; c < 3; ++c) at = put_word(at, (uint32_t)m->corner[t][c]);
    if (fwrite(bytes, 1, TRIANGLE_BYTES, file) != TRIANGLE_BYTES) return false;
  }
  return true;
}

cf_status cf_ply_write(const char *path, const cf_mesh *mesh, const cf_stamp *stamp) {
  for (int a = 0; a < mesh->attributes; ++a)
    if (strpbrk(mesh->attribute[a].name, " \t\r\n") != NULL)
      return cf_fail(CF_BAD_ARGUMENT, "an attribute of a mesh named \"%s\": no blank can stand in a name",
                     mesh->attribute[a].name);
  return cf_file_fill(path, fill, &(job){mesh, stamp});
}
