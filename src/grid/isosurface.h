/* SPDX-License-Identifier: MIT
 *
 * The surface on which a cell field has a value, in 3D: watertight, without edges of more than two triangles, in the
 * same order and with the same bits for any number of threads.
 */
#ifndef CF_GRID_ISOSURFACE_H
#define CF_GRID_ISOSURFACE_H

#include "grid/mesh.h"

typedef struct cf_isosurface {
  double level;
  bool below; /* inside is where the field is below the level (a signed distance), else where it is above */
  bool caps;  /* close it with a face where inside meets a wall; else it ends at the outermost centres */
  int low[3], high[3]; /* look at cells low <= (i, j, k) < high only; zeroed: at all */
} cf_isosurface;

/* Replaces what the mesh holds, attributes included. Normals are from the field's gradient. Ghosts are not read. A field
 * that is inside or outside everywhere has no surface: the mesh is empty. CF_BAD_ARGUMENT: a grid of 2D, or cells that
 * are not there; CF_OVER_LIMIT: more than INT32_MAX vertices or triangles; CF_NO_MEMORY. */
cf_status cf_isosurface_make(cf_mesh *mesh, const cf_grid *g, cf_cell f, const cf_isosurface *rule);

#endif
