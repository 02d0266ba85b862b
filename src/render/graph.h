/* SPDX-License-Identifier: MIT
 *
 * Curves of numbers over time, as a picture of its own or to be set into another.
 */
#ifndef CF_RENDER_GRAPH_H
#define CF_RENDER_GRAPH_H

#include <stdint.h>

#include "render/canvas.h"

typedef struct cf_curve {
  int64_t count;
  const double *x, *y; /* NaN: a gap */
  cf_colour colour;
  const char *label; /* NULL: none */
} cf_curve;

typedef struct cf_graph {
  const char *title, *x_name; /* NULL: none */
  int curves;
  const cf_curve *curve;
  double now; /* a line and a dot there; NaN: none */
} cf_graph;

/* A colour for the i-th curve, dark enough for paper. */
cf_colour cf_graph_colour(int i);

/* On a fresh canvas. CF_BAD_ARGUMENT: a size too small for numbers; CF_NO_MEMORY. */
cf_status cf_graph_draw(const cf_graph *g, int width, int height, cf_canvas *c);

#endif
