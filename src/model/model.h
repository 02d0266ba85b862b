/* SPDX-License-Identifier: MIT
 *
 * A model couples equations into something the program can run. It is one const struct, listed once in
 * models.c; its state is what it puts into the registry, and nothing else.
 */
#ifndef CF_MODEL_MODEL_H
#define CF_MODEL_MODEL_H

#include "base/status.h"
#include "grid/registry.h"
#include "model/scene.h"
#include "solve/helmholtz.h"

/* What a step reports: solver work summed over its solves, the worst residual, and whether all converged. */
typedef struct cf_step_report {
  cf_solve_report solve;
  char warning[256]; /* "" or a sentence that the log should have (once) */
} cf_step_report;

typedef struct cf_model {
  const char *name, *summary;

  /* Builds the state at time 0 and registers it. CF_BAD_SCENE (cf_scene_fail_at) for what only a grid can
   * tell. */
  cf_status (*create)(void **model, const cf_scene *scene, cf_registry *registry);
  void (*destroy)(void *model); /* NULL is fine */

  /* The state has been read back from a checkpoint: what is derived from it must follow. NULL: nothing is. */
  cf_status (*restored)(void *model);

  /* The step that `dt: auto` takes at time t, s. */
  double (*natural_dt)(const void *model, double t);

  /* A line about how it computes, for the log: false past the last. NULL: nothing to say. */
  bool (*describe)(const void *model, int line, char *text, size_t size);

  /* The state from t to t + dt. */
  cf_status (*step)(void *model, double t, double dt, cf_step_report *report);

  /* Columns, fixed at creation, and their values now. */
  int (*metric_names)(const void *model, cf_metric *names);
  void (*metrics)(const void *model, double *values);
} cf_model;

extern const cf_model cf_model_tracer;

/* By the index of the scene's word `model`; NULL past the last. */
const cf_model *cf_model_of(int word);

#endif
