/* SPDX-License-Identifier: MIT
 *
 * The points of a scene that go with the flow (`points:`): one set of particles, "points", with
 *
 *     id          never used twice
 *     position
 *     born        the time at which it came, s
 *     source      which entry of `points` it is from, where there are several
 *     velocity    in frames only
 *
 * A model with a velocity makes them, registers them, and moves them once a step:
 *
 *     cf_drifters_create(&d, scene, grid);
 *     cf_drifters_start(&d, flow, registry);          // the points of time 0
 *     cf_drifters_step(&d, flow, t, dt);              // flow: the velocities of the step (physics/drift.h)
 *
 * Where points begin is a matter of counted random numbers and of the time alone, so a stop changes nothing. Points
 * born within a step are carried for the rest of it: what comes out of a hole is a stream, not a row of puffs.
 */
#ifndef CF_MODEL_DRIFTERS_H
#define CF_MODEL_DRIFTERS_H

#include "grid/registry.h"
#include "model/model.h"
#include "model/obstacles.h"
#include "physics/drift.h"

typedef struct cf_drifters {
  const cf_scene *scene;
  const cf_grid *grid;
  const cf_obstacles *solids; /* NULL: none; a point that has come into one is put back on its surface */
  cf_particles *set;          /* NULL: the scene has none, and nothing below does anything */
  int born, source, velocity; /* attributes; source: -1 */
  /* state: */
  int64_t moves; /* so far */
  double time;   /* where they are now */
  double left;   /* how many have gone out */
  double *given; /* by the rate of each entry */
} cf_drifters;

/* CF_NO_MEMORY, CF_BAD_SCENE; cf_drifters_destroy cleans up after any failure. */
cf_status cf_drifters_create(cf_drifters *d, const cf_scene *scene, const cf_grid *g);
void cf_drifters_destroy(cf_drifters *d);

/* Those that are there at time 0; registers the state. CF_BAD_SCENE: a region without a place for them. */
cf_status cf_drifters_start(cf_drifters *d, cf_registry *registry);

/* From t to t + dt: moves those there are, removes those that have left, adds those that come. */
cf_status cf_drifters_step(cf_drifters *d, const cf_drift *flow, double t, double dt);

/* The derived velocity, for a frame. */
void cf_drifters_show(const cf_drifters *d, const cf_drift *flow);

/* "points", and how many there are now. */
int cf_drifters_metric_names(const cf_drifters *d, cf_metric *names);
int cf_drifters_metrics(const cf_drifters *d, double *values);

/* Checks the entries of `points`. CF_BAD_SCENE. */
cf_status cf_drifters_resolve(const cf_scene *scene);

/* Whether output may name it: points, points.ATTRIBUTE. */
bool cf_drifters_shows(const cf_scene *scene, const char *name);

/* What `check` says of them; bytes that they need, as far as that can be known. */
void cf_drifters_check(const cf_scene *scene, const cf_page *page);
double cf_drifters_memory(const cf_scene *scene);

#endif
