/* SPDX-License-Identifier: MIT
 *
 * The parts that previews and sheets are put together from: the field in its frame, axes, colour bar, lines.
 */
#ifndef CF_RENDER_PLOT_H
#define CF_RENDER_PLOT_H

#include "render/plane.h"
#include "render/text.h"

/* Where a plane lies on the canvas. */
typedef struct cf_plot {
  int x, y, width, height; /* pixels, without the frame */
  double font;             /* size of the labels */
  const cf_plane *plane;
} cf_plot;

extern const cf_colour cf_plot_ground, cf_plot_text, cf_plot_faint;

/* The field in colours and a thin frame around it. */
cf_status cf_plot_field(cf_canvas *c, const cf_plot *plot, const cf_scale *scale, bool cells);

/* Bodies over it, with smooth edges. */
cf_status cf_plot_solid(cf_canvas *c, const cf_plot *plot);

/* Ticks at round places on the lower and left side, with numbers and names where asked for. */
cf_status cf_plot_axes(cf_canvas *c, const cf_plot *plot, bool lower_numbers, bool left_numbers);

/* Pixels that the numbers and the name of the left axis take. */
double cf_plot_left_room(const cf_plot *plot);

cf_status cf_plot_lines(cf_canvas *c, const cf_plot *plot, int lines, const cf_polyline *line);

/* `count` lines of equal value at equal steps between the ends of the scale. */
cf_status cf_plot_contours(cf_canvas *c, const cf_plot *plot, const cf_scale *scale, int count);

/* Arrows on a lattice, the longest as long as the lattice is wide. */
cf_status cf_plot_arrows(cf_canvas *c, const cf_plot *plot, const cf_plane part[2]);

/* A colour bar in the box at (x, y), numbers on its right. */
cf_status cf_plot_bar(cf_canvas *c, const int box[4], double font, const cf_scale *scale);

/* Pixels that the bar and its numbers take, `height` pixels high. */
double cf_plot_bar_room(double font, const cf_scale *scale, int height);

/* Text that is made smaller, and then shorter, until it fits. */
cf_status cf_plot_fitted(cf_canvas *c, const cf_lettering *l, double x, double y, double room,
                         const char *text);

/* A name of a field as a person writes it: phi is the letter. */
const char *cf_plot_name(const char *field);

/* The field's name, unit, and what is shown of it: "φ (kg/m^3), slice at z = 2 m". */
void cf_plot_caption(const cf_plane *plane, const cf_preview *p, char *text, size_t size);

/* "t = 0.5 s"; "" if the time is not to be shown. */
void cf_plot_time(double time, char *text, size_t size);

#endif
