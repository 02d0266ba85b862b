/* SPDX-License-Identifier: MIT
 *
 * Lights from far away, the sky around everything, and what stands behind.
 */
#ifndef CF_RENDER_LIGHT_H
#define CF_RENDER_LIGHT_H

#include "render/vec.h"

#define CF_LIGHTS 4

/* A white surface that faces the light is as bright as `colour`. */
typedef struct cf_light {
  cf_vec toward; /* unit */
  cf_vec colour;
  float spread; /* half-angle that it fills, radians: 0.005 sun, 0.3 soft box */
} cf_light;

/* Light from everywhere: above, level, below. */
typedef struct cf_sky {
  cf_vec zenith, horizon, ground;
} cf_sky;

/* What is seen where nothing is: `middle` at a point of the picture, `edge` at `reach` heights from it. */
typedef struct cf_backdrop {
  cf_vec middle, edge;
  float at[2], reach; /* parts of width and height from the top left corner; of the height */
} cf_backdrop;

static inline cf_vec cf_sky_from(const cf_sky *s, const cf_vec along) {
  const float up = along.z;
  return up >= 0 ? cf_vec_mix(s->horizon, s->zenith, sqrtf(up))
                 : cf_vec_mix(s->horizon, s->ground, sqrtf(-up));
}

static inline cf_vec cf_backdrop_at(const cf_backdrop *b, const float x, const float y, const float aspect) {
  const float dx = (x - b->at[0]) * aspect, dy = y - b->at[1], reach = b->reach > 0 ? b->reach : 1;
  return cf_vec_mix(b->middle, b->edge, cf_smooth_step(0, 1, sqrtf(dx * dx + dy * dy) / reach));
}

/* From degrees: turn (0: from -y, 90: from +x) and rise above the horizon. */
static inline cf_vec cf_light_toward(const double turn, const double rise) {
  const double radian = acos(-1.0) / 180, a = turn * radian, b = rise * radian;
  return (cf_vec){(float)(sin(a) * cos(b)), (float)(-cos(a) * cos(b)), (float)sin(b)};
}

#endif
