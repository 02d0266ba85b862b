/* SPDX-License-Identifier: MIT
 *
 * The snowfall's state: what snowfall_create.c makes and snowfall.c steps.
 */
#ifndef CF_MODEL_SNOWFALL_PART_H
#define CF_MODEL_SNOWFALL_PART_H

#include "grid/particles.h"
#include "grid/shape.h"
#include "model/atlas.h"
#include "model/model.h"
#include "model/obstacles.h"
#include "physics/flake.h"
#include "physics/gust.h"
#include "physics/snowpack.h"

/* Attributes, by their number in their set; `position` is 0 in each. */
enum { CF_FLAKE_VELOCITY = 1, CF_FLAKE_ORIENTATION, CF_FLAKE_SPIN, CF_FLAKE_RADIUS, CF_FLAKE_KIND };
enum { CF_SETTLED_ORIENTATION = 1, CF_SETTLED_RADIUS, CF_SETTLED_KIND };
enum { CF_GROUND_BASE = 1, CF_GROUND_DEPTH };

/* Masses of flakes, kg: entered (with those there at first), and gone out through the top. What landed is in the
 * layer. */
typedef struct cf_snow_ledger {
  double entered, left;
} cf_snow_ledger;

typedef struct cf_snowfall {
  const cf_scene *scene;
  const cf_scene_snowfall *keys;
  const cf_grid *grid;
  cf_atlas *atlas;
  cf_atlas_shape *shape; /* of its flakes */
  cf_air air;
  cf_gust gust;
  double low[3], high[3]; /* the box */
  cf_particles *flakes;   /* in the air */
  cf_particles *settled;  /* lying on the layer, or on the sides of obstacles */
  cf_particles *ground;   /* a point a column: its top, with `base` and `depth` */
  cf_snowpack pack;       /* on the arrays of `ground` */
  cf_real *change;
  cf_obstacles obstacles;
  cf_snow_ledger ledger;
  double landed; /* flakes that have, by number */
} cf_snowfall;

cf_status cf_snowfall_create(void **model, const cf_scene *scene, cf_registry *registry);
void cf_snowfall_destroy(void *model);
cf_status cf_snowfall_resolve(cf_scene *scene);
double cf_snowfall_memory(const cf_scene *scene);

/* Points the layer at the arrays of `ground`. */
void cf_snowfall_bind(cf_snowfall *s);

/* n new flakes: anywhere in the box above the ground, or at its top. */
cf_status cf_snowfall_add(cf_snowfall *s, int64_t n, bool at_top);

/* What the flake with that id, kind and radius is. */
void cf_snowfall_flake(const cf_snowfall *s, int64_t id, int kind, double radius, cf_flake *flake);

double cf_snowfall_mass_in_air(const cf_snowfall *s);

/* snowfall_show.c: of cf_model. */
bool cf_snowfall_shows(const cf_scene *scene, const char *name);
bool cf_snowfall_derived(const void *model, int i, cf_derived *field);
cf_status cf_snowfall_derive(void *model, int which, cf_cell out);
cf_status cf_snowfall_mesh(void *model, struct cf_mesh *mesh);
bool cf_snowfall_describe(const void *model, int line, char *text, size_t size);
int cf_snowfall_metric_names(const void *model, cf_metric *names);
void cf_snowfall_metrics(const void *model, double *values);

#endif
