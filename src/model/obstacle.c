/* SPDX-License-Identifier: MIT
 *
 * One obstacle made of its keys: its shape, and how it moves.
 *
 * Stops of a path are joined by cubics whose slopes are limited (Fritsch, Carlson 1980): nothing swings beyond a stop,
 * and what stands between two equal stops stands.
 */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "model/obstacles_part.h"
#include "model/surface.h"

#define PI 3.14159265358979323846

/* --- motion ------------------------------------------------------------------------------------------------ */

/* What stop i says of a track, m or degrees. */
static double stop_value(const cf_obstacle_track *k, const int i) {
  const cf_scene_obstacle_stop *s = &k->of->keys->path.item[i];
  if (k->which == 3) return s->turn;
  return k->which < s->place.count ? s->place.value[k->which] - k->of->motion.pivot[k->which] : 0;
}

static double chord(const cf_obstacle_track *k, const int i) {
  const cf_scene_obstacle_stop *s = k->of->keys->path.item;
  return (stop_value(k, i + 1) - stop_value(k, i)) / (s[i + 1].time - s[i].time);
}

/* The slope at a stop: 0 at the ends and where the path turns back, else the harmonic mean of the chords. */
static double slope(const cf_obstacle_track *k, const int i) {
  if (i == 0 || i == k->of->keys->path.count - 1) return 0;
  const double low = chord(k, i - 1), high = chord(k, i);
  return low * high > 0 ? 2 * low * high / (low + high) : 0;
}

static double on_path(const cf_obstacle_track *k, const double t) {
  const cf_scene_obstacle_stop *s = k->of->keys->path.item;
  const int last = k->of->keys->path.count - 1;
  int i = 0;
  if (t <= s[0].time) return stop_value(k, 0);
  if (t >= s[last].time) return stop_value(k, last);
  while (t > s[i + 1].time) ++i;
  const double w = s[i + 1].time - s[i].time, x = (t - s[i].time) / w, y = 1 - x;
  return y * y * (1 + 2 * x) * stop_value(k, i) + x * x * (1 + 2 * y) * stop_value(k, i + 1) +
         w * x * y * (y * slope(k, i) - x * slope(k, i + 1));
}

/* A cf_fn: m, or rad. */
static void track_row(const void *context, const int n, const double *x, const double *y, const double *z,
                      const double t, double *out) {
  const cf_obstacle_track *k = context;
  const cf_scene_obstacle *o = k->of->keys;
  (void)x, (void)y, (void)z;
  double v = o->path.count > 0 ? on_path(k, t) : 0;
  if (k->which < 3 && k->which < o->motion.count) v += cf_fn_at(&o->motion.axis[k->which].fn, 0, 0, 0, t);
  if (k->which == 3) v = (v + o->turn) * PI / 180;
  if (k->which == 3 && o->given.rotation) v += cf_fn_at(&o->rotation.fn, 0, 0, 0, t);
  for (int i = 0; i < n; ++i) out[i] = v;
}

static void make_motion(cf_obstacle *o, const double pivot[3]) {
  const cf_scene_obstacle *k = o->keys;
  o->motion = (cf_motion){.pivot = {pivot[0], pivot[1], pivot[2]}};
  for (int a = 0; a < 3; ++a) {
    o->motion.axis[a] = k->axis.value[a];
    if (a < k->pivot.count) o->motion.pivot[a] = k->pivot.value[a];
  }
  for (int w = 0; w < 4; ++w) {
    o->track[w] = (cf_obstacle_track){o, w};
    cf_fn *fn = w < 3 ? &o->motion.shift[w] : &o->motion.angle;
    *fn = (cf_fn){.eval = track_row, .context = &o->track[w], .in_time = true};
  }
  o->moves = k->motion.count > 0 || k->given.rotation || k->path.count > 0;
  o->posed = o->moves || k->turn != 0;
  o->changes = o->moves || (k->shape == CF_OBSTACLE_EXPRESSION && k->distance.fn.in_time);
}

/* --- shapes ------------------------------------------------------------------------------------------------ */

static void fill(const cf_param_numbers *given, double x[3]) {
  for (int a = 0; a < 3; ++a) x[a] = a < given->count ? given->value[a] : 0;
}

static bool is_array(const char *file) {
  const char *dot = strrchr(file, '.');
  return dot != NULL && strcmp(dot, ".npy") == 0;
}

static cf_status read_file(const cf_obstacles *all, cf_obstacle *o, double middle[3]) {
  const cf_scene_obstacle *k = o->keys;
  double low[3], high[3];
  if (!is_array(k->file)) {
    CF_TRY(cf_surface_read(k->file, &(cf_surface_place){&k->center, &k->half}, all->grid->h, 3, &o->samples,
                           low, high));
  } else {
    for (int a = 0; a < 3; ++a)
      low[a] = a < k->origin.count ? k->origin.value[a] : cf_grid_place(all->grid, a, 0, 0);
    CF_TRY(cf_surface_read_distances(k->file, o->dim, k->given.spacing ? k->spacing : all->grid->h, low,
                                     &o->samples));
    for (int a = 0; a < 3; ++a)
      high[a] = low[a] = a < o->dim ? low[a] : 0, high[a] += (o->samples.n[a] - 1) * o->samples.h;
  }
  for (int a = 0; a < 3; ++a) middle[a] = (low[a] + high[a]) / 2;
  return CF_OK;
}

/* The shape as given; `middle` becomes what it turns about if the scene says nothing else. */
static cf_status make_shape(const cf_obstacles *all, cf_obstacle *o, double middle[3]) {
  const cf_scene_obstacle *k = o->keys;
  double half[3], other[3], n[3];
  fill(&k->center, middle);
  fill(&k->half, half);
  fill(&k->end, other);
  for (int a = 0; a < 3; ++a)
    n[a] = a < k->normal.count ? k->normal.value[a] : k->normal.count == 0 && a == o->dim - 1;
  switch (k->shape) {
    case CF_OBSTACLE_BOX:
      o->inner = cf_shape_box(o->dim, middle, half);
      return CF_OK;
    case CF_OBSTACLE_CAPSULE:
      o->inner = cf_shape_capsule(middle, other, k->radius);
      return CF_OK;
    case CF_OBSTACLE_PLANE:
      o->inner = cf_shape_plane(middle, n);
      return CF_OK;
    case CF_OBSTACLE_EXPRESSION:
      o->inner = cf_shape_function(&k->distance.fn);
      return CF_OK;
    case CF_OBSTACLE_FILE:
      CF_TRY(read_file(all, o, middle));
      o->inner = cf_shape_sampled(&o->samples);
      return CF_OK;
    default:
      o->inner = cf_shape_sphere(middle, k->radius);
      return CF_OK;
  }
}

cf_status cf_obstacle_make(cf_obstacles *all, const int i) {
  cf_obstacle *o = &all->item[i];
  char key[64], sentence[CF_SENTENCE_MAX];
  double middle[3];
  o->keys = &all->scene->obstacles.item[i];
  o->dim = all->grid->box.dim;
  o->pose = cf_pose_at_rest();
  const cf_status s = make_shape(all, o, middle);
  if (s == CF_NO_MEMORY) return s;
  if (s != CF_OK) {
    snprintf(key, sizeof key, "obstacles.%d.file", i);
    snprintf(sentence, sizeof sentence, "%s", cf_status_sentence());
    return cf_scene_fail_at(all->scene, key, "%s: %s", key, sentence);
  }
  o->shape = o->keys->outside ? cf_shape_complement(&o->inner) : o->inner;
  make_motion(o, middle);
  all->changes = all->changes || o->changes;
  return CF_OK;
}
