/* SPDX-License-Identifier: MIT */
#include "session/overlay.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "stencil/regime.h"

#define EDGE_COLOUR \
  (cf_colour) { 240, 120, 20 }

static double velocity_at(const cf_scene *scene, const int axis, const double *x) {
  const cf_function *f = &scene->velocity.axis[scene->velocity.count > 1 ? axis : 0];
  return cf_fn_at(&f->fn, x[0], x[1], 0, 0);
}

static void add_edge(cf_overlay *o, const double *apex, const double direction, const double length) {
  double(*at)[2] = o->at[o->count];
  at[0][0] = apex[0];
  at[0][1] = apex[1];
  at[1][0] = apex[0] + length * cos(direction);
  at[1][1] = apex[1] + length * sin(direction);
  o->line[o->count] = (cf_polyline){.count = 2,
                                    .at = (const double(*)[2])at,
                                    .colour = EDGE_COLOUR,
                                    .width = 2,
                                    .dash = 9,
                                    .label = o->label[o->count]};
  ++o->count;
}

/* The middle of what a source without a shape adds, and whether it is small beside the box: then it is as good as a
 * point. */
static bool centroid_of(const cf_grid *g, const double t, const cf_fn *rate, double apex[2]) {
  double sum = 0, first[2] = {0, 0}, second[2] = {0, 0};
  if (cf_fn_is_constant(rate)) return false;
  for (int j = 0; j < g->box.n[1]; ++j)
    for (int i = 0; i < g->box.n[0]; ++i) {
      const double x[2] = {cf_grid_place(g, 0, i, 0), cf_grid_place(g, 1, j, 0)};
      const double w = fabs(cf_fn_at(rate, x[0], x[1], 0, t));
      sum += w;
      for (int a = 0; a < 2; ++a) first[a] += w * x[a], second[a] += w * x[a] * x[a];
    }
  bool small = sum > 0;
  for (int a = 0; a < 2; ++a) {
    apex[a] = first[a] / sum;
    const double spread = sqrt(fmax(0, second[a] / sum - apex[a] * apex[a]));
    small = small && spread < g->box.n[a] * g->h / 16;
  }
  return small;
}

/* Where a source is, if it is anywhere in particular. */
static bool apex_of(const cf_grid *g, const double t, const cf_scene_source *s, double apex[2]) {
  if (!s->given.at && s->shape == CF_SCENE_SHAPE_EVERYWHERE)
    return s->given.rate && centroid_of(g, t, &s->rate.axis[0].fn, apex);
  const double *middle = s->given.at ? s->at.value : s->center.value;
  apex[0] = middle[0];
  apex[1] = middle[1];
  return true;
}

void cf_overlay_cones(const cf_scene *scene, const cf_grid *g, const double t, const char *field,
                      cf_overlay *o) {
  const int f = cf_scene_field_index(scene, field);
  o->count = 0;
  if (scene->dim != 2 || f < 0 || t == 0) return;
  const cf_scene_diffusion *d = &scene->fields.item[f].diffusion;
  if (!cf_fn_is_constant(&d->k.fn) || !cf_fn_is_constant(&d->capacity.fn)) return;
  const double c = cf_regime_speed(d->k.fn.value / d->capacity.fn.value, d->tau, d->f_t);
  for (int i = 0; i < scene->sources.count && o->count + 2 <= CF_OVERLAY_MAX; ++i) {
    const cf_scene_source *s = &scene->sources.item[i];
    double apex[2];
    if (strcmp(s->field, field) != 0 || !apex_of(g, t, s, apex)) continue;
    const double u = velocity_at(scene, 0, apex), v = velocity_at(scene, 1, apex), speed = hypot(u, v);
    if (!(c > 0) || !isfinite(c) || !(speed > c)) continue;
    const double half = asin(c / speed), along = atan2(v, u), length = sqrt(speed * speed - c * c) * t;
    snprintf(o->label[o->count], sizeof o->label[0], "%.1f\xc2\xb0", half * 180 / acos(-1.0));
    o->label[o->count + 1][0] = '\0';
    add_edge(o, apex, along + half, length);
    add_edge(o, apex, along - half, length);
    o->line[o->count - 1].label = NULL;
  }
}
