/* SPDX-License-Identifier: MIT
 *
 * The phase model's state, and what its files share.
 *
 *   phase.c          a step
 *   phase_create.c   making it
 *   phase_scene.c    its keys beyond their table, and what `check` says
 *   phase_seeds.c    seeds, orientations, masks
 *   phase_maps.c     those of them that are pictures and arrays
 *   phase_noise.c    noise
 *   phase_move.c     the flow that carries phase and heat, and the window
 *   phase_show.c     derived fields, the surface, metrics
 */
#ifndef CF_MODEL_PHASE_PART_H
#define CF_MODEL_PHASE_PART_H

#include "model/model.h"
#include "model/sources.h"
#include "physics/advect.h"
#include "physics/diffuse.h"
#include "physics/phase.h"

/* What may be a picture or an array instead of an expression. */
enum { CF_CRYSTAL_MASK, CF_CRYSTAL_DISTANCE, CF_CRYSTAL_ANGLE, CF_CRYSTAL_STRENGTH, CF_CRYSTAL_MAPS };

typedef struct cf_crystal_map {
  int n[3];
  double origin[3], per_part[3]; /* parts a metre */
  bool nearest;
  float *value; /* x fastest; NULL: there is no such map */
} cf_crystal_map;

typedef struct cf_crystal {
  const cf_scene *scene;
  cf_grid still;          /* where the box was at time 0, as the physics knows it */
  const cf_grid *grid;    /* that one */
  int eta_field, T_field; /* in scene->fields */
  cf_phase_params params;
  bool scheduled; /* some of them depend on t */
  cf_phase_walls walls;
  cf_phase *phase;
  bool implicit;
  int order; /* of explicit steps */
  char why[160];
  cf_phase_state y;
  cf_phase_places places;
  cf_crystal_map map[CF_CRYSTAL_MAPS];
  cf_cell grain,
      next_grain;   /* which seed a cell froze from, from 1; 0: none. Where crystals have their own angles */
  cf_cell arrival;  /* when eta passed 1/2, s; -1: it has not */
  double centre[3]; /* of the first seed, before the window moved */
  cf_ledger heat;   /* of T - K eta */

  /* implicit steps, and what acts on T */
  cf_diffuse *diffuse;
  cf_sources *sources;
  cf_source acts;
  cf_cell W, h_now, h_before;
  double dt_before;

  /* the flow, and the window */
  cf_advect *carry;
  cf_face u;
  bool moves, velocity_in_time;
  cf_walls carried_eta, carried_T, carried_memory;
  double passed; /* largest velocity that stood on an insulated wall */
  int window_axis, window_side;
  double window_cells; /* that it has moved by */
  int64_t noise_of;    /* the period that places.noise is of; -1: none yet */
  const double *now;   /* the clock */
  double *rows;
} cf_crystal;

/* --- seeds and places ------------------------------------------------------------------------------------- */

cf_status cf_crystal_seed(cf_crystal *m);        /* eta, T, r, w, grain, arrival at time 0 */
cf_status cf_crystal_make_places(cf_crystal *m); /* orientation, strength, mask */
void cf_crystal_grow_grains(cf_crystal *m);      /* cells that have begun to freeze take their neighbour's */
void cf_crystal_turn(cf_crystal *m);             /* C and S of the grains */
void cf_crystal_note_arrival(cf_crystal *m, double t); /* cells that passed 1/2 until t */
double cf_crystal_far_T(const cf_crystal *m);          /* what T comes in with */
void cf_crystal_make_noise(cf_crystal *m, double t);
double cf_crystal_centre(const cf_crystal *m, int axis); /* in the box as it is now */
cf_grid cf_crystal_window(const cf_crystal *m);          /* the grid where the box is now */

bool cf_crystal_has_map(const cf_scene *scene, int which);
bool cf_crystal_is_constant(const cf_scene *scene, int which); /* one number everywhere */
/* Into zeroed maps; CF_BAD_SCENE at the key of a file that cannot be read. */
cf_status cf_crystal_read_maps(const cf_scene *scene, cf_crystal_map map[CF_CRYSTAL_MAPS]);
void cf_crystal_drop_maps(cf_crystal_map map[CF_CRYSTAL_MAPS]);
cf_fn cf_crystal_map_fn(const cf_crystal *m, int which); /* the map, or the expression where there is none */

/* --- flow and window -------------------------------------------------------------------------------------- */

cf_status cf_crystal_make_flow(cf_crystal *m);
cf_status cf_crystal_set_flow(cf_crystal *m, double t);
cf_status cf_crystal_move(cf_crystal *m, double t, double dt, cf_step_report *report);
cf_status cf_crystal_follow(cf_crystal *m);

/* --- the rest --------------------------------------------------------------------------------------------- */

cf_status cf_crystal_create(void **model, const cf_scene *scene, cf_registry *registry);
void cf_crystal_destroy(void *model);
cf_phase_params cf_crystal_params_at(const cf_scene *scene, double t);
bool cf_crystal_is_scheduled(const cf_scene *scene);
double cf_crystal_natural_dt(const void *model, double t);
/* The step of `dt: auto` with these numbers, and substeps of explicit steps. */
double cf_crystal_step_of(const cf_phase_limits *l, double cfl);
int cf_crystal_substeps(const cf_phase_limits *l, double dt);

cf_status cf_crystal_resolve(cf_scene *scene);
cf_status cf_crystal_check(const cf_scene *scene, double dt, const cf_page *page);
bool cf_crystal_shows(const cf_scene *scene, const char *name);
cf_scalar_law cf_crystal_law(const cf_scene *scene, int field);
double cf_crystal_memory(const cf_scene *scene);

bool cf_crystal_derived(const void *model, int i, cf_derived *field);
cf_status cf_crystal_derive(void *model, int i, cf_cell out);
cf_status cf_crystal_mesh(void *model, struct cf_mesh *mesh);
int cf_crystal_metric_names(const void *model, cf_metric *names);
void cf_crystal_metrics(const void *model, double *values);

#endif
