/* SPDX-License-Identifier: MIT
 *
 * The tracer model's state: what tracer_create.c makes and tracer.c steps.
 */
#ifndef CF_MODEL_TRACER_PART_H
#define CF_MODEL_TRACER_PART_H

#include "model/model.h"
#include "model/plan.h"
#include "model/sources.h"
#include "physics/advect.h"
#include "physics/diffuse.h"

enum { CF_TRACER_ADVECT_SCHEMES = 4 };

typedef struct cf_tracer_scalar {
  char name[CF_NAME_MAX], flux[CF_NAME_MAX];
  int field; /* in scene->fields */
  cf_cell phi;
  cf_face q; /* one of q and s = div q is there (cf_plan) */
  cf_cell s;
  cf_walls walls, memory_walls; /* memory_walls: s flows in as 0 */
  cf_diffuse *diffuse;
  cf_sources *sources;
  cf_ledger ledger;
  const cf_scene_diffusion *scene;
  cf_plan plan;
  double D;               /* the largest k/C */
  bool paper, has_memory; /* has_memory: the flux at the end of a step matters to the next one */
} cf_tracer_scalar;

typedef struct cf_tracer {
  const cf_scene *scene;
  const cf_grid *grid;
  int count;
  cf_tracer_scalar *scalar;
  bool moves, velocity_in_time;
  double through_walls; /* largest velocity that stood on an insulated wall */
  cf_face u;
  cf_advect *by_scheme[CF_TRACER_ADVECT_SCHEMES]; /* by cf_advect_scheme, made where needed */
  double *rows;
} cf_tracer;

cf_status cf_tracer_create(void **model, const cf_scene *scene, cf_registry *registry);
void cf_tracer_destroy(void *model);
double cf_tracer_natural_dt(const void *model, double t);
double cf_tracer_memory(const cf_scene *scene);

cf_status cf_tracer_set_velocity(cf_tracer *m, double t);
cf_advect_scheme cf_tracer_advection(const cf_tracer *m, const cf_tracer_scalar *s);

#endif
