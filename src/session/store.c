/* SPDX-License-Identifier: MIT
 *
 * Saving a simulation into a file and loading it again, for those who use the library: a checkpoint as
 * io/checkpoint.h writes it, together with the resolved scene, by which a file of another scene is known.
 */
#include <stdio.h>
#include <string.h>

#include "io/checkpoint.h"
#include "model/sim.h"

cf_status cf_sim_save(const cf_sim *sim, const char *path) {
  char *scene;
  CF_TRY(cf_scene_write(sim->scene, &scene));
  const cf_stamp stamp = {.title = sim->scene->title, .scene = scene, .time = sim->time, .step = sim->step};
  const cf_status s = cf_checkpoint_write_to(path, &sim->registry, &stamp);
  cf_free(scene);
  return s;
}

static cf_status check_scene(const cf_sim *sim, const char *path) {
  cf_checkpoint_facts facts;
  char *saved, *ours;
  CF_TRY(cf_checkpoint_describe(path, &facts, &saved));
  cf_status s = cf_scene_write(sim->scene, &ours);
  if (s != CF_OK) {
    cf_free(saved);
    return s;
  }
  if (saved == NULL || strcmp(saved, ours) != 0)
    s = cf_fail(CF_BAD_FILE,
                "%s: belongs to another scene (\"%.200s\", step %lld): if it is this run's, put the scene "
                "(of a folder: "
                "run.yaml) back as it was; else start a new run in another folder",
                path, facts.title, (long long)facts.step);
  cf_free(saved);
  cf_free(ours);
  return s;
}

cf_status cf_sim_load(cf_sim *sim, const char *path) {
  CF_TRY(check_scene(sim, path));
  CF_TRY(cf_checkpoint_read(path, &sim->registry));
  memset(&sim->report, 0, sizeof sim->report);
  sim->warning[0] = '\0';
  return cf_sim_restored(sim);
}
