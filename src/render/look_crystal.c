/* SPDX-License-Identifier: MIT
 *
 * A flat crystal as one sees it in a microscope, between two coloured lights.
 *
 * Ice is clear: what one sees of it is where it bends light to. Its surface is taken to be as high as the field
 * `thickness` says, or, where there is none, the root of its `age`, for what froze first has grown thickest; that
 * gives ridges along the branches. A slope sends a warm light from one side to the eye and a cold one from the other;
 * where it is level one sees the dark ground through it. The rim, where the surface falls to nothing, catches both, and
 * a small bright lamp above glitters.
 *
 * Everything is worked out on twice as many points each way, and averaged.
 */
#include <string.h>

#include "base/mem.h"
#include "base/real.h"
#include "grid/sweep.h"
#include "render/look_part.h"
#include "render/plane.h"

enum { FINER = 2 };

typedef struct plate {
  int width, height; /* points */
  double *ice, *high;
  double wide; /* of a point, over the height of the plane */
} plate;

static void plate_destroy(plate *p) {
  cf_free(p->ice);
  cf_free(p->high);
}

static cf_status resampled(const cf_exhibit *e, const cf_exhibit_field *f, plate *p, double **out) {
  const cf_preview how = cf_preview_default(f->name, "");
  cf_plane plane;
  CF_TRY(cf_plane_create(&plane, e->grid, f->at, &how));
  cf_status s = CF_OK;
  if (p->width == 0)
    p->width = CF_MAX((int)lrint((double)p->height * plane.n[0] / plane.n[1]), 1), p->wide = 1.0 / p->height;
  s = CF_NEW(out, (size_t)p->width * (size_t)p->height);
  if (s == CF_OK) s = cf_plane_resample(&plane, p->width, p->height, false, *out);
  cf_plane_destroy(&plane);
  return s;
}

/* From thickness or age a height of 0 to 1 inside the ice. */
static cf_status raise_up(const cf_exhibit *e, plate *p) {
  const cf_exhibit_field *thickness = cf_exhibit_find(e, "thickness"), *age = cf_exhibit_find(e, "age");
  const cf_exhibit_field *f = thickness != NULL ? thickness : age != NULL ? age : &e->field[0];
  const size_t n = (size_t)p->width * (size_t)p->height;
  double most = 0;
  CF_TRY(resampled(e, f, p, &p->high));
  for (size_t i = 0; i < n; ++i)
    if (p->ice[i] > 0.5 && isfinite(p->high[i])) most = CF_MAX(most, p->high[i]);
  for (size_t i = 0; i < n; ++i) {
    const double part = most > 0 && isfinite(p->high[i]) ? CF_MIN(CF_MAX(p->high[i] / most, 0), 1) : 1;
    const double ice = (double)cf_smooth_step(0.15f, 0.85f, (float)p->ice[i]);
    p->high[i] = ice * (0.35 + 0.65 * (f == age ? sqrt(part) : part));
  }
  return CF_OK;
}

/* Enlarged many times over, a cubic still shows where the cells are: running means over about a cell, both ways. */
static cf_status smooth(plate *p, const int cells) {
  const int r = p->height / cells / 2, n[2] = {p->width, p->height};
  double *line;
  if (r < 1) return CF_OK;
  CF_TRY(CF_NEW(&line, CF_MAX(n[0], n[1])));
  for (int pass = 0; pass < 4; ++pass) {
    const int a = pass % 2;
    const ptrdiff_t along = a == 0 ? 1 : n[0], across = a == 0 ? n[0] : 1;
    for (int j = 0; j < n[1 - a]; ++j) {
      double *v = p->high + j * across, sum = 0;
      for (int i = -r; i <= r; ++i) sum += v[CF_MIN(CF_MAX(i, 0), n[a] - 1) * along];
      for (int i = 0; i < n[a]; ++i) {
        line[i] = sum / (2 * r + 1);
        sum += v[CF_MIN(i + r + 1, n[a] - 1) * along] - v[CF_MAX(i - r, 0) * along];
      }
      for (int i = 0; i < n[a]; ++i) v[i * along] = line[i];
    }
  }
  cf_free(line);
  return CF_OK;
}

static double at(const plate *p, const double *v, const int i, const int j) {
  const int a = CF_MIN(CF_MAX(i, 0), p->width - 1), b = CF_MIN(CF_MAX(j, 0), p->height - 1);
  return v[(size_t)b * (size_t)p->width + (size_t)a];
}

typedef struct lamps {
  cf_vec warm, cold, body, veil;
  float from[2]; /* direction of the warm one in the picture */
  double gain;   /* slopes that count as steep */
} lamps;

/* What a point of the plate sends; `ground` is what lies behind. */
static cf_vec shade(const plate *p, const lamps *l, const int i, const int j, const cf_vec ground) {
  const double ice = at(p, p->ice, i, j);
  const float cover = cf_smooth_step(0.35f, 0.65f, (float)ice), high = (float)at(p, p->high, i, j);
  if (cover <= 0) return ground;
  const double dx = (at(p, p->high, i + 1, j) - at(p, p->high, i - 1, j)) / (2 * p->wide);
  const double dy = (at(p, p->high, i, j - 1) - at(p, p->high, i, j + 1)) / (2 * p->wide);
  const float sx = (float)(l->gain * dx), sy = (float)(l->gain * dy), steep = sqrtf(sx * sx + sy * sy);
  const float side = -(sx * l->from[0] + sy * l->from[1]) / sqrtf(1 + steep * steep);
  const float tilt = steep / sqrtf(1 + steep * steep);
  const cf_vec normal = cf_vec_unit((cf_vec){-sx, -sy, 1});
  const cf_vec lamp = cf_vec_unit((cf_vec){0.25f * l->from[0] - 0.12f, 0.25f * l->from[1] + 0.22f, 1});
  const float glint = powf(fmaxf(cf_vec_dot(normal, lamp), 0), 220);
  cf_vec sum = cf_vec_along(cf_vec_scale(1 - 0.55f * tilt, ground), 1, cf_vec_scale(high, l->body));
  sum = cf_vec_along(sum, 0.85f * powf(fmaxf(side, 0), 1.3f), l->warm);
  sum = cf_vec_along(sum, 0.95f * powf(fmaxf(-side, 0), 1.3f), l->cold);
  sum = cf_vec_along(sum, 0.22f * tilt * tilt * tilt + 0.10f * glint * high, l->veil);
  return cf_vec_mix(ground, sum, cover);
}

/* The mean of FINER x FINER points for a pixel; points outside of the plane are ground. */
static void fill_row(const cf_look *look, const plate *p, const lamps *l, const cf_backdrop *b, const int y,
                     cf_film *f) {
  const int off_x = (FINER * look->width - p->width) / 2, off_y = (FINER * look->height - p->height) / 2;
  const float wide = (float)look->width, tall = (float)look->height;
  for (int x = 0; x < look->width; ++x) {
    const cf_vec ground = cf_backdrop_at(b, ((float)x + 0.5f) / wide, ((float)y + 0.5f) / tall, wide / tall);
    cf_vec sum = {0, 0, 0};
    for (int n = 0; n < FINER * FINER; ++n) {
      const int i = FINER * x + n % FINER - off_x, j = FINER * y + n / FINER - off_y;
      const bool in = i >= 0 && j >= 0 && i < p->width && j < p->height;
      sum = cf_vec_add(sum, in ? shade(p, l, i, j, ground) : ground);
    }
    f->light[(size_t)y * (size_t)f->width + (size_t)x] = cf_vec_scale(1.0f / (FINER * FINER), sum);
  }
}

double cf_crystal_zoom(const cf_exhibit *e) {
  const cf_box *b = &e->grid->box;
  double reach = 0;
  for (int j = 0; e->fields > 0 && j < b->n[1]; ++j)
    for (int i = 0; i < b->n[0]; ++i)
      if (e->field[0].at[cf_box_at(b, i, j, 0)] > (cf_real)0.5)
        reach = CF_MAX(reach, CF_MAX(fabs(i + 0.5 - 0.5 * b->n[0]), fabs(j + 0.5 - 0.5 * b->n[1])));
  return reach > 0 ? CF_MIN(CF_MAX(0.42 * b->n[1] / reach, 0.9), 8) : 1;
}

cf_status cf_draw_crystal(const cf_look *look, const cf_exhibit *e, cf_canvas *c) {
  const cf_develop how = {
      .exposure = look->exposure, .contrast = 1.2, .white = 2.2, .glow = 0.05, .vignette = 0.25};
  const cf_vec night = cf_or_colour(look->background, (cf_vec){0.007f, 0.020f, 0.060f});
  const cf_backdrop b = {night, cf_vec_scale(0.13f, night), {0.5f, 0.5f}, 0.95f};
  const double turn = cf_or(look->light_turn, 125) * acos(-1.0) / 180;
  lamps l = {.warm = {1.00f, 0.50f, 0.16f},
             .cold = {0.12f, 0.48f, 1.00f},
             .body = cf_or_colour(look->colour, (cf_vec){0.070f, 0.115f, 0.190f}),
             .veil = {0.95f, 0.98f, 1.0f},
             .from = {(float)cos(turn), (float)sin(turn)},
             .gain = 0.06 * cf_or(look->strength, 1)};
  plate p = {.width = 0};
  cf_film f = {.light = NULL};
  if (e->fields == 0) return cf_look_no(look, "a field");
  l.warm = cf_vec_scale((float)look->light_strength, l.warm);
  l.cold = cf_vec_scale((float)look->light_strength, l.cold);
  const double fit = CF_MIN(1.0, (double)look->width / look->height * e->grid->box.n[1] / e->grid->box.n[0]);
  p.height = CF_MAX((int)lrint(FINER * look->height * look->zoom * fit), 2);
  if (p.height > 16 * look->height)
    return cf_fail(CF_BAD_ARGUMENT, "render.camera.zoom = %g: at most 8 for a crystal", look->zoom);
  cf_status s = resampled(e, &e->field[0], &p, &p.ice);
  if (s == CF_OK) s = raise_up(e, &p);
  if (s == CF_OK) s = smooth(&p, e->grid->box.n[1]);
  if (s == CF_OK) s = cf_film_create(&f, look->width, look->height);
  if (s == CF_OK) {
    CF_PRAGMA(omp parallel for schedule(static) num_threads(CF_MAX(look->threads, 1)))
    for (int y = 0; y < look->height; ++y) fill_row(look, &p, &l, &b, y, &f);
    s = cf_film_develop(&f, &how, c);
  }
  cf_film_destroy(&f);
  plate_destroy(&p);
  return s;
}
