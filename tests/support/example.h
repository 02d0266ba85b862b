/* SPDX-License-Identifier: MIT
 *
 * Runs the scene file of an example, without its folder, so that no parameter of a check can differ from it; and
 * samples its fields.
 */
#ifndef CF_TESTS_EXAMPLE_H
#define CF_TESTS_EXAMPLE_H

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "cattaneo.h"
#include "reference.h"
#include "testing.h"

typedef struct example {
  cf_scene *scene;
  cf_sim *sim;
} example;

/* Opens examples/PATH; `set` (NULL ends it) are overrides, NULL where there are none. */
static inline example example_open(const char *file, const char *const *set) {
  char path[512];
  int count = 0;
  example e;
  while (set != NULL && set[count] != NULL) ++count;
  snprintf(path, sizeof path, "%s/examples/%s", CF_SOURCE_DIR, file);
  OK(cf_scene_read(&e.scene, path, count, set));
  OK(cf_sim_create(&e.sim, e.scene, 2));
  return e;
}

static inline void example_run(const example *e, const double until) {
  OK(cf_sim_run(e->sim, until, NULL, NULL));
}

static inline void example_close(example *e) {
  cf_sim_destroy(e->sim);
  cf_scene_destroy(e->scene);
}

static inline cf_view example_field(const example *e, const char *name, const int component) {
  cf_view v;
  OK(cf_sim_field(e->sim, name, component, &v));
  return v;
}

static inline double view_at(const cf_view *v, const int i, const int j, const int k) {
  return (double)v->at[i * v->stride[0] + j * v->stride[1] + k * v->stride[2]];
}

/* Cubic interpolation along an axis through the line of values (i, j, k); x in m. */
static inline double view_along(const cf_view *v, const int axis, const double x, const int i, const int j,
                                const int k) {
  int at[3] = {i, j, k};
  const double place = (x - v->place[axis]) / v->h;
  int low = (int)floor(place) - 1;
  if (low < 0) low = 0;
  if (low > v->shape[axis] - 4) low = v->shape[axis] - 4;
  const double s = place - low - 1;
  const double w[4] = {-s * (s - 1) * (s - 2) / 6, (s + 1) * (s - 1) * (s - 2) / 2,
                       -(s + 1) * s * (s - 2) / 2, (s + 1) * s * (s - 1) / 6};
  double sum = 0;
  for (int n = 0; n < 4; ++n) {
    at[axis] = low + n;
    sum += w[n] * view_at(v, at[0], at[1], at[2]);
  }
  return sum;
}

/* In the plane. */
static inline double view_in_plane(const cf_view *v, const double x, const double y) {
  const double place = (y - v->place[1]) / v->h;
  int low = (int)floor(place) - 1;
  if (low < 0) low = 0;
  if (low > v->shape[1] - 4) low = v->shape[1] - 4;
  const double s = place - low - 1;
  const double w[4] = {-s * (s - 1) * (s - 2) / 6, (s + 1) * (s - 1) * (s - 2) / 2,
                       -(s + 1) * s * (s - 2) / 2, (s + 1) * s * (s - 1) / 6};
  double sum = 0;
  for (int n = 0; n < 4; ++n) sum += w[n] * view_along(v, 0, x, 0, low + n, 0);
  return sum;
}

static inline double view_x(const cf_view *v, const int axis, const int i) {
  return v->place[axis] + i * v->h;
}

/* A column of the metrics by its name. */
static inline double example_metric(const example *e, const char *name) {
  static cf_metric names[CF_METRICS_MAX];
  static double values[CF_METRICS_MAX];
  const int count = cf_sim_metric_names(e->sim, names);
  cf_sim_metrics(e->sim, values);
  for (int i = 0; i < count; ++i)
    if (strcmp(names[i].name, name) == 0) return values[i];
  fail_msg("no metric %s", name);
  return NAN;
}

#endif
