/* SPDX-License-Identifier: MIT
 *
 * Lines of equal value and arrows over a field.
 *
 * A pixel belongs to the line of the value v as far as its distance |f - v|/|grad f| is below half of the line's
 * width: no tracing, and no gaps.
 */
#include <math.h>

#include "base/mem.h"
#include "base/real.h"
#include "render/plot.h"

#define LINE 1.25 /* pixels */

static double at(const cf_plot *plot, const double *v, const int i, const int j) {
  const int a = CF_MIN(CF_MAX(i, 0), plot->width - 1), b = CF_MIN(CF_MAX(j, 0), plot->height - 1);
  return v[(size_t)b * (size_t)plot->width + (size_t)a];
}

/* How much of a pixel the nearest of the lines covers. */
static double covered(const cf_plot *plot, const cf_scale *s, const int count, const double *v, const int i,
                      const int j) {
  const double step = (s->high - s->low) / (count + 1), here = at(plot, v, i, j);
  const double n = CF_MIN(CF_MAX(round((here - s->low) / step), 1), count), value = s->low + n * step;
  const double slope = 0.5 * hypot(at(plot, v, i + 1, j) - at(plot, v, i - 1, j),
                                   at(plot, v, i, j + 1) - at(plot, v, i, j - 1));
  if (!isfinite(here) || !(slope > 1e-6 * step)) return 0;
  return CF_MIN(CF_MAX(0.5 * LINE + 0.5 - fabs(here - value) / slope, 0), 1);
}

static uint8_t towards(const uint8_t from, const uint8_t to, const double part) {
  return (uint8_t)lrint(from + part * (to - from));
}

cf_status cf_plot_contours(cf_canvas *c, const cf_plot *plot, const cf_scale *scale, const int count) {
  double *v;
  CF_TRY(CF_NEW(&v, (size_t)plot->width * (size_t)plot->height));
  const cf_status s = cf_plane_resample(plot->plane, plot->width, plot->height, false, v);
  for (int j = 0; s == CF_OK && j < plot->height; ++j)
    for (int i = 0; i < plot->width; ++i) {
      uint8_t *p = c->rgb + 3 * ((size_t)(plot->y + j) * (size_t)c->width + (size_t)(plot->x + i));
      const double part = covered(plot, scale, count, v, i, j);
      /* Dark on light, light on dark. */
      const uint8_t ink = 2 * p[0] + 5 * p[1] + p[2] > 8 * 120 ? 20 : 235;
      for (int k = 0; part > 0 && k < 3; ++k) p[k] = towards(p[k], ink, 0.7 * part);
    }
  cf_free(v);
  return s;
}

/* --- arrows --------------------------------------------------------------------------------------------------------- */

static double value(const cf_plane *p, const double u, const double v) {
  const int i = CF_MIN(CF_MAX((int)(u * p->n[0]), 0), p->n[0] - 1);
  const int j = CF_MIN(CF_MAX((int)(v * p->n[1]), 0), p->n[1] - 1);
  return p->at[(size_t)j * (size_t)p->n[0] + (size_t)i];
}

static cf_status arrow(cf_canvas *c, const cf_plot *plot, const double middle[2], const double d[2]) {
  const double length = hypot(d[0], d[1]), head = CF_MIN(0.38 * length, 0.55 * plot->font);
  if (length < 2.5) return CF_OK;
  const double e[2] = {d[0] / length, d[1] / length};
  const double tip[2] = {middle[0] + 0.5 * d[0], middle[1] + 0.5 * d[1]};
  const double shaft[2][2] = {{middle[0] - 0.5 * d[0], middle[1] - 0.5 * d[1]}, {tip[0], tip[1]}};
  const double barb[3][2] = {{tip[0] - head * (e[0] - 0.5 * e[1]), tip[1] - head * (e[1] + 0.5 * e[0])},
                             {tip[0], tip[1]},
                             {tip[0] - head * (e[0] + 0.5 * e[1]), tip[1] - head * (e[1] - 0.5 * e[0])}};
  const int reach = (int)ceil(0.5 * length) + 3;
  const int x0 = CF_MAX((int)middle[0] - reach, plot->x), y0 = CF_MAX((int)middle[1] - reach, plot->y);
  cf_pen pen = {.clip = {x0, y0, CF_MIN((int)middle[0] + reach, plot->x + plot->width) - x0,
                         CF_MIN((int)middle[1] + reach, plot->y + plot->height) - y0}};
  for (int rim = 1; rim >= 0; --rim) { /* a dark rim, so that it is seen on every colour */
    pen.colour = rim ? (cf_colour){15, 15, 20} : (cf_colour){250, 250, 250};
    pen.width = rim ? 3 : 1.3;
    CF_TRY(cf_canvas_stroke(c, &pen, 2, shaft));
    CF_TRY(cf_canvas_stroke(c, &pen, 3, barb));
  }
  return CF_OK;
}

cf_status cf_plot_arrows(cf_canvas *c, const cf_plot *plot, const cf_plane part[2]) {
  const double wide = 2.6 * plot->font;
  const int across = CF_MAX((int)(plot->width / wide), 1), rows = CF_MAX((int)(plot->height / wide), 1);
  double most = 0;
  for (ptrdiff_t i = 0; i < (ptrdiff_t)part[0].n[0] * part[0].n[1]; ++i) {
    const double size = hypot(part[0].at[i], part[1].at[i]);
    if (isfinite(size)) most = CF_MAX(most, size);
  }
  for (int j = 0; j < rows && most > 0; ++j)
    for (int i = 0; i < across; ++i) {
      const double u = (i + 0.5) / across, v = (j + 0.5) / rows;
      const double middle[2] = {plot->x + u * plot->width, plot->y + (1 - v) * plot->height};
      const double d[2] = {wide * value(&part[0], u, v) / most, -wide * value(&part[1], u, v) / most};
      if (isfinite(d[0]) && isfinite(d[1])) CF_TRY(arrow(c, plot, middle, d));
    }
  return CF_OK;
}
