/* SPDX-License-Identifier: MIT
 *
 * Surfaces of triangles in files that other programs make and read.
 *
 *   PLY  written in binary: x, y, z, normals, then every attribute as a property of the vertices, with its unit in a
 *        comment. Read in ASCII and in binary of either byte order; polygons become fans of triangles, elements that
 *        are neither vertices nor faces are passed over, further scalar properties of vertices become attributes.
 *   OBJ  read: v and f lines (also a/b/c and negative numbers); all else is passed over.
 */
#ifndef CF_IO_MESH_H
#define CF_IO_MESH_H

#include "grid/mesh.h"
#include "io/stamp.h"

/* Reads a file into the mesh, whose kind its name tells (.ply, .obj, in any case). Normals that it does not have are
 * made. CF_BAD_FILE with path, line or element, and what is wrong there: the mesh is empty then. CF_OVER_LIMIT,
 * CF_NO_MEMORY. */
cf_status cf_mesh_read(cf_mesh *mesh, const char *path);

/* Writes a PLY file, whole or not at all. CF_CANNOT_WRITE. */
cf_status cf_ply_write(const char *path, const cf_mesh *mesh, const cf_stamp *stamp);

#endif
