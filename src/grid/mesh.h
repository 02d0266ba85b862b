/* SPDX-License-Identifier: MIT
 *
 * Surfaces of triangles: made from a field (grid/isosurface.h) or read from a file, with numbers at the vertices, and
 * turned into signed distances.
 *
 *     cf_mesh *mesh;
 *     cf_mesh_create(&mesh);
 *     cf_isosurface_make(mesh, &grid, phi, &(cf_isosurface){.level = 0.5, .caps = true});
 *     cf_mesh_sample(mesh, &grid, T, "T", "K");
 *     cf_mesh_destroy(mesh);
 */
#ifndef CF_GRID_MESH_H
#define CF_GRID_MESH_H

#include <stdint.h>

#include "grid/field.h"
#include "grid/grid.h"
#include "grid/shape.h"

#define CF_MESH_ATTRIBUTES 12

typedef struct cf_mesh_attribute {
  char name[CF_NAME_MAX], unit[CF_NAME_MAX];
  cf_real *at; /* one value a vertex */
} cf_mesh_attribute;

typedef struct cf_mesh {
  int64_t vertices, triangles; /* at most INT32_MAX each */
  cf_real (*place)[3];         /* of a vertex, m */
  cf_real (*normal)[3];        /* outwards, of length 1 (0 where there is none); NULL: none are known */
  int32_t (*corner)[3];        /* of a triangle, anticlockwise seen from outside */
  int attributes;
  cf_mesh_attribute attribute[CF_MESH_ATTRIBUTES];
} cf_mesh;

/* An empty one. */
cf_status cf_mesh_create(cf_mesh **mesh);
void cf_mesh_destroy(cf_mesh *mesh); /* NULL is fine */

/* Makes it so large, with or without normals, everything zero; what it held is gone. CF_OVER_LIMIT, CF_NO_MEMORY: it
 * is empty then. */
cf_status cf_mesh_resize(cf_mesh *mesh, int64_t vertices, int64_t triangles, bool normals);

/* Adds an attribute, zero; *at (NULL is fine) is its values. CF_BAD_ARGUMENT: the name is taken, empty or too long;
 * CF_OVER_LIMIT, CF_NO_MEMORY. */
cf_status cf_mesh_attribute_add(cf_mesh *mesh, const char *name, const char *unit, cf_real **at);

/* Adds an attribute with the values of a cell field at the vertices, linear between centres, constant beyond. Ghosts
 * are not read. */
cf_status cf_mesh_sample(cf_mesh *mesh, const cf_grid *g, cf_cell f, const char *name, const char *unit);

/* Normals as means of the triangles around each vertex, weighted with their angles there. CF_NO_MEMORY. */
cf_status cf_mesh_make_normals(cf_mesh *mesh);

/* --- what a mesh is --------------------------------------------------------------------------------------- */

typedef struct cf_mesh_facts {
  int64_t open_edges;    /* with one triangle */
  int64_t crowded_edges; /* with more than two */
  int64_t turned_edges;  /* whose two triangles disagree about outside */
  int64_t degenerate;    /* triangles with two equal corners */
  int64_t euler;         /* used vertices - edges + triangles: 2 for a sphere, 0 for a torus */
  double area, volume;   /* m^2, m^3; the volume means something where the mesh is closed */
  double low[3], high[3];
} cf_mesh_facts;

cf_status cf_mesh_look(const cf_mesh *mesh, cf_mesh_facts *facts); /* CF_NO_MEMORY */

/* Whether it bounds a body. CF_BAD_ARGUMENT: "not closed: 12 open edges". CF_NO_MEMORY. */
cf_status cf_mesh_check_closed(const cf_mesh *mesh);

/* --- a mesh as a shape ------------------------------------------------------------------------------------ */

/* Signed distance, negative inside, at points h apart that cover the mesh and `margin` points more on every side: what
 * cf_shape_sampled takes. Inside is what a ray leaves through an odd number of triangles, by the majority of rays along
 * x, y and z, so small holes do no harm. Exact next to the surface, elsewhere to a fraction of h. CF_BAD_ARGUMENT: no
 * triangles, or not finite; CF_OVER_LIMIT: more than 2^31 points; CF_NO_MEMORY. *samples: cf_samples_destroy. */
cf_status cf_mesh_distance(const cf_mesh *mesh, double h, int margin, cf_samples *samples);

#endif
