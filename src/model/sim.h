/* SPDX-License-Identifier: MIT
 *
 * A scene in motion: grid, registry, model and clock, without files. The functions are cf_sim_* of cattaneo.h;
 * here is what is inside, for those who write the state to files and read it back.
 */
#ifndef CF_MODEL_SIM_H
#define CF_MODEL_SIM_H

#include <stdbool.h>

#include "model/model.h"

struct cf_sim {
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
  int64_t retries; /* how often the step was halved after a failure; in the registry if time.retry is > 0 */

  cf_registry
      shown; /* what a frame may show: the state, and after cf_sim_show the derived fields asked for */
  cf_step_report report; /* of the latest step */
  char warning[512];     /* of the latest step: the model's, or that the solver stalled; "" */
};

/* After cf_checkpoint_read into sim->registry. */
cf_status cf_sim_restored(cf_sim *sim);

/* CF_NOT_FINITE, with the place and the likely cause, if any state is not finite. */
cf_status cf_sim_check_finite(const cf_sim *sim);

/* The values of the derived fields among output.fields and output.preview.field, as the state is now, in
 * sim->shown. */
cf_status cf_sim_show(cf_sim *sim);

#endif
