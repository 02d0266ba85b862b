/* SPDX-License-Identifier: MIT
 *
 * A picture in memory, and drawing on it: filled rectangles and antialiased strokes with round ends.
 * Coordinates are in pixels from the top left corner; the centre of the first pixel is (0.5, 0.5).
 */
#ifndef CF_RENDER_CANVAS_H
#define CF_RENDER_CANVAS_H

#include <stdint.h>

#include "base/status.h"

typedef struct cf_colour {
  uint8_t r, g, b; /* sRGB */
} cf_colour;

typedef struct cf_canvas {
  int width, height;
  uint8_t *rgb; /* rows from the top, 3 bytes a pixel */
} cf_canvas;

/* A canvas of one colour. CF_BAD_ARGUMENT: a side below 1 or above 32768; CF_NO_MEMORY. */
cf_status cf_canvas_create(cf_canvas *c, int width, int height, cf_colour ground);
void cf_canvas_destroy(cf_canvas *c); /* a zeroed one is fine */

/* What lies outside of the canvas is cut off. */
void cf_canvas_set(cf_canvas *c, int x, int y, cf_colour colour);
void cf_canvas_fill(cf_canvas *c, int x, int y, int width, int height, cf_colour colour);
void cf_canvas_copy(cf_canvas *c, int x, int y, const cf_canvas *picture);

typedef struct cf_pen {
  cf_colour colour;
  double width;     /* pixels */
  double dash, gap; /* pixels; dash 0: a whole line */
  int clip[4];      /* x, y, width, height; all 0: the canvas */
} cf_pen;

/* A line through `count` points, blended once however often it crosses itself. CF_NO_MEMORY. */
cf_status cf_canvas_stroke(cf_canvas *c, const cf_pen *pen, int count, const double (*at)[2]);

#endif
