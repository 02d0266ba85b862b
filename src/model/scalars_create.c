/* SPDX-License-Identifier: MIT
 *
 * Making the scalars: what they are, how each will be computed (plan.h), and the state they live in.
 */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "base/mem.h"
#include "grid/sweep.h"
#include "grid/wall.h"
#include "model/scalars.h"
#include "stencil/regime.h"

/* --- memory ----------------------------------------------------------------------------------------------- */

/* What a scheme takes at once: 8/7 of a field in space for all levels of multigrid. */
static double levels_of(const cf_scene *scene) { return scene->dim == 3 ? 8.0 / 7 : 4.0 / 3; }

/* What the solver takes of memory for coefficients that are fields: the four fields of conjugate gradients, and numbers in single
 * precision, so many a cell at 128^3 and 1400^2: levels of couplings, the finest one apart by colour as well, and clusters where
 * k is far from alike (solve/clusters.h). */
static double solver_of_fields(const cf_scene *scene, const bool k_varies) {
  const double levels = scene->dim == 3 ? 28 : 20, clusters = scene->dim == 3 ? 10 : 13;
  return 4 + (levels + (k_varies ? clusters : 0)) * 4.0 / sizeof(cf_real);
}

/* Whether a source of the kind acts on a field. */
static bool has_source(const cf_scene *scene, const char *name, const bool held) {
  for (int i = 0; i < scene->sources.count; ++i)
    if (strcmp(scene->sources.item[i].field, name) == 0 && scene->sources.item[i].given.value == held)
      return true;
  return false;
}

static bool radiates(const cf_scene *scene, const cf_walls *walls) {
  for (int a = 0; a < scene->dim; ++a)
    if (walls->kind[a][0] == CF_WALL_RADIATE || walls->kind[a][1] == CF_WALL_RADIATE) return true;
  return false;
}

/* Fields of one scalar under a plan: state, what diffusion takes (cf_diffuse_create), and its solver. */
static double fields_under(const cf_scene *scene, const int field, const cf_plan *plan) {
  const cf_scene_field *f = &scene->fields.item[field];
  const cf_scene_diffusion *d = &f->diffusion;
  const double dim = scene->dim, in_single = 4.0 / sizeof(cf_real);
  char flux[CF_NAME_MAX];
  cf_plan_flux_name(scene, field, flux);
  const bool k_varies = !cf_fn_is_constant(&d->k.fn), held = has_source(scene, f->name, true);
  const bool c_varies = !cf_fn_is_constant(&d->capacity.fn) || d->capacity.fn.value != 1;
  const bool follows_fourier = plan->scheme == CF_DIFFUSE_LEAPFROG && d->f_t > 0;
  const bool implicit = plan->scheme == CF_DIFFUSE_PAPER || plan->scheme == CF_DIFFUSE_SDIRK2 ||
                        (follows_fourier && !plan->positive);
  const bool beta =
      (implicit && (k_varies || radiates(scene, &f->walls.walls))) || (plan->positive && d->f_t > 0);
  double fields = 1 + (plan->scalar_form ? 1 : dim) + 2;
  if (has_source(scene, f->name, false)) fields += 1;
  if (has_source(scene, flux, false)) fields += dim;
  if (held) fields += 4;
  fields += (k_varies ? dim : 0) + (c_varies ? 1 : 0) + (beta ? dim : 0) + (plan->front_filter ? 1 : 0);
  if (plan->scheme == CF_DIFFUSE_WAVE) fields += 2 + dim;
  if (!implicit) return fields;
  const bool varied = beta || held || c_varies || scene->obstacles.count > 0;
  return fields + (varied ? solver_of_fields(scene, beta) : 2 * levels_of(scene) * in_single);
}

/* The same before any grid is there: with the step that diffusion alone would ask for, or with the dearest scheme.
 * `beside`: what its flux makes advection take besides. */
static double fields_of(const cf_scene *scene, const int field, int *beside) {
  const cf_scene_diffusion *d = &scene->fields.item[field].diffusion;
  const bool known = cf_fn_is_constant(&d->k.fn) && cf_fn_is_constant(&d->capacity.fn);
  const double D = known && d->capacity.fn.value > 0 ? d->k.fn.value / d->capacity.fn.value : 0;
  const double c = d->tau > 0 ? cf_regime_speed(D, d->tau, d->f_t) : 0, h = scene->spacing;
  const double own = c > 0 ? scene->time.cfl * h / c : scene->time.end / 100;
  const double dt = isnan(scene->time.dt) ? CF_MIN(own, scene->time.end / 100) : scene->time.dt;
  cf_plan plan;
  cf_plan_make(scene, field, D, cf_plan_step(scene, dt), &plan);
  if (d->tau > 0) *beside = CF_MAX(*beside, plan.scalar_form ? 1 : scene->dim);
  const double fields = fields_under(scene, field, &plan);
  if (known) return fields;
  plan.scheme = CF_DIFFUSE_SDIRK2;
  return CF_MAX(fields, fields_under(scene, field, &plan));
}

double cf_scalars_memory(const cf_scene *scene) {
  int beside = 0;
  double fields = 1; /* advection's scratch */
  for (int f = 0; f < scene->fields.count; ++f)
    if (!cf_scene_name_is_flux(scene->fields.item[f].name)) fields += fields_of(scene, f, &beside);
  if (scene->advection.scheme == CF_SCENE_ADVECTION_WENO5) fields += 1;
  return fields + beside;
}

double cf_scalars_bytes(const cf_scene *scene, const double fields) {
  int n[3] = {1, 1, 1};
  cf_box box;
  for (int a = 0; a < scene->dim; ++a) n[a] = (int)scene->domain.cells.value[a];
  if (cf_box_init(&box, scene->dim, n, CF_HALO) != CF_OK) return INFINITY;
  return fields * (double)box.size * sizeof(cf_real) + 64e6;
}

/* --- the plan --------------------------------------------------------------------------------------------- */

/* The largest k/C, as far as it can be had: what is wrong with k or C is told when diffusion is made. */
static cf_status find_diffusivity(const cf_scalars *m, cf_scalar *s) {
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

static void make_plans(cf_scalars *s, const double dt) {
  for (int i = 0; i < s->count; ++i)
    cf_plan_make(s->scene, s->item[i].field, s->item[i].D, cf_plan_step(s->scene, dt), &s->item[i].plan);
}

/* --- each ------------------------------------------------------------------------------------------------- */

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

static cf_status initial_flux(const cf_scalars *m, cf_scalar *s) {
  const int f = cf_scene_field_index(m->scene, s->flux);
  if (f < 0) return CF_OK;
  const cf_param_profiles *initial = &m->scene->fields.item[f].initial;
  for (int a = 0; a < m->grid->box.dim; ++a)
    CF_TRY(cf_grid_sample(m->grid, &initial->axis[initial->count > 1 ? a : 0].fn, a, 0, s->q.at[a]));
  close_flux(m->grid, &s->walls, s->q);
  return CF_OK;
}

static void describe_scalar(const cf_scalars *m, const int field, cf_scalar *s) {
  const cf_scene_field *f = &m->scene->fields.item[field];
  s->field = field;
  snprintf(s->name, sizeof s->name, "%s", f->name);
  cf_plan_flux_name(m->scene, field, s->flux);
  s->scene = &f->diffusion;
  s->walls = s->carried = s->carried_flux = f->walls.walls;
  for (int a = 0; a < m->grid->box.dim; ++a)
    for (int side = 0; side < 2; ++side)
      if (s->walls.kind[a][side] == CF_WALL_VALUE) s->carried_flux.kind[a][side] = CF_WALL_OPEN;
  s->paper = s->scene->scheme == CF_SCENE_SCHEME_PAPER;
  s->has_memory = s->scene->tau > 0;
}

cf_status cf_scalars_make_diffuse(const cf_scalars *m, cf_scalar *s) {
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
      .region = s->region,
  };
  cf_source acts;
  const cf_walls walls = cf_scalars_ends(m, &s->walls, CF_WALL_INSULATED);
  CF_TRY(cf_sources_create(&s->sources, scene, &m->part, s->field, s->flux, &acts));
  if (s->region != NULL) cf_sources_add_held(s->sources, m->obstacles, &acts);
  const cf_status made = cf_diffuse_create(&s->diffuse, &m->part, &walls, &p, &acts);
  if (made == CF_OK && s->passes && s->plan.scalar_form) cf_diffuse_let_through(s->diffuse);
  if (made != CF_BAD_ARGUMENT) return made;
  /* The sentence begins with the name of the parameter, which is that of its key. */
  char why[CF_SENTENCE_MAX], key[3 * CF_NAME_MAX];
  snprintf(why, sizeof why, "%s", cf_status_sentence());
  const int name = CF_MIN((int)strcspn(why, " "), CF_NAME_MAX);
  snprintf(key, sizeof key, "fields.%s.diffusion.%.*s", s->name, name, why);
  if (!cf_scene_has(scene, key)) snprintf(key, sizeof key, "diffusion.%.*s", name, why);
  return cf_scene_fail_at(scene, cf_scene_has(scene, key) ? key : "diffusion", "%s", why);
}

static cf_status register_scalar(cf_scalar *s, const char *unit, cf_registry *r) {
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

static cf_status make_scalar(const cf_scalars *m, cf_scalar *s, cf_registry *r) {
  const cf_scene_field *f = &m->scene->fields.item[s->field];
  if (s->plan.scalar_form)
    CF_TRY(cf_cell_create(&s->s, &m->grid->box));
  else
    CF_TRY(cf_face_create(&s->q, &m->grid->box));
  CF_TRY(cf_scalars_make_region(m, s));
  CF_TRY(cf_scalars_make_diffuse(m, s));
  CF_TRY(cf_grid_sample(m->grid, &f->initial.axis[0].fn, CF_CENTRES, 0, s->phi.at));
  if (!s->plan.scalar_form) CF_TRY(initial_flux(m, s));
  cf_diffuse_set_outside(s->diffuse, s->phi);
  if (!s->plan.scalar_form) cf_diffuse_close_faces(s->diffuse, s->q);
  s->ledger.first = cf_diffuse_content(s->diffuse, s->phi);
  return register_scalar(s, f->unit, r);
}

/* --- all -------------------------------------------------------------------------------------------------- */

cf_status cf_scalars_create(cf_scalars *s, const cf_scene *scene, const cf_grid *g) {
  s->scene = scene;
  s->grid = g;
  s->part = *g;
  CF_TRY(CF_NEW(&s->rows, 3 * cf_box_rows(&g->box)));
  CF_TRY(CF_NEW(&s->item, CF_MAX(1, scene->fields.count)));
  for (int f = 0; f < scene->fields.count; ++f) {
    if (cf_scene_name_is_flux(scene->fields.item[f].name)) continue;
    if (s->count == CF_METRICS_MAX / CF_SCALAR_METRICS - 4)
      return cf_scene_fail_at(scene, "fields", "more than %d scalars",
                              CF_METRICS_MAX / CF_SCALAR_METRICS - 4);
    describe_scalar(s, f, &s->item[s->count++]);
  }
  for (int i = 0; i < s->count; ++i) {
    CF_TRY(cf_cell_create(&s->item[i].phi, &g->box));
    CF_TRY(find_diffusivity(s, &s->item[i]));
  }
  return cf_scalars_make_solid(s);
}

void cf_scalars_open(cf_scalars *s, const int axis, const int side) {
  for (int i = 0; i < s->count; ++i) {
    cf_scalar *one = &s->item[i];
    if (one->walls.kind[axis][side] != CF_WALL_INSULATED) continue;
    one->carried.kind[axis][side] = one->carried_flux.kind[axis][side] = CF_WALL_OPEN;
    one->passes = true;
  }
}

cf_status cf_scalars_make(cf_scalars *s, const double dt, cf_registry *r) {
  make_plans(s, dt);
  for (int i = 0; i < s->count; ++i) CF_TRY(make_scalar(s, &s->item[i], r));
  return cf_scalars_may_follow(s, &s->follows);
}

void cf_scalars_destroy(cf_scalars *s) {
  for (int i = 0; s->item != NULL && i < s->count; ++i) {
    cf_scalar *one = &s->item[i];
    cf_diffuse_destroy(one->diffuse);
    cf_region_destroy(one->region);
    cf_sources_destroy(one->sources);
    cf_cell_destroy(&one->phi, &s->grid->box);
    cf_cell_destroy(&one->s, &s->grid->box);
    cf_face_destroy(&one->q, &s->grid->box);
  }
  for (int a = 0; a < CF_ADVECT_SCHEMES; ++a) cf_advect_destroy(s->by_scheme[a]);
  cf_region_destroy(s->solid);
  cf_rim_destroy(&s->rim);
  cf_free(s->item);
  cf_free(s->rows);
}
