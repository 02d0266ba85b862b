/* SPDX-License-Identifier: MIT
 *
 * A camera with a thin lens. Pixels count from the top left corner as on a canvas.
 *
 * A point at distance z along the axis, with the sharp plane at distance f and a lens of diameter A, becomes a disc
 * of the diameter A |z - f|/z in that plane (the circle of confusion).
 */
#ifndef CF_RENDER_CAMERA_H
#define CF_RENDER_CAMERA_H

#include <stdbool.h>

#include "base/status.h"
#include "render/vec.h"

typedef struct cf_camera {
  double eye[3], aim[3]; /* m */
  double up[3];          /* all 0: z */
  double angle;          /* of view from the lower to the upper edge, degrees; 0: parallel rays */
  double span;           /* parallel rays: what the picture's height covers, m */
  double focus;          /* distance of the sharp plane, m; 0: that of `aim` */
  double aperture;       /* diameter of the lens, m; 0: everything is sharp */
} cf_camera;

/* The same for a picture of so many pixels, ready for use. */
typedef struct cf_lens {
  int width, height;
  bool parallel;
  cf_vec eye, right, up, forward;
  float pixel; /* width of a pixel: in the plane at distance 1, or (parallel) in m */
  float focus, radius;
} cf_lens;

typedef struct cf_ray {
  cf_vec from, along; /* unit */
  float time;         /* of the shutter, 0 to 1 */
} cf_ray;

/* CF_BAD_ARGUMENT: eye and aim coincide, `up` points along the view, an angle or length that makes no sense. */
cf_status cf_lens_grind(cf_lens *l, const cf_camera *c, int width, int height);

/* The ray through (x, y), pixels, that leaves the lens at `disc` (in the unit disc). */
cf_ray cf_lens_ray(const cf_lens *l, float x, float y, const float disc[2]);

/* Where a place is seen: pixels, and its distance along the axis (<= 0: behind the camera, x and y are not set). */
float cf_lens_project(const cf_lens *l, cf_vec at, float *x, float *y);

/* Pixels that a metre covers at a distance. */
float cf_lens_scale(const cf_lens *l, float distance);

/* Radius of the circle of confusion in pixels. */
float cf_lens_blur(const cf_lens *l, float distance);

/* Whether a ray through pixels x0 <= x <= x1, y0 <= y <= y1 may meet the box; false is sure. */
bool cf_lens_reaches(const cf_lens *l, const float pixels[4], cf_vec low, cf_vec high);

/* A camera that looks at the box low..high so that all of it is in the picture. `turn` (0: from -y; 90: from +x)
 * and `rise` above the horizon in degrees; `aspect` is width over height. */
cf_camera cf_camera_around(const double low[3], const double high[3], double turn, double rise, double angle,
                           double aspect);

#endif
