/* SPDX-License-Identifier: MIT
 *
 * The studio: what stands in front of the camera, how it is lit, and taking the picture.
 *
 * A plain struct that is filled in; arrays are the caller's and are only read. A pixel takes rays through lens and
 * shutter until the noise is small, `samples` at most: blocks of pixels take 4, 8, 16 ... each, and stop where the root
 * mean square over the block of sqrt(mean of all) - sqrt(mean of the first half), which is about the error of a half in
 * what the eye sees, is below `noise`. A ray crosses media (medium.h) and haze and meets surfaces (rays.h). A surface of albedo a sends
 *
 *     the lights      a E cos(angle) where nothing is in the way, and a highlight (GGX; Walter et al. 2007)
 *     the sky         a times what one ray, with the cosine's density, finds: sky, or the colour of what is near;
 *                     that is what darkens crevices
 *     what is inside  `through` of light from behind, faded over the way through the body
 *     a reflection    Fresnel's part (Schlick 1994) of what lies there: sky and lights
 *
 * and clear bodies (ice, glass) reflect or refract the ray, which goes on. It does not follow light that several diffuse
 * surfaces hand on, nor caustics.
 *
 * The same bits for any number of threads.
 */
#ifndef CF_RENDER_STUDIO_H
#define CF_RENDER_STUDIO_H

#include <stdint.h>

#include "render/camera.h"
#include "render/film.h"
#include "render/light.h"
#include "render/medium.h"

typedef struct cf_material {
  cf_vec tint;     /* albedo, times the colour of the vertex */
  float gloss;     /* what is reflected at right angles: 0.02 water, 0.04 most things; 0: matt */
  float roughness; /* 0: a mirror, 1: hardly a highlight */
  float through;   /* the part of diffuse light that goes in: 0 stone, 0.5 leaf, 0.8 jelly */
  cf_vec absorb;   /* of light on its way through the body, 1/m */
  float clear;     /* the part that passes without being scattered: 1 ice */
  float index;     /* of refraction, for that part; 0: 1 */
  bool bright;     /* shows its colour as it is, unlit */
} cf_material;

/* Triangles. */
typedef struct cf_solid {
  int64_t vertices, triangles;
  const float (*at)[3];
  const float (*normal)[3]; /* NULL: flat triangles */
  const float (*colour)[3]; /* linear light; NULL: white */
  const uint32_t (*corner)[3];
  cf_material material;
} cf_solid;

typedef struct cf_balls {
  int64_t count;
  const float (*at)[4];     /* x, y, z, radius */
  const float (*moved)[3];  /* while the shutter is open, m; NULL: at rest */
  const float (*colour)[3]; /* NULL: white */
  cf_material material;
} cf_balls;

/* Water or air between: what is far fades towards `colour`. */
typedef struct cf_haze {
  cf_vec fade; /* 1/m */
  cf_vec colour;
} cf_haze;

#define CF_STUDIO_SOLIDS 8
#define CF_STUDIO_BALLS  4
#define CF_STUDIO_MEDIA  3 /* only one of them may scatter */

typedef struct cf_studio {
  int width, height, threads;
  int samples; /* of a pixel, at most */
  float noise; /* of sqrt(light); a block of pixels that has less takes no more samples; 0: all take all */
  uint64_t seed;
  cf_camera camera;
  int lights;
  cf_light light[CF_LIGHTS];
  cf_sky sky;
  cf_backdrop backdrop;
  cf_haze haze;
  float bounce; /* what surfaces near each other hand on: 0 none, 1 all */
  int solids, balls, media;
  cf_solid solid[CF_STUDIO_SOLIDS];
  cf_balls ball[CF_STUDIO_BALLS];
  cf_medium *medium[CF_STUDIO_MEDIA];
} cf_studio;

/* Onto a fresh film, the caller's to destroy. CF_BAD_ARGUMENT: size, samples, camera, mesh; CF_NO_MEMORY. */
cf_status cf_studio_expose(const cf_studio *s, cf_film *f);

#endif
