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

struct cf_mesh;
struct cf_obstacles;

/* Where the time of a step goes; S(UPPER, as tables say it). */
#define CF_STAGE_LIST(S)      \
  S(ADVECT, "advection")      \
  S(PROJECT, "projection")    \
  S(DIFFUSE, "C-F diffusion") \
  S(FORCE, "forces") S(TRANSFER, "particles and grid") S(REACT, "phase change") S(OTHER, "other")
typedef enum cf_stage {
#define CF_STAGE_ENUM(upper, text) CF_STAGE_##upper,
  CF_STAGE_LIST(CF_STAGE_ENUM)
#undef CF_STAGE_ENUM
      CF_STAGES
} cf_stage;

/* What a step reports: solver work summed over its solves, the worst residual, and whether all converged. */
typedef struct cf_step_report {
  cf_solve_report solve;
  double seconds[CF_STAGES]; /* of the wall clock; what a model does not tell is 0 */
  int iterations[CF_STAGES]; /* of the solver, by stage */
  char warning[256];         /* "" or a sentence that the log should have (once) */
} cf_step_report;

/* Adds what one solve reports to a step's. */
void cf_step_report_add(cf_step_report *report, cf_stage stage, const cf_solve_report *solve);

/* Seconds of the wall clock since `from`, added to the stage; returns now. Start with from = cf_stage_clock(). */
double cf_stage_clock(void);
double cf_stage_end(cf_step_report *report, cf_stage stage, double from);

/* A cell field that is no state: worked out from it when a frame is written or somebody looks. */
typedef struct cf_derived {
  char name[CF_NAME_MAX], unit[CF_NAME_MAX];
} cf_derived;

/* Where `check` takes lines from a model: rows of the page ("tip", "radius 0.02 m"), and warnings. */
typedef struct cf_page {
  void (*row)(void *context, const char *name, const char *text);
  void (*warn)(void *context, const char *sentence);
  void *context;
} cf_page;

/* How a scalar diffuses: by its own plan (model/plan.h), in steps that the model takes with something else, or not by
 * what the scene says of scalars. */
typedef enum cf_scalar_law { CF_SCALAR_PLANNED, CF_SCALAR_COUPLED, CF_SCALAR_ELSEWHERE } cf_scalar_law;

typedef struct cf_model {
  const char *name, *summary;

  /* --- what it reads of a scene --- */

  /* The keys at the root of a scene that are this model's (others may read them too), NULL at the end. A key that
   * no model lists is everybody's; one that others list and this one does not is an error in its scenes. */
  const char *const *keys;

  /* The scalars it has, NULL at the end: `fields` may say more of these and of no others. NULL: those that the
   * scene names, phi if it names none. */
  const char *const *fields;

  /* What is written where output.fields is left out, NULL at the end. NULL: what stands in `fields`. */
  const char *const *outputs;

  /* Its own keys made complete and checked, after all others. CF_BAD_SCENE at the key. NULL: nothing to do. */
  cf_status (*resolve)(cf_scene *scene);

  /* Whether a run has something called `name` to show, beyond the scene's fields and their fluxes: velocity,
   * derived fields, particles. NULL: nothing. */
  bool (*shows)(const cf_scene *scene, const char *name);

  /* Bytes that a run needs at most, before anything is allocated. */
  double (*memory)(const cf_scene *scene);

  /* How scene->fields.item[field] diffuses, for `check`. NULL: every scalar by its plan. */
  cf_scalar_law (*law)(const cf_scene *scene, int field);

  /* Adds what `check` should say of its own keys; `dt` is the step that will be taken, s. NULL: nothing. */
  cf_status (*check)(const cf_scene *scene, double dt, const cf_page *page);

  /* --- what it does --- */

  /* Builds the state at time 0 and registers it. CF_BAD_SCENE (cf_scene_fail_at) for what only a grid can
   * tell. */
  cf_status (*create)(void **model, const cf_scene *scene, cf_registry *registry);
  void (*destroy)(void *model); /* NULL is fine */

  /* The state has been read back from a checkpoint: what is derived from it must follow. NULL: nothing is. */
  cf_status (*restored)(void *model);

  /* How far the box has moved along each axis since time 0, m. NULL: it stands still. */
  void (*moved)(const void *model, double by[3]);

  /* The step that `dt: auto` takes at time t, s. */
  double (*natural_dt)(const void *model, double t);

  /* A line about how it computes, for the log: false past the last. NULL: nothing to say. */
  bool (*describe)(const void *model, int line, char *text, size_t size);

  /* The state from t to t + dt. */
  cf_status (*step)(void *model, double t, double dt, cf_step_report *report);

  /* Fields that are no state: the i-th, false past the last; and its values now, into every cell of `out`. NULL:
   * there are none. */
  bool (*derived)(const void *model, int i, cf_derived *field);
  cf_status (*derive)(void *model, int i, cf_cell out);

  /* The obstacles on its grid, which frames have as the field `solid` (1 within, 0 without). NULL: it has none. */
  const struct cf_obstacles *(*obstacles)(const void *model);

  /* Fills what is derived and written besides fields: derived attributes of particles. Called before a frame is
   * written. NULL: there is nothing. */
  cf_status (*show)(void *model);

  /* The surface that a frame shows, in a mesh the caller made and will destroy. NULL: there is none. */
  cf_status (*mesh)(void *model, struct cf_mesh *mesh);

  /* Columns, fixed at creation, and their values now. */
  int (*metric_names)(const void *model, cf_metric *names);
  void (*metrics)(const void *model, double *values);
} cf_model;

#define CF_MODEL_EXTERN(upper, lower) extern const cf_model cf_model_##lower;
CF_MODEL_WORDS(CF_MODEL_EXTERN)
#undef CF_MODEL_EXTERN

/* By the index of the scene's word `model`; NULL past the last. */
const cf_model *cf_model_of(int word);

/* Whether the model reads the key `key` of a scene's root: it is in its list, or in nobody's. */
bool cf_model_reads(const cf_model *model, const char *key);

#endif
