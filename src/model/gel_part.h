/* SPDX-License-Identifier: MIT
 *
 * The gel's state: gel_create.c makes it, with particles from gel_bodies.c; gel.c steps it, gel_show.c shows it,
 * gel_scene.c checks its keys.
 */
#ifndef CF_MODEL_GEL_PART_H
#define CF_MODEL_GEL_PART_H

#include "grid/mesh.h"
#include "model/model.h"
#include "model/obstacles.h"
#include "physics/mpm.h"
#include "physics/poro.h"

/* Cells around the domain that the lattice of the particles has besides: nodes beyond walls, blocks that align. */
#define CF_GEL_MARGIN 8
/* The lattice's cells an axis where there are no walls. */
#define CF_GEL_UNBOUNDED(dim) ((dim) == 3 ? 1024 : 8192)

typedef struct cf_gel {
  const cf_scene *scene;
  const cf_scene_gel *keys;
  const cf_grid *grid; /* the domain */
  cf_grid lattice;     /* around it */
  int offset[3];       /* of the domain's first cell in the lattice */
  cf_particles *set;
  cf_mpm_attributes at;
  int saturation, jacobian, stress; /* attributes that only frames have */
  cf_mpm_material *material;        /* one a body */
  cf_obstacles solids;
  cf_mpm_obstacle *obstacle;     /* walls first, then those of the scene */
  cf_shape *shape, *place, *dry; /* of walls, of water */
  cf_poro_source *source;
  int obstacles, sources;
  cf_mpm *mpm;
  cf_poro *poro;         /* NULL: no water moves */
  cf_cell on_lattice[3]; /* fill, saturation, J: where surfaces are made */
  double *given;         /* by each source */
  cf_ledger water;
  double *filter_due, *eta; /* of each body: the exponent that the filter has not had yet, and what follows */
} cf_gel;

cf_status cf_gel_create(void **model, const cf_scene *scene, cf_registry *registry);
void cf_gel_destroy(void *model);

/* gel_bodies.c: the particles of all bodies, with materials and water. */
cf_status cf_gel_fill(cf_gel *g);
/* How many there will be, roughly. */
double cf_gel_count(const cf_scene *scene);

/* gel_scene.c */
cf_status cf_gel_resolve(cf_scene *scene);
double cf_gel_room(const cf_scene *scene); /* for so many particles, split ones among them */
double cf_gel_memory(const cf_scene *scene);
cf_status cf_gel_check(const cf_scene *scene, double dt, const cf_page *page);
cf_mpm_material cf_gel_material(const cf_scene *scene, int body);
cf_status cf_gel_lattice(const cf_scene *scene, cf_grid *lattice, int offset[3]);

/* gel_bend.c: the curvature of the first body, 1/m. */
double cf_gel_curvature(const cf_gel *g);

/* gel_show.c */
bool cf_gel_shows(const cf_scene *scene, const char *name);
bool cf_gel_derived(const void *model, int i, cf_derived *field);
cf_status cf_gel_derive(void *model, int i, cf_cell out);
cf_status cf_gel_show(void *model);
cf_status cf_gel_mesh(void *model, struct cf_mesh *mesh);
bool cf_gel_describe(const void *model, int line, char *text, size_t size);
int cf_gel_metric_names(const void *model, cf_metric *names);
void cf_gel_metrics(const void *model, double *values);

#endif
