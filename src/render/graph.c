/* SPDX-License-Identifier: MIT */
#include "render/graph.h"

#include <math.h>

#include "base/mem.h"
#include "base/real.h"
#include "render/plot.h"
#include "render/ticks.h"

typedef struct frame {
  int x, y, width, height;
  double font, low[2], high[2];
} frame;

cf_colour cf_graph_colour(const int i) {
  static const cf_colour colours[] = {{24, 96, 170},  {214, 96, 20}, {40, 130, 72},
                                      {150, 60, 150}, {180, 40, 50}, {90, 90, 100}};
  return colours[i % (int)(sizeof colours / sizeof *colours)];
}

static void take_in(frame *f, const cf_graph *g) {
  f->low[0] = f->low[1] = (double)INFINITY, f->high[0] = f->high[1] = -(double)INFINITY;
  for (int n = 0; n < g->curves; ++n)
    for (int64_t i = 0; i < g->curve[n].count; ++i) {
      const double v[2] = {g->curve[n].x[i], g->curve[n].y[i]};
      for (int a = 0; a < 2 && isfinite(v[0]) && isfinite(v[1]); ++a)
        f->low[a] = CF_MIN(f->low[a], v[a]), f->high[a] = CF_MAX(f->high[a], v[a]);
    }
  for (int a = 0; a < 2; ++a) {
    if (!(f->low[a] <= f->high[a])) f->low[a] = 0, f->high[a] = 1;
    /* From 0 where that is near. */
    if (a == 1 && f->low[a] > 0 && f->low[a] < 0.5 * f->high[a]) f->low[a] = 0;
    if (f->low[a] == f->high[a]) f->high[a] += f->low[a] == 0 ? 1 : 0.1 * fabs(f->low[a]);
    if (a == 1) f->high[a] += 0.05 * (f->high[a] - f->low[a]);
  }
}

static double pixel(const frame *f, const int a, const double v) {
  const double part = (v - f->low[a]) / (f->high[a] - f->low[a]);
  return a == 0 ? f->x + part * f->width : f->y + (1 - part) * f->height;
}

static cf_status axes(cf_canvas *c, const frame *f, const cf_graph *g) {
  const cf_ticks across = cf_ticks_between(f->low[0], f->high[0], CF_MAX(f->width / (5 * f->font), 2));
  const cf_ticks up = cf_ticks_between(f->low[1], f->high[1], CF_MAX(f->height / (2.6 * f->font), 2));
  cf_lettering l = {.size = f->font, .colour = cf_plot_text, .align = 0.5};
  cf_canvas_fill(c, f->x, f->y + f->height, f->width, 1, cf_plot_faint);
  cf_canvas_fill(c, f->x - 1, f->y, 1, f->height + 1, cf_plot_faint);
  for (int i = 0; i < across.count; ++i) {
    const int x = (int)pixel(f, 0, across.at[i]);
    cf_canvas_fill(c, x, f->y + f->height + 1, 1, 4, cf_plot_faint);
    CF_TRY(cf_text_draw(c, &l, x, f->y + f->height + 6 + cf_text_height(f->font), across.label[i]));
  }
  l.align = 1;
  for (int i = 0; i < up.count; ++i) {
    const int y = (int)pixel(f, 1, up.at[i]);
    cf_canvas_fill(c, f->x - 5, y, 4, 1, cf_plot_faint);
    CF_TRY(cf_text_draw(c, &l, f->x - 8, y + cf_text_height(f->font) / 2, up.label[i]));
  }
  l.colour = cf_plot_faint;
  if (g->x_name != NULL)
    CF_TRY(cf_text_draw(c, &l, f->x + f->width, f->y + f->height + 7 + 2.4 * f->font, g->x_name));
  l.align = 0;
  return up.factor[0] != '\0' ? cf_text_draw(c, &l, f->x + 4, f->y + f->font, up.factor) : CF_OK;
}

/* The stretch of a curve from its point `from` up to the next gap. */
static cf_status stretch(cf_canvas *c, const frame *f, const cf_curve *curve, int64_t *from) {
  const cf_pen pen = {.colour = curve->colour,
                      .width = CF_MAX(f->font / 7, 1.5),
                      .clip = {f->x, f->y - 3, f->width + 3, f->height + 6}};
  int64_t n = 0;
  double(*at)[2];
  while (*from + n < curve->count && isfinite(curve->x[*from + n]) && isfinite(curve->y[*from + n])) ++n;
  if (n == 0) {
    ++*from;
    return CF_OK;
  }
  /* No more points than pixels can show. */
  const int64_t most = 4 * (int64_t)f->width, points = CF_MIN(n, most);
  CF_TRY(CF_NEW(&at, points));
  for (int64_t i = 0; i < points; ++i) {
    const int64_t p = *from + (points > 1 ? i * (n - 1) / (points - 1) : 0);
    at[i][0] = pixel(f, 0, curve->x[p]), at[i][1] = pixel(f, 1, curve->y[p]);
  }
  const cf_status s = cf_canvas_stroke(c, &pen, (int)points, (const double(*)[2])at);
  cf_free(at);
  *from += n;
  return s;
}

static double value_at(const cf_curve *c, const double x) {
  for (int64_t i = 0; i + 1 < c->count; ++i)
    if (c->x[i] <= x && x <= c->x[i + 1]) {
      const double wide = c->x[i + 1] - c->x[i];
      return wide > 0 ? c->y[i] + (c->y[i + 1] - c->y[i]) * (x - c->x[i]) / wide : c->y[i];
    }
  return (double)NAN;
}

static cf_status mark_now(cf_canvas *c, const frame *f, const cf_graph *g) {
  const double x = pixel(f, 0, g->now);
  if (isnan(g->now) || x < f->x || x > f->x + f->width) return CF_OK;
  cf_canvas_fill(c, (int)x, f->y, 1, f->height, (cf_colour){190, 190, 195});
  for (int n = 0; n < g->curves; ++n) {
    const double v = value_at(&g->curve[n], g->now);
    const cf_pen pen = {.colour = g->curve[n].colour, .width = 0.55 * f->font};
    const double dot[2][2] = {{x, pixel(f, 1, v)}, {x, pixel(f, 1, v)}};
    if (isfinite(v)) CF_TRY(cf_canvas_stroke(c, &pen, 2, dot));
  }
  return CF_OK;
}

static cf_status labels(cf_canvas *c, const frame *f, const cf_graph *g) {
  cf_lettering l = {.size = f->font, .align = 1, .outline = 0};
  double y = f->y + f->height - 0.6 * f->font;
  for (int n = g->curves - 1; n >= 0; --n) {
    if (g->curve[n].label == NULL || g->curves < 2) continue;
    l.colour = g->curve[n].colour;
    CF_TRY(cf_text_draw(c, &l, f->x + f->width - 4, y, g->curve[n].label));
    y -= 1.35 * f->font;
  }
  const cf_lettering title = {.size = f->font, .colour = cf_plot_text, .weight = 1.2};
  const double room = f->width + 4.0 * f->font;
  return g->title == NULL ? CF_OK : cf_plot_fitted(c, &title, f->x, f->y - 0.7 * f->font, room, g->title);
}

cf_status cf_graph_draw(const cf_graph *g, const int width, const int height, cf_canvas *c) {
  const double font = CF_MAX(round(CF_MIN(width, 1.6 * height) / 26.0), 10);
  frame f = {.font = font, .x = (int)(4.6 * font), .y = (int)(2.2 * font)};
  f.width = width - f.x - (int)(1.4 * font);
  f.height = height - f.y - (int)((g->x_name != NULL ? 3.9 : 2.4) * font);
  *c = (cf_canvas){.rgb = NULL};
  if (f.width < 20 || f.height < 20)
    return cf_fail(CF_BAD_ARGUMENT, "a graph of %d x %d pixels: too small for its numbers", width, height);
  take_in(&f, g);
  CF_TRY(cf_canvas_create(c, width, height, cf_plot_ground));
  cf_status s = axes(c, &f, g);
  for (int n = 0; n < g->curves && s == CF_OK; ++n)
    for (int64_t i = 0; i < g->curve[n].count && s == CF_OK;) s = stretch(c, &f, &g->curve[n], &i);
  if (s == CF_OK) s = mark_now(c, &f, g);
  if (s == CF_OK) s = labels(c, &f, g);
  if (s != CF_OK) cf_canvas_destroy(c);
  return s;
}
