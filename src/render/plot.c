/* SPDX-License-Identifier: MIT */
#include "render/plot.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "base/mem.h"
#include "base/real.h"
#include "render/ticks.h"

#define SHADES 1024

const cf_colour cf_plot_ground = {255, 255, 255}, cf_plot_text = {32, 36, 44},
                cf_plot_faint = {104, 110, 122};
static const cf_colour not_a_number = {200, 0, 200}, body = {122, 128, 138};

/* --- colours -------------------------------------------------------------------------------------------------- */

/* Where a value is on its map. The middle of a signed map is 0, whatever the range. */
static double shade(const cf_scale *s, const double value) {
  if (cf_colormap_is_signed((cf_colormap)s->map) && s->low < 0 && s->high > 0)
    return 0.5 + 0.5 * value / CF_MAX(-s->low, s->high);
  return (value - s->low) / (s->high - s->low);
}

static cf_colour pick(const cf_colour *shades, const double s) {
  if (isnan(s)) return not_a_number;
  return shades[(int)lrint(CF_MIN(CF_MAX(s, 0), 1) * (SHADES - 1))];
}

static void frame(cf_canvas *c, const int x, const int y, const int width, const int height) {
  cf_canvas_fill(c, x - 1, y - 1, width + 2, 1, cf_plot_faint);
  cf_canvas_fill(c, x - 1, y + height, width + 2, 1, cf_plot_faint);
  cf_canvas_fill(c, x - 1, y, 1, height, cf_plot_faint);
  cf_canvas_fill(c, x + width, y, 1, height, cf_plot_faint);
}

cf_status cf_plot_field(cf_canvas *c, const cf_plot *plot, const cf_scale *scale, const bool cells) {
  cf_colour shades[SHADES];
  double *values;
  CF_TRY(CF_NEW(&values, (size_t)plot->width * (size_t)plot->height));
  const cf_status s = cf_plane_resample(plot->plane, plot->width, plot->height, cells, values);
  cf_colormap_fill((cf_colormap)scale->map, SHADES, shades);
  for (int j = 0; s == CF_OK && j < plot->height; ++j)
    for (int i = 0; i < plot->width; ++i) {
      const double value = values[(size_t)j * (size_t)plot->width + (size_t)i];
      cf_canvas_set(c, plot->x + i, plot->y + j, pick(shades, shade(scale, value)));
    }
  cf_free(values);
  frame(c, plot->x, plot->y, plot->width, plot->height);
  return s;
}

static unsigned char mix(const unsigned char under, const unsigned char over, const double share) {
  return (unsigned char)lrint(under + share * (over - under));
}

cf_status cf_plot_solid(cf_canvas *c, const cf_plot *plot) {
  const size_t pixels = (size_t)plot->width * (size_t)plot->height;
  double *values;
  if (plot->plane->solid == NULL) return CF_OK;
  cf_plane bodies = *plot->plane;
  bodies.at = bodies.solid;
  CF_TRY(CF_NEW(&values, pixels));
  const cf_status s = cf_plane_resample(&bodies, plot->width, plot->height, false, values);
  const double steep = CF_MAX(1, (double)plot->width / bodies.n[0]); /* the edge is about a pixel wide */
  for (size_t i = 0; s == CF_OK && i < pixels; ++i) {
    const double share = CF_MIN(CF_MAX((values[i] - 0.5) * steep + 0.5, 0), 1);
    unsigned char *rgb = c->rgb + 3 * ((size_t)(plot->y + (int)(i / (size_t)plot->width)) * (size_t)c->width +
                                       (size_t)plot->x + i % (size_t)plot->width);
    rgb[0] = mix(rgb[0], body.r, share);
    rgb[1] = mix(rgb[1], body.g, share);
    rgb[2] = mix(rgb[2], body.b, share);
  }
  cf_free(values);
  return s;
}

/* --- axes ------------------------------------------------------------------------------------------------------ */

static double high_end(const cf_plane *p, const int s) { return p->low[s] + p->h * p->n[s]; }

static cf_ticks axis_ticks(const cf_plot *plot, const int s) {
  const double pixels = s == 0 ? plot->width / (5.5 * plot->font) : plot->height / (4.0 * plot->font);
  cf_ticks t = cf_ticks_between(plot->plane->low[s], high_end(plot->plane, s), CF_MIN(CF_MAX(pixels, 2), 10));
  /* A narrow plot has room for one number. */
  if ((s == 0 ? plot->width : plot->height) < 2 * (s == 0 ? 2.5 : 1.0) * plot->font)
    t.count = CF_MIN(t.count, 1);
  return t;
}

static void axis_name(const cf_plot *plot, const int s, const cf_ticks *t, char *name, const size_t size) {
  snprintf(name, size, "%c (%s%sm)", "xyz"[plot->plane->axis[s]], t -> factor,
           t -> factor[0] != '\0' ? " " : "");
}

/* A place on axis s as pixels from its low end. */
static double pixel_at(const cf_plot *plot, const int s, const double place) {
  const double part = (place - plot->plane->low[s]) / (plot->plane->h * plot->plane->n[s]);
  return part * (s == 0 ? plot->width : plot->height);
}

static cf_status lower_axis(cf_canvas *c, const cf_plot *plot, const bool numbers) {
  const cf_ticks t = axis_ticks(plot, 0);
  const int y = plot->y + plot->height, tick = (int)CF_MAX(plot->font * 0.35, 3);
  const double line = y + tick + cf_text_height(plot->font) + plot->font * 0.35;
  cf_lettering l = {.size = plot->font, .colour = cf_plot_text, .align = 0.5};
  char name[64];
  for (int i = 0; i < t.count; ++i) {
    const int x = plot->x + CF_MIN((int)pixel_at(plot, 0, t.at[i]), plot->width - 1);
    cf_canvas_fill(c, x, y + 1, 1, tick, cf_plot_faint);
    if (numbers) CF_TRY(cf_text_draw(c, &l, x, line, t.label[i]));
  }
  if (!numbers) return CF_OK;
  axis_name(plot, 0, &t, name, sizeof name);
  l.colour = cf_plot_faint;
  return cf_text_draw(c, &l, plot->x + plot->width / 2.0, line + 1.5 * plot->font, name);
}

static double widest(const cf_ticks *t, const double font) {
  double width = 0;
  for (int i = 0; i < t->count; ++i) width = CF_MAX(width, cf_text_width(font, t->label[i]));
  return width;
}

static cf_status left_axis(cf_canvas *c, const cf_plot *plot, const bool numbers) {
  const cf_ticks t = axis_ticks(plot, 1);
  const int tick = (int)CF_MAX(plot->font * 0.35, 3);
  const double column = plot->x - tick - plot->font * 0.45;
  cf_lettering l = {.size = plot->font, .colour = cf_plot_text, .align = 1};
  char name[64];
  for (int i = 0; i < t.count; ++i) {
    const int y = plot->y + plot->height - 1 - CF_MIN((int)pixel_at(plot, 1, t.at[i]), plot->height - 1);
    cf_canvas_fill(c, plot->x - 1 - tick, y, tick, 1, cf_plot_faint);
    if (numbers) CF_TRY(cf_text_draw(c, &l, column, y + cf_text_height(plot->font) / 2, t.label[i]));
  }
  if (!numbers) return CF_OK;
  axis_name(plot, 1, &t, name, sizeof name);
  l.colour = cf_plot_faint, l.align = 0.5, l.upward = 1;
  return cf_text_draw(c, &l, column - widest(&t, plot->font) - plot->font * 0.7, plot->y + plot->height / 2.0,
                      name);
}

double cf_plot_left_room(const cf_plot *plot) {
  const cf_ticks t = axis_ticks(plot, 1);
  return widest(&t, plot->font) + 2.9 * plot->font;
}

cf_status cf_plot_axes(cf_canvas *c, const cf_plot *plot, const bool lower_numbers, const bool left_numbers) {
  CF_TRY(lower_axis(c, plot, lower_numbers));
  return left_axis(c, plot, left_numbers);
}

/* --- lines ------------------------------------------------------------------------------------------------------- */

static bool is_inside(const cf_plot *plot, const double at[2]) {
  return at[0] >= plot->x && at[0] <= plot->x + plot->width && at[1] >= plot->y &&
         at[1] <= plot->y + plot->height;
}

/* The last place of a line that can be seen, and the direction there; false if it is all outside. */
static bool last_seen(const cf_plot *plot, const int count, const double (*at)[2], double seen[2],
                      double along[2]) {
  bool found = false;
  for (int i = 0; i + 1 < count; ++i)
    for (int n = 0; n <= 64; ++n) {
      const double s = n / 64.0, dx = at[i + 1][0] - at[i][0], dy = at[i + 1][1] - at[i][1];
      const double here[2] = {at[i][0] + s * dx, at[i][1] + s * dy}, length = CF_MAX(hypot(dx, dy), 1e-9);
      if (!is_inside(plot, here)) continue;
      seen[0] = here[0], seen[1] = here[1], found = true;
      along[0] = dx / length, along[1] = dy / length;
    }
  return found;
}

/* The centre of a box of this size that touches `end` on the side `way`; false if the box is not in the plot. */
static bool beside(const cf_plot *plot, const double end[2], const double way[2], const double size[2],
                   double centre[2]) {
  const double far = fabs(way[0]) * size[0] / 2 + fabs(way[1]) * size[1] / 2 + 0.5 * plot->font;
  bool inside = true;
  for (int a = 0; a < 2; ++a) {
    const double low = (a == 0 ? plot->x : plot->y) + size[a] / 2 + 4;
    const double high = (a == 0 ? plot->x + plot->width : plot->y + plot->height) - size[a] / 2 - 4;
    const double wanted = end[a] + far * way[a];
    centre[a] = CF_MAX(CF_MIN(wanted, high), low);
    inside = inside && centre[a] == wanted;
  }
  return inside;
}

/* Behind the end of its line if there is room, else on one of its sides. */
static cf_status line_label(cf_canvas *c, const cf_plot *plot, const cf_polyline *line, const double end[2],
                            const double along[2]) {
  const cf_lettering l = {.size = plot->font, .colour = line->colour, .align = 0.5, .outline = 1};
  const double size[2] = {cf_text_width(plot->font, line->label), cf_text_height(plot->font)};
  const double back[2] = {end[0] - along[0] * size[0] / 2, end[1] - along[1] * size[0] / 2};
  const double left[2] = {along[1], -along[0]}, right[2] = {-along[1], along[0]};
  double centre[2];
  if (!beside(plot, end, along, size, centre) && !beside(plot, back, left, size, centre))
    beside(plot, back, right, size, centre);
  return cf_text_draw(c, &l, centre[0], centre[1] + size[1] / 2, line->label);
}

static cf_status draw_line(cf_canvas *c, const cf_plot *plot, const cf_polyline *line, double (*at)[2]) {
  const double width = line->width > 0 ? line->width : 1.5;
  const cf_pen pen = {.colour = line->colour,
                      .width = width,
                      .dash = line->dash,
                      .gap = 0.7 * line->dash + width,
                      .clip = {plot->x, plot->y, plot->width, plot->height}};
  double end[2], along[2];
  for (int i = 0; i < line->count; ++i) {
    at[i][0] = plot->x + pixel_at(plot, 0, line->at[i][0]);
    at[i][1] = plot->y + plot->height - pixel_at(plot, 1, line->at[i][1]);
  }
  CF_TRY(cf_canvas_stroke(c, &pen, line->count, (const double(*)[2])at));
  if (line->label == NULL || !last_seen(plot, line->count, (const double(*)[2])at, end, along)) return CF_OK;
  return line_label(c, plot, line, end, along);
}

cf_status cf_plot_lines(cf_canvas *c, const cf_plot *plot, const int lines, const cf_polyline *line) {
  for (int i = 0; i < lines; ++i) {
    double(*at)[2];
    CF_TRY(CF_NEW(&at, line[i].count));
    const cf_status s = draw_line(c, plot, &line[i], at);
    cf_free(at);
    CF_TRY(s);
  }
  return CF_OK;
}

/* --- the colour bar ------------------------------------------------------------------------------------------------ */

static cf_ticks bar_ticks(const cf_scale *s, const double font, const int height) {
  return cf_ticks_between(s->low, s->high, CF_MIN(CF_MAX(height / (3.2 * font), 3), 8));
}

double cf_plot_bar_room(const double font, const cf_scale *scale, const int height) {
  const cf_ticks t = bar_ticks(scale, font, height);
  return 1.2 * font + 0.8 * font + CF_MAX(widest(&t, font), cf_text_width(font, t.factor) - 1.2 * font);
}

/* A point at an end of the bar where values go on beyond it. */
static void bar_point(cf_canvas *c, const int x, const int y, const int width, const int up,
                      const cf_colour colour) {
  for (int j = 0; 2 * j < width; ++j) {
    const int row = y + (up ? -2 - j : 1 + j);
    cf_canvas_fill(c, x + j, row, width - 2 * j, 1, colour);
    cf_canvas_set(c, x + j - 1, row, cf_plot_faint);
    cf_canvas_set(c, x + width - j, row, cf_plot_faint);
  }
}

cf_status cf_plot_bar(cf_canvas *c, const int box[4], const double font, const cf_scale *scale) {
  const int x = box[0], y = box[1], width = box[2], height = box[3], tick = (int)CF_MAX(font * 0.3, 3);
  const cf_ticks t = bar_ticks(scale, font, height);
  const cf_lettering l = {.size = font, .colour = cf_plot_text};
  cf_colour shades[SHADES];
  cf_colormap_fill((cf_colormap)scale->map, SHADES, shades);
  for (int j = 0; j < height; ++j) {
    const double value = scale->low + (scale->high - scale->low) * (height - 0.5 - j) / height;
    cf_canvas_fill(c, x, y + j, width, 1, pick(shades, shade(scale, value)));
  }
  frame(c, x, y, width, height);
  if (scale->above) bar_point(c, x, y, width, 1, pick(shades, shade(scale, scale->high)));
  if (scale->below) bar_point(c, x, y + height, width, 0, pick(shades, shade(scale, scale->low)));
  for (int i = 0; i < t.count; ++i) {
    const double part = (t.at[i] - scale->low) / (scale->high - scale->low);
    const int at = y + height - 1 - CF_MIN((int)(part * height), height - 1);
    cf_canvas_fill(c, x + width + 1, at, tick, 1, cf_plot_faint);
    CF_TRY(cf_text_draw(c, &l, x + width + tick + 0.4 * font, at + cf_text_height(font) / 2, t.label[i]));
  }
  if (t.factor[0] == '\0') return CF_OK;
  return cf_text_draw(c, &l, x, y - 0.9 * font - (scale->above ? width / 2.0 : 0), t.factor);
}

/* --- words --------------------------------------------------------------------------------------------------------- */

cf_status cf_plot_fitted(cf_canvas *c, const cf_lettering *l, const double x, const double y,
                         const double room, const char *text) {
  cf_lettering fitted = *l;
  char cut[300];
  snprintf(cut, sizeof cut - 4, "%s", text);
  const double space = l->weight > 1 ? 0.94 * room : room;
  for (; fitted.size > 11 && cf_text_width(fitted.size, cut) > space; fitted.size -= 0.5) continue;
  for (size_t length = strlen(cut); length > 0 && cf_text_width(fitted.size, cut) > space;) {
    do --length;
    while (length > 0 && ((unsigned char)text[length] & 0xc0) == 0x80); /* not inside a character */
    snprintf(cut + length, 4, "\xe2\x80\xa6");
  }
  return cf_text_draw(c, &fitted, x, y, cut);
}

const char *cf_plot_name(const char *field) {
  static const char *const letters[][2] = {{"phi", "\xcf\x86"}, {"theta", "\xce\xb8"}, {"psi", "\xcf\x88"},
                                           {"tau", "\xcf\x84"}, {"rho", "\xcf\x81"},   {"omega", "\xcf\x89"}};
  for (size_t i = 0; i < sizeof letters / sizeof letters[0]; ++i)
    if (strcmp(field, letters[i][0]) == 0) return letters[i][1];
  return field;
}

/* "3.5", with a real minus. */
static void write_value(char *text, const size_t size, const double value) {
  snprintf(text, size, "%s%.5g", value < 0 ? "\xe2\x88\x92" : "", fabs(value));
}

void cf_plot_caption(const cf_plane *plane, const cf_preview *p, char *text, const size_t size) {
  char unit[80] = "", part[80] = "", value[32];
  if (p->unit != NULL && p->unit[0] != '\0') snprintf(unit, sizeof unit, " (%.70s)", p->unit);
  write_value(value, sizeof value, plane->middle);
  if (plane->along >= 0 && p->view == CF_VIEW_MEAN)
    snprintf(part, sizeof part, ", mean along %c", "xyz"[plane->along]);
  else if (plane->along >= 0)
    snprintf(part, sizeof part, ", slice at %c = %s m", "xyz"[plane->along], value);
  snprintf(text, size, "%s%s%s", cf_plot_name(p->field), unit, part);
}

void cf_plot_time(const double time, char *text, const size_t size) {
  char value[32];
  text[0] = '\0';
  if (isnan(time)) return;
  write_value(value, sizeof value, time);
  snprintf(text, size, "t = %s s", value);
}
