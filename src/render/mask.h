/* SPDX-License-Identifier: MIT
 *
 * How much of each pixel is covered, collected from many strokes and blended once: where strokes of a letter or line
 * meet nothing gets darker. Coverage comes from the distance to the stroke's axis, which gives even, round-ended lines.
 */
#ifndef CF_RENDER_MASK_H
#define CF_RENDER_MASK_H

#include "render/canvas.h"

typedef struct cf_mask {
  int x, y, width, height; /* on the canvas */
  float *cover;            /* 0 to 1 */
} cf_mask;

/* An empty mask over the part of the box (x0, y0, x1, y1; pixels) that lies on the canvas. CF_NO_MEMORY. */
cf_status cf_mask_create(cf_mask *m, const cf_canvas *c, const double box[4]);
void cf_mask_destroy(cf_mask *m);

/* A straight stroke of this width from a to b. */
void cf_mask_stroke(cf_mask *m, const double a[2], const double b[2], double width);

void cf_mask_blend(const cf_mask *m, cf_canvas *c, cf_colour colour);

#endif
