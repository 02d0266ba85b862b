/* SPDX-License-Identifier: MIT
 *
 * What a ray meets: triangles and balls, found by Embree (Wald et al. 2014), whose trees are built here by one thread,
 * so that they and everything seen through them are always the same.
 *
 * Any number of threads may ask once cf_rays_ready has been called.
 */
#ifndef CF_RENDER_RAYS_H
#define CF_RENDER_RAYS_H

#include <stdint.h>

#include "base/status.h"
#include "render/camera.h"

typedef struct cf_rays cf_rays;

/* CF_NO_MEMORY; CF_FAILED with Embree's reason. */
cf_status cf_rays_create(cf_rays **r);
void cf_rays_destroy(cf_rays *r); /* NULL is fine */

/* The arrays are copied. *object numbers what was added, from 0. Corners beyond the vertices: CF_BAD_ARGUMENT. */
cf_status cf_rays_add_mesh(cf_rays *r, int64_t vertices, const float (*at)[3], int64_t triangles,
                           const uint32_t (*corner)[3], unsigned *object);

/* Balls (x, y, z, radius); `moved` (NULL: nothing moves) is how far each comes while the shutter is open, m. */
cf_status cf_rays_add_balls(cf_rays *r, int64_t count, const float (*at)[4], const float (*moved)[3],
                            unsigned *object);

cf_status cf_rays_ready(cf_rays *r);

/* The box that all of it is in; false: there is nothing. */
bool cf_rays_bounds(const cf_rays *r, cf_vec *low, cf_vec *high);

typedef struct cf_hit {
  float distance;
  cf_vec normal;         /* across the surface, of no particular length */
  float u, v;            /* weights of the second and third corner */
  unsigned object, part; /* part: the triangle or ball */
} cf_hit;

/* The first thing met between `near` and `far`, m; false: nothing. */
bool cf_rays_hit(const cf_rays *r, const cf_ray *ray, float near, float far, cf_hit *hit);

/* Whether anything lies between. */
bool cf_rays_blocked(const cf_rays *r, const cf_ray *ray, float near, float far);

#endif
