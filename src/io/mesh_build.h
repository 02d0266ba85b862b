/* SPDX-License-Identifier: MIT
 *
 * What the readers of meshes share. A file is gone through twice: once to count, once to fill.
 */
#ifndef CF_IO_MESH_BUILD_H
#define CF_IO_MESH_BUILD_H

#include "io/mesh.h"

typedef struct cf_mesh_build {
  cf_mesh *mesh;
  bool filling;
  int64_t vertices, triangles; /* so far in this pass */
  int64_t corners;             /* of the polygon at hand */
  int64_t first, latest;       /* of its vertices */
} cf_mesh_build;

/* The whole file, zero-terminated, is at `text`. Errors name `path`. */
cf_status cf_ply_read(cf_mesh *mesh, const char *path, char *text, size_t size);
cf_status cf_obj_read(cf_mesh *mesh, const char *path, char *text, size_t size);

void cf_mesh_build_vertex(cf_mesh_build *b, const double place[3]);

/* A polygon, corner by corner; from the third on each makes a triangle with the first and the one before. */
void cf_mesh_build_polygon(cf_mesh_build *b);
void cf_mesh_build_corner(cf_mesh_build *b, int64_t vertex);

/* Whether the vertices are places and the triangles have vertices that are there. CF_BAD_FILE. */
cf_status cf_mesh_build_check(const cf_mesh *mesh, const char *path);

#endif
