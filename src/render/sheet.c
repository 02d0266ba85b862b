/* SPDX-License-Identifier: MIT
 *
 * Several fields, or several finished pictures, in one.
 */
#include <math.h>
#include <stdio.h>

#include "base/mem.h"
#include "base/real.h"
#include "render/plot.h"

#define WIDTH_USUAL 1200
#define WIDTH_LEAST 240
#define WIDTH_MOST  16384

/* Rows and columns of boxes of one size; the left column and the last row of a sheet of fields have room for numbers. */
typedef struct grid_of_boxes {
  int columns, rows;
  double font, left, top, step_x, step_y;
} grid_of_boxes;

static cf_status check_count(const int count, const int columns) {
  if (count >= 1 && columns >= 1) return CF_OK;
  return cf_fail(CF_BAD_ARGUMENT, "a sheet of %d pictures in %d columns: must be at least one", count,
                 columns);
}

/* --- fields ------------------------------------------------------------------------------------------------------- */

typedef struct sheet {
  int panels;
  const cf_panel *panel;
  const cf_preview *p;
  cf_plane *plane;
  cf_scale scale;
  grid_of_boxes g;
  int box[2];  /* pixels for the field of a panel */
  int size[2]; /* of the picture */
  double bar_room;
} sheet;

/* The tallest panel decides how high a row is. */
static void lay_out(sheet *s, const int columns) {
  const int width = CF_MIN(CF_MAX(s->p->size > 0 ? s->p->size : WIDTH_USUAL, WIDTH_LEAST), WIDTH_MOST);
  grid_of_boxes *g = &s->g;
  g->columns = CF_MIN(columns, s->panels);
  g->rows = (s->panels + g->columns - 1) / g->columns;
  g->font = CF_MAX(round(width / 80.0), 11);
  const cf_plot typical = {
      .width = width / g->columns, .height = width / g->columns, .font = g->font, .plane = s->plane};
  const double gap = 1.8 * g->font;
  const bool titled = s->p->title != NULL && s->p->title[0] != '\0';
  g->left = cf_plot_left_room(&typical);
  g->top = (titled ? 2.2 : 0.2) * g->font + 2.6 * g->font;
  s->bar_room = 1.4 * g->font + cf_plot_bar_room(g->font, &s->scale, width / 2) + 0.8 * g->font;
  s->box[0] = CF_MAX((int)((width - g->left - s->bar_room - gap * (g->columns - 1)) / g->columns), 16);
  double tallest = 0;
  for (int i = 0; i < s->panels; ++i) tallest = CF_MAX(tallest, (double)s->plane[i].n[1] / s->plane[i].n[0]);
  s->box[1] = CF_MAX((int)(s->box[0] * CF_MIN(tallest, 4)), 8);
  g->step_x = s->box[0] + gap;
  g->step_y = s->box[1] + 2.9 * g->font;
  s->size[0] = width;
  s->size[1] = 2 * (int)ceil((g->top + g->step_y * g->rows + 2.4 * g->font) / 2);
}

/* The field of a panel, as large as its box allows, at the box's lower left. */
static cf_plot plot_of(const sheet *s, const int i) {
  const grid_of_boxes *g = &s->g;
  const cf_plane *plane = &s->plane[i];
  const double pixels = CF_MIN((double)s->box[0] / plane->n[0], (double)s->box[1] / plane->n[1]);
  cf_plot plot = {.font = g->font, .plane = plane};
  plot.width = CF_MAX((int)(pixels * plane->n[0]), 2);
  plot.height = CF_MAX((int)(pixels * plane->n[1]), 2);
  plot.x = (int)round(g->left + g->step_x * (i % g->columns));
  plot.y = (int)round(g->top + g->step_y * (i / g->columns) + 1.6 * g->font) + s->box[1] - plot.height;
  return plot;
}

static cf_status draw_panel(cf_canvas *c, const sheet *s, const int i) {
  const cf_plot plot = plot_of(s, i);
  const cf_panel *panel = &s->panel[i];
  const cf_lettering caption = {.size = s->g.font, .colour = cf_plot_text};
  CF_TRY(cf_plot_field(c, &plot, &s->scale, s->p->cells));
  CF_TRY(cf_plot_lines(c, &plot, s->p->lines, s->p->line));
  CF_TRY(cf_plot_lines(c, &plot, panel->lines, panel->line));
  CF_TRY(cf_plot_axes(c, &plot, i + s->g.columns >= s->panels, i % s->g.columns == 0));
  if (panel->caption == NULL) return CF_OK;
  return cf_plot_fitted(c, &caption, plot.x - 1, plot.y - 0.6 * s->g.font, s->box[0], panel->caption);
}

static cf_status draw_words(cf_canvas *c, const sheet *s) {
  const double font = s->g.font, x = s->g.left - 1, end = s->size[0] - s->bar_room;
  const cf_lettering title = {.size = round(1.3 * font), .colour = cf_plot_text, .weight = 1.3};
  const cf_lettering caption = {.size = font, .colour = cf_plot_faint};
  const cf_lettering clock = {.size = font, .colour = cf_plot_faint, .align = 1};
  char text[256];
  if (s->p->title != NULL && s->p->title[0] != '\0')
    CF_TRY(cf_plot_fitted(c, &title, x, 2.1 * font, end - x, s->p->title));
  cf_plot_time(s->p->time, text, sizeof text);
  CF_TRY(cf_text_draw(c, &clock, end, s->g.top - 0.9 * font, text));
  cf_plot_caption(&s->plane[0], s->p, text, sizeof text);
  return cf_plot_fitted(c, &caption, x, s->g.top - 0.9 * font, end - x - 8 * font, text);
}

static cf_status draw_sheet(cf_canvas *c, const sheet *s) {
  const cf_plot first = plot_of(s, 0);
  const double font = s->g.font;
  const int bar[4] = {(int)(s->size[0] - s->bar_room + 1.4 * font), first.y, (int)round(1.2 * font),
                      (int)(s->g.step_y * (s->g.rows - 1)) + first.height};
  for (int i = 0; i < s->panels; ++i) CF_TRY(draw_panel(c, s, i));
  CF_TRY(cf_plot_bar(c, bar, font, &s->scale));
  return draw_words(c, s);
}

static cf_status make_sheet(cf_canvas *c, sheet *s, const int columns) {
  for (int i = 0; i < s->panels; ++i)
    CF_TRY(cf_plane_create(&s->plane[i], s->panel[i].grid, s->panel[i].f, s->p));
  CF_TRY(cf_plane_scale(&s->scale, s->panels, s->plane, s->p));
  lay_out(s, columns);
  CF_TRY(cf_canvas_create(c, s->size[0], s->size[1], cf_plot_ground));
  const cf_status status = draw_sheet(c, s);
  if (status != CF_OK) cf_canvas_destroy(c);
  return status;
}

cf_status cf_sheet_draw(cf_canvas *c, const int panels, const cf_panel *panel, const int columns,
                        const cf_preview *p) {
  sheet s = {.panels = panels, .panel = panel, .p = p};
  *c = (cf_canvas){.rgb = NULL};
  CF_TRY(check_count(panels, columns));
  CF_TRY(CF_NEW(&s.plane, panels));
  const cf_status status = make_sheet(c, &s, columns);
  for (int i = 0; i < panels; ++i) cf_plane_destroy(&s.plane[i]);
  cf_free(s.plane);
  return status;
}

/* --- pictures ------------------------------------------------------------------------------------------------------ */

/* The mean colour of what a pixel covers, in each channel as it is stored. */
static cf_colour covered(const cf_canvas *p, const double x0, const double y0, const double x1,
                         const double y1) {
  double sum[3] = {0}, area = 0;
  for (int y = (int)y0; y < y1 && y < p->height; ++y)
    for (int x = (int)x0; x < x1 && x < p->width; ++x) {
      const double part = (CF_MIN(x1, x + 1.0) - CF_MAX(x0, x)) * (CF_MIN(y1, y + 1.0) - CF_MAX(y0, y));
      const uint8_t *rgb = p->rgb + 3 * ((size_t)y * (size_t)p->width + (size_t)x);
      for (int i = 0; i < 3; ++i) sum[i] += part * rgb[i];
      area += part;
    }
  for (int i = 0; i < 3; ++i) sum[i] = area > 0 ? sum[i] / area : 255;
  return (cf_colour){(uint8_t)lrint(sum[0]), (uint8_t)lrint(sum[1]), (uint8_t)lrint(sum[2])};
}

static void place_picture(cf_canvas *c, const cf_canvas *p, const int x, const int y, const double scale) {
  const int width = (int)(p->width / scale), height = (int)(p->height / scale);
  if (scale <= 1) {
    cf_canvas_copy(c, x, y, p);
    return;
  }
  for (int j = 0; j < height; ++j)
    for (int i = 0; i < width; ++i)
      cf_canvas_set(c, x + i, y + j, covered(p, i * scale, j * scale, (i + 1) * scale, (j + 1) * scale));
}

cf_status cf_sheet_pictures(cf_canvas *c, const int pictures, const cf_canvas *const *picture,
                            const char *const *captions, int columns, const int width) {
  int widest = 1, tallest = 1;
  *c = (cf_canvas){.rgb = NULL};
  CF_TRY(check_count(pictures, columns));
  columns = CF_MIN(columns, pictures);
  for (int i = 0; i < pictures; ++i) {
    widest = CF_MAX(widest, picture[i]->width);
    tallest = CF_MAX(tallest, picture[i]->height);
  }
  const int total = CF_MIN(CF_MAX(width > 0 ? width : WIDTH_USUAL, WIDTH_LEAST), WIDTH_MOST);
  const double font = CF_MAX(round(total / 80.0), 11), gap = font;
  const double scale = CF_MAX(widest / ((total - gap * (columns + 1)) / columns), 1);
  const double step_x = widest / scale + gap, step_y = tallest / scale + 2.2 * font;
  const int rows = (pictures + columns - 1) / columns;
  CF_TRY(cf_canvas_create(c, 2 * (int)ceil((gap + step_x * columns) / 2),
                          2 * (int)ceil((gap + step_y * rows) / 2), cf_plot_ground));
  cf_status s = CF_OK;
  for (int i = 0; i < pictures && s == CF_OK; ++i) {
    const int x = (int)(gap + step_x * (i % columns)), y = (int)(gap + step_y * (i / columns) + 1.4 * font);
    const cf_lettering l = {.size = font, .colour = cf_plot_text};
    place_picture(c, picture[i], x, y, scale);
    if (captions != NULL && captions[i] != NULL)
      s = cf_plot_fitted(c, &l, x, y - 0.5 * font, widest / scale, captions[i]);
  }
  if (s != CF_OK) cf_canvas_destroy(c);
  return s;
}
