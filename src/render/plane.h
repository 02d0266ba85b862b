/* SPDX-License-Identifier: MIT
 *
 * What of a field is shown: a plane of values. In 2D the field itself; in 3D the slice through the middle (between two
 * cells: their mean), or the mean along an axis. And the plane at the size of a picture.
 */
#ifndef CF_RENDER_PLANE_H
#define CF_RENDER_PLANE_H

#include "render/colormap.h"
#include "render/preview.h"

typedef struct cf_plane {
  int n[2];         /* cells across and up */
  int axis[2];      /* which axes of the grid these are */
  int along;        /* the axis looked along, -1 in 2D */
  double h, low[2]; /* spacing, lower corner */
  double middle;    /* where the slice is */
  double *at;       /* n[1] rows of n[0], from below */
  double
      *solid; /* likewise, the share of a body; NULL: there is none. Values there continue those around it */
} cf_plane;

cf_status cf_plane_create(cf_plane *p, const cf_grid *g, const cf_real *f, const cf_preview *how);
void cf_plane_destroy(cf_plane *p); /* a zeroed one is fine */

/* The plane as width x height values, rows from the top. Larger: smooth in between (a cubic that goes through the cells
 * and not beyond its neighbours), or squares if `cells`. Smaller: means. */
cf_status cf_plane_resample(const cf_plane *p, int width, int height, bool cells, double *values);

/* The range and map for some planes together, by the rule of render/preview.h. */
cf_status cf_plane_scale(cf_scale *s, int planes, const cf_plane *plane, const cf_preview *how);

#endif
