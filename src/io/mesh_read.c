/* SPDX-License-Identifier: MIT */
#define _GNU_SOURCE
#include <inttypes.h>
#include <math.h>
#include <string.h>
#include <strings.h>

#include "base/mem.h"
#include "io/folder.h"
#include "io/mesh_build.h"

#define MOST_BYTES ((size_t)1 << 32)

void cf_mesh_build_vertex(cf_mesh_build *b, const double place[3]) {
  if (b->filling)
    for (int a = 0; a < 3; ++a) b->mesh->place[b->vertices][a] = (cf_real)place[a];
  ++b->vertices;
}

void cf_mesh_build_polygon(cf_mesh_build *b) { b->corners = 0; }

void cf_mesh_build_corner(cf_mesh_build *b, const int64_t vertex) {
  if (b->corners == 0) b->first = vertex;
  if (b->corners >= 2) {
    int32_t *corner = b->filling ? b->mesh->corner[b->triangles] : NULL;
    if (corner != NULL)
      corner[0] = (int32_t)b->first, corner[1] = (int32_t)b->latest, corner[2] = (int32_t)vertex;
    ++b->triangles;
  }
  b->latest = vertex;
  ++b->corners;
}

cf_status cf_mesh_build_check(const cf_mesh *m, const char *path) {
  for (int64_t v = 0; v < m->vertices; ++v)
    for (int a = 0; a < 3; ++a)
      if (!isfinite(m->place[v][a]))
        return cf_fail(CF_BAD_FILE, "%s: vertex %" PRId64 " is at no place: %c is %g", path, v, "xyz"[a],
                       (double)m -> place[v][a]);
  if (m->triangles == 0) return cf_fail(CF_BAD_FILE, "%s: has no faces", path);
  return CF_OK;
}

static cf_status read_text(cf_mesh *mesh, const char *path, char *text, const size_t size) {
  const char *dot = strrchr(path, '.');
  if (dot != NULL && strcasecmp(dot, ".ply") == 0) return cf_ply_read(mesh, path, text, size);
  if (dot != NULL && strcasecmp(dot, ".obj") == 0) return cf_obj_read(mesh, path, text, size);
  return cf_fail(CF_BAD_FILE, "%s: a mesh is a file .ply or .obj", path);
}

cf_status cf_mesh_read(cf_mesh *mesh, const char *path) {
  char *text;
  size_t size;
  CF_TRY(cf_mesh_resize(mesh, 0, 0, false));
  CF_TRY(cf_file_read(path, MOST_BYTES, &text, &size));
  cf_status s = read_text(mesh, path, text, size);
  cf_free(text);
  if (s == CF_OK) s = cf_mesh_build_check(mesh, path);
  if (s == CF_OK && mesh->normal == NULL) s = cf_mesh_make_normals(mesh);
  if (s != CF_OK) (void)cf_mesh_resize(mesh, 0, 0, false);
  return s;
}
