/* SPDX-License-Identifier: MIT
 *
 * A scene given as text, run to its end without a folder.
 */
#ifndef CF_TESTS_SCENE_RUN_H
#define CF_TESTS_SCENE_RUN_H

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "folders.h"
#include "model/sim.h"
#include "testing.h"

typedef struct scene_run {
  cf_scene *scene;
  cf_sim *sim;
} scene_run;

/* The path of a file with that text. */
static inline const char *scene_path(const char *name, const char *text) {
  static char path[1024];
  const char *folder = folder_fresh(name);
  file_write(folder, "scene.yaml", text);
  snprintf(path, sizeof path, "%s/scene.yaml", folder);
  return path;
}

static inline void scene_open(scene_run *r, const char *name, const char *text, const int threads) {
  OK(cf_scene_read(&r->scene, scene_path(name, text), 0, NULL));
  OK(cf_sim_create(&r->sim, r->scene, threads));
}

static inline void scene_close(scene_run *r) {
  cf_sim_destroy(r->sim);
  cf_scene_destroy(r->scene);
}

/* What the model says of scalar `line`. */
static inline const char *scene_says(const scene_run *r, const int line) {
  static char text[512];
  if (!r->sim->model->describe(r->sim->state, line, text, sizeof text)) text[0] = '\0';
  return text;
}

/* The metric of that name, now. */
static inline double scene_metric(const scene_run *r, const char *name) {
  cf_metric names[CF_METRICS_MAX];
  double values[CF_METRICS_MAX];
  const int count = cf_sim_metric_names(r->sim, names);
  cf_sim_metrics(r->sim, values);
  for (int i = 0; i < count; ++i)
    if (strcmp(names[i].name, name) == 0) return values[i];
  fail_msg("no metric %s", name);
  return NAN;
}

/* phi at a place in the plane, from the 4 x 4 cells around it (Lagrange, third order). */
static inline double scene_at(const scene_run *r, const double x, const double y) {
  cf_view v;
  OK(cf_sim_field(r->sim, "phi", 0, &v));
  const double at[2] = {(x - v.place[0]) / v.h, (y - v.place[1]) / v.h};
  double weight[2][4], sum = 0;
  int low[2];
  for (int a = 0; a < 2; ++a) {
    const double f = at[a] - floor(at[a]);
    low[a] = (int)floor(at[a]) - 1;
    weight[a][0] = -f * (f - 1) * (f - 2) / 6;
    weight[a][1] = (f + 1) * (f - 1) * (f - 2) / 2;
    weight[a][2] = -(f + 1) * f * (f - 2) / 2;
    weight[a][3] = (f + 1) * f * (f - 1) / 6;
    assert_true(low[a] >= 0 && low[a] + 3 < v.shape[a]);
  }
  for (int j = 0; j < 4; ++j)
    for (int i = 0; i < 4; ++i)
      sum +=
          weight[0][i] * weight[1][j] * (double)v.at[(low[0] + i) * v.stride[0] + (low[1] + j) * v.stride[1]];
  return sum;
}

#endif
