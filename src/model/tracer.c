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
 * The flow does not know of the scalars: for that there is another model.
 */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "base/mem.h"
#include "grid/sweep.h"
#include "grid/wall.h"
#include "model/model.h"
#include "model/sources.h"
#include "physics/advect.h"
#include "physics/diffuse.h"
#include "stencil/front.h"

/* Below this share of Fourier diffusion a front is sharp enough to ring (`front_filter: auto`). */
#define FILTER_BELOW 0.01
/* `dt: auto` where only Fourier diffusion limits the step: so many explicit steps in one. */
#define FOURIER_STEPS 16

enum { ADVECT_SCHEMES = 4 };

typedef struct scalar {
  char name[CF_NAME_MAX], flux[CF_NAME_MAX];
  cf_cell phi;
  cf_face q;
  cf_walls walls;
  cf_diffuse *diffuse;
  cf_sources *sources;
  cf_ledger ledger;
  const cf_scene_diffusion *scene;
  bool paper, has_memory; /* has_memory: q at the end of a step matters to the next one */
} scalar;

typedef struct tracer {
  const cf_scene *scene;
  const cf_grid *grid;
  int count;
  scalar *scalar;
  bool moves, velocity_in_time;
  double through_walls; /* largest velocity that stood on an insulated wall */
  cf_face u;
  cf_advect *by_scheme[ADVECT_SCHEMES]; /* by cf_advect_scheme, made where needed */
  cf_cell work;                         /* of the front filter */
  double *rows;
} tracer;

/* --- the velocity -----------------------------------------------------------------------------------------
 */

static const cf_function *velocity_of(const cf_scene *scene, const int axis) {
  return &scene->velocity.axis[scene->velocity.count > 1 ? axis : 0];
}

/* Sets u.n = 0 on the insulated walls of the domain; returns the largest value that stood there. */
static double close_walls(const tracer *m) {
  const cf_box *box = &m->grid->box;
  double largest = 0;
  for (int a = 0; a < box->dim; ++a)
    for (int side = 0; side < 2; ++side) {
      if (m->scene->domain.walls.walls.kind[a][side] != CF_WALL_INSULATED) continue;
      const cf_wall_side w = cf_wall_side_of(box, a, side);
      for (int i_c = 0; i_c < w.n_c; ++i_c)
        for (int i_b = 0; i_b < w.n_b; ++i_b) {
          cf_real *u = &m->u.at[a][cf_wall_cell(box, &w, i_b, i_c) + (side == 0 ? 0 : w.outward)];
          largest = CF_MAX(largest, fabs((double)*u));
          *u = 0;
        }
    }
  return largest;
}

static cf_status set_velocity(tracer *m, const double t) {
  for (int a = 0; a < m->grid->box.dim; ++a)
    CF_TRY(cf_grid_sample(m->grid, &velocity_of(m->scene, a)->fn, a, t, m->u.at[a]));
  m->through_walls = close_walls(m);
  for (int s = 0; s < ADVECT_SCHEMES; ++s)
    if (m->by_scheme[s] != NULL)
      CF_TRY(cf_advect_set_velocity(m->by_scheme[s], m->u, &m->scene->domain.walls.walls));
  return CF_OK;
}

static cf_advect_scheme advection_of(const tracer *m, const scalar *s) {
  static const cf_advect_scheme by_word[] = {[CF_SCENE_ADVECTION_PPM] = CF_ADVECT_PPM,
                                             [CF_SCENE_ADVECTION_LINEAR] = CF_ADVECT_LINEAR,
                                             [CF_SCENE_ADVECTION_WENO5] = CF_ADVECT_WENO5,
                                             [CF_SCENE_ADVECTION_CUBIC] = CF_ADVECT_CUBIC};
  if (s->paper && !m->scene->advection.given.scheme) return CF_ADVECT_LINEAR;
  return by_word[m->scene->advection.scheme];
}

static cf_status make_velocity(tracer *m, cf_registry *r) {
  static const char *const parity[ADVECT_SCHEMES] = {"sweep_parity", "sweep_parity_linear",
                                                     "sweep_parity_weno5", "sweep_parity_cubic"};
  for (int a = 0; a < m->grid->box.dim; ++a) {
    const cf_fn *f = &velocity_of(m->scene, a)->fn;
    m->moves = m->moves || !cf_fn_is_constant(f) || f->value != 0;
    m->velocity_in_time = m->velocity_in_time || f->in_time;
  }
  if (!m->moves) return CF_OK;
  CF_TRY(cf_face_create(&m->u, &m->grid->box));
  for (int i = 0; i < m->count; ++i) {
    const cf_advect_scheme s = advection_of(m, &m->scalar[i]);
    if (m->by_scheme[s] != NULL) continue;
    CF_TRY(cf_advect_create(&m->by_scheme[s], m->grid, s));
    CF_TRY(cf_registry_add_counter(r, parity[s], cf_advect_parity(m->by_scheme[s])));
  }
  CF_TRY(set_velocity(m, 0));
  return cf_registry_add_face(r, "velocity", "m/s", m->u);
}

/* --- creation ---------------------------------------------------------------------------------------------
 */

static cf_diffuse_params diffuse_params(const cf_scene *scene, const cf_scene_diffusion *d) {
  return (cf_diffuse_params){
      .k = d->k.fn,
      .capacity = d->capacity.fn,
      .tau = d->tau,
      .f_t = d->f_t,
      .scheme = d->scheme == CF_SCENE_SCHEME_PAPER ? CF_DIFFUSE_PAPER : CF_DIFFUSE_SDIRK2,
      .solver = {scene->solver.tolerance, (int)scene->solver.max_iterations},
      .levels = (int)scene->solver.levels,
  };
}

/* No flux stands on an insulated wall, whatever an expression says. */
static void close_flux(const cf_grid *g, const cf_walls *walls, const cf_face q) {
  for (int a = 0; a < g->box.dim; ++a)
    for (int side = 0; side < 2; ++side) {
      if (walls->kind[a][side] != CF_WALL_INSULATED) continue;
      const cf_wall_side w = cf_wall_side_of(&g->box, a, side);
      for (int i_c = 0; i_c < w.n_c; ++i_c)
        for (int i_b = 0; i_b < w.n_b; ++i_b)
          q.at[a][cf_wall_cell(&g->box, &w, i_b, i_c) + (side == 0 ? 0 : w.outward)] = 0;
    }
}

static cf_status initial_flux(const tracer *m, scalar *s) {
  const int f = cf_scene_field_index(m->scene, s->flux);
  if (f < 0) return CF_OK;
  const cf_param_profiles *initial = &m->scene->fields.item[f].initial;
  for (int a = 0; a < m->grid->box.dim; ++a)
    CF_TRY(cf_grid_sample(m->grid, &initial->axis[initial->count > 1 ? a : 0].fn, a, 0, s->q.at[a]));
  close_flux(m->grid, &s->walls, s->q);
  return CF_OK;
}

/* The flux of phi, or of the only scalar, is q; that of NAME is q_NAME. */
static void name_flux(const tracer *m, scalar *s) {
  char own[CF_NAME_MAX + 2];
  snprintf(own, sizeof own, "q_%s", s->name);
  const bool plain =
      strcmp(s->name, "phi") == 0 || (m->count == 1 && cf_scene_field_index(m->scene, own) < 0);
  snprintf(s->flux, sizeof s->flux, "%.*s", CF_NAME_MAX - 1, plain ? "q" : own);
}

static cf_status make_scalar(tracer *m, const int field, scalar *s, cf_registry *r) {
  const cf_scene_field *f = &m->scene->fields.item[field];
  cf_source acts;
  s->scene = &f->diffusion;
  s->walls = f->walls.walls;
  s->paper = s->scene->scheme == CF_SCENE_SCHEME_PAPER;
  s->has_memory = s->scene->tau > 0;
  name_flux(m, s);
  CF_TRY(cf_cell_create(&s->phi, &m->grid->box));
  CF_TRY(cf_face_create(&s->q, &m->grid->box));
  CF_TRY(cf_sources_create(&s->sources, m->scene, m->grid, field, s->flux, &acts));
  const cf_diffuse_params p = diffuse_params(m->scene, s->scene);
  const cf_status made = cf_diffuse_create(&s->diffuse, m->grid, &s->walls, &p, &acts);
  if (made == CF_BAD_ARGUMENT) {
    char why[CF_SENTENCE_MAX], key[2 * CF_NAME_MAX];
    snprintf(why, sizeof why, "%s", cf_status_sentence());
    snprintf(key, sizeof key, "fields.%s.diffusion", s->name);
    return cf_scene_fail_at(m->scene, cf_scene_has(m->scene, key) ? key : "diffusion", "%s", why);
  }
  CF_TRY(made);
  CF_TRY(cf_grid_sample(m->grid, &f->initial.axis[0].fn, CF_CENTRES, 0, s->phi.at));
  CF_TRY(initial_flux(m, s));
  s->ledger.first = cf_diffuse_content(s->diffuse, s->phi);
  char ledger[CF_NAME_MAX + 8];
  snprintf(ledger, sizeof ledger, "ledger_%.*s", CF_NAME_MAX - 8, s->name);
  CF_TRY(cf_registry_add_cell(r, s->name, f->unit, s->phi));
  CF_TRY(cf_registry_add_face(r, s->flux, "", s->q));
  return cf_registry_add_numbers(r, ledger, "", &s->ledger.first, 3);
}

/* A scalar's insulated wall in the way of the flow would pile it up without end. */
static cf_status check_walls(const tracer *m, const scalar *s) {
  const cf_box *box = &m->grid->box;
  if (!m->moves) return CF_OK;
  for (int a = 0; a < box->dim; ++a)
    for (int side = 0; side < 2; ++side) {
      if (s->walls.kind[a][side] != CF_WALL_INSULATED) continue;
      const cf_wall_side w = cf_wall_side_of(box, a, side);
      for (int i_c = 0; i_c < w.n_c; ++i_c)
        for (int i_b = 0; i_b < w.n_b; ++i_b)
          if (m->u.at[a][cf_wall_cell(box, &w, i_b, i_c) + (side == 0 ? 0 : w.outward)] != 0) {
            char key[2 * CF_NAME_MAX];
            snprintf(key, sizeof key, "fields.%s.walls", s->name);
            return cf_scene_fail_at(m->scene, key,
                                    "the %c%c wall of %s is insulated, but the flow passes through it",
                                    "xyz"[a], side == 0 ? '-' : '+', s->name);
          }
    }
  return CF_OK;
}

static cf_status make(tracer *m, cf_registry *r) {
  const cf_scene *scene = m->scene;
  CF_TRY(CF_NEW(&m->rows, 3 * cf_box_rows(&m->grid->box)));
  CF_TRY(CF_NEW(&m->scalar, CF_MAX(1, scene->fields.count)));
  int index[CF_METRICS_MAX];
  for (int f = 0; f < scene->fields.count; ++f) {
    if (cf_scene_name_is_flux(scene->fields.item[f].name)) continue;
    if (m->count == CF_METRICS_MAX / 4 - 2)
      return cf_scene_fail_at(scene, "fields", "more than %d scalars", CF_METRICS_MAX / 4 - 2);
    index[m->count] = f;
    snprintf(m->scalar[m->count++].name, CF_NAME_MAX, "%s", scene->fields.item[f].name);
  }
  CF_TRY(cf_cell_create(&m->work, &m->grid->box));
  for (int i = 0; i < m->count; ++i) CF_TRY(make_scalar(m, index[i], &m->scalar[i], r));
  CF_TRY(make_velocity(m, r));
  for (int i = 0; i < m->count; ++i) CF_TRY(check_walls(m, &m->scalar[i]));
  return CF_OK;
}

static void tracer_destroy(void *model) {
  tracer *m = model;
  if (m == NULL) return;
  for (int i = 0; m->scalar != NULL && i < m->count; ++i) {
    cf_diffuse_destroy(m->scalar[i].diffuse);
    cf_sources_destroy(m->scalar[i].sources);
    cf_cell_destroy(&m->scalar[i].phi, &m->grid->box);
    cf_face_destroy(&m->scalar[i].q, &m->grid->box);
  }
  cf_face_destroy(&m->u, &m->grid->box);
  cf_cell_destroy(&m->work, &m->grid->box);
  for (int s = 0; s < ADVECT_SCHEMES; ++s) cf_advect_destroy(m->by_scheme[s]);
  cf_free(m->scalar);
  cf_free(m->rows);
  cf_free(m);
}

static cf_status tracer_create(void **model, const cf_scene *scene, cf_registry *registry) {
  tracer *m;
  CF_TRY(CF_NEW(&m, 1));
  m->scene = scene;
  m->grid = registry->grid;
  const cf_status s = make(m, registry);
  if (s != CF_OK) {
    tracer_destroy(m);
    return s;
  }
  *model = m;
  return CF_OK;
}

/* The velocity has been read back as the last step had it: the length of the next one may hang on that. */
static cf_status tracer_restored(void *model) {
  tracer *m = model;
  for (int s = 0; s < 2; ++s)
    if (m->by_scheme[s] != NULL)
      CF_TRY(cf_advect_set_velocity(m->by_scheme[s], m->u, &m->scene->domain.walls.walls));
  return CF_OK;
}

/* --- a step -----------------------------------------------------------------------------------------------
 */

static double tracer_natural_dt(const void *model, const double t) {
  (void)t;
  const tracer *m = model;
  const double h = m->grid->h;
  double rate = 0; /* 1/dt at cfl 1 */
  for (int s = 0; s < ADVECT_SCHEMES; ++s)
    if (m->by_scheme[s] != NULL) rate = CF_MAX(rate, cf_advect_rate(m->by_scheme[s]));
  double diffusion = 0;
  for (int i = 0; i < m->count; ++i) {
    const scalar *s = &m->scalar[i];
    const double f_t = s->scene->tau > 0 ? s->scene->f_t : 1;
    diffusion = CF_MAX(diffusion, cf_diffuse_speed_max(s->diffuse) / h);
    diffusion = CF_MAX(diffusion, f_t * cf_diffuse_k_max(s->diffuse) / (FOURIER_STEPS * h * h));
  }
  rate += diffusion;
  const double longest = m->scene->time.end / 100;
  return rate > 0 ? CF_MIN(m->scene->time.cfl / rate, longest) : longest;
}

/* Every scalar that is carried by `scheme` moves over [t, t + dt] with the velocity of t_velocity. */
static cf_status move(tracer *m, const bool paper, const double t, const double dt, const double t_velocity,
                      cf_step_report *report) {
  if (!m->moves) return CF_OK;
  if (m->velocity_in_time) CF_TRY(set_velocity(m, t_velocity));
  bool begun[ADVECT_SCHEMES] = {false};
  for (int i = 0; i < m->count; ++i) {
    scalar *s = &m->scalar[i];
    if (s->paper != paper) continue;
    const cf_advect_scheme scheme = advection_of(m, s);
    cf_advect *a = m->by_scheme[scheme];
    if (!begun[scheme]) CF_TRY(cf_advect_begin(a, t, dt));
    begun[scheme] = true;
    cf_through through = {0, 0};
    CF_TRY(cf_advect_cell(a, &s->walls, s->phi, &through));
    s->ledger.entered += through.entered;
    s->ledger.left += through.left;
    const cf_flux_rate rate = s->paper && !s->scene->given.flux_rate                   ? CF_RATE_MATERIAL
                              : s->scene->flux_rate == CF_SCENE_FLUX_RATE_MATERIAL     ? CF_RATE_MATERIAL
                              : s->scene->flux_rate == CF_SCENE_FLUX_RATE_CONSERVATIVE ? CF_RATE_CONSERVATIVE
                                                                                       : CF_RATE_OBJECTIVE;
    if (s->has_memory) CF_TRY(cf_advect_face(a, &s->walls, rate, s->q));
  }
  if (m->through_walls > 0 && report->warning[0] == '\0')
    snprintf(report->warning, sizeof report->warning,
             "the velocity passes through insulated walls (up to %g m/s): set to 0 there", m->through_walls);
  return CF_OK;
}

static bool filtered(const scalar *s) {
  if (s->scene->front_filter == CF_SCENE_FILTER_AUTO)
    return !s->paper && s->scene->tau > 0 && s->scene->f_t < FILTER_BELOW;
  return s->scene->front_filter == CF_SCENE_FILTER_ON;
}

static void filter_fronts(const tracer *m, const scalar *s, const double dt) {
  const double courant = cf_diffuse_speed_max(s->diffuse) * dt / m->grid->h;
  const double nu = cf_front_strength(m->grid->box.dim, courant, 1);
  cf_front_cell(m->grid, &s->walls, nu, s->phi, m->work);
  cf_front_face(m->grid, &s->walls, nu, s->q, m->work);
}

static cf_status diffuse(tracer *m, scalar *s, const double t, const double dt, cf_step_report *report) {
  cf_solve_report one;
  CF_TRY(cf_diffuse_step(s->diffuse, t, dt, s->phi, s->q, &s->ledger, &one));
  cf_sources_hold_flux(s->sources, t + dt, s->q);
  if (filtered(s)) filter_fronts(m, s, dt);
  report->solve.iterations += one.iterations;
  report->solve.levels = one.levels;
  report->solve.residual = CF_MAX(report->solve.residual, one.residual);
  report->solve.converged = report->solve.converged && one.converged;
  return CF_OK;
}

static cf_status tracer_step(void *model, const double t, const double dt, cf_step_report *report) {
  tracer *m = model;
  CF_TRY(move(m, true, t, dt, t, report));
  CF_TRY(move(m, false, t, dt / 2, t + dt / 4, report));
  for (int i = 0; i < m->count; ++i) CF_TRY(diffuse(m, &m->scalar[i], t, dt, report));
  return move(m, false, t + dt / 2, dt / 2, t + 3 * dt / 4, report);
}

/* --- metrics ----------------------------------------------------------------------------------------------
 */

static int tracer_metric_names(const void *model, cf_metric *names) {
  static const char *const per_scalar[4] = {"sum", "min", "max", "error"};
  const tracer *m = model;
  for (int i = 0; i < m->count; ++i)
    for (int c = 0; c < 4; ++c)
      snprintf(names[4 * i + c].name, CF_NAME_MAX, "%s_%.*s", per_scalar[c], CF_NAME_MAX - 8,
               m->scalar[i].name);
  return 4 * m->count;
}

static void tracer_metrics(const void *model, double *values) {
  const tracer *m = model;
  for (int i = 0; i < m->count; ++i) {
    const scalar *s = &m->scalar[i];
    const cf_range range = cf_sweep_range(&m->grid->box, m->grid->threads, s->phi.at, m->rows);
    values[4 * i] = range.sum * cf_grid_volume(m->grid);
    values[4 * i + 1] = range.min;
    values[4 * i + 2] = range.max;
    values[4 * i + 3] = cf_ledger_error(&s->ledger, cf_diffuse_content(s->diffuse, s->phi));
  }
}

const cf_model cf_model_tracer = {
    .name = "tracer",
    .summary = "scalars with C-F diffusion in a prescribed flow",
    .create = tracer_create,
    .destroy = tracer_destroy,
    .restored = tracer_restored,
    .natural_dt = tracer_natural_dt,
    .step = tracer_step,
    .metric_names = tracer_metric_names,
    .metrics = tracer_metrics,
};
