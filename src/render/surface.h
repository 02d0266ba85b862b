/* SPDX-License-Identifier: MIT
 *
 * What a surface does with light; the parts of studio.h that happen at a point.
 */
#ifndef CF_RENDER_SURFACE_H
#define CF_RENDER_SURFACE_H

#include "render/rays.h"
#include "render/sample.h"
#include "render/studio.h"

/* A mesh or balls, by the number that Embree knows. */
typedef struct cf_thing {
  const cf_solid *solid;
  const cf_balls *balls;
  const cf_material *material;
} cf_thing;

typedef struct cf_stage {
  const cf_studio *studio;
  cf_rays *rays;
  cf_thing thing[CF_STUDIO_SOLIDS + CF_STUDIO_BALLS];
} cf_stage;

/* Where a ray has met a surface. */
typedef struct cf_point {
  cf_vec at, flat, normal; /* of the triangle, and as it should look; both towards the viewer */
  cf_vec colour;
  const cf_material *material;
  bool leaving; /* the ray comes from inside */
  float skin;   /* rays that go on start so far from the surface, m */
} cf_point;

void cf_surface_meet(const cf_stage *s, const cf_ray *ray, const cf_hit *hit, cf_point *p);

/* What comes from a direction in which nothing is: the sky, and, with `lamps`, the lights as large as they are. */
cf_vec cf_surface_around(const cf_stage *s, cf_vec along, bool lamps);

/* The part of light that is reflected where it comes in under an angle of this cosine. */
float cf_surface_mirror(const cf_point *p, float cosine);

/* What the point sends back along the ray. */
cf_vec cf_surface_light(const cf_stage *s, const cf_ray *ray, const cf_point *p, cf_dice *dice);

#endif
