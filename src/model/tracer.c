/* SPDX-License-Identifier: MIT
 *
 * Model `tracer`: any number of scalars with C-F diffusion in a medium whose velocity is prescribed (section
 * 5 of the paper, Figs 3 and 4):
 *
 *     C (phi_t + div(u phi)) + div(q_C - F_T k grad phi) = C W
 *     tau [q_t + div(u q) - q.grad u] + q + (1 - F_T) k grad phi = tau B        (objective rate; others as
 * asked)
 *
 * One step is Strang's: half a move with the flow, diffusion, half a move (each half with the velocity at its
 * middle); `scheme: paper` takes Lie's, the whole move with the old velocity and then eqs 13 to 18.
 *
 * Around obstacles the velocity is led (detour.h), and nothing passes them. They stand still during a step and are
 * placed anew at its end.
 *
 * The flow does not know of the scalars: for that there is another model (flow.c).
 */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "base/mem.h"
#include "grid/sweep.h"
#include "grid/wall.h"
#include "model/detour.h"
#include "model/drifters.h"
#include "model/scalars.h"
#include "stencil/courant.h"

#define STUCK 1e-3 /* from this share on a warning is due */

typedef struct cf_tracer {
  cf_scalars scalars;
  cf_obstacles obstacles;
  cf_detour detour; /* where something moves around obstacles */
  bool velocity_in_time;
  double fastest;       /* largest component of the velocity on any face, m/s */
  double through_walls; /* largest that stood on an insulated wall */
  cf_face u;
  cf_drifters points;
  cf_face at[3]; /* for points in a flow that changes: at the beginning, middle and end of a step */
} cf_tracer;

/* --- the velocity ----------------------------------------------------------------------------------------- */

static const cf_function *velocity_of(const cf_scene *scene, const int axis) {
  return &scene->velocity.axis[scene->velocity.count > 1 ? axis : 0];
}

/* What counts as passing through a wall: sin(pi x) at x = 1 is 1.2e-16. */
#define ROUND_OFF 1e-9

/* The largest component of u on any face. */
static double fastest(const cf_tracer *m, const cf_face field) {
  const cf_box *box = &m->scalars.grid->box;
  double largest = 0;
  for (int a = 0; a < box->dim; ++a) {
    const ptrdiff_t rows = (ptrdiff_t)cf_box_extent(box, 1, a) * cf_box_extent(box, 2, a);
    const int threads = cf_sweep_threads(box, m->scalars.grid->threads), n = cf_box_extent(box, 0, a);
#pragma omp parallel for schedule(static) num_threads(threads) reduction(max : largest)
    for (ptrdiff_t r = 0; r < rows; ++r) {
      const cf_real *u = field.at[a] + cf_box_face_row(box, a, r);
      for (int i = 0; i < n; ++i) largest = CF_MAX(largest, fabs((double)u[i]));
    }
  }
  return largest;
}

/* Sets u.n = 0 on the insulated walls of the domain; returns the largest value that stood there, 0 if that is no more
 * than round-off. */
static double close_walls(cf_tracer *m, const cf_face field) {
  const cf_box *box = &m->scalars.grid->box;
  double largest = 0;
  m->fastest = fastest(m, field);
  for (int a = 0; a < box->dim; ++a)
    for (int side = 0; side < 2; ++side) {
      if (m->scalars.scene->domain.walls.walls.kind[a][side] != CF_WALL_INSULATED) continue;
      const cf_wall_side w = cf_wall_side_of(box, a, side);
      for (int i_c = 0; i_c < w.n_c; ++i_c)
        for (int i_b = 0; i_b < w.n_b; ++i_b) {
          cf_real *u = &field.at[a][cf_wall_cell(box, &w, i_b, i_c) + (side == 0 ? 0 : w.outward)];
          largest = CF_MAX(largest, fabs((double)*u));
          *u = 0;
        }
    }
  return largest > ROUND_OFF * m->fastest ? largest : 0;
}

/* The given velocity at time t, closed on walls and led around obstacles. report: NULL before there are steps. */
static cf_status sample_velocity(cf_tracer *m, const double t, const cf_face u, cf_step_report *report) {
  const cf_grid *g = m->scalars.grid;
  cf_solve_report one;
  for (int a = 0; a < g->box.dim; ++a)
    CF_TRY(cf_grid_sample(g, &velocity_of(m->scalars.scene, a)->fn, a, t, u.at[a]));
  m->through_walls = close_walls(m, u);
  if (m->obstacles.count == 0) return CF_OK;
  CF_TRY(cf_detour_make(&m->detour, u, &one));
  if (report != NULL) cf_step_report_add(report, CF_STAGE_PROJECT, &one);
  return CF_OK;
}

static cf_status set_velocity(cf_tracer *m, const double t, cf_step_report *report) {
  CF_TRY(sample_velocity(m, t, m->u, report));
  return cf_scalars_set_velocity(&m->scalars, m->u);
}

static cf_status make_velocity(cf_tracer *m) {
  const cf_scene *scene = m->scalars.scene;
  bool moves = false;
  m->velocity_in_time = m->obstacles.changes;
  for (int a = 0; a < m->scalars.grid->box.dim; ++a) {
    const cf_fn *f = &velocity_of(scene, a)->fn;
    moves = moves || !cf_fn_is_constant(f) || f->value != 0;
    m->velocity_in_time = m->velocity_in_time || f->in_time;
  }
  if (!moves) return CF_OK;
  CF_TRY(cf_face_create(&m->u, &m->scalars.grid->box));
  return cf_scalars_carry(&m->scalars, -1);
}

/* The velocity at time 0, which plans need, and the way it takes around obstacles. */
static cf_status begin_velocity(cf_tracer *m) {
  const cf_scalars *s = &m->scalars;
  if (!s->moves) return CF_OK;
  if (m->obstacles.count > 0)
    CF_TRY(cf_detour_create(&m->detour, &m->obstacles, &s->scene->domain.walls.walls, s->solid));
  const cf_status status = set_velocity(m, 0, NULL);
  if (status != CF_NOT_FINITE) return status;
  char why[CF_SENTENCE_MAX];
  snprintf(why, sizeof why, "%s", cf_status_sentence());
  return cf_scene_fail_at(s->scene, "velocity", "at time 0: %s", why);
}

static cf_status register_velocity(const cf_tracer *m, cf_registry *r) {
  if (!m->scalars.moves) return CF_OK;
  CF_TRY(cf_scalars_register_moves(&m->scalars, r));
  return cf_registry_add_face(r, "velocity", "m/s", m->u);
}

/* A scalar's insulated wall in the way of the flow would pile it up without end. */
static cf_status check_walls(const cf_tracer *m, const cf_scalar *s) {
  const cf_box *box = &m->scalars.grid->box;
  if (!m->scalars.moves) return CF_OK;
  for (int a = 0; a < box->dim; ++a)
    for (int side = 0; side < 2; ++side) {
      if (s->walls.kind[a][side] != CF_WALL_INSULATED) continue;
      const cf_wall_side w = cf_wall_side_of(box, a, side);
      for (int i_c = 0; i_c < w.n_c; ++i_c)
        for (int i_b = 0; i_b < w.n_b; ++i_b)
          if (fabs((double)m->u.at[a][cf_wall_cell(box, &w, i_b, i_c) + (side == 0 ? 0 : w.outward)]) >
              ROUND_OFF * m->fastest) {
            char key[2 * CF_NAME_MAX];
            snprintf(key, sizeof key, "fields.%s.walls", s->name);
            return cf_scene_fail_at(m->scalars.scene, key,
                                    "the %c%c wall of %s is insulated, but the flow passes through it",
                                    "xyz"[a], side == 0 ? '-' : '+', s->name);
          }
    }
  return CF_OK;
}

/* --- points ----------------------------------------------------------------------------------------------- */

static cf_drift drift_of(const cf_tracer *m) {
  const cf_walls *walls = &m->scalars.scene->domain.walls.walls;
  cf_drift d = {.grid = m->scalars.grid};
  for (int when = 0; when < 3; ++when) d.u[when] = m->at[when].at[0] != NULL ? m->at[when] : m->u;
  for (int a = 0; a < d.grid->box.dim; ++a) {
    d.wraps[a] = walls->kind[a][0] == CF_WALL_PERIODIC;
    for (int side = 0; side < 2; ++side) d.open[a][side] = walls->kind[a][side] != CF_WALL_INSULATED;
  }
  return d;
}

/* The velocity at time t into the field of the points that is for `when`. */
static cf_status sample_for_points(cf_tracer *m, const int when, const double t, cf_step_report *report) {
  const cf_drift flow = drift_of(m);
  CF_TRY(sample_velocity(m, t, m->at[when], report));
  cf_courant_ghosts(m->scalars.grid, flow.wraps, m->at[when]);
  return CF_OK;
}

static cf_status make_points(cf_tracer *m, cf_registry *r) {
  const cf_scene *scene = m->scalars.scene;
  if (scene->points.count > 0 && !m->scalars.moves)
    return cf_scene_fail_at(scene, "points", "points: there is no velocity that could carry them");
  CF_TRY(cf_drifters_create(&m->points, scene, m->scalars.grid));
  for (int when = 0; when < 3 && m->points.set != NULL && m->velocity_in_time; ++when) {
    CF_TRY(cf_face_create(&m->at[when], &m->scalars.grid->box));
    CF_TRY(sample_for_points(m, when, 0, NULL));
  }
  return cf_drifters_start(&m->points, r);
}

static cf_status move_points(cf_tracer *m, const double t, const double dt, cf_step_report *report) {
  if (m->points.set == NULL) return CF_OK;
  for (int when = 0; when < 3 && m->velocity_in_time; ++when)
    CF_TRY(sample_for_points(m, when, t + when * dt / 2, report));
  const cf_drift flow = drift_of(m);
  return cf_drifters_step(&m->points, &flow, t, dt);
}

static cf_status tracer_show(void *model) {
  const cf_tracer *m = model;
  const cf_drift flow = drift_of(m);
  cf_drifters_show(&m->points, &flow);
  return CF_OK;
}

/* --- making one ------------------------------------------------------------------------------------------- */

static double tracer_natural_dt(const void *model, const double t) {
  (void)t;
  const cf_tracer *m = model;
  double rate = m->obstacles.changes ? cf_obstacles_speed(&m->obstacles) / m->scalars.grid->h : 0;
  for (int s = 0; s < CF_ADVECT_SCHEMES; ++s)
    if (m->scalars.by_scheme[s] != NULL) rate = CF_MAX(rate, cf_advect_rate(m->scalars.by_scheme[s]));
  return cf_scalars_natural_dt(&m->scalars, rate);
}

static cf_status make(cf_tracer *m, const cf_scene *scene, cf_registry *r) {
  CF_TRY(cf_obstacles_create(&m->obstacles, scene, r->grid));
  m->scalars.obstacles = m->points.solids = &m->obstacles;
  CF_TRY(cf_scalars_create(&m->scalars, scene, r->grid));
  CF_TRY(make_velocity(m));
  CF_TRY(begin_velocity(m));
  CF_TRY(cf_scalars_make(&m->scalars, isnan(scene->time.dt) ? tracer_natural_dt(m, 0) : scene->time.dt, r));
  CF_TRY(register_velocity(m, r));
  CF_TRY(cf_obstacles_register(&m->obstacles, r));
  for (int i = 0; i < m->scalars.count; ++i) CF_TRY(check_walls(m, &m->scalars.item[i]));
  return make_points(m, r);
}

static void tracer_destroy(void *model) {
  cf_tracer *m = model;
  if (m == NULL) return;
  cf_face_destroy(&m->u, &m->scalars.grid->box);
  cf_detour_destroy(&m->detour);
  for (int when = 0; when < 3; ++when) cf_face_destroy(&m->at[when], &m->scalars.grid->box);
  cf_drifters_destroy(&m->points);
  cf_scalars_destroy(&m->scalars);
  cf_obstacles_destroy(&m->obstacles);
  cf_free(m);
}

static cf_status tracer_create(void **model, const cf_scene *scene, cf_registry *registry) {
  cf_tracer *m;
  CF_TRY(CF_NEW(&m, 1));
  m->scalars.grid = registry->grid;
  const cf_status s = make(m, scene, registry);
  if (s != CF_OK) {
    tracer_destroy(m);
    return s;
  }
  *model = m;
  return CF_OK;
}

/* --- a step ----------------------------------------------------------------------------------------------- */

/* Every scalar that is (not) the paper's moves over [t, t + dt] with the velocity of t_velocity. */
static cf_status move(cf_tracer *m, const bool paper, const double t, const double dt,
                      const double t_velocity, cf_step_report *report) {
  bool begun[CF_ADVECT_SCHEMES] = {false};
  if (!m->scalars.moves) return CF_OK;
  if (m->velocity_in_time) CF_TRY(set_velocity(m, t_velocity, report));
  CF_TRY(cf_scalars_move(&m->scalars, paper, t, dt, begun));
  if (m->through_walls > 0 && report->warning[0] == '\0')
    snprintf(report->warning, sizeof report->warning,
             "the velocity passes through insulated walls (up to %g m/s): set to 0 there", m->through_walls);
  if (m->detour.stuck > STUCK && report->warning[0] == '\0')
    snprintf(
        report->warning, sizeof report->warning,
        "obstacles stand where the velocity enters or leaves the box: %.2g %% of what they stop has no way "
        "out and piles up or runs dry",
        100 * m->detour.stuck);
  return CF_OK;
}

static cf_status tracer_step(void *model, const double t, const double dt, cf_step_report *report) {
  cf_tracer *m = model;
  double clock = cf_stage_clock();
  CF_TRY(cf_scalars_follow(&m->scalars, dt));
  cf_obstacles_pace(&m->obstacles, t + dt / 2, dt);
  CF_TRY(move(m, true, t, dt, t, report));
  CF_TRY(move(m, false, t, dt / 2, t + dt / 4, report));
  clock = cf_stage_end(report, CF_STAGE_ADVECT, clock);
  CF_TRY(cf_scalars_diffuse(&m->scalars, t, dt, report));
  clock = cf_stage_end(report, CF_STAGE_DIFFUSE, clock);
  CF_TRY(move(m, false, t + dt / 2, dt / 2, t + 3 * dt / 4, report));
  clock = cf_stage_end(report, CF_STAGE_ADVECT, clock);
  CF_TRY(move_points(m, t, dt, report));
  cf_stage_end(report, CF_STAGE_TRANSFER, clock);
  CF_TRY(cf_obstacles_place(&m->obstacles, t + dt, dt));
  m->detour.set = m->detour.set && !m->obstacles.changes;
  return cf_scalars_place(&m->scalars);
}

/* The velocity has been read back as the last step had it: the length of the next one may hang on that. */
static cf_status tracer_restored(void *model) {
  cf_tracer *m = model;
  CF_TRY(cf_obstacles_restored(&m->obstacles));
  CF_TRY(cf_scalars_restored(&m->scalars));
  m->detour.set = false;
  if (m->at[2].at[0] != NULL) CF_TRY(sample_for_points(m, 2, m->points.time, NULL));
  return m->scalars.moves ? cf_scalars_set_velocity(&m->scalars, m->u) : CF_OK;
}

/* --- telling ---------------------------------------------------------------------------------------------- */

static bool tracer_describe(const void *model, const int line, char *text, const size_t size) {
  return cf_scalars_describe(&((const cf_tracer *)model)->scalars, line, text, size);
}

static int tracer_metric_names(const void *model, cf_metric *names) {
  const cf_tracer *m = model;
  const int count = cf_scalars_metric_names(&m->scalars, names);
  return count + cf_drifters_metric_names(&m->points, names + count);
}

static void tracer_metrics(const void *model, double *values) {
  const cf_tracer *m = model;
  cf_scalars_metrics(&m->scalars, values);
  (void)cf_drifters_metrics(&m->points, values + CF_SCALAR_METRICS * m->scalars.count);
}

static double tracer_memory(const cf_scene *scene) {
  const double velocities = scene->dim * (scene->points.count > 0 ? 4 : 1);
  return cf_scalars_bytes(scene, velocities + cf_scalars_memory(scene)) + cf_drifters_memory(scene);
}

static const char *const tracer_keys[] = {"diffusion", "advection", "fields",    "velocity", "sources",
                                          "sparse",    "points",    "obstacles", NULL};

static cf_status tracer_check(const cf_scene *scene, const double dt, const cf_page *page) {
  (void)dt;
  cf_drifters_check(scene, page);
  return CF_OK;
}

static cf_status tracer_resolve(cf_scene *scene) { return cf_drifters_resolve(scene); }

static const cf_obstacles *tracer_obstacles(const void *model) {
  return &((const cf_tracer *)model)->obstacles;
}

static bool tracer_shows(const cf_scene *scene, const char *name) {
  if (cf_drifters_shows(scene, name)) return true;
  return scene->given.velocity && strcmp(name, "velocity") == 0;
}

const cf_model cf_model_tracer = {
    .name = "tracer",
    .summary = "scalars with C-F diffusion in a prescribed flow",
    .keys = tracer_keys,
    .resolve = tracer_resolve,
    .shows = tracer_shows,
    .memory = tracer_memory,
    .check = tracer_check,
    .create = tracer_create,
    .destroy = tracer_destroy,
    .restored = tracer_restored,
    .natural_dt = tracer_natural_dt,
    .describe = tracer_describe,
    .step = tracer_step,
    .obstacles = tracer_obstacles,
    .show = tracer_show,
    .metric_names = tracer_metric_names,
    .metrics = tracer_metrics,
};
