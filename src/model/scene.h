/* SPDX-License-Identifier: MIT
 *
 * The scene: every key a scene file may have, once, in the tables below; and the struct that comes of it.
 *
 * cf_scene_read gives a resolved scene: what was left out has its default, fields.NAME.diffusion and
 * fields.NAME.walls are complete for every scalar, front_speed and its kin have become k, tau and f_t, lists that go
 * by axis have one entry an axis, and everything that can be checked without a grid has been checked. So the
 * program reads scene->fields.item[i].diffusion.k and never asks what was given.
 *
 * Checks that need more (does dt suit the scheme? is there memory?) are made higher up and report at the
 * place of the key with cf_scene_fail_at.
 *
 * Rows: P(name, type, default, unit, range, meaning), R(kind, name, struct, meaning); see base/param.h.
 */
#ifndef CF_MODEL_SCENE_H
#define CF_MODEL_SCENE_H

#include <stdbool.h>
#include <stdio.h>

#include "base/param.h"
#include "base/status.h"
#include "cattaneo.h"
#include "model/flow_keys.h"
#include "model/gel_keys.h"
#include "model/obstacle_keys.h"
#include "model/phase_keys.h"
#include "model/points_keys.h"
#include "model/render_keys.h"
#include "model/snowfall_keys.h"
#include "model/sparse_keys.h"

/* --- words: W(UPPER, as a scene writes it) ---------------------------------------------------- */

#define CF_MODEL_WORDS(W) W(TRACER, tracer) W(FLOW, flow) W(PHASE, phase) W(SNOWFALL, snowfall) W(GEL, gel)
#define CF_SCHEME_WORDS(W) \
  W(DEFAULT, default) W(PAPER, paper) W(SDIRK2, sdirk2) W(LEAPFROG, leapfrog) W(WAVE, wave)
#define CF_SWITCH_WORDS(W) W(OFF, off) W(ON, on)
#define CF_FLUX_RATE_WORDS(W) \
  W(MATERIAL, material) W(CONSERVATIVE, conservative) W(OBJECTIVE, objective) W(PARTIAL, partial)
#define CF_FILTER_WORDS(W)    W(AUTO, auto) W(ON, on) W(OFF, off)
#define CF_ADVECTION_WORDS(W) W(PPM, ppm) W(LINEAR, linear) W(WENO5, weno5) W(CUBIC, cubic)
#define CF_SHAPE_WORDS(W)     W(BOX, box) W(SPHERE, sphere) W(EVERYWHERE, everywhere)
#define CF_STALL_WORDS(W)     W(WARN, warn) W(STOP, stop)
#define CF_FORMAT_WORDS(W)    W(VTKHDF, vtkhdf) W(PNG, png) W(NPY, npy) W(VDB, vdb) W(PLY, ply)

#define CF_SCENE_ENUM(upper, lower) CF_SCENE_ENUM_PREFIX(upper),
enum {
#define CF_SCENE_ENUM_PREFIX(upper) CF_SCENE_MODEL_##upper
  CF_MODEL_WORDS(CF_SCENE_ENUM)
#undef CF_SCENE_ENUM_PREFIX
};
enum {
#define CF_SCENE_ENUM_PREFIX(upper) CF_SCENE_SCHEME_##upper
  CF_SCHEME_WORDS(CF_SCENE_ENUM)
#undef CF_SCENE_ENUM_PREFIX
};
enum {
#define CF_SCENE_ENUM_PREFIX(upper) CF_SCENE_FLUX_RATE_##upper
  CF_FLUX_RATE_WORDS(CF_SCENE_ENUM)
#undef CF_SCENE_ENUM_PREFIX
};
enum {
#define CF_SCENE_ENUM_PREFIX(upper) CF_SCENE_FILTER_##upper
  CF_FILTER_WORDS(CF_SCENE_ENUM)
#undef CF_SCENE_ENUM_PREFIX
};
enum {
#define CF_SCENE_ENUM_PREFIX(upper) CF_SCENE_SWITCH_##upper
  CF_SWITCH_WORDS(CF_SCENE_ENUM)
#undef CF_SCENE_ENUM_PREFIX
};
enum {
#define CF_SCENE_ENUM_PREFIX(upper) CF_SCENE_ADVECTION_##upper
  CF_ADVECTION_WORDS(CF_SCENE_ENUM)
#undef CF_SCENE_ENUM_PREFIX
};
enum {
#define CF_SCENE_ENUM_PREFIX(upper) CF_SCENE_SHAPE_##upper
  CF_SHAPE_WORDS(CF_SCENE_ENUM)
#undef CF_SCENE_ENUM_PREFIX
};
enum {
#define CF_SCENE_ENUM_PREFIX(upper) CF_SCENE_STALL_##upper
  CF_STALL_WORDS(CF_SCENE_ENUM)
#undef CF_SCENE_ENUM_PREFIX
};
enum { /* bits of output.formats: 1u << CF_SCENE_FORMAT_PNG */
#define CF_SCENE_ENUM_PREFIX(upper) CF_SCENE_FORMAT_##upper
       CF_FORMAT_WORDS(CF_SCENE_ENUM)
#undef CF_SCENE_ENUM_PREFIX
};
#undef CF_SCENE_ENUM

/* --- tables ----------------------------------------------------------------------------------- */

#define CF_DOMAIN_TABLE(P, R)                                                                             \
  P(size, numbers, CF_REQUIRED, "m", "2..3 of (0, inf)",                                                  \
    "Lengths of the sides of the box; two make a plane scene")                                            \
  P(cells, integers, CF_REQUIRED, "", "2..3 of [1, 1073741824]",                                          \
    "Number of cells on each axis; size/cells, the spacing h, must be the same on all axes")              \
  P(origin, numbers, CF_NONE, "m", "2..3 of (-inf, inf)",                                                 \
    "The lower corner of the box; left out: 0 on every axis")                                             \
  P(walls, walls, "insulated", "", "",                                                                    \
    "What holds on the walls, one word for all or a map of x-, x+, y-, y+, z-, z+: insulated (no flux), " \
    "open "                                                                                               \
    "(value 0), {value: expression in x, y, z, t}, radiate (waves leave), periodic (both sides of an "    \
    "axis); "                                                                                             \
    "sides left out of the map are insulated")

#define CF_TIME_TABLE(P, R)                                                                                 \
  P(end, number, CF_REQUIRED, "s", "(0, inf)", "The time at which the run ends; it starts at 0")            \
  P(dt, number_or_auto, "auto", "s", "(0, inf)",                                                            \
    "Length of a step, dt of eqs 11 to 18; steps are shortened to land on frames and on the end; auto: by " \
    "cfl")                                                                                                  \
  P(cfl, number, "0.5", "", "(0, inf)",                                                                     \
    "With dt: auto the step is cfl times the smallest limit of the scheme: h/|u|, h/c")                     \
  P(frames, number, "0", "1/s", "[0, inf)",                                                                 \
    "Output frames per unit of time; 0: only the first and the last state")                                 \
  P(retry, integer, "0", "", "[0, 30]",                                                                     \
    "After a value that is not finite (or a stalled solve with on_stall: stop): how often the run may go "  \
    "back to a checkpoint, each time one further, at last to the start, and try again with half the step")

#define CF_DIFFUSION_TABLE(P, R)                                                                             \
  P(k, profile, "0", "m^2/s", "[0, inf)", "Diffusivity k of eqs 7 to 10; an expression in x, y, z")          \
  P(tau, number, "0", "s", "[0, inf)", "Relaxation time tau of the flux, eqs 7 to 10; 0 is Fourier's law")   \
  P(f_t, number, "0", "", "[0, 1]",                                                                          \
    "The fraction F_T of Fourier's law in the flux: 0 is Cattaneo's law, 1 Fourier's")                       \
  P(front_speed, number, CF_NONE, "m/s", "(0, inf)",                                                         \
    "In place of k or of tau: the speed c of the front, c^2 = (1 - f_t) k/tau")                              \
  P(reach, number, CF_NONE, "m", "(0, inf)",                                                                 \
    "In place of k or of tau: how far a front comes before 5 % of it is left, 6 c tau")                      \
  P(blur, number, CF_NONE, "m", "[0, inf)",                                                                  \
    "In place of f_t: the length over which fronts are blurred, blur^2 = f_t k tau")                         \
  P(cone_angle, number, CF_NONE, "degree", "(0, 90)",                                                        \
    "In place of front_speed: the half-angle of the cone behind a source in the wind, sin = c/wind")         \
  P(visible_length, number, CF_NONE, "m", "(0, inf)",                                                        \
    "In place of k or of tau: the length over which that cone is straight, 2 tau wind cos^2(cone_angle)")    \
  P(wind, number, CF_NONE, "m/s", "(0, inf)",                                                                \
    "The speed that cone_angle and visible_length refer to; left out: that of `velocity`, if it is uniform") \
  P(thickness, number, CF_NONE, "m", "(0, inf)", "Of the slab that arrival and saturation refer to")         \
  P(arrival, number, CF_NONE, "s", "(0, inf)",                                                               \
    "In place of front_speed: when the front is through the slab, thickness/c")                              \
  P(saturation, number, CF_NONE, "s", "(0, inf)",                                                            \
    "In place of k: when a slab that takes up from one side is 95 % full, 1.129 thickness^2/k")              \
  P(capacity, profile, "1", "", "(0, inf)",                                                                  \
    "Capacity C of eq. 1, what one unit of the scalar needs; an expression in x, y, z")                      \
  P(scheme, word, "default", "", CF_WORDS(CF_SCHEME_WORDS),                                                  \
    "default: leapfrog or sdirk2, whichever costs less; paper: eqs 11 to 18 as printed; sdirk2: two "        \
    "implicit stages; leapfrog: explicit substeps; wave: explicit, sharpest fronts (f_t = 0, one k)")        \
  P(flux_rate, word, "objective", "", CF_WORDS(CF_FLUX_RATE_WORDS),                                          \
    "How a flux is carried by the flow: material (eq. 10), conservative (eq. 9), objective (turns and "      \
    "stretches with the flow), partial (not at all: the single-field model of Appendix A, whose wave "       \
    "speeds are wrong; for comparison)")                                                                     \
  P(front_filter, word, "auto", "", CF_WORDS(CF_FILTER_WORDS),                                               \
    "Takes the ripples off sharp fronts; auto: on where f_t is below 0.01")                                  \
  P(positivity, word, "off", "", CF_WORDS(CF_SWITCH_WORDS),                                                  \
    "on: limits the flux to |q| <= c phi, so that what is >= 0 stays so; the law itself falls below 0 "      \
    "behind fronts in 2D and 3D. Goes with scheme default or leapfrog")

#define CF_ADVECTION_TABLE(P, R)                                                                  \
  P(scheme, word, "ppm", "", CF_WORDS(CF_ADVECTION_WORDS),                                        \
    "How fields are carried by the flow: ppm (conservative, no new extrema, clips peaks), weno5 " \
    "(conservative, fifth order, "                                                                \
    "small overshoots at jumps), cubic (semi-Lagrangian, any step, no exact mass), "              \
    "linear (semi-Lagrangian with linear interpolation, as in the paper)")

#define CF_FIELD_TABLE(P, R)                                                                     \
  P(name, key, CF_NONE, "", "", "The name of the field")                                         \
  P(initial, profiles, "0", "", "",                                                              \
    "Values at time 0, an expression in x, y, z; for a flux (q, q_NAME) one expression an axis") \
  R(optional, diffusion, cf_scene_diffusion,                                                     \
    "Diffusion of this scalar, where it differs from the common one")                            \
  P(walls, walls, CF_NONE, "", "", "Walls of this scalar, where they differ from domain.walls")  \
  P(unit, text, "", "", "", "Unit of the values, written beside them in the output")

#define CF_SOURCE_TABLE(P, R)                                                                               \
  P(field, text, "phi", "", "", "The field it works on: a scalar or a flux")                                \
  P(shape, word, CF_NONE, "", CF_WORDS(CF_SHAPE_WORDS),                                                     \
    "Where it works: box (center, half), sphere (center, radius), everywhere; a cell takes the fraction "   \
    "inside")                                                                                               \
  P(center, numbers, CF_NONE, "m", "2..3 of (-inf, inf)", "Middle of the box or sphere")                    \
  P(half, numbers, CF_NONE, "m", "2..3 of (0, inf)", "Half of the sides of the box")                        \
  P(radius, number, CF_NONE, "m", "(0, inf)", "Radius of the sphere")                                       \
  P(at, numbers, CF_NONE, "m", "2..3 of (-inf, inf)", "Place of a point source, with amount")               \
  P(amount, function, CF_NONE, "", "", "What a point source adds per unit of time, integrated over space")  \
  P(rate, functions, CF_NONE, "", "",                                                                       \
    "What is added per unit of time: W of eq. 1, an expression in x, y, z, t; on a flux one expression an " \
    "axis")                                                                                                 \
  P(value, functions, CF_NONE, "", "",                                                                      \
    "Holds the field at this value inside the shape; an expression in x, y, z, t; on a flux one an axis")

#define CF_SOLVER_TABLE(P, R)                                                                             \
  P(tolerance, number, "1e-6", "", "(0, 1)",                                                              \
    "A solve ends when the residual is this fraction of the right side")                                  \
  P(max_iterations, integer, "200", "", "[1, 1000000]", "A solve that takes more iterations has stalled") \
  P(on_stall, word, "warn", "", CF_WORDS(CF_STALL_WORDS),                                                 \
    "What a stalled solve does: warn and go on, or stop the run (exit code 3)")                           \
  P(levels, integer, "0", "", "[0, 32]", "Number of multigrid levels; 0: as many as fit")

#define CF_CHECKPOINT_TABLE(P, R)                                                                         \
  P(every, interval, "10 min", "", "",                                                                    \
    "How often the state is saved: a number of steps (100 steps), a time of the wall clock (10 min), or " \
    "never")                                                                                              \
  P(keep, integer, "2", "", "[1, 1000000]", "How many checkpoints are kept")

#define CF_PREVIEW_TABLE(P, R)                                                                          \
  P(field, text, "", "", "", "The field in the pictures; left out: the first of output.fields")         \
  P(map, text, "", "", "", "The colour map; left out: one that suits the field")                        \
  P(range, numbers_or_auto, "auto", "", "2 of (-inf, inf)", "Values at the two ends of the colour map") \
  P(size, integers, CF_NONE, "", "2 of [16, 16384]",                                                    \
    "Width and height in pixels; left out: what suits the box")

#define CF_VDB_TABLE(P, R)                                                    \
  P(half, word, "off", "", CF_WORDS(CF_SWITCH_WORDS),                         \
    "Values of 16 bits instead of 32: half the size, three digits: on | off") \
  P(prune, number, "1e-6", "", "[0, 1)",                                      \
    "Voxels below this part of a field's largest value are left out; 0: those that are 0")

#define CF_OUTPUT_TABLE(P, R)                                                        \
  P(fields, texts, CF_NONE, "", "",                                                  \
    "The fields that are written; left out: the scalars and the fluxes in `fields`") \
  P(formats, words, "[vtkhdf, png]", "", CF_WORDS(CF_FORMAT_WORDS),                  \
    "What a frame is written as: vtkhdf (ParaView), png (a picture), npy (NumPy), "  \
    "vdb (volumes for Blender and others), ply (the surface, of models that have "   \
    "one)")                                                                          \
  R(record, vdb, cf_scene_vdb, "The volumes")                                        \
  R(record, checkpoint, cf_scene_checkpoint, "Saved states to resume from")          \
  R(record, preview, cf_scene_preview, "The pictures")

#define CF_SCENE_TABLE(P, R)                                                                                \
  P(cattaneo, integer, CF_REQUIRED, "", "", "Version of the scene format: 1")                               \
  P(title, text, "", "", "", "A line about the scene")                                                      \
  P(model, word, CF_REQUIRED, "", CF_WORDS(CF_MODEL_WORDS),                                                 \
    "What is computed: tracer (scalars in a given flow), flow (a fluid and what it carries), phase "        \
    "(crystals), snowfall "                                                                                 \
    "(flakes in the wind), gel (bodies that take up water and swell)")                                      \
  P(let, constants, CF_NONE, "", "",                                                                        \
    "Names for numbers, for use in expressions and wherever a number stands")                               \
  R(record, domain, cf_scene_domain, "The box and its cells")                                               \
  R(record, time, cf_scene_time, "Steps and frames")                                                        \
  R(record, diffusion, cf_scene_diffusion, "Diffusion of the scalars, eqs 7 to 18")                         \
  R(record, advection, cf_scene_advection, "How the flow carries things")                                   \
  R(map, fields, cf_scene_field,                                                                            \
    "The fields by name: scalars, and q or q_NAME for a flux; left out: one scalar phi")                    \
  P(velocity, functions, "0", "m/s", "",                                                                    \
    "The flow, one expression in x, y, z, t an axis, evaluated at the faces; in model flow that at time 0") \
  R(record, sparse, cf_scene_sparse, "Computing scalars only where they are")                               \
  R(list, sources, cf_scene_source, "What is added to fields, or holds them")                               \
  R(list, obstacles, cf_scene_obstacle, "Solid bodies: what nothing passes, or what holds scalars")         \
  R(list, points, cf_scene_points, "Points that the flow carries along")                                    \
  R(record, flow, cf_scene_flow, "The fluid, of model flow")                                                \
  R(record, gel, cf_scene_gel, "Bodies that swell, of model gel")                                           \
  R(record, phase, cf_scene_phase, "The crystal, of model phase")                                           \
  R(record, snowfall, cf_scene_snowfall, "Flakes falling, of model snowfall")                               \
  R(record, solver, cf_scene_solver, "The linear solver")                                                   \
  R(record, output, cf_scene_output, "What is written, and how often")                                      \
  R(record, render, cf_scene_render, "How `cattaneo render` and `cattaneo movie` show it")

/* --- structs ---------------------------------------------------------------------------------- */

typedef struct cf_scene_domain {
  CF_PARAM_MEMBERS(CF_DOMAIN_TABLE)
} cf_scene_domain;
typedef struct cf_scene_time {
  CF_PARAM_MEMBERS(CF_TIME_TABLE)
} cf_scene_time;
typedef struct cf_scene_diffusion {
  CF_PARAM_MEMBERS(CF_DIFFUSION_TABLE)
} cf_scene_diffusion;
typedef struct cf_scene_advection {
  CF_PARAM_MEMBERS(CF_ADVECTION_TABLE)
} cf_scene_advection;
typedef struct cf_scene_field {
  CF_PARAM_MEMBERS(CF_FIELD_TABLE)
} cf_scene_field;
typedef struct cf_scene_source {
  CF_PARAM_MEMBERS(CF_SOURCE_TABLE)
} cf_scene_source;
typedef struct cf_scene_solver {
  CF_PARAM_MEMBERS(CF_SOLVER_TABLE)
} cf_scene_solver;
typedef struct cf_scene_checkpoint {
  CF_PARAM_MEMBERS(CF_CHECKPOINT_TABLE)
} cf_scene_checkpoint;
typedef struct cf_scene_preview {
  CF_PARAM_MEMBERS(CF_PREVIEW_TABLE)
} cf_scene_preview;
typedef struct cf_scene_vdb {
  CF_PARAM_MEMBERS(CF_VDB_TABLE)
} cf_scene_vdb;
typedef struct cf_scene_output {
  CF_PARAM_MEMBERS(CF_OUTPUT_TABLE)
} cf_scene_output;

struct cf_scene {
  CF_PARAM_MEMBERS(CF_SCENE_TABLE)
  /* worked out */
  int dim;                  /* 2 or 3 */
  double spacing;           /* h, the same on all axes */
  struct cf_config *config; /* the places of the keys, and the memory of all texts and functions */
};

/* --- functions -------------------------------------------------------------------------------- */

/* The path as given, and the folder of the file: paths in a scene are relative to it ("." at least). */
const char *cf_scene_path(const cf_scene *scene);
const char *cf_scene_folder(const cf_scene *scene);

/* For checks made elsewhere: CF_BAD_SCENE with the sentence, the line and a caret at the place of `key`, for
 * example "diffusion.k", "sources.0.rate", "fields.phi.initial"; a key that was left out points at what
 * encloses it. */
cf_status cf_scene_fail_at(const cf_scene *scene, const char *key, const char *format, ...) CF_PRINTF(3, 4);

/* Whether the file or an override has `key`. */
bool cf_scene_has(const cf_scene *scene, const char *key);

/* The resolved scene as YAML, every default filled in; read again it gives the same scene. cf_free the text.
 */
cf_status cf_scene_write(const cf_scene *scene, char **text);

/* A name that starts with q_, or is q, is that of a flux. */
bool cf_scene_name_is_flux(const char *name);

/* Index of the field `name` in scene->fields, or -1. */
int cf_scene_field_index(const cf_scene *scene, const char *name);

/* Index of the scalar whose flux is called `name`, or -1: q_NAME is that of NAME; q that of phi, or of the
 * only scalar. The flux itself need not stand in `fields`. */
int cf_scene_flux_scalar(const cf_scene *scene, const char *name);

/* The table of all keys, for pages made from it. */
extern const cf_param_table cf_scene_table;

#endif
