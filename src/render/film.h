/* SPDX-License-Identifier: MIT
 *
 * The film: light in every pixel, linear, without an upper end; and how it is developed into a picture.
 *
 * Exposure multiplies by 2^stops. The tone curve is that of a photographic film, a straight part with a steepness in
 * the middle, a toe and a shoulder,
 *
 *     y = x^g (w^g + m)/(w^g (x^g + m))         g: contrast; w: the light that becomes white; middle grey 0.18 stays
 *
 * (Naka and Rushton's curve, 1966, as in Reinhard and Devlin 2005, here with a white point); g = 1 and w = 1 is the
 * straight line. Light beyond white keeps its hue as long as it can and then pales. Then come the curve of sRGB and a
 * dither of one step, so that soft gradients show no bands.
 */
#ifndef CF_RENDER_FILM_H
#define CF_RENDER_FILM_H

#include <stdbool.h>

#include "render/canvas.h"
#include "render/vec.h"

typedef struct cf_film {
  int width, height;
  cf_vec *light; /* rows from the top */
  float
      *distance; /* of what is seen in a pixel, along the camera's axis, in the mean, m; INFINITY: nothing */
  float *share;  /* of the pixel that it covers */
} cf_film;

cf_status cf_film_create(cf_film *f, int width, int height);
void cf_film_destroy(cf_film *f); /* a zeroed one is fine */

typedef struct cf_develop {
  double exposure; /* stops */
  double contrast; /* g; 0: 1 */
  double white;    /* w; 0: 1 */
  double glow;     /* part of the light that strays around bright places; 0: none */
  double vignette; /* how much darker the corners are, 0 to 1 */
  bool plain;      /* no dither */
} cf_develop;

/* The tone curve itself. */
double cf_film_tone(const cf_develop *how, double x);

/* A fresh canvas with the picture. CF_NO_MEMORY. */
cf_status cf_film_develop(cf_film *f, const cf_develop *how, cf_canvas *c);

/* sRGB to linear light and back. */
cf_vec cf_colour_light(cf_colour c);
float cf_colour_linear(float s);
float cf_colour_encoded(float v);

#endif
