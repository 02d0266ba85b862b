/* SPDX-License-Identifier: MIT
 *
 * A scene in motion: grid, registry, model and clock, without files. cf_sim_step takes one step; steps are
 * shortened to land exactly on the times of frames and on the end.
 *
 *     frame i is at i/frames for i/frames <= end; if end is no such time it is one more frame. frames = 0:
 * the start and the end only. A remainder below 1e-9 dt is no step.
 */
#ifndef CF_MODEL_SIM_H
#define CF_MODEL_SIM_H

#include <stdbool.h>

#include "model/model.h"

typedef struct cf_sim {
  const cf_scene *scene;
  const cf_model *model;
  void *state; /* of the model */
  cf_grid grid;
  cf_registry registry;
  double end; /* of this run: the scene's, or an earlier one asked for */

  /* the clock; in the registry */
  double time, dt; /* dt: of the latest step, 0 before the first */
  int64_t step;    /* steps taken */
  int64_t frame;   /* frames reached; frame 0 is the start */

  cf_step_report report; /* of the latest step */
} cf_sim;

/* `scene` must outlive it. threads >= 1. */
cf_status cf_sim_create(cf_sim **sim, const cf_scene *scene, int threads);
void cf_sim_destroy(cf_sim *sim); /* NULL is fine */

/* After cf_checkpoint_read into sim->registry. */
cf_status cf_sim_restored(cf_sim *sim);

bool cf_sim_finished(const cf_sim *sim);

/* One step. CF_NOT_FINITE names field and cell; CF_NOT_CONVERGED only where the scene says `on_stall: stop`.
 * *on_frame: the state is now that of frame sim->frame. */
cf_status cf_sim_step(cf_sim *sim, bool *on_frame);

/* The number of frames of the whole run, start included, and the time of frame i. */
int64_t cf_sim_frames(const cf_sim *sim);
double cf_sim_frame_time(const cf_sim *sim, int64_t i);

/* Columns of metrics.csv: step, time, dt, iterations, residual, then the model's. */
int cf_sim_metric_names(const cf_sim *sim, cf_metric *names);
void cf_sim_metrics(const cf_sim *sim, double *values);

#endif
