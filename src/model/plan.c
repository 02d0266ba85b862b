/* SPDX-License-Identifier: MIT */
#include "model/plan.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "model/obstacles.h"
#include "stencil/explicit.h"
#include "stencil/regime.h"

/* Below this share of Fourier diffusion a front is sharp enough to ring (`front_filter: auto`). */
#define FILTER_BELOW 0.01

/* --- the flux --------------------------------------------------------------------------------------------- */

void cf_plan_flux_name(const cf_scene *scene, const int field, char name[CF_NAME_MAX]) {
  char own[CF_NAME_MAX + 2];
  snprintf(own, sizeof own, "q_%s", scene->fields.item[field].name);
  const bool only = cf_scene_flux_scalar(scene, "q") == field && cf_scene_field_index(scene, own) < 0;
  const bool plain = strcmp(scene->fields.item[field].name, "phi") == 0 || only;
  snprintf(name, CF_NAME_MAX, "%.*s", CF_NAME_MAX - 1, plain ? "q" : own);
}

/* Whether the scene speaks of the flux, under either of its names. */
static bool is_named(const cf_scene *scene, const int field) {
  const cf_scene_output *o = &scene->output;
  for (int i = 0; i < scene->fields.count; ++i)
    if (cf_scene_flux_scalar(scene, scene->fields.item[i].name) == field) return true;
  for (int i = 0; i < o->fields.count; ++i)
    if (cf_scene_flux_scalar(scene, o->fields.item[i]) == field) return true;
  for (int i = 0; i < scene->sources.count; ++i)
    if (cf_scene_flux_scalar(scene, scene->sources.item[i].field) == field) return true;
  return cf_scene_flux_scalar(scene, o->preview.field) == field;
}

static bool radiates(const cf_scene *scene, const int field) {
  const cf_walls *w = &scene->fields.item[field].walls.walls;
  for (int a = 0; a < scene->dim; ++a)
    if (w->kind[a][0] == CF_WALL_RADIATE || w->kind[a][1] == CF_WALL_RADIATE) return true;
  return false;
}

static bool moves(const cf_scene *scene) {
  if (scene->model == CF_SCENE_MODEL_FLOW) return true;
  for (int a = 0; a < scene->velocity.count; ++a) {
    const cf_fn *f = &scene->velocity.axis[a].fn;
    if (!cf_fn_is_constant(f) || f->value != 0) return true;
  }
  return false;
}

static bool is_scalar_form(const cf_scene *scene, const int field, const cf_plan *plan) {
  const cf_scene_diffusion *d = &scene->fields.item[field].diffusion;
  if (plan->scheme != CF_DIFFUSE_SDIRK2 && plan->scheme != CF_DIFFUSE_LEAPFROG) return false;
  if (plan->positive || radiates(scene, field) || is_named(scene, field)) return false;
  if (cf_obstacles_change(scene)) return false; /* of a face that is closed the flux must be known */
  const int carried = scene->advection.scheme;  /* by tracing back, sum(s) = 0 would not be kept */
  if (moves(scene) && (carried == CF_SCENE_ADVECTION_LINEAR || carried == CF_SCENE_ADVECTION_CUBIC))
    return false;
  return d->flux_rate == CF_SCENE_FLUX_RATE_OBJECTIVE || !moves(scene);
}

/* --- the scheme ------------------------------------------------------------------------------------------- */

/* What an implicit stage costs in explicit substeps with their front filter; measured, in plane and space alike. */
static double stage_cost(const double sigma) { return sigma < 0.3 ? 2.2 : sigma < 2 ? 3 : 4; }

/* Explicit substeps may cost this many times what implicit stages cost: their error is ten times smaller. */
#define WORTH 2

/* The axes along which something can flow. */
static int axes_of(const cf_scene *scene, const int field) {
  const cf_walls *w = &scene->fields.item[field].walls.walls;
  int axes = 0;
  for (int a = 0; a < scene->dim; ++a) {
    const bool open = (w->kind[a][0] != CF_WALL_INSULATED && w->kind[a][0] != CF_WALL_PERIODIC) ||
                      (w->kind[a][1] != CF_WALL_INSULATED && w->kind[a][1] != CF_WALL_PERIODIC);
    if (open || scene->domain.cells.value[a] > 1) ++axes;
  }
  return axes > 0 ? axes : 1;
}

static void choose(const cf_scene *scene, const int field, const double D, const double dt, cf_plan *plan) {
  const cf_scene_diffusion *d = &scene->fields.item[field].diffusion;
  const double h = scene->spacing, tau = d->tau, f = d->f_t;
  const double n = cf_explicit_substeps(axes_of(scene, field), (1 - f) * D, tau, h, dt);
  const double sigma = cf_regime_sigma(cf_regime_stage((1 - sqrt(0.5)) * dt, tau, f), D, h);
  const double implicit = 2 * stage_cost(sigma);
  const double explicit = n + (f > 0 ? 4 * stage_cost(f * D * dt / (h * h)) : 0);
  plan->scheme = CF_DIFFUSE_SDIRK2;
  plan->substeps = 1;
  if (!(D > 0)) {
    plan->scheme = CF_DIFFUSE_LEAPFROG;
    snprintf(plan->why, sizeof plan->why, "leapfrog, 1 explicit substep a step: nothing diffuses");
  } else if (!(tau > 0) || f >= 1) {
    snprintf(plan->why, sizeof plan->why,
             "sdirk2, two implicit stages a step: Fourier's law has no waves to follow");
  } else if (explicit < WORTH * implicit) {
    plan->scheme = CF_DIFFUSE_LEAPFROG;
    plan->substeps = n;
    snprintf(
        plan->why, sizeof plan->why,
        "leapfrog, %.0f explicit substep%s a step: sharper fronts at %.2g times the cost of implicit stages",
        n, n == 1 ? "" : "s", explicit / implicit);
  } else {
    snprintf(plan->why, sizeof plan->why,
             "sdirk2, two implicit stages a step: %.3g explicit substep%s%s would cost %.2g times as much", n,
             n == 1 ? "" : "s", f > 0 ? " and Fourier's part" : "", explicit / implicit);
  }
}

/* A scheme that the scene names. */
static void follow(const cf_scene *scene, const int field, const double D, const double dt, cf_plan *plan) {
  const cf_scene_diffusion *d = &scene->fields.item[field].diffusion;
  const int axes = axes_of(scene, field);
  const double h = scene->spacing;
  plan->substeps = 1;
  if (d->scheme == CF_SCENE_SCHEME_PAPER) {
    plan->scheme = CF_DIFFUSE_PAPER;
    snprintf(plan->why, sizeof plan->why, "paper, one stage of backward Euler a step (eqs 11 to 18)");
  } else if (d->scheme == CF_SCENE_SCHEME_SDIRK2) {
    plan->scheme = CF_DIFFUSE_SDIRK2;
    snprintf(plan->why, sizeof plan->why, "sdirk2, two implicit stages a step");
  } else if (d->scheme == CF_SCENE_SCHEME_WAVE) {
    plan->scheme = CF_DIFFUSE_WAVE;
    plan->substeps = cf_explicit_wave_substeps(axes, cf_regime_speed(D, d->tau, 0), d->tau, h, dt);
    snprintf(plan->why, sizeof plan->why, "wave, %.0f explicit substep%s of three stages a step",
             plan->substeps, plan->substeps == 1 ? "" : "s");
  } else {
    plan->scheme = CF_DIFFUSE_LEAPFROG;
    plan->substeps = cf_explicit_substeps(axes, (1 - d->f_t) * D, d->tau, h, dt);
    snprintf(plan->why, sizeof plan->why, "leapfrog, %.0f explicit substep%s a step%s", plan->substeps,
             plan->substeps == 1 ? "" : "s", plan->positive ? ", its fluxes limited to |q| <= c phi" : "");
  }
}

void cf_plan_make(const cf_scene *scene, const int field, const double D, const double dt, cf_plan *plan) {
  const cf_scene_diffusion *d = &scene->fields.item[field].diffusion;
  *plan = (cf_plan){.positive = d->positivity == CF_SCENE_SWITCH_ON};
  if (d->scheme == CF_SCENE_SCHEME_DEFAULT && !plan->positive)
    choose(scene, field, D, dt, plan);
  else
    follow(scene, field, D, dt, plan);
  const bool sharp = plan->scheme != CF_DIFFUSE_PAPER && D > 0 && d->tau > 0 && d->f_t < FILTER_BELOW;
  plan->front_filter =
      plan->scheme != CF_DIFFUSE_WAVE &&
      (d->front_filter == CF_SCENE_FILTER_AUTO ? sharp : d->front_filter == CF_SCENE_FILTER_ON);
  plan->scalar_form = is_scalar_form(scene, field, plan);
}

double cf_plan_step(const cf_scene *scene, const double dt) {
  const double frame = scene->time.frames > 0 ? 1 / scene->time.frames : scene->time.end;
  return fmin(dt, fmin(frame, scene->time.end));
}
