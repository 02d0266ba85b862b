/* SPDX-License-Identifier: MIT
 *
 * The keys of `phase:` beyond their table, and what `check` says of them.
 */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "model/phase_part.h"
#include "model/scalars.h"

enum { KEY_MAX = 160 };

#define THICKNESS 6.2146 /* of the interface from 10 to 90 %, in widths */

/* --- what goes together ----------------------------------------------------------------------------------- */

static cf_status check_in_time(const cf_scene *scene, const cf_function *f, const char *key,
                               const double low) {
  const double now = cf_fn_at(&f->fn, 0, 0, 0, 0);
  if (now >= low) return CF_OK;
  return cf_scene_fail_at(scene, key, "%s is %g at time 0: must be >= %g", key, now, low);
}

static cf_status check_list(const cf_scene *scene, const cf_param_numbers *list, const bool given,
                            const char *key, const char *name) {
  if (!given || list->count == scene->dim) return CF_OK;
  return cf_scene_fail_at(scene, key, "%s.%s has %d entries, domain.size has %d", key, name, list->count,
                          scene->dim);
}

static cf_status check_seed(const cf_scene *scene, const int number) {
  const cf_scene_phase_seed *s = &scene->phase.seeds.item[number];
  char key[KEY_MAX];
  snprintf(key, sizeof key, "phase.seeds.%d", number);
  CF_TRY(check_list(scene, &s->center, s->given.center, key, "center"));
  CF_TRY(check_list(scene, &s->half, s->given.half, key, "half"));
  CF_TRY(check_list(scene, &s->end, s->given.end, key, "end"));
  if ((s->shape == CF_SCENE_SEED_BOX) != s->given.half)
    return cf_scene_fail_at(scene, key, "%s: half goes with shape: box, and that with half", key);
  if ((s->shape == CF_SCENE_SEED_LINE) != s->given.end)
    return cf_scene_fail_at(scene, key, "%s: end goes with shape: line, and that with end", key);
  if (s->given.half_height && (s->shape != CF_SCENE_SEED_DISC || scene->dim == 2))
    return cf_scene_fail_at(scene, key, "%s: half_height goes with shape: disc in 3D", key);
  if (s->given.angle && scene->phase.carried == CF_SCENE_PHASE_BOTH)
    for (int a = 0; a < scene->velocity.count; ++a)
      if (scene->velocity.axis[a].fn.eval != NULL || scene->velocity.axis[a].fn.value != 0)
        return cf_scene_fail_at(scene, key,
                                "%s: crystals with angles of their own cannot drift; let the flow carry "
                                "heat alone (phase.carried: heat)",
                                key);
  return CF_OK;
}

static cf_status check_anisotropy(const cf_scene *scene) {
  const cf_scene_phase_anisotropy *a = &scene->phase.anisotropy;
  if (a->law == CF_SCENE_PHASE_FOLD && a->folds % 2 != 0)
    return cf_scene_fail_at(
        scene, "phase.anisotropy.folds",
        "phase.anisotropy.folds = %ld: must be even, as a surface has the same energy from both "
        "sides",
        a->folds);
  if (a->polar_folds % 2 != 0)
    return cf_scene_fail_at(scene, "phase.anisotropy.polar_folds",
                            "phase.anisotropy.polar_folds = %ld: must be even", a->polar_folds);
  if (a->polar_folds > 0 && (scene->dim == 2 || a->law != CF_SCENE_PHASE_FOLD))
    return cf_scene_fail_at(scene, "phase.anisotropy.polar_folds",
                            "phase.anisotropy.polar_folds goes with law: fold in 3D");
  return CF_OK;
}

/* Of the ways to say one thing a scene takes one; and its pictures can be read. */
static cf_status check_maps(const cf_scene *scene) {
  const cf_scene_phase *p = &scene->phase;
  cf_crystal_map map[CF_CRYSTAL_MAPS] = {{.value = NULL}};
  const struct {
    const char *key, *other;
    bool both;
  } pairs[] = {
      {"phase.distance", "phase.mask", p->given.mask && p->given.distance},
      {"phase.maps.mask", "phase.mask", p->given.mask && cf_crystal_has_map(scene, CF_CRYSTAL_MASK)},
      {"phase.maps.mask", "phase.distance", p->given.distance && cf_crystal_has_map(scene, CF_CRYSTAL_MASK)},
      {"phase.maps.distance", "phase.mask", p->given.mask && cf_crystal_has_map(scene, CF_CRYSTAL_DISTANCE)},
      {"phase.maps.distance", "phase.distance",
       p->given.distance && cf_crystal_has_map(scene, CF_CRYSTAL_DISTANCE)},
      {"phase.maps.distance", "phase.maps.mask",
       cf_crystal_has_map(scene, CF_CRYSTAL_MASK) && cf_crystal_has_map(scene, CF_CRYSTAL_DISTANCE)},
      {"phase.maps.angle", "phase.anisotropy.angle",
       p->anisotropy.given.angle && cf_crystal_has_map(scene, CF_CRYSTAL_ANGLE)},
      {"phase.maps.strength", "phase.anisotropy.strength",
       p->anisotropy.given.strength && cf_crystal_has_map(scene, CF_CRYSTAL_STRENGTH)},
  };
  for (size_t i = 0; i < sizeof pairs / sizeof *pairs; ++i)
    if (pairs[i].both)
      return cf_scene_fail_at(scene, pairs[i].key, "%s: %s says the same already", pairs[i].key,
                              pairs[i].other);
  const cf_status s = cf_crystal_read_maps(scene, map);
  cf_crystal_drop_maps(map);
  return s;
}

static cf_status check_window(const cf_scene *scene) {
  const char *follow = scene->phase.window.follow;
  if (follow[0] == '\0') return CF_OK;
  for (int a = 0; a < scene->dim; ++a) {
    const char name[3] = {"xyz"[a], '+', '\0'};
    if (strcmp(follow, name) != 0) continue;
    if (scene->domain.walls.walls.kind[a][0] == CF_WALL_PERIODIC)
      return cf_scene_fail_at(scene, "phase.window.follow",
                              "phase.window.follow: no wall to follow, %s is periodic", name);
    return CF_OK;
  }
  return cf_scene_fail_at(scene, "phase.window.follow", "phase.window.follow: \"%.20s\" is not x+, y+%s",
                          follow, scene->dim == 3 ? " or z+" : "");
}

/* Heat spreads with k = 1 where the scene does not say. */
static cf_status resolve_heat(cf_scene *scene) {
  cf_scene_diffusion *d = &scene->fields.item[cf_scene_field_index(scene, "T")].diffusion;
  const bool given =
      scene->diffusion.given.k || d->given.k || scene->diffusion.given.front_speed || d->k.fn.value > 0;
  if (!given && cf_fn_is_constant(&d->k.fn)) {
    d->k.fn.value = 1;
    d->k.text = "1";
  }
  if (!cf_fn_is_constant(&d->k.fn))
    return cf_scene_fail_at(scene, "diffusion.k", "diffusion.k must be one number in `model: phase`");
  if (!cf_fn_is_constant(&d->capacity.fn) || d->capacity.fn.value != 1)
    return cf_scene_fail_at(scene, "diffusion.capacity", "diffusion.capacity must be 1 in `model: phase`");
  return CF_OK;
}

static cf_status check_sources(const cf_scene *scene) {
  char key[KEY_MAX];
  for (int i = 0; i < scene->sources.count; ++i) {
    snprintf(key, sizeof key, "sources.%d.field", i);
    if (strcmp(scene->sources.item[i].field, "T") != 0)
      return cf_scene_fail_at(scene, key,
                              "%s: in `model: phase` sources act on T; what is solid at first stands in "
                              "phase.seeds",
                              key);
  }
  return CF_OK;
}

cf_status cf_crystal_resolve(cf_scene *scene) {
  cf_scene_phase *p = &scene->phase;
  CF_TRY(check_in_time(scene, &p->tau_eta, "phase.tau_eta", 0));
  CF_TRY(check_in_time(scene, &p->tau_1, "phase.tau_1", 0));
  CF_TRY(check_in_time(scene, &p->gamma, "phase.gamma", 0));
  CF_TRY(check_in_time(scene, &p->alpha, "phase.alpha", 0));
  for (int i = 0; i < p->seeds.count; ++i) CF_TRY(check_seed(scene, i));
  CF_TRY(check_anisotropy(scene));
  CF_TRY(check_maps(scene));
  if (p->form == CF_SCENE_PHASE_PAPER && p->scheme == CF_SCENE_PHASE_IMPLICIT)
    return cf_scene_fail_at(scene, "phase.scheme", "phase.scheme: phase.form: paper has explicit steps only");
  if (!p->noise.given.period) {
    const double tau = cf_fn_at(&p->tau_eta.fn, 0, 0, 0, 0);
    p->noise.period = tau > 0 ? 5 * tau : scene->time.end / 1000;
  }
  CF_TRY(check_window(scene));
  CF_TRY(check_sources(scene));
  return resolve_heat(scene);
}

/* --- what `check` says ------------------------------------------------------------------------------------ */

static void warn_form(const cf_scene *scene, const cf_phase_params *p, const cf_page *page) {
  char text[300];
  (void)scene;
  if (p->form != CF_PHASE_PAPER || !cf_phase_has_memory(p) || p->tau_1 <= 3 * p->tau_eta) return;
  snprintf(text, sizeof text,
           "tau_1/tau_eta = %.3g: from about 3 on the paper's form amplifies every wavelength in the "
           "interface, and "
           "what grows is the grid's pattern; phase.form: stable does not",
           p->tau_1 / p->tau_eta);
  page->warn(page->context, text);
}

static void warn_anisotropy(const cf_scene *scene, const cf_phase_params *p, const cf_page *page) {
  char text[300];
  cf_anisotropy law;
  if (cf_anisotropy_init(&law, &p->anisotropy) != CF_OK) return;
  const cf_anisotropy_bounds b = cf_anisotropy_range(&law, scene->dim, law.strength);
  if (b.stiff_min > 0 || b.stiff_max == b.stiff_min) return;
  snprintf(text, sizeof text,
           "anisotropy.strength = %g: from %.4g = 1/(folds^2 - 1) on some directions are missing from the "
           "crystal and "
           "the equation is not well-posed there; facets will be as rough as the grid",
           p->anisotropy.strength, 1.0 / (law.n * law.n - 1.0));
  page->warn(page->context, text);
}

/* Where the interface does not fit, nothing is ever all solid or all melt. */
static void warn_width(const cf_scene *scene, const cf_phase_params *p, const cf_page *page) {
  char text[300];
  double least = INFINITY;
  for (int a = 0; a < scene->dim; ++a) least = fmin(least, scene->domain.size.value[a]);
  if (THICKNESS * p->width <= least) return;
  snprintf(
      text, sizeof text,
      "phase.width = %.3g m: the interface, %.3g m thick, does not fit into the box of %.3g m; a width of "
      "about half a cell, %.2g m, resolves it",
      p->width, THICKNESS * p->width, least, scene->spacing / 2);
  page->warn(page->context, text);
}

static void warn_grid(const cf_scene *scene, const cf_phase_params *p, const cf_page *page) {
  char text[300];
  if (scene->spacing <= 4 * p->width) return;
  snprintf(text, sizeof text,
           "cells are %.3g widths of the interface: above about 3 it catches on the grid (cells of %.3g "
           "would be 2)",
           scene->spacing / p->width, 2 * p->width);
  page->warn(page->context, text);
}

cf_status cf_crystal_check(const cf_scene *scene, const double dt, const cf_page *page) {
  const cf_phase_params p = cf_crystal_params_at(scene, 0);
  char text[200];
  snprintf(text, sizeof text, "%.4g m from 10 to 90 %%, %.3g cells", THICKNESS * p.width,
           THICKNESS * p.width / scene->spacing);
  page->row(page->context, "interface", text);
  const double psi = p.karma_rappel ? 0 : p.alpha / acos(-1) * atan(p.gamma * fabs(-1.0));
  const double theta = p.tau_eta > 0 && cf_phase_has_memory(&p) ? p.tau_1 / p.tau_eta : 0;
  const double speed =
      p.tau_eta > 0 ? sqrt(2) * psi * p.width / p.tau_eta / sqrt(1 + 2 * theta * psi * psi) : INFINITY;
  if (!p.karma_rappel) {
    snprintf(text, sizeof text, "psi = %.4g at T = -1; a flat front there would run at %.4g m/s", psi, speed);
    page->row(page->context, "driving force", text);
  }
  snprintf(text, sizeof text, "tau_1/tau_eta = %.4g, F_eta = %g; dt = %.3g tau_eta", theta, p.f_eta,
           dt / p.tau_eta);
  page->row(page->context, "memory", text);
  warn_form(scene, &p, page);
  warn_anisotropy(scene, &p, page);
  warn_width(scene, &p, page);
  warn_grid(scene, &p, page);
  return CF_OK;
}

/* Heat is stepped with the phase, whatever plan.h would say of it alone; eta diffuses by the keys of `phase:`. */
cf_scalar_law cf_crystal_law(const cf_scene *scene, const int field) {
  return strcmp(scene->fields.item[field].name, "T") == 0 ? CF_SCALAR_COUPLED : CF_SCALAR_ELSEWHERE;
}

bool cf_crystal_shows(const cf_scene *scene, const char *name) {
  static const char *const all[] = {"arrival", "age", "thickness", "heat_flux", "psi", "grain", "velocity"};
  (void)scene;
  for (size_t i = 0; i < sizeof all / sizeof *all; ++i)
    if (strcmp(name, all[i]) == 0) return true;
  return false;
}

double cf_crystal_memory(const cf_scene *scene) {
  const bool moves =
      scene->velocity.count > 0 && (scene->velocity.axis[0].fn.eval != NULL ||
                                    scene->velocity.axis[0].fn.value != 0 || scene->velocity.count > 1);
  return cf_scalars_bytes(scene, 26 + (moves ? 2 * scene->dim + 4 : 0));
}
