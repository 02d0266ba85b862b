/* SPDX-License-Identifier: MIT
 *
 * Lettering drawn as strokes: an alphabet of our own (Latin, Greek, signs), so that pictures come out the
 * same on every machine and need no fonts.
 *
 * Text is UTF-8. m^2, 10^-3 and x^{ab} raise what follows; H_c and T_{max} lower it, if a single letter
 * stands before and it is short, so that names_with_underscores stay as they are. Accents of Latin letters
 * are drawn. What the alphabet does not have is a small box.
 */
#ifndef CF_RENDER_TEXT_H
#define CF_RENDER_TEXT_H

#include "render/canvas.h"

typedef struct cf_lettering {
  double size; /* pixels from descender to ascender, about: 14 is a good label */
  cf_colour colour;
  double weight; /* stroke width over the usual one; 0: 1 */
  double align;  /* 0: starts at the point, 0.5: centred, 1: ends there */
  int upward;    /* 1: reads from bottom to top */
  int outline;   /* 1: a rim around the letters, light or dark as suits, for text on a picture */
} cf_lettering;

/* The baseline starts (or is centred, or ends) at (x, y). CF_NO_MEMORY. */
cf_status cf_text_draw(cf_canvas *c, const cf_lettering *l, double x, double y, const char *text);

/* Pixels that the text advances. */
double cf_text_width(double size, const char *text);

/* Pixels from the baseline to the top of a capital. */
double cf_text_height(double size);

#endif
