/* SPDX-License-Identifier: MIT
 *
 * How a preview is laid out. All distances follow the size of the letters, and that follows the size of the picture.
 */
#include "render/preview.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "base/mem.h"
#include "base/real.h"
#include "render/plot.h"

#define SIZE_USUAL 900
#define SIZE_LEAST 160
#define SIZE_MOST  16384
#define BAR_LEAST  6.0 /* of the size of the letters */

cf_preview cf_preview_default(const char *field, const char *unit) {
  return (cf_preview){.field = field, .unit = unit, .time = NAN, .axis = 3};
}

cf_status cf_preview_scale(cf_scale *s, const int fields, const cf_grid *const *g, const cf_real *const *f,
                           const cf_preview *p) {
  cf_plane *planes;
  cf_status status = CF_OK;
  CF_TRY(CF_NEW(&planes, fields));
  for (int i = 0; i < fields && status == CF_OK; ++i) status = cf_plane_create(&planes[i], g[i], f[i], p);
  if (status == CF_OK) status = cf_plane_scale(s, fields, planes, p);
  for (int i = 0; i < fields; ++i) cf_plane_destroy(&planes[i]);
  cf_free(planes);
  return status;
}

typedef struct layout {
  int width, height;
  double font;
  cf_plot plot;
  int bar[4];
  double title_line, caption_line, room; /* baselines; pixels for text across */
} layout;

static int even(const double v) { return 2 * (int)ceil(v / 2); } /* films want even sides */

/* Margins first, then the largest plot that fits, then the picture around it. */
static layout lay_out(const cf_plane *plane, const cf_scale *scale, const cf_preview *p) {
  layout l = {.width = 0};
  const bool framed = p->frame[0] > 0 && p->frame[1] > 0;
  const int wanted = framed ? CF_MAX(p->frame[0], p->frame[1]) : p->size > 0 ? p->size : SIZE_USUAL;
  const int size = CF_MIN(CF_MAX(wanted, SIZE_LEAST), SIZE_MOST);
  const int wide = framed ? p->frame[0] : size, high = framed ? p->frame[1] : size;
  l.font = CF_MAX(round(size / 64.0), 11);
  l.plot = (cf_plot){.width = size, .height = size, .font = l.font, .plane = plane};
  const bool titled = p->title != NULL && p->title[0] != '\0';
  const double left = cf_plot_left_room(&l.plot);
  const bool thin = plane->n[1] < 0.15 * plane->n[0]; /* the last number of the axis would reach the bar */
  const double beside = (thin ? 2.8 : 1.2) * l.font;
  const double right = beside + cf_plot_bar_room(l.font, scale, size) + 0.8 * l.font;
  const double top = (titled ? 2.2 : 0.2) * l.font + 2.6 * l.font, bottom = 4.0 * l.font;
  double pixels = CF_MIN((wide - left - right) / plane->n[0], (high - top - bottom) / plane->n[1]);
  if (p->cells && pixels > 1) pixels = floor(pixels);
  l.plot.width = CF_MAX((int)(pixels * plane->n[0]), 2);
  l.plot.height = CF_MAX((int)(pixels * plane->n[1]), 2);
  l.width = CF_MIN(even(CF_MAX(l.plot.width + left + right, 0.4 * size)), even(size));
  const double band = CF_MAX(l.plot.height, BAR_LEAST * l.font); /* a thin plot lies in the middle of it */
  l.height = CF_MAX(CF_MIN(even(l.plot.height + top + bottom), even(size)), even(band + top + bottom));
  const double down = framed ? CF_MAX(high - l.height, 0) / 2 : 0;
  if (framed) l.width = wide, l.height = high;
  l.plot.x = (int)round(left + CF_MAX(l.width - left - right - l.plot.width, 0) / 2);
  l.plot.y = (int)round(down + top + (band - l.plot.height) / 2);
  l.bar[0] = l.plot.x + l.plot.width + (int)round(beside);
  l.bar[1] = (int)round(down + top);
  l.bar[2] = (int)round(1.2 * l.font);
  l.bar[3] = (int)round(band);
  l.title_line = down + 2.1 * l.font;
  l.caption_line = l.bar[1] - 0.9 * l.font;
  l.room = l.width - l.plot.x - 0.8 * l.font;
  return l;
}

static cf_status draw_words(cf_canvas *c, const layout *l, const cf_plane *plane, const cf_preview *p) {
  const cf_lettering title = {.size = round(1.25 * l->font), .colour = cf_plot_text, .weight = 1.3};
  const cf_lettering caption = {.size = l->font, .colour = cf_plot_text};
  const cf_lettering clock = {.size = l->font, .colour = cf_plot_text, .align = 1};
  char text[320];
  if (p->title != NULL && p->title[0] != '\0')
    CF_TRY(cf_plot_fitted(c, &title, l->plot.x - 1, l->title_line, l->room, p->title));
  char when[64];
  cf_plot_caption(plane, p, text, sizeof text);
  cf_plot_time(p->time, when, sizeof when);
  const double taken = cf_text_width(l->font, when) + l->font;
  if (cf_text_width(l->font, text) + taken <= l->plot.width) {
    CF_TRY(cf_text_draw(c, &clock, l->plot.x + l->plot.width, l->caption_line, when));
  } else if (when[0] != '\0') { /* one after the other */
    const size_t length = strlen(text);
    snprintf(text + length, sizeof text - length, ", %s", when);
  }
  return cf_plot_fitted(c, &caption, l->plot.x - 1, l->caption_line, l->room, text);
}

static cf_status draw_arrows(cf_canvas *c, const layout *l, const cf_grid *g, const cf_preview *p) {
  cf_plane part[2] = {{.at = NULL}, {.at = NULL}};
  cf_status s = cf_plane_create(&part[0], g, p->arrows[0], p);
  if (s == CF_OK) s = cf_plane_create(&part[1], g, p->arrows[1], p);
  if (s == CF_OK) s = cf_plot_arrows(c, &l->plot, part);
  cf_plane_destroy(&part[1]);
  cf_plane_destroy(&part[0]);
  return s;
}

static cf_status draw_all(cf_canvas *c, const layout *l, const cf_grid *g, const cf_scale *scale,
                          const cf_preview *p) {
  CF_TRY(cf_plot_field(c, &l->plot, scale, p->cells));
  if (p->contours > 0) CF_TRY(cf_plot_contours(c, &l->plot, scale, p->contours));
  if (p->arrows[0] != NULL && p->arrows[1] != NULL && g->box.dim == 2) CF_TRY(draw_arrows(c, l, g, p));
  CF_TRY(cf_plot_solid(c, &l->plot));
  CF_TRY(cf_plot_lines(c, &l->plot, p->lines, p->line));
  CF_TRY(cf_plot_axes(c, &l->plot, true, true));
  CF_TRY(cf_plot_bar(c, l->bar, l->font, scale));
  return draw_words(c, l, l->plot.plane, p);
}

static cf_status draw_plane(cf_canvas *c, const cf_grid *g, const cf_plane *plane, const cf_preview *p) {
  cf_scale scale;
  CF_TRY(cf_plane_scale(&scale, 1, plane, p));
  const layout l = lay_out(plane, &scale, p);
  CF_TRY(cf_canvas_create(c, l.width, l.height, cf_plot_ground));
  const cf_status s = draw_all(c, &l, g, &scale, p);
  if (s != CF_OK) cf_canvas_destroy(c);
  return s;
}

cf_status cf_preview_draw(cf_canvas *c, const cf_grid *g, const cf_real *f, const cf_preview *p) {
  cf_plane plane;
  *c = (cf_canvas){.rgb = NULL};
  CF_TRY(cf_plane_create(&plane, g, f, p));
  const cf_status s = draw_plane(c, g, &plane, p);
  cf_plane_destroy(&plane);
  return s;
}
