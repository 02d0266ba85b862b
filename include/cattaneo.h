/* SPDX-License-Identifier: MIT
 *
 * Cattaneo: diffusion in which the flux has a memory, so that what diffuses has a front with a finite speed.
 *
 *     C phi_t + div q = C W,   q = q_C - F_T k grad phi,   tau (q_C)_t + q_C = -(1 - F_T) k grad phi
 *
 * (Xue, Su, Han, Jiang, Aanjaneya 2020, eqs 1, 6, 7, 8; numbers in brackets below are equations of that paper.)
 * tau = 0 or F_T = 1 is Fourier's law; otherwise fronts run with c = sqrt((1 - F_T) k/(C tau)).
 *
 * The library has three levels, in this order, and what you need of it ends where your level ends:
 *
 *     0. Failures                 what every function returns
 *     1. Run a scene              a file says everything, the library steps it     examples/c/run_scene.c
 *     2. One step of one equation on arrays of your own                            examples/c/diffuse_step.c
 *     3. The solver               (alpha - div beta grad) x = b                    examples/c/solve.c
 *
 * Compile and link with `pkg-config --cflags --libs cattaneo`, or find_package(cattaneo) and
 * cattaneo::cattaneo in CMake.
 *
 * Precision. Fields are cf_real: double in libcattaneo, float in libcattaneof, for which CF_SINGLE must be
 * defined (pkg-config cattaneof does so). Times, sums and parameters are double in both. Sources say cf_ either
 * way; the symbols of libcattaneof start with cff_, so one program can link both.
 *
 * Threads. The library has no global state: objects are yours, and any thread may use its own. One object is
 * used by one thread at a time; constant ones (cf_scene, cf_grid) may be shared. Inside a call the library uses
 * as many OpenMP threads as the grid says, and the result has the same bits for any number of them.
 *
 * Manners. Nothing is printed, nothing exits, no environment is read; files are touched only by functions that
 * take a path. Objects of which only the name is told here are made by _create and freed by _destroy, which
 * accepts NULL. SI units, unless all of your numbers are without dimension.
 */
#ifndef CATTANEO_H
#define CATTANEO_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif
#ifdef __GNUC__
#pragma GCC visibility push(default)
#endif

#ifdef CF_SINGLE
typedef float cf_real;
#else
typedef double cf_real;
#endif

/* The version of the library that is linked, "0.1.0". */
const char *cf_version(void);

/* ========================================================================================================
 * 0. Failures
 *
 * Functions that can fail return a cf_status. CF_OK is 0; for every other one the library keeps a sentence
 * that says what was wrong, with the values:
 *
 *     if (cf_scene_read(&scene, "ink.yaml", 0, NULL) != CF_OK) {
 *       fprintf(stderr, "%s\n", cf_status_sentence());
 *       ...
 *
 * After a failed _create or _read the pointer is NULL and nothing is left behind.
 * ===================================================================================================== */

/* name, exit code of a program that ends with it, what it means */
#define CF_STATUS_LIST(S)                                                 \
  S(OK, 0, "done")                                                        \
  S(FAILED, 1, "an operation failed")                                     \
  S(BAD_ARGUMENT, 2, "a value was out of range or did not fit")           \
  S(BAD_SCENE, 2, "the scene has an error")                               \
  S(BAD_USAGE, 2, "the command line has an error")                        \
  S(NOT_CONVERGED, 3, "the solver did not converge")                      \
  S(NOT_FINITE, 4, "a value stopped being finite")                        \
  S(NO_MEMORY, 5, "memory or address space ran out")                      \
  S(OVER_LIMIT, 5, "a limit set by the user or the machine was reached")  \
  S(BAD_FILE, 1, "a file could not be read, or is not what it should be") \
  S(CANNOT_WRITE, 1, "a file could not be written")                       \
  S(STOPPED, 130, "stopped on request")

typedef enum cf_status {
#define CF_STATUS_ENUM(name, exit_code, meaning) CF_##name,
  CF_STATUS_LIST(CF_STATUS_ENUM)
#undef CF_STATUS_ENUM
} cf_status;

/* The sentence of this thread's latest failure, "" if there was none; valid until its next one. */
const char *cf_status_sentence(void);

/* "BAD_SCENE" for CF_BAD_SCENE, and what `cattaneo` would exit with. "unknown" and 1 for anything else. */
const char *cf_status_name(cf_status code);
int cf_status_exit_code(cf_status code);

/* Frees a text that a function here made. NULL is fine. */
void cf_free(void *text);

/* ========================================================================================================
 * 1. Run a scene
 *
 *     cf_scene *scene;
 *     cf_sim *sim;
 *     cf_scene_read(&scene, "ink.yaml", 0, NULL);
 *     cf_sim_create(&sim, scene, 2);
 *     cf_sim_run(sim, INFINITY, NULL, NULL);            // to the end that the scene says
 *
 *     cf_view phi;
 *     cf_sim_field(sim, "phi", 0, &phi);
 *     double middle = phi.at[phi.shape[0]/2*phi.stride[0] + phi.shape[1]/2*phi.stride[1]];
 *
 *     cf_sim_destroy(sim);
 *     cf_scene_destroy(scene);
 *
 * The scene file is that of the program; `cattaneo explain` tells its keys. No folder is written: `output` in
 * the scene is checked and otherwise ignored.
 * ===================================================================================================== */

typedef struct cf_scene cf_scene;

/* Reads, resolves and checks the scene at `path`; `set` holds `overrides` texts "diffusion.tau=2" that go
 * before what the file says. CF_BAD_SCENE with the message to print (several lines: place, line, caret) for
 * everything that is wrong. */
cf_status cf_scene_read(cf_scene **scene, const char *path, int overrides, const char *const *set);
void cf_scene_destroy(cf_scene *scene);

/* The page on `key` ("diffusion.k", "fields.NAME.initial", "diffusion"), or on every key if it is NULL.
 * cf_free the text. CF_BAD_USAGE for a key that does not exist; the sentence says which may have been meant. */
cf_status cf_scene_explain(const char *key, char **text);

/* --- stepping ------------------------------------------------------------------------------------------ */

typedef struct cf_sim cf_sim;

/* The state at time 0. `scene` must outlive it. threads: at least 1. CF_BAD_SCENE for what only the grid can
 * tell; CF_NO_MEMORY. */
cf_status cf_sim_create(cf_sim **sim, const cf_scene *scene, int threads);
void cf_sim_destroy(cf_sim *sim);

/* One step. Steps are shortened to land exactly on the times of frames and on the end; a remainder below 1e-9 dt
 * is no step. *on_frame (NULL is fine): the state is now that of a frame. CF_NOT_FINITE names field and cell;
 * CF_NOT_CONVERGED only where the scene says `on_stall: stop`; CF_FAILED at the end, where no step is left. */
cf_status cf_sim_step(cf_sim *sim, bool *on_frame);

/* Called after every step; false stops the run. It may look at fields, change them, and save. */
typedef bool (*cf_sim_progress)(void *context, cf_sim *sim);

/* Steps to the time `until`, s, exactly, or to the scene's end if that is earlier (INFINITY: always). progress
 * may be NULL. CF_STOPPED: progress said so; a later call goes on. Otherwise as cf_sim_step, and CF_BAD_ARGUMENT
 * where `until` is no number. A step that was shortened for `until` makes the later ones differ from those of
 * an unbroken run by the scheme's error. */
cf_status cf_sim_run(cf_sim *sim, double until, cf_sim_progress progress, void *context);

/* The clock: time and end in s, steps taken, whether the end is reached. */
double cf_sim_time(const cf_sim *sim);
double cf_sim_end(const cf_sim *sim);
int64_t cf_sim_step_count(const cf_sim *sim);
bool cf_sim_finished(const cf_sim *sim);

/* The number of frames of the whole run, the start included, and the time of frame i. Frame i is at
 * i/time.frames while that is no later than the end; if the end is no such time it is one more frame.
 * time.frames = 0: start and end only. */
int64_t cf_sim_frames(const cf_sim *sim);
double cf_sim_frame_time(const cf_sim *sim, int64_t i);

/* A sentence that the latest step has for you (a velocity that met a closed wall, a solve that stalled and went
 * on), or "". */
const char *cf_sim_warning(const cf_sim *sim);

/* --- fields -------------------------------------------------------------------------------------------- */

/* Where the values of a field are. The value of (i, j, k), 0 <= i < shape[0] and so on, is
 *
 *     at[i*stride[0] + j*stride[1] + k*stride[2]],      type cf_real
 *
 * and belongs to the point place + (i, j, k) h. Scalars sit at the centres of cells. A component of a flux or
 * velocity sits on the faces across its axis (the MAC arrangement): shape has one more entry there, the first
 * and last being on the walls. In 2D shape[2] = 1. Memory beyond the shape is not yours. */
typedef struct cf_view {
  cf_real *at;
  int shape[3];
  ptrdiff_t stride[3]; /* in elements */
  int staggered;       /* the axis across which the faces lie; -1: cells */
  double place[3];     /* of (0, 0, 0), m */
  double h;            /* spacing of the values on all axes, m */
  const char *unit;    /* "" where the scene gives none */
} cf_view;

/* The field `name`: "phi" or another scalar of the scene (component 0); its flux "q" or "q_NAME" where the scene
 * names it, in `fields` or output.fields; "velocity" (component: the axis). The view stays valid as long as the
 * simulation, and shows the state as it is now.
 *
 * Scalars and fluxes may be written between steps; on a periodic axis the last faces are the first ones again, so
 * write both. The velocity is set from the scene at every step that needs it. The ledger in the metrics counts
 * what you write as an error, for it is not the scene's.
 *
 * CF_BAD_ARGUMENT: there is no such field or component; the sentence lists those there are. */
cf_status cf_sim_field(cf_sim *sim, const char *name, int component, cf_view *view);

/* The names of the fields: 0, 1, ... until NULL. */
const char *cf_sim_field_name(const cf_sim *sim, int i);

/* --- particles ----------------------------------------------------------------------------------------- */

/* An attribute of a set of particles: component c of particle i, 0 <= i < count, is at[c][i]. Every component is an
 * array of its own; memory beyond `count` is not yours. */
typedef struct cf_particle_view {
  int64_t count;
  const int64_t
      *id;        /* id[i] stays with particle i for life and is never used again; its place i may change */
  int components; /* 1 to 9 */
  cf_real *at[9];
  const char *unit; /* "" where the scene gives none */
} cf_particle_view;

/* The attribute `attribute` ("position", ...) of the particles `set`. The view is valid until the next step, or load.
 * Values may be written between steps. CF_BAD_ARGUMENT: there is no such set or attribute; the sentence lists those
 * there are. */
cf_status cf_sim_particles(cf_sim *sim, const char *set, const char *attribute, cf_particle_view *view);

/* The names of the sets, and of the attributes of a set: 0, 1, ... until NULL. */
const char *cf_sim_particles_name(const cf_sim *sim, int i);
const char *cf_sim_particles_attribute(const cf_sim *sim, const char *set, int i);

/* --- numbers ------------------------------------------------------------------------------------------- */

#define CF_NAME_MAX    64
#define CF_METRICS_MAX 256

/* What metrics.csv has in a line: step, time, dt, iterations, residual, then the model's: of every scalar
 * sum_NAME (integral over the box), min_NAME, max_NAME, error_NAME (of its ledger). */
typedef struct cf_metric {
  char name[CF_NAME_MAX];
} cf_metric;

/* The columns (at most CF_METRICS_MAX, fixed for a simulation) and how many; and their values now. */
int cf_sim_metric_names(const cf_sim *sim, cf_metric *names);
void cf_sim_metrics(const cf_sim *sim, double *values);

/* --- checkpoints --------------------------------------------------------------------------------------- */

/* Writes the whole state into the file `path` (HDF5), whole or not at all: an earlier file of that name stays
 * until the new one is on the disk. CF_CANNOT_WRITE with path and reason. */
cf_status cf_sim_save(const cf_sim *sim, const char *path);

/* Puts the simulation into the state that was saved from one of the same scene; stepping on gives the same bits
 * as if it had never been saved. Checkpoints of `cattaneo run` can be loaded as well. CF_BAD_FILE: the file is
 * damaged, or of another scene, shape or precision, and the sentence says which; the state is as it was. After
 * CF_NO_MEMORY it may be half loaded: load once more. */
cf_status cf_sim_load(cf_sim *sim, const char *path);

/* ========================================================================================================
 * 2. One step of one equation
 *
 * First the nouns (box, grid, field, wall, function), then the equations.
 *
 *     cf_grid grid;
 *     cf_cell phi;
 *     cf_face q;
 *     cf_grid_init(&grid, 2, (int[]){128, 128}, 1.0/128, NULL);
 *     cf_cell_create(&phi, &grid.box);
 *     cf_face_create(&q, &grid.box);
 *     phi.at[64 + 64*grid.box.stride[1]] = 1;
 * ===================================================================================================== */

/* --- arrays -------------------------------------------------------------------------------------------- */

/* How cells lie in an array. Cell (i, j, k) is element i + j stride[1] + k stride[2] counted from cell
 * (0, 0, 0), which is element `first` of an array of `size` elements. Around the box lie `halo` layers of ghost
 * cells (none in z in 2D), which belong to the library: it fills and overwrites them.
 *
 * A cell and its low faces share an index: face p of axis a lies between cells p - stride[a] and p, and the high
 * wall of axis a is the low face of the first ghost cell. One set of strides therefore serves cells and faces,
 * and no array has n + 1 entries. */
typedef struct cf_box {
  int dim;             /* 2 or 3 */
  int n[3];            /* cells an axis; n[2] = 1 in 2D */
  int halo;            /* ghost cells on every side of the axes below dim */
  ptrdiff_t stride[3]; /* elements to the next cell of an axis; stride[0] = 1 */
  ptrdiff_t first;     /* elements before cell (0, 0, 0) */
  ptrdiff_t size;      /* elements of the array */
} cf_box;

/* n: dim entries are read. CF_BAD_ARGUMENT where an extent is below 1 or the array could not be addressed.
 * (cf_grid_init does this with the halo that the equations need.) */
cf_status cf_box_init(cf_box *b, int dim, const int n[3], int halo);

/* A box of cells in space. Cells are squares or cubes of width h; cell (i, j, k) is centred at
 * origin + (i + 1/2, j + 1/2, k + 1/2) h, the low face of axis a lies half a cell below it on that axis. */
typedef struct cf_grid {
  cf_box box;
  double h;         /* m */
  double origin[3]; /* lower corner, m */
  int threads;      /* at least 1; cf_grid_init sets 1, change it as you like */
} cf_grid;

/* `cells` and `origin` have dim entries read; origin NULL: 0. CF_BAD_ARGUMENT: sizes or a spacing that make no
 * sense. */
cf_status cf_grid_init(cf_grid *g, int dim, const int *cells, double h, const double *origin);

/* A value a cell: at[p] with p = i + j stride[1] + k stride[2]. */
typedef struct cf_cell {
  cf_real *at;
} cf_cell;

/* A value a face, one array an axis: at[a][p] on the low face of axis a of cell p; NULL for axes >= dim. */
typedef struct cf_face {
  cf_real *at[3];
} cf_face;

/* Zeroed fields, whose memory is committed page by page as it is touched. CF_NO_MEMORY. An array of your own
 * serves as well: box.size elements, `at` pointing at element box.first of it, aligned to 64 bytes. */
cf_status cf_cell_create(cf_cell *f, const cf_box *b);
void cf_cell_destroy(cf_cell *f, const cf_box *b); /* a zeroed one is fine */
cf_status cf_face_create(cf_face *f, const cf_box *b);
void cf_face_destroy(cf_face *f, const cf_box *b);

/* --- walls and functions ------------------------------------------------------------------------------- */

/* A function of place and time, W(x, y, z, t), in m and s. {.value = 3} is the constant 3. */
typedef struct cf_fn {
  /* out[i] = W(x[i], y[i], z[i], t) for i in 0..n-1. NULL: the function is the constant `value`. */
  void (*eval)(const void *context, int n, const double *x, const double *y, const double *z, double t,
               double *out);
  const void *context;
  double value;
  bool in_time; /* depends on t: evaluated again at every time */
} cf_fn;

/* What holds on a wall, for one scalar:
 *   insulated  no flux passes
 *   open       the scalar is 0 on the wall face (and what the flow brings in is 0)
 *   value      the scalar is a given function of place and time on the wall face
 *   radiate    the flux is C c (phi - phi_inf), c the front's speed: waves leave; without waves it is value
 *   periodic   the opposite wall is the neighbour; given for both sides of an axis
 * Upper case as here, lower case as a scene writes it. */
#define CF_WALL_LIST(W) \
  W(INSULATED, insulated) W(OPEN, open) W(VALUE, value) W(RADIATE, radiate) W(PERIODIC, periodic)

typedef enum cf_wall {
#define CF_WALL_ENUM(upper, lower) CF_WALL_##upper,
  CF_WALL_LIST(CF_WALL_ENUM)
#undef CF_WALL_ENUM
} cf_wall;

/* The six walls of a box (four in 2D); zeroed: all insulated. */
typedef struct cf_walls {
  cf_wall kind[3][2]; /* [axis][0: low side, 1: high side] */
  cf_fn value[3][2];  /* read for CF_WALL_VALUE and CF_WALL_RADIATE */
} cf_walls;

/* --- what a solve takes and tells ---------------------------------------------------------------------- */

typedef struct cf_solve_options {
  double tolerance;   /* on |b - A x| / |b| */
  int max_iterations; /* of conjugate gradients */
} cf_solve_options;

typedef struct cf_solve_report {
  int iterations;  /* of conjugate gradients, one V-cycle each */
  int levels;      /* that the cycle went through */
  double residual; /* |b - A x| / |b| at the end, to within 1e-7 of the one at the beginning */
  bool converged;
  int pockets; /* parts of the region whose level nothing fixes: each keeps the mean that its x came with */
  const char *method; /* that did it: "sor", "multigrid", "multigrid-pcg", "line" or "direct" */
} cf_solve_report;

/* --- diffusion with a memory --------------------------------------------------------------------------- *
 *
 * Of one scalar phi (cells) and its flux q_C (faces), in a medium at rest:
 *
 *     C phi_t + div q = C W,     q = q_C - F_T k grad phi,                                         (1, 6, 7)
 *     tau (q_C)_t + q_C + (1 - F_T) k grad phi = tau B.                                                  (8)
 *
 * tau = 0, tau = INFINITY, F_T = 0 or 1 and k = 0 are ordinary values.
 *
 *     cf_diffuse *d;
 *     cf_walls walls = {0};
 *     cf_diffuse_params p = {.k = {.value = 1}, .capacity = {.value = 1}, .tau = 0.1, .solver = {1e-6, 100},
 *                            .scheme = CF_DIFFUSE_SDIRK2};
 *     cf_diffuse_create(&d, &grid, &walls, &p, NULL);
 *     cf_ledger ledger = {.first = cf_diffuse_content(d, phi)};
 *     cf_solve_report report;
 *     for (int i = 0; i < 100; ++i) cf_diffuse_step(d, i*dt, dt, phi, q, &ledger, &report);
 */

/* CF_DIFFUSE_PAPER     eqs 11-18 as printed: backward Euler, W taken at the old time. First order.
 * CF_DIFFUSE_SDIRK2    two stages of (1 - 1/sqrt(2)) dt (Alexander 1977): second order, L-stable.
 * CF_DIFFUSE_LEAPFROG  explicit and in place: q <- E q - (1 - E)(1 - F_T) k grad phi with E = exp(-dt/tau), then
 *                      phi <- phi - dt div q/C, in as many substeps as keep it stable. Second order. The part
 *                      with F_T, if any, is implicit, before and after.
 * CF_DIFFUSE_WAVE      explicit, fifth-order weighted reconstruction of both fields, three Runge-Kutta stages: the
 *                      sharpest fronts. k and C one number each, F_T = 0, 0 < tau < INFINITY.
 * All but the first keep the sum of C phi to round-off, whatever the solver's tolerance. */
typedef enum cf_diffuse_scheme {
  CF_DIFFUSE_PAPER,
  CF_DIFFUSE_SDIRK2,
  CF_DIFFUSE_LEAPFROG,
  CF_DIFFUSE_WAVE
} cf_diffuse_scheme;

/* What acts on the scalar; a NULL function does not act. Each writes every cell (face) of its fields at time t,
 * s. What it returns other than CF_OK ends the step and is returned by it. */
typedef struct cf_source {
  cf_status (*rate)(void *context, double t, cf_cell W);      /* d phi/dt */
  cf_status (*flux_rate)(void *context, double t, cf_face B); /* d q/dt */
  /* Cells held at `value` with weight `fraction` in [0, 1] (0: free, 1: held). */
  cf_status (*hold)(void *context, double t, cf_cell fraction, cf_cell value);
  /* The values of the region's cells that are held; NULL: as they are in the region. Others are not read. */
  cf_status (*held)(void *context, double t, cf_cell value);
  void *context;
} cf_source;

/* Where in the box an equation holds, see section 3. */
typedef struct cf_region cf_region;

typedef struct cf_diffuse_params {
  cf_fn k;        /* m^2/s (times C's unit); constant or of x, y, z; >= 0 */
  cf_fn capacity; /* C > 0 */
  double tau;     /* s, >= 0 */
  double f_t;     /* F_T, 0 ... 1 */
  cf_diffuse_scheme scheme;
  cf_solve_options solver;
  int levels; /* of multigrid; 0: as needed */
  /* Takes the ripples off steep fronts after every (sub)step; CF_DIFFUSE_WAVE needs none. */
  bool front_filter;
  /* CF_DIFFUSE_LEAPFROG: fluxes are limited so that phi >= 0 stays so; the law itself goes below 0 behind fronts
   * in 2D and 3D. */
  bool positive;
  /* NULL: the whole box; otherwise on the same grid and as long as the object. phi is 0 in its walls, and in held cells
   * their value, which passes through their faces; q is 0 on faces that it closes. All schemes but CF_DIFFUSE_WAVE. */
  cf_region *region;
} cf_diffuse_params;

/* Where the scalar's sum came from and went, in absolute amounts (integral of C phi). With `first` what was
 * there at the start, first + entered - left is what must be inside. */
typedef struct cf_ledger {
  double first, entered, left;
} cf_ledger;

typedef struct cf_diffuse cf_diffuse;

/* `g` must outlive the object; `source` (NULL: nothing acts) is copied. CF_BAD_ARGUMENT: a parameter out of
 * range, or k < 0, C <= 0 somewhere. CF_NO_MEMORY. */
cf_status cf_diffuse_create(cf_diffuse **d, const cf_grid *g, const cf_walls *walls,
                            const cf_diffuse_params *p, const cf_source *source);
void cf_diffuse_destroy(cf_diffuse *d);

/* phi and q from t to t + dt, s. The ghosts of both are scratch. `ledger` is added to. report->iterations is
 * summed over the solves, ->residual the largest; not converging is told there and is no failure.
 * CF_NOT_FINITE as cf_helmholtz_solve. */
cf_status cf_diffuse_step(cf_diffuse *d, double t, double dt, cf_cell phi, cf_face q, cf_ledger *ledger,
                          cf_solve_report *report);

/* The kinds of the region's cells have changed. CF_NO_MEMORY. */
cf_status cf_diffuse_region_changed(cf_diffuse *d);

/* Integral of C phi over the box, or over the cells inside its region: what the ledger counts. */
double cf_diffuse_content(const cf_diffuse *d, cf_cell phi);

/* (inside - first - entered + left) / (|first| + entered + left), 0 if all are 0. */
double cf_ledger_error(const cf_ledger *l, double inside);

/* Adds an amount to `entered`, or to `left` where it is negative. */
void cf_ledger_add(cf_ledger *l, double amount);

/* The largest k of the box, and the largest wave speed sqrt((1 - F_T) k/(C tau)); 0 where tau = 0. */
double cf_diffuse_k_max(const cf_diffuse *d);
double cf_diffuse_speed_max(const cf_diffuse *d);

/* --- what a moving medium carries along ---------------------------------------------------------------- *
 *
 * Scalars in cells, phi_t + div(u phi) = 0, and fluxes on faces. A step of both, second order (Strang 1968):
 * advect over dt/2, diffuse over dt, advect over dt/2.
 *
 *     cf_advect_set_velocity(a, u, walls);          // whenever u has changed
 *     cf_advect_begin(a, t, dt);                    // once a step (or half step)
 *     cf_advect_cell(a, walls, phi, &through);      // any number of fields over that same step
 *     cf_advect_face(a, walls, CF_RATE_OBJECTIVE, q);
 */

/* CF_ADVECT_PPM     one axis at a time with a piecewise parabola a cell (Colella, Woodward 1984) on a
 *                   pseudo-density, in as many substeps as it takes. Mass exact to round-off, through walls as
 *                   well; no new extrema and constants kept for any u that is discretely free of divergence;
 *                   linear to round-off; order 2 and a bit on smooth fields, extrema are clipped.
 * CF_ADVECT_LINEAR  the paper's: trace back over dt with a midpoint step, interpolate linearly. One step for
 *                   any dt, bounded, strongly smearing, no promise about mass.
 * CF_ADVECT_WENO5   finite volumes with fifth-order weighted reconstruction (WENO5-Z) and three Runge-Kutta
 *                   stages, in as many substeps as it takes. Mass exact to round-off, through walls as well;
 *                   smooth peaks are not clipped; new extrema of some per cent at jumps. The dearest.
 * CF_ADVECT_CUBIC   traced back like CF_ADVECT_LINEAR, with cubic interpolation: sharp and cheap for any dt, new
 *                   extrema at jumps, no promise about mass. */
typedef enum cf_advect_scheme {
  CF_ADVECT_PPM,
  CF_ADVECT_LINEAR,
  CF_ADVECT_WENO5,
  CF_ADVECT_CUBIC
} cf_advect_scheme;

/* What the time derivative of a flux means in a moving medium:
 *   objective     q_t + div(u q) - q.grad u = 0: the flux turns and stretches with the medium (upper convected)
 *   conservative  q_t + div(u q) = 0                                                                        (9)
 *   material      q_t + u.grad q = 0                                                                       (10) */
typedef enum cf_flux_rate { CF_RATE_OBJECTIVE, CF_RATE_CONSERVATIVE, CF_RATE_MATERIAL } cf_flux_rate;

/* Amounts (integrals over wall faces and time, in units of phi times a volume) that the flow brought in and
 * carried out; both are >= 0 where phi is. Inside changes by entered - left to round-off. */
typedef struct cf_through {
  double entered, left;
} cf_through;

typedef struct cf_advect cf_advect;

/* Allocates all scratch; nothing below allocates. `g` must outlive the object. CF_NO_MEMORY. */
cf_status cf_advect_create(cf_advect **a, const cf_grid *g, cf_advect_scheme scheme);
void cf_advect_destroy(cf_advect *a);

/* The velocity of the medium, m/s on faces; kept by reference, and its first layer of ghosts is written. Of
 * `walls` only the periodic axes are read: a velocity through an insulated wall must already be 0.
 * CF_NOT_FINITE: some velocity is not. */
cf_status cf_advect_set_velocity(cf_advect *a, cf_face u, const cf_walls *walls);

/* The Courant number of the velocity for dt = 1, in 1/s: dt = cfl/rate moves things by cfl. With
 * c = u dt/h on the faces of a cell it is the maximum over cells and axes d of
 * max(c_d+, 0) + max(-c_d-, 0) + sum over e != d of max(c_e+ - c_e-, 0). 0 where nothing moves. */
double cf_advect_rate(const cf_advect *a);

/* Substeps that a step of dt takes, as many as keep the Courant number (with CF_ADVECT_WENO5 dim times it)
 * <= 0.9; 1 with CF_ADVECT_LINEAR and CF_ADVECT_CUBIC. */
double cf_advect_substeps(const cf_advect *a, double dt);

#define CF_ADVECT_SUBSTEPS_MAX 100000

/* Fixes time, length and substeps of the moves that follow, and their order of axes.
 * CF_BAD_ARGUMENT: dt < 0. CF_OVER_LIMIT: the step would need more than CF_ADVECT_SUBSTEPS_MAX substeps. */
cf_status cf_advect_begin(cf_advect *a, double t, double dt);

/* Counts substeps; its parity sets the order of the axes, which is reversed every substep: with a fixed order
 * the scheme is of first order. It is state: whoever saves and restores phi must save and restore it. */
int64_t *cf_advect_parity(cf_advect *a);

/* Moves phi over the step begun. Walls of phi: insulated mirrors; open lets 0 in; value and radiate let their
 * function (at the wall's face centres, at the middle of each substep) in; what flows out is phi itself.
 * Amounts are added to `through` (NULL is fine; with CF_ADVECT_LINEAR and _CUBIC it stays as it is). */
cf_status cf_advect_cell(cf_advect *a, const cf_walls *walls, cf_cell phi, cf_through *through);

/* Moves the components of q over the step begun, each on volumes around its own faces. q.n on insulated walls
 * is 0; through all other walls the nearest q flows in. q must not be the velocity itself (move a copy). With
 * CF_ADVECT_LINEAR and CF_ADVECT_CUBIC conservative and material are the same. */
cf_status cf_advect_face(cf_advect *a, const cf_walls *walls, cf_flux_rate rate, cf_face q);

/* ========================================================================================================
 * 3. The solver
 *
 * Every implicit equation here is
 *
 *     (alpha - div beta grad) x = b        on cells, in a box with walls,
 *
 * alpha >= 0 a number or a cell field, beta >= 0 a number or a face field:
 *
 *     backward Euler for heat      alpha 1,  beta dt k,                             b the old phi
 *     a stage of (1, 6-8)          alpha C,  beta d k (d + F_T tau)/(d + tau),      b as in (17)
 *     Poisson                      alpha 0,  beta 1,                                b any that sums to zero
 *
 *     cf_helmholtz *A;
 *     cf_helmholtz_create(&A, &grid, &walls, 0);
 *     cf_helmholtz_set(A, &(cf_coefficients){.alpha = 1, .beta = dt*k});
 *     cf_helmholtz_solve(A, b, &(cf_solve_options){1e-8, 100}, x, &report);
 *
 * Faces are those of a five-point (seven-point) stencil, (A x)_p = alpha_p x_p + sum over the faces f of p of
 * beta_f (x_p - x_neighbour)/h^2. On an insulated wall nothing is added; on an open or value wall x is known
 * half a cell away, and the face adds 2 beta_f (x_p - x_wall)/h^2: the matrix has 2 beta_f x_p/h^2, and
 * 2 beta_f x_wall/h^2 belongs to your b. Radiating walls count as insulated ones.
 *
 * The solver is a multigrid V-cycle, alone where alpha and beta are numbers and within flexible conjugate gradients
 * (Polak-Ribiere) where they vary: about 6 of them for six digits whatever n, alpha and beta are. Any extents will do, also
 * odd and long ones.
 * ===================================================================================================== */

/* --- which cells -------------------------------------------------------------------------------------------- *
 *
 * The equation may hold in a part of the box only. Every cell then has a kind, and between a cell inside and one of
 * another kind holds what holds on a wall of the box:
 *   wall     the face is closed, as on an insulated wall
 *   inside   the equation's own
 *   held     the value of that cell is known on the face
 *   outside  the value on the face is 0, as on an open wall
 *
 *     cf_region *region;
 *     cf_region_create(&region, &grid);                        // all inside
 *     cf_region_kinds(region)[p] = CF_CELL_WALL;               // p as in a cf_cell
 *     cf_region_update(region);                                // whenever kinds have changed
 *     cf_helmholtz_set(A, &(cf_coefficients){.alpha = 1, .beta = dt*k, .region = region});
 */

#define CF_CELL_KIND_LIST(K) K(WALL, wall) K(INSIDE, inside) K(HELD, held) K(OUTSIDE, outside)

typedef enum cf_cell_kind {
#define CF_CELL_KIND_ENUM(upper, lower) CF_CELL_##upper,
  CF_CELL_KIND_LIST(CF_CELL_KIND_ENUM)
#undef CF_CELL_KIND_ENUM
} cf_cell_kind;

/* Every cell inside. CF_NO_MEMORY. */
cf_status cf_region_create(cf_region **r, const cf_grid *g);
void cf_region_destroy(cf_region *r);

/* The kinds, a byte a cell, in the layout of a cf_cell (ghosts are not read); and the values of held cells. Both are
 * yours to write. */
unsigned char *cf_region_kinds(cf_region *r);
cf_cell cf_region_values(cf_region *r);

/* Takes what was written. CF_BAD_ARGUMENT: a byte that is no kind. */
cf_status cf_region_update(cf_region *r);

/* The number of cells inside. */
ptrdiff_t cf_region_inside(const cf_region *r);

/* The operator, with the multigrid hierarchy that solves it. */
typedef struct cf_helmholtz cf_helmholtz;

typedef struct cf_coefficients {
  double alpha, beta;      /* used where the fields below are NULL; beta in m^2 (times alpha's unit) */
  const cf_cell *alpha_at; /* fields on the grid's box, owned by the caller, alive while solving */
  const cf_face *beta_at;
  const cf_region *region; /* NULL: the whole box; otherwise on the same grid, alive while solving */
} cf_coefficients;

/* levels: 0 for as many as the equation needs, otherwise at most that many (1: no coarse grids). Of `walls` only
 * the kinds are read. CF_NO_MEMORY. */
cf_status cf_helmholtz_create(cf_helmholtz **A, const cf_grid *g, const cf_walls *walls, int levels);
void cf_helmholtz_destroy(cf_helmholtz *A);

/* Coefficients may change from step to step; they must be set once before anything below. beta's faces on the
 * high side of a periodic axis are set to those on its low side. Fields cost the hierarchy their own memory,
 * taken when first seen: CF_NO_MEMORY. CF_BAD_ARGUMENT: negative or not finite numbers. The same numbers again in a region
 * that has not been updated since cost nothing. */
cf_status cf_helmholtz_set(cf_helmholtz *A, const cf_coefficients *c);

/* Solves A x = b to |b - A x| <= tolerance |b|; x comes as the initial guess. With alpha = 0 and no held wall
 * the solution is known up to a constant: a mean of b that the tolerance would notice is taken out of b, and x keeps the
 * mean it came with (in a region, every part that is cut off for itself). Cells that are not inside are left alone. Otherwise
 * b is kept. Not converging is a report, not a failure. CF_NOT_FINITE: b or x holds a value that is not. */
cf_status cf_helmholtz_solve(cf_helmholtz *A, cf_cell b, const cf_solve_options *o, cf_cell x,
                             cf_solve_report *report);

/* b += what cells of the region that are held contribute, 2 beta x_held/h^2 for each of their faces. */
void cf_helmholtz_add_held(const cf_helmholtz *A, cf_cell b);

/* y = A x. x's ghosts on periodic walls may be filled. */
void cf_helmholtz_apply(cf_helmholtz *A, cf_cell x, cf_cell y);

/* |b - A x| / |b|, computed afresh. */
double cf_helmholtz_residual(cf_helmholtz *A, cf_cell x, cf_cell b);

/* ========================================================================================================
 * The list of all functions above, without cf_. The build makes the exports of the libraries of it, and with
 * CF_SINGLE the names that the linker sees: cff_ for cf_.
 * ===================================================================================================== */

/* clang-format off */
#define CF_PUBLIC_LIST(F)                                                                               \
  F(version) F(status_sentence) F(status_name) F(status_exit_code) F(free)                              \
  F(scene_read) F(scene_destroy) F(scene_explain)                                                       \
  F(sim_create) F(sim_destroy) F(sim_step) F(sim_run)                                                   \
  F(sim_time) F(sim_end) F(sim_step_count) F(sim_finished) F(sim_frames) F(sim_frame_time)              \
  F(sim_particles) F(sim_particles_name) F(sim_particles_attribute)                                     \
  F(sim_warning) F(sim_field) F(sim_field_name) F(sim_metric_names) F(sim_metrics)                      \
  F(sim_save) F(sim_load)                                                                               \
  F(box_init) F(grid_init) F(cell_create) F(cell_destroy) F(face_create) F(face_destroy)                \
  F(diffuse_create) F(diffuse_destroy) F(diffuse_step) F(diffuse_content) F(diffuse_region_changed)                               \
  F(diffuse_k_max) F(diffuse_speed_max) F(ledger_error) F(ledger_add)                                   \
  F(advect_create) F(advect_destroy) F(advect_set_velocity) F(advect_rate) F(advect_substeps)           \
  F(advect_begin) F(advect_parity) F(advect_cell) F(advect_face)                                        \
  F(region_create) F(region_destroy) F(region_kinds) F(region_values) F(region_update)                  \
  F(region_inside)                                                                                      \
  F(helmholtz_create) F(helmholtz_destroy) F(helmholtz_set) F(helmholtz_solve)                          \
  F(helmholtz_apply) F(helmholtz_residual) F(helmholtz_add_held)
/* clang-format on */

#ifdef CF_SINGLE
#define CF_PRAGMA_TEXT(text) _Pragma(#text)
#define CF_RENAME(name)      CF_PRAGMA_TEXT(redefine_extname cf_##name cff_##name)
CF_PUBLIC_LIST(CF_RENAME)
#undef CF_RENAME
#undef CF_PRAGMA_TEXT
#endif

#ifdef __GNUC__
#pragma GCC visibility pop
#endif
#ifdef __cplusplus
}
#endif

#endif
