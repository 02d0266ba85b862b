/* SPDX-License-Identifier: MIT
 *
 * Flakes: many small flat pictures in space, in front of a film that has been exposed already.
 *
 * A flake is a parallelogram with a texture of cover, brightness and slope. What the lens and the shutter do to it is
 * found for each flake by itself, at places the farther apart the softer it is: it is drawn as the mean of copies along
 * its way while the shutter is open, and the lens makes a disc of each place (disc.h). So there is no noise in soft
 * flakes, and the cost follows the pixels that are touched. Flakes are then laid over each other from the far to
 * the near, each as a whole: within the blur of two flakes that cross, which is in front is decided by their centres.
 *
 * Light: ice scatters a little of every light to all sides, and mirrors like a plate: where the half-way direction between
 * eye and light meets the normal (tilted by the texture's slope) it glints.
 *
 * The picture is worked on in tiles, each with its flakes in the same order: the same bits for any number of threads.
 */
#ifndef CF_RENDER_CARDS_H
#define CF_RENDER_CARDS_H

#include <stdint.h>

#include "render/camera.h"
#include "render/film.h"
#include "render/light.h"

/* A square texture with its coarser copies: 4 numbers a texel (cover, brightness times cover, slope in x and y times cover). */
typedef struct cf_flake_picture {
  int side, levels; /* side is a power of two */
  float *texel;
  size_t start[16]; /* of the levels, in texels */
} cf_flake_picture;

/* From side*side values each, rows from the top: cover and brightness 0 to 1, slopes. Any side from 1 to 8192; it is
 * brought to the next smaller power of two. CF_BAD_ARGUMENT, CF_NO_MEMORY. */
cf_status cf_flake_picture_create(cf_flake_picture *p, int side, const float *cover, const float *bright,
                                  const float (*slope)[2]);
void cf_flake_picture_destroy(cf_flake_picture *p); /* a zeroed one is fine */

typedef struct cf_card {
  cf_vec at;        /* middle, m */
  cf_vec right, up; /* from the middle to the edges of the texture, m */
  cf_vec velocity;  /* m/s */
  int picture;
} cf_card;

typedef struct cf_cards {
  int pictures;
  const cf_flake_picture *picture;
  int64_t count;
  const cf_card *card;
} cf_cards;

typedef struct cf_cards_light {
  int lights;
  const cf_light *light;
  cf_sky sky;
  cf_vec tint;        /* of the ice */
  float glint;        /* strength of reflections, 1 */
  cf_vec haze;        /* what is far fades by these parts of a metre, */
  cf_vec haze_colour; /* to this */
} cf_cards_light;

/* Draws the cards over the film, in front of what is farther than they are. shutter: s. CF_BAD_ARGUMENT: a picture
 * that is not there, a camera that makes no sense; CF_NO_MEMORY. */
cf_status cf_cards_draw(const cf_cards *c, const cf_cards_light *light, const cf_camera *camera,
                        double shutter, int threads, cf_film *film);

#endif
