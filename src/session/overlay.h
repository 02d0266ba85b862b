/* SPDX-License-Identifier: MIT
 *
 * What theory predicts, as lines over a picture: behind a source in a stream faster than the front speed c,
 * diffusion stays inside a cone of half-angle asin(1/H_c), H_c = |u|/c (section 5). After a time t the cone
 * reaches as far as the tangents to the youngest circle, sqrt(u^2 - c^2) t along its edge.
 */
#ifndef CF_SESSION_OVERLAY_H
#define CF_SESSION_OVERLAY_H

#include "grid/grid.h"
#include "model/scene.h"
#include "render/preview.h"

#define CF_OVERLAY_MAX 16

typedef struct cf_overlay {
  int count;
  cf_polyline line[CF_OVERLAY_MAX];
  double at[CF_OVERLAY_MAX][2][2];
  char label[CF_OVERLAY_MAX][48];
} cf_overlay;

/* The cones of the sources of scalar `field` in a plane scene with a steady flow, at time t; none where H_c <= 1.
 * The overlay is not to be moved: its lines point into it. */
void cf_overlay_cones(const cf_scene *scene, const cf_grid *g, double t, const char *field,
                      cf_overlay *overlay);

#endif
