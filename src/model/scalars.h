/* SPDX-License-Identifier: MIT
 *
 * The scalars of a scene: any number, each with its own diffusion, walls, sources and ledger, and how a medium
 * that moves carries them. What moves the medium is the model's: prescribed (tracer.c) or computed (flow.c).
 *
 *     cf_scalars_create(&s, scene, grid);             // the fields, and the largest diffusivity of each
 *     cf_scalars_carry(&s);                           // if the medium moves
 *     cf_scalars_set_velocity(&s, u);
 *     cf_scalars_make(&s, dt, registry);              // plans for steps of about dt, initial values, state
 *
 * With obstacles (s.obstacles set before, and placed) everything goes around them. Where they move, call
 * cf_scalars_place at the end of a step after cf_obstacles_place, and cf_scalars_restored after a state was read back.
 *
 * and a step is Strang's, cf_scalars_move over dt/2, cf_scalars_diffuse over dt, cf_scalars_move over dt/2; those with
 * `scheme: paper` take Lie's, the whole move first.
 */
#ifndef CF_MODEL_SCALARS_H
#define CF_MODEL_SCALARS_H

#include "grid/rim.h"
#include "grid/sweep.h"
#include "model/model.h"
#include "model/obstacles.h"
#include "model/plan.h"
#include "model/sources.h"
#include "physics/advect.h"
#include "physics/diffuse.h"

enum { CF_ADVECT_SCHEMES = 4, CF_SCALAR_METRICS = 4 };

typedef struct cf_scalar {
  char name[CF_NAME_MAX], flux[CF_NAME_MAX];
  int field; /* in scene->fields */
  cf_cell phi;
  cf_face q; /* one of q and s = div q is there (cf_plan) */
  cf_cell s;
  cf_walls walls;                 /* what diffusion meets */
  cf_walls carried, carried_flux; /* what the flow meets; s flows in as 0 */
  bool passes;                    /* the flow takes it through walls that are insulated for diffusion */
  cf_region *region;              /* where it may be; NULL: in the whole box */
  cf_diffuse *diffuse;
  cf_sources *sources;
  cf_ledger ledger;
  double before; /* scratch: content before obstacles moved */
  const cf_scene_diffusion *scene;
  cf_plan plan;
  double D;               /* the largest k/C */
  bool paper, has_memory; /* has_memory: the flux at the end of a step matters to the next one */
} cf_scalar;

typedef struct cf_scalars {
  const cf_scene *scene;
  const cf_grid *grid;
  cf_grid part;     /* where they are computed: all of the grid, or a part of it with the same strides */
  ptrdiff_t corner; /* that part's first cell, in the whole */
  bool follows;     /* the part follows them (scalars_part.c) */
  int count;
  cf_scalar *item;
  const cf_obstacles *obstacles; /* the model's; NULL: there are none */
  cf_region *solid;              /* every obstacle a wall; NULL: there are none */
  cf_rim rim;                    /* of `solid` */
  bool moves;
  cf_advect *by_scheme[CF_ADVECT_SCHEMES]; /* by cf_advect_scheme, made where needed */
  double *rows;
} cf_scalars;

/* A zeroed `s` gets its fields. CF_BAD_SCENE, CF_NO_MEMORY; cf_scalars_destroy cleans up after any failure. */
cf_status cf_scalars_create(cf_scalars *s, const cf_scene *scene, const cf_grid *g);
void cf_scalars_destroy(cf_scalars *s);

/* Makes what moves them: the schemes that the scalars use, and this one more (-1: none). */
cf_status cf_scalars_carry(cf_scalars *s, int more);

/* The flow passes through this wall of the domain: what diffusion is insulated from may still flow out, and 0 flows
 * in. Before cf_scalars_make. */
void cf_scalars_open(cf_scalars *s, int axis, int side);

/* The velocity that the next moves are with. CF_NOT_FINITE. */
cf_status cf_scalars_set_velocity(cf_scalars *s, cf_face u);

/* Initial values and plans; registers fields, fluxes and ledgers. CF_BAD_SCENE, CF_NO_MEMORY. */
cf_status cf_scalars_make(cf_scalars *s, double dt, cf_registry *registry);

/* Registers the parities of sweeps. */
cf_status cf_scalars_register_moves(const cf_scalars *s, cf_registry *registry);

/* 1/dt that diffusion asks for at a Courant number of 1, and the step that follows with the flow's own rate. */
double cf_scalars_rate(const cf_scalars *s);
double cf_scalars_natural_dt(const cf_scalars *s, double flow_rate);

/* Moves the scalars that are (not) the paper's over [t, t + dt]. `begun` says which schemes have begun this step. */
cf_status cf_scalars_move(cf_scalars *s, bool paper, double t, double dt, bool begun[CF_ADVECT_SCHEMES]);

/* Before anything else in a step of dt: the part of the box that it will be computed in, if that follows the scalars; what
 * is cut off is booked as having left. CF_NO_MEMORY. */
cf_status cf_scalars_follow(cf_scalars *s, double dt);

/* The share of the box that is computed. */
double cf_scalars_share(const cf_scalars *s);

/* --- obstacles (scalars_around.c) */

/* The obstacles stand elsewhere. A cell that one has come into is gone with what was in it; one that it has left gets
 * the mean of its neighbours: the ledger counts both. CF_NO_MEMORY. */
cf_status cf_scalars_place(cf_scalars *s);

/* The same for a state that was read back: nothing is lost or gained. */
cf_status cf_scalars_restored(cf_scalars *s);

/* Regions of all scalars, and of one; sum, least and largest value of the cells that are in no obstacle. */
cf_status cf_scalars_make_solid(cf_scalars *s);
cf_status cf_scalars_make_region(const cf_scalars *s, cf_scalar *i);
cf_range cf_scalars_range_around(const cf_scalars *s, const cf_scalar *i);

/* Diffusion and sources of all of them over [t, t + dt]. */
cf_status cf_scalars_diffuse(cf_scalars *s, double t, double dt, cf_step_report *report);

/* sum, min, max and error of each. */
bool cf_scalars_describe(const cf_scalars *s, int line, char *text, size_t size);
int cf_scalars_metric_names(const cf_scalars *s, cf_metric *names);
void cf_scalars_metrics(const cf_scalars *s, double *values);

/* Fields of the box that they will need at most, in elements a cell, advection's scratch included. */
double cf_scalars_memory(const cf_scene *scene);

/* Zero again where diffusion has written ghosts beside the part. */
void cf_scalars_clear_ghosts(const cf_scalars *s);

/* The walls of a field for the part that is computed: its own where the part ends at the box, `inside` elsewhere. */
cf_walls cf_scalars_ends(const cf_scalars *s, const cf_walls *walls, cf_wall inside);

/* For scalars_part.c: diffusion and sources of one scalar on s->part, afresh. */
cf_status cf_scalars_make_diffuse(const cf_scalars *s, cf_scalar *one);

/* Whether scalars may be computed in a part of the box; CF_BAD_SCENE: asked for, but something speaks against it. */
cf_status cf_scalars_may_follow(const cf_scalars *s, bool *may);

/* Bytes of so many fields, and what a run needs besides. */
double cf_scalars_bytes(const cf_scene *scene, double fields);

/* What carries a scalar; a word of `advection.scheme` as the enumeration that physics knows. */
cf_advect_scheme cf_scalars_scheme(int word);

#endif
