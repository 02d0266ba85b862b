/* SPDX-License-Identifier: MIT
 *
 * Making a tracer: what its scalars are, how each will be computed (plan.h), and the state they live in.
 */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "base/mem.h"
#include "grid/sweep.h"
#include "grid/wall.h"
#include "model/tracer_part.h"
#include "stencil/regime.h"

/* `dt: auto` where only Fourier diffusion limits the step: so many explicit steps in one. */
#define FOURIER_STEPS 16

/* --- the velocity ----------------------------------------------------------------------------------------- */

static const cf_function *velocity_of(const cf_scene *scene, const int axis) {
  return &scene->velocity.axis[scene->velocity.count > 1 ? axis : 0];
}

/* Sets u.n = 0 on the insulated walls of the domain; returns the largest value that stood there. */
static double close_walls(const cf_tracer *m) {
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

cf_status cf_tracer_set_velocity(cf_tracer *m, const double t) {
  for (int a = 0; a < m->grid->box.dim; ++a)
    CF_TRY(cf_grid_sample(m->grid, &velocity_of(m->scene, a)->fn, a, t, m->u.at[a]));
  m->through_walls = close_walls(m);
  for (int s = 0; s < CF_TRACER_ADVECT_SCHEMES; ++s)
    if (m->by_scheme[s] != NULL)
      CF_TRY(cf_advect_set_velocity(m->by_scheme[s], m->u, &m->scene->domain.walls.walls));
  return CF_OK;
}

cf_advect_scheme cf_tracer_advection(const cf_tracer *m, const cf_tracer_scalar *s) {
  static const cf_advect_scheme by_word[] = {[CF_SCENE_ADVECTION_PPM] = CF_ADVECT_PPM,
                                             [CF_SCENE_ADVECTION_LINEAR] = CF_ADVECT_LINEAR,
                                             [CF_SCENE_ADVECTION_WENO5] = CF_ADVECT_WENO5,
                                             [CF_SCENE_ADVECTION_CUBIC] = CF_ADVECT_CUBIC};
  if (s->paper && !m->scene->advection.given.scheme) return CF_ADVECT_LINEAR;
  return by_word[m->scene->advection.scheme];
}

static cf_status make_velocity(cf_tracer *m) {
  for (int a = 0; a < m->grid->box.dim; ++a) {
    const cf_fn *f = &velocity_of(m->scene, a)->fn;
    m->moves = m->moves || !cf_fn_is_constant(f) || f->value != 0;
    m->velocity_in_time = m->velocity_in_time || f->in_time;
  }
  if (!m->moves) return CF_OK;
  CF_TRY(cf_face_create(&m->u, &m->grid->box));
  for (int i = 0; i < m->count; ++i) {
    const cf_advect_scheme s = cf_tracer_advection(m, &m->scalar[i]);
    if (m->by_scheme[s] == NULL) CF_TRY(cf_advect_create(&m->by_scheme[s], m->grid, s));
  }
  return cf_tracer_set_velocity(m, 0);
}

static cf_status register_velocity(const cf_tracer *m, cf_registry *r) {
  static const char *const parity[CF_TRACER_ADVECT_SCHEMES] = {"sweep_parity", "sweep_parity_linear",
                                                               "sweep_parity_weno5", "sweep_parity_cubic"};
  if (!m->moves) return CF_OK;
  for (int s = 0; s < CF_TRACER_ADVECT_SCHEMES; ++s)
    if (m->by_scheme[s] != NULL)
      CF_TRY(cf_registry_add_counter(r, parity[s], cf_advect_parity(m->by_scheme[s])));
  return cf_registry_add_face(r, "velocity", "m/s", m->u);
}

/* --- memory ----------------------------------------------------------------------------------------------- */

static bool has_source(const cf_scene *scene, const bool held) {
  for (int i = 0; i < scene->sources.count; ++i)
    if (scene->sources.item[i].given.value == held) return true;
  return false;
}

double cf_tracer_memory(const cf_scene *scene) {
  const double dim = scene->dim, coarse = dim == 3 ? 1.0 / 7 : 1.0 / 3;
  int n[3] = {1, 1, 1};
  for (int a = 0; a < scene->dim; ++a) n[a] = (int)scene->domain.cells.value[a];
  cf_box box;
  if (cf_box_init(&box, scene->dim, n, CF_HALO) != CF_OK) return INFINITY;
  double fields = 2 * dim + 4; /* the velocity, and advection's scratch */
  for (int f = 0; f < scene->fields.count; ++f) {
    const cf_scene_field *field = &scene->fields.item[f];
    if (cf_scene_name_is_flux(field->name)) continue;
    const bool varies =
        !cf_fn_is_constant(&field->diffusion.k.fn) || field->diffusion.capacity.fn.eval != NULL;
    fields += 1 + dim;            /* phi, q */
    fields += 2 + 5 + 3 * coarse; /* phi~ and right side; the solver's vectors; coarse levels */
    if (varies) fields += 2 * dim + 2 + (dim + 1) * coarse;
    if (has_source(scene, false)) fields += 1 + dim;
    if (has_source(scene, true)) fields += 3 + (dim + 1) * (1 + coarse);
  }
  return fields * (double)box.size * sizeof(cf_real) + 64e6;
}

/* --- the plan --------------------------------------------------------------------------------------------- */

/* The largest k/C, as far as it can be had: what is wrong with k or C is told when diffusion is made. */
static cf_status find_diffusivity(const cf_tracer *m, cf_tracer_scalar *s) {
  const cf_box *box = &m->grid->box;
  double k = s->scene->k.fn.value, c = s->scene->capacity.fn.value;
  if (!cf_fn_is_constant(&s->scene->k.fn)) {
    CF_TRY(cf_grid_sample(m->grid, &s->scene->k.fn, CF_CENTRES, 0, s->phi.at));
    k = cf_sweep_range(box, m->grid->threads, s->phi.at, m->rows).max;
  }
  if (!cf_fn_is_constant(&s->scene->capacity.fn)) {
    CF_TRY(cf_grid_sample(m->grid, &s->scene->capacity.fn, CF_CENTRES, 0, s->phi.at));
    c = cf_sweep_range(box, m->grid->threads, s->phi.at, m->rows).min;
  }
  s->D = k > 0 && c > 0 && isfinite(k / c) ? k / c : 0;
  return CF_OK;
}

double cf_tracer_natural_dt(const void *model, const double t) {
  (void)t;
  const cf_tracer *m = model;
  const double h = m->grid->h;
  double rate = 0, diffusion = 0; /* 1/dt at cfl 1 */
  for (int s = 0; s < CF_TRACER_ADVECT_SCHEMES; ++s)
    if (m->by_scheme[s] != NULL) rate = CF_MAX(rate, cf_advect_rate(m->by_scheme[s]));
  for (int i = 0; i < m->count; ++i) {
    const cf_tracer_scalar *s = &m->scalar[i];
    const double tau = s->scene->tau, f_t = tau > 0 ? s->scene->f_t : 1;
    if (tau > 0) diffusion = CF_MAX(diffusion, cf_regime_speed(s->D, tau, f_t) / h);
    diffusion = CF_MAX(diffusion, f_t * s->D / (FOURIER_STEPS * h * h));
  }
  rate += diffusion;
  const double longest = m->scene->time.end / 100;
  return rate > 0 ? CF_MIN(m->scene->time.cfl / rate, longest) : longest;
}

static void make_plans(cf_tracer *m) {
  const double wish = isnan(m->scene->time.dt) ? cf_tracer_natural_dt(m, 0) : m->scene->time.dt;
  for (int i = 0; i < m->count; ++i)
    cf_plan_make(m->scene, m->scalar[i].field, m->scalar[i].D, cf_plan_step(m->scene, wish),
                 &m->scalar[i].plan);
}

/* --- scalars ---------------------------------------------------------------------------------------------- */

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

static cf_status initial_flux(const cf_tracer *m, cf_tracer_scalar *s) {
  const int f = cf_scene_field_index(m->scene, s->flux);
  if (f < 0) return CF_OK;
  const cf_param_profiles *initial = &m->scene->fields.item[f].initial;
  for (int a = 0; a < m->grid->box.dim; ++a)
    CF_TRY(cf_grid_sample(m->grid, &initial->axis[initial->count > 1 ? a : 0].fn, a, 0, s->q.at[a]));
  close_flux(m->grid, &s->walls, s->q);
  return CF_OK;
}

static void describe_scalar(const cf_tracer *m, const int field, cf_tracer_scalar *s) {
  const cf_scene_field *f = &m->scene->fields.item[field];
  s->field = field;
  snprintf(s->name, sizeof s->name, "%s", f->name);
  cf_plan_flux_name(m->scene, field, s->flux);
  s->scene = &f->diffusion;
  s->walls = s->memory_walls = f->walls.walls;
  for (int a = 0; a < m->grid->box.dim; ++a)
    for (int side = 0; side < 2; ++side)
      if (s->walls.kind[a][side] == CF_WALL_VALUE) s->memory_walls.kind[a][side] = CF_WALL_OPEN;
  s->paper = s->scene->scheme == CF_SCENE_SCHEME_PAPER;
  s->has_memory = s->scene->tau > 0;
}

static cf_status make_diffuse(const cf_tracer *m, cf_tracer_scalar *s) {
  const cf_scene *scene = m->scene;
  const cf_scene_diffusion *d = s->scene;
  const cf_diffuse_params p = {
      .k = d->k.fn,
      .capacity = d->capacity.fn,
      .tau = d->tau,
      .f_t = d->f_t,
      .scheme = s->plan.scheme,
      .solver = {scene->solver.tolerance, (int)scene->solver.max_iterations},
      .levels = (int)scene->solver.levels,
      .front_filter = s->plan.front_filter,
      .positive = s->plan.positive,
  };
  cf_source acts;
  CF_TRY(cf_sources_create(&s->sources, scene, m->grid, s->field, s->flux, &acts));
  const cf_status made = cf_diffuse_create(&s->diffuse, m->grid, &s->walls, &p, &acts);
  if (made != CF_BAD_ARGUMENT) return made;
  char why[CF_SENTENCE_MAX], key[2 * CF_NAME_MAX];
  snprintf(why, sizeof why, "%s", cf_status_sentence());
  snprintf(key, sizeof key, "fields.%s.diffusion", s->name);
  return cf_scene_fail_at(scene, cf_scene_has(scene, key) ? key : "diffusion", "%s", why);
}

static cf_status register_scalar(cf_tracer_scalar *s, const char *unit, cf_registry *r) {
  char name[CF_NAME_MAX + 8];
  CF_TRY(cf_registry_add_cell(r, s->name, unit, s->phi));
  snprintf(name, sizeof name, "div_%.*s", CF_NAME_MAX - 8, s->flux);
  if (s->plan.scalar_form)
    CF_TRY(cf_registry_add_cell(r, name, "", s->s));
  else
    CF_TRY(cf_registry_add_face(r, s->flux, "", s->q));
  snprintf(name, sizeof name, "ledger_%.*s", CF_NAME_MAX - 8, s->name);
  return cf_registry_add_numbers(r, name, "", &s->ledger.first, 3);
}

static cf_status make_scalar(const cf_tracer *m, cf_tracer_scalar *s, cf_registry *r) {
  const cf_scene_field *f = &m->scene->fields.item[s->field];
  if (s->plan.scalar_form)
    CF_TRY(cf_cell_create(&s->s, &m->grid->box));
  else
    CF_TRY(cf_face_create(&s->q, &m->grid->box));
  CF_TRY(make_diffuse(m, s));
  CF_TRY(cf_grid_sample(m->grid, &f->initial.axis[0].fn, CF_CENTRES, 0, s->phi.at));
  if (!s->plan.scalar_form) CF_TRY(initial_flux(m, s));
  s->ledger.first = cf_diffuse_content(s->diffuse, s->phi);
  return register_scalar(s, f->unit, r);
}

/* A scalar's insulated wall in the way of the flow would pile it up without end. */
static cf_status check_walls(const cf_tracer *m, const cf_tracer_scalar *s) {
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

static cf_status make(cf_tracer *m, cf_registry *r) {
  const cf_scene *scene = m->scene;
  CF_TRY(CF_NEW(&m->rows, 3 * cf_box_rows(&m->grid->box)));
  CF_TRY(CF_NEW(&m->scalar, CF_MAX(1, scene->fields.count)));
  for (int f = 0; f < scene->fields.count; ++f) {
    if (cf_scene_name_is_flux(scene->fields.item[f].name)) continue;
    if (m->count == CF_METRICS_MAX / 4 - 2)
      return cf_scene_fail_at(scene, "fields", "more than %d scalars", CF_METRICS_MAX / 4 - 2);
    describe_scalar(m, f, &m->scalar[m->count++]);
  }
  for (int i = 0; i < m->count; ++i) {
    CF_TRY(cf_cell_create(&m->scalar[i].phi, &m->grid->box));
    CF_TRY(find_diffusivity(m, &m->scalar[i]));
  }
  CF_TRY(make_velocity(m));
  make_plans(m);
  for (int i = 0; i < m->count; ++i) CF_TRY(make_scalar(m, &m->scalar[i], r));
  CF_TRY(register_velocity(m, r));
  for (int i = 0; i < m->count; ++i) CF_TRY(check_walls(m, &m->scalar[i]));
  return CF_OK;
}

void cf_tracer_destroy(void *model) {
  cf_tracer *m = model;
  if (m == NULL) return;
  for (int i = 0; m->scalar != NULL && i < m->count; ++i) {
    cf_diffuse_destroy(m->scalar[i].diffuse);
    cf_sources_destroy(m->scalar[i].sources);
    cf_cell_destroy(&m->scalar[i].phi, &m->grid->box);
    cf_cell_destroy(&m->scalar[i].s, &m->grid->box);
    cf_face_destroy(&m->scalar[i].q, &m->grid->box);
  }
  cf_face_destroy(&m->u, &m->grid->box);
  for (int s = 0; s < CF_TRACER_ADVECT_SCHEMES; ++s) cf_advect_destroy(m->by_scheme[s]);
  cf_free(m->scalar);
  cf_free(m->rows);
  cf_free(m);
}

cf_status cf_tracer_create(void **model, const cf_scene *scene, cf_registry *registry) {
  cf_tracer *m;
  CF_TRY(CF_NEW(&m, 1));
  m->scene = scene;
  m->grid = registry->grid;
  const cf_status s = make(m, registry);
  if (s != CF_OK) {
    cf_tracer_destroy(m);
    return s;
  }
  *model = m;
  return CF_OK;
}
