/* SPDX-License-Identifier: MIT */
#include "render/portrait.h"

#include <math.h>

#include "base/mem.h"
#include "base/real.h"

#define DENSITY 917.0 /* of ice, kg/m^3 */
#define FAINT   0.01  /* less eta than this is vapour */
#define MARGIN  1.04  /* half of the picture over the radius, and two pixels */

enum { CELLS_LEAST = 4, FINE = 4, SAMPLES_MOST = 16 };

/* The crystal in cells: eta and thickness between their centres, 0 outside of the grid. */
typedef struct crystal {
  const cf_grid *grid;
  cf_cell eta, thickness;
  double middle[2], radius; /* in cells */
} crystal;

static double value_at(const cf_box *b, const cf_real *f, const int i, const int j) {
  if (i < 0 || j < 0 || i >= b->n[0] || j >= b->n[1]) return 0;
  return fmax(0, (double)f[cf_box_at(b, i, j, 0)]);
}

static double between(const cf_box *b, const cf_real *f, const double x, const double y) {
  const int i = (int)floor(x), j = (int)floor(y);
  const double u = x - i, v = y - j;
  return (1 - v) * ((1 - u) * value_at(b, f, i, j) + u * value_at(b, f, i + 1, j)) +
         v * ((1 - u) * value_at(b, f, i, j + 1) + u * value_at(b, f, i + 1, j + 1));
}

static double ice_at(const crystal *c, const double x, const double y) {
  const double eta = between(&c->grid->box, c->eta.at, x, y);
  return eta < FAINT ? 0 : fmin(1, eta);
}

static double thickness_at(const crystal *c, const double x, const double y) {
  return ice_at(c, x, y) > 0 ? between(&c->grid->box, c->thickness.at, x, y) : 0;
}

/* --- measuring ------------------------------------------------------------------------------------------------------------ */

static cf_status find_middle(crystal *c, bool *cut) {
  const cf_box *b = &c->grid->box;
  double mass = 0, sum[2] = {0, 0};
  int64_t solid = 0;
  *cut = false;
  for (int j = 0; j < b->n[1]; ++j)
    for (int i = 0; i < b->n[0]; ++i) {
      const double d = thickness_at(c, i, j);
      mass += d, sum[0] += d * i, sum[1] += d * j;
      if (ice_at(c, i, j) < 0.5) continue;
      ++solid;
      *cut = *cut || i == 0 || j == 0 || i == b->n[0] - 1 || j == b->n[1] - 1;
    }
  if (solid == 0) return cf_fail(CF_BAD_ARGUMENT, "there is no crystal in it: eta is nowhere above 1/2");
  if (!(mass > 0)) return cf_fail(CF_BAD_ARGUMENT, "its crystal has no thickness");
  for (int a = 0; a < 2; ++a) c->middle[a] = sum[a] / mass;
  return CF_OK;
}

/* The farthest point of the solid near cell (i, j), looked for on a finer lattice. */
static void reach(crystal *c, const int i, const int j) {
  for (int v = -FINE; v <= FINE; ++v)
    for (int u = -FINE; u <= FINE; ++u) {
      const double x = i + (double)u / FINE, y = j + (double)v / FINE;
      const double r = hypot(x - c->middle[0], y - c->middle[1]);
      if (r > c->radius && ice_at(c, x, y) >= 0.5) c->radius = r;
    }
}

static cf_status find_radius(crystal *c) {
  const cf_box *b = &c->grid->box;
  c->radius = 0;
  for (int j = 0; j < b->n[1]; ++j)
    for (int i = 0; i < b->n[0]; ++i)
      if (ice_at(c, i, j) >= 0.5 && hypot(i - c->middle[0], j - c->middle[1]) + 1.5 > c->radius)
        reach(c, i, j);
  if (c->radius >= CELLS_LEAST) return CF_OK;
  return cf_fail(CF_BAD_ARGUMENT, "its crystal is only %.2g cells from the middle to the rim: let it grow",
                 c->radius);
}

/* --- maps ------------------------------------------------------------------------------------------------------------------- */

/* Means of cover and thickness (in cells) over each pixel, `step` cells wide. */
static void resample(const crystal *c, const int pixels, const double step, double *cover, double *thick) {
  const int k = CF_MIN(CF_MAX((int)ceil(2 * step), 2), SAMPLES_MOST);
  for (int y = 0; y < pixels; ++y)
    for (int x = 0; x < pixels; ++x) {
      double ice = 0, d = 0;
      for (int s = 0; s < k * k; ++s) {
        const double u = x - 0.5 * (pixels - 1) + (s % k + 0.5) / k - 0.5;
        const double v = 0.5 * (pixels - 1) - y + (s / k + 0.5) / k - 0.5;
        ice += ice_at(c, c->middle[0] + u * step, c->middle[1] + v * step);
        d += thickness_at(c, c->middle[0] + u * step, c->middle[1] + v * step);
      }
      const ptrdiff_t p = (ptrdiff_t)y * pixels + x;
      cover[p] = ice / (k * k);
      thick[p] = d / (k * k) / c->grid->h;
    }
}

/* So that the numbers are those of the pictures. */
static void measure(cf_portrait *p, const double *cover, const double *thick, const double scale) {
  const double cell = p->metres_per_pixel * p->metres_per_pixel;
  double area = 0, volume = 0, most = 0, sum[2] = {0, 0};
  for (int y = 0; y < p->pixels; ++y)
    for (int x = 0; x < p->pixels; ++x) {
      const ptrdiff_t at = (ptrdiff_t)y * p->pixels + x;
      area += cover[at];
      volume += thick[at];
      sum[0] += thick[at] * x, sum[1] += thick[at] * y;
      most = fmax(most, thick[at]);
    }
  for (int a = 0; a < 2; ++a) p->center[a] = sum[a] / volume;
  p->area = area * cell;
  p->mean_thickness = scale * volume / area;
  p->mass = DENSITY * p->area * p->mean_thickness;
  p->height_scale = 0.5 * scale * most;
}

static uint16_t deep(const double v) { return (uint16_t)lrint(65535 * fmax(0, fmin(1, v))); }

/* The slope of the height at a pixel, rows upwards. */
static double slope(const cf_portrait *p, const double *thick, const int x, const int y, const int axis) {
  const int dx = axis == 0, dy = axis == 0 ? 0 : -1, last = p->pixels - 1;
  const int x1 = CF_MIN(x + dx, last), y1 = CF_MAX(y + dy, 0), x0 = CF_MAX(x - dx, 0),
            y0 = CF_MIN(y - dy, last);
  return 0.5 * (thick[(ptrdiff_t)y1 * p->pixels + x1] - thick[(ptrdiff_t)y0 * p->pixels + x0]) / 2;
}

/* `unit`: pixels in the unit of `thick`. */
static void paint(cf_portrait *p, const double *cover, const double *thick, const double unit,
                  const double most) {
  static const double thin[3] = {0.80, 0.89, 0.98}, full[3] = {0.97, 0.985, 1};
  for (int y = 0; y < p->pixels; ++y)
    for (int x = 0; x < p->pixels; ++x) {
      const ptrdiff_t at = (ptrdiff_t)y * p->pixels + x;
      const double up[3] = {-slope(p, thick, x, y, 0) * unit, -slope(p, thick, x, y, 1) * unit, 1};
      const double length = sqrt(up[0] * up[0] + up[1] * up[1] + 1), share = thick[at] / most;
      for (int a = 0; a < 3; ++a) {
        p->rgba[4 * at + a] = deep(thin[a] + share * (full[a] - thin[a]));
        p->normal[3 * at + a] = deep(0.5 + 0.5 * up[a] / length);
      }
      p->rgba[4 * at + 3] = deep(cover[at]);
      p->height[at] = deep(share);
    }
}

static cf_status draw(cf_portrait *p, const crystal *c) {
  const ptrdiff_t all = (ptrdiff_t)p->pixels * p->pixels;
  const double step = 2 * MARGIN * c->radius / (p->pixels - 4); /* cells a pixel */
  const double scale = p->radius / c->radius;                   /* m a cell */
  double *maps;
  CF_TRY(CF_NEW(&maps, 2 * all));
  p->metres_per_pixel = scale * step;
  resample(c, p->pixels, step, maps, maps + all);
  measure(p, maps, maps + all, scale);
  paint(p, maps, maps + all, 1 / step, 2 * p->height_scale / scale);
  cf_free(maps);
  return CF_OK;
}

cf_status cf_portrait_create(cf_portrait *p, const cf_grid *g, const cf_cell eta, const cf_cell thickness,
                             const int pixels, const double radius) {
  const ptrdiff_t all = (ptrdiff_t)pixels * pixels;
  crystal c = {.grid = g, .eta = eta, .thickness = thickness};
  *p = (cf_portrait){.pixels = pixels, .radius = radius};
  if (g->box.dim != 2) return cf_fail(CF_BAD_ARGUMENT, "its crystal grew in space, not in the plane");
  CF_TRY(find_middle(&c, &p->cut));
  CF_TRY(find_radius(&c));
  cf_status status = CF_NEW(&p->rgba, 4 * all);
  if (status == CF_OK) status = CF_NEW(&p->height, all);
  if (status == CF_OK) status = CF_NEW(&p->normal, 3 * all);
  if (status == CF_OK) status = draw(p, &c);
  if (status != CF_OK) cf_portrait_destroy(p);
  return status;
}

void cf_portrait_destroy(cf_portrait *p) {
  cf_free(p->rgba);
  cf_free(p->height);
  cf_free(p->normal);
  *p = (cf_portrait){.pixels = 0};
}
