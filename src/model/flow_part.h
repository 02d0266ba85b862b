/* SPDX-License-Identifier: MIT
 *
 * What the files of model `flow` share:
 *
 *   flow.c          the step
 *   flow_create.c   making one
 *   flow_scene.c    its keys: completed, checked, and told by `check`
 *   flow_walls.c    walls and inlets as a scene gives them
 *   flow_solids.c   solid bodies
 *   flow_tell.c     metrics and derived fields
 */
#ifndef CF_MODEL_FLOW_PART_H
#define CF_MODEL_FLOW_PART_H

#include "grid/wall.h"
#include "model/drifters.h"
#include "model/obstacles.h"
#include "model/scalars.h"
#include "physics/confine.h"
#include "physics/force.h"
#include "physics/project.h"
#include "physics/viscosity.h"

typedef struct cf_flow {
  const cf_scene *scene;
  const cf_grid *grid;
  cf_scalars scalars;
  cf_flow_walls walls;
  bool walls_in_time;
  cf_advect_scheme scheme; /* of the velocity */
  cf_project *project;
  cf_force *force;         /* NULL: no buoyancy */
  cf_viscosity *viscosity; /* NULL: none */
  cf_confine *confine;     /* NULL: none */
  double *lift;            /* of each scalar */
  cf_face given;           /* flow.force */
  bool given_in_time;

  cf_face u, before; /* velocity now and a step ago */
  double last_dt;    /* between the two */
  cf_cell pressure;

  cf_face middle; /* velocity in the middle of the step: scratch */
  cf_face push;   /* acceleration, where viscosity wants it; scratch */
  double rate;    /* of u, for the length of the next step */

  cf_drifters points;

  cf_obstacles solids;
  cf_region *fluid,
      *felt; /* cells that are no solid; and what friction meets in those that are. NULL: no solids */
} cf_flow;

cf_status cf_flow_create(void **model, const cf_scene *scene, cf_registry *registry);
void cf_flow_destroy(void *model);
cf_status cf_flow_restored(void *model);
double cf_flow_natural_dt(const void *model, double t);

/* The rate at which u empties cells, as it is now. CF_NOT_FINITE. */
cf_status cf_flow_find_rate(cf_flow *m);

/* Regions for the equations; the solids at another time. CF_NO_MEMORY. */
cf_status cf_flow_make_solids(cf_flow *m);
cf_status cf_flow_solids_restored(cf_flow *m);
cf_status cf_flow_place(cf_flow *m, double t, double dt);

/* The known velocities on faces of closed walls and of solids. */
void cf_flow_hold(const cf_flow *m, cf_face u);

/* What carries points: the velocities of the step. */
cf_drift cf_flow_drift(const cf_flow *m);

/* The walls' velocities at time t. CF_BAD_SCENE: more comes in than goes out and no wall is open. */
cf_status cf_flow_walls_of_scene(cf_flow *m);
cf_status cf_flow_walls_at(cf_flow *m, double t);

cf_status cf_flow_resolve(cf_scene *scene);
cf_status cf_flow_check(const cf_scene *scene, double dt, const cf_page *page);
bool cf_flow_shows(const cf_scene *scene, const char *name);
double cf_flow_memory(const cf_scene *scene);

/* "y-": its axis and side; false: no wall has this name. */
bool cf_flow_side(const char *name, int *axis, int *side);

/* Given, or 9.81 along -y. */
void cf_flow_gravity(const cf_scene *scene, double g[3]);

bool cf_flow_derived(const void *model, int i, cf_derived *field);
cf_status cf_flow_derive(void *model, int i, cf_cell out);
int cf_flow_metric_names(const void *model, cf_metric *names);
void cf_flow_metrics(const void *model, double *values);
cf_status cf_flow_show(void *model);

#endif
