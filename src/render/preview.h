/* SPDX-License-Identifier: MIT
 *
 * A picture of one cell field: the field in colours, axes in metres, a colour bar with round numbers, title,
 * time, and lines drawn over it. In 3D a slice through the middle, or the mean along an axis.
 *
 * The range of the colours: low..high where low < high; otherwise it is taken from what is shown. Then it ends at the
 * 0.5 % and 99.5 % quantiles (a few hot cells do not darken all the rest; the colour bar ends in points where values
 * lie beyond), and
 *     values of both signs, each beyond 5 % of the other: -m..m with the larger bound m, and the map `balance`
 *     otherwise: min..max, from or to 0 if min < max / 2 (if max > min / 2 below 0), and the map `ember`
 * The middle of a signed map is 0 also where low and high are given and differ.
 * For a movie give low and high, else the colours change their meaning from frame to frame.
 */
#ifndef CF_RENDER_PREVIEW_H
#define CF_RENDER_PREVIEW_H

#include <stdbool.h>

#include "grid/grid.h"
#include "render/canvas.h"

/* A line over the picture, in the coordinates of its two axes (m). */
typedef struct cf_polyline {
  int count;
  const double (*at)[2];
  cf_colour colour;
  double width;      /* pixels; 0: 1.5 */
  double dash;       /* pixels; 0: a whole line */
  const char *label; /* written near its last visible point; NULL: none */
} cf_polyline;

typedef enum cf_preview_view { CF_VIEW_SLICE, CF_VIEW_MEAN } cf_preview_view;

typedef struct cf_preview {
  const char *title; /* NULL: none */
  const char *field; /* name of what is shown */
  const char *unit;  /* "" or NULL: none */
  double time;       /* s; NaN: not shown */
  const char *map;   /* NULL: by the rule above */
  double low, high;
  int size;     /* pixels of the longer side; 0: 900 */
  int frame[2]; /* width and height of the picture, with the plot in its middle; 0: what the plot takes */
  bool cells;   /* show every cell as a square; else smooth in between */
  cf_preview_view view; /* 3D only */
  int axis;             /* 3D only: the axis looked along, 0..2; 3: none given, z */
  int lines;
  const cf_polyline *line;
  int contours;             /* lines of equal value, so many between the ends of the range; 0: none */
  const cf_real *solid;     /* above 1/2 there is nothing to show but a body: shown in grey; NULL: nowhere */
  const cf_real *arrows[2]; /* 2D only: a vector field, its parts along x and y; NULL: none */
} cf_preview;

/* Nothing shown but the field. */
cf_preview cf_preview_default(const char *field, const char *unit);

/* Draws the field f (shaped by g->box) on a fresh canvas, the caller's to destroy. CF_BAD_ARGUMENT: no such
 * map; CF_NO_MEMORY. */
cf_status cf_preview_draw(cf_canvas *c, const cf_grid *g, const cf_real *f, const cf_preview *p);

/* The range and map that the rule above gives for fields that are to be compared. */
typedef struct cf_scale {
  double low, high;
  int map;           /* a cf_colormap */
  bool below, above; /* there are values beyond */
} cf_scale;
cf_status cf_preview_scale(cf_scale *s, int fields, const cf_grid *const *g, const cf_real *const *f,
                           const cf_preview *p);

/* --- several in one picture -------------------------------------------------------------------------- */

typedef struct cf_panel {
  const cf_grid *grid;
  const cf_real *f;
  const char *caption;
  int lines; /* drawn over this panel */
  const cf_polyline *line;
} cf_panel;

/* Panels in rows of `columns`, all in one scale with one colour bar. p->size is the width of the whole (0:
 * 1200); lines of p are drawn over every panel. */
cf_status cf_sheet_draw(cf_canvas *c, int panels, const cf_panel *panel, int columns, const cf_preview *p);

/* Finished pictures in rows of `columns`, each with a caption, scaled down to fit `width` pixels in all. */
cf_status cf_sheet_pictures(cf_canvas *c, int pictures, const cf_canvas *const *picture,
                            const char *const *captions, int columns, int width);

#endif
