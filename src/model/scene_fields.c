/* SPDX-License-Identifier: MIT
 *
 * The fields of a scene made complete: names, initial values, and for every scalar its own diffusion and
 * walls, with what it leaves out taken from the common ones.
 */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "io/scene.h"
#include "model/model.h"
#include "model/scene_check.h"
#include "model/scene_params.h"

enum { KEY_MAX = 160 };

/* --- diffusion ---------------------------------------------------------------------------------------------
 */

static cf_status resolve_own_diffusion(cf_scene *scene, cf_scene_field *field) {
  char path[KEY_MAX];
  cf_scene_diffusion *d = &field->diffusion;
  const cf_scene_diffusion *common = &scene->diffusion;
  snprintf(path, sizeof path, "fields.%s.diffusion", field->name);
  if (!d->given.f_t) d->f_t = common->f_t;
  if (!d->given.capacity) d->capacity = common->capacity;
  CF_TRY(cf_scene_resolve_params(scene, path, d));
#define CF_INHERIT(name, type, fallback, unit, range, doc) \
  if (!d->given.name) d->name = common->name;
  CF_DIFFUSION_TABLE(CF_INHERIT, )
#undef CF_INHERIT
  return CF_OK;
}

/* The key of a scalar's own diffusion, or the common one where it has none. */
static cf_status fail_scheme(const cf_scene *scene, const cf_scene_field *field, const char *name,
                             const char *sentence) {
  char key[KEY_MAX];
  snprintf(key, sizeof key, "fields.%s.diffusion.%s", field->name, name);
  if (!cf_scene_has(scene, key)) snprintf(key, sizeof key, "diffusion.%s", name);
  return cf_scene_fail_at(scene, key, "%s %s", key, sentence);
}

/* What schemes cannot do. */
static cf_status check_scheme(const cf_scene *scene, const cf_scene_field *field) {
  const cf_scene_diffusion *d = &field->diffusion;
  const bool wave = d->scheme == CF_SCENE_SCHEME_WAVE, positive = d->positivity == CF_SCENE_SWITCH_ON;
  if (wave && d->f_t > 0) return fail_scheme(scene, field, "f_t", "must be 0 with scheme: wave");
  if (wave && !(d->tau > 0)) return fail_scheme(scene, field, "tau", "must be above 0 with scheme: wave");
  if (wave && !cf_fn_is_constant(&d->k.fn))
    return fail_scheme(scene, field, "k", "must be one number with scheme: wave");
  if (wave && !cf_fn_is_constant(&d->capacity.fn))
    return fail_scheme(scene, field, "capacity", "must be one number with scheme: wave");
  if (positive && d->scheme != CF_SCENE_SCHEME_DEFAULT && d->scheme != CF_SCENE_SCHEME_LEAPFROG)
    return fail_scheme(scene, field, "positivity", "goes with scheme: default or leapfrog");
  return CF_OK;
}

/* --- walls ------------------------------------------------------------------------------------ */

static const char *side_name(const int axis, const int high) {
  static const char *const names[3][2] = {{"x-", "x+"}, {"y-", "y+"}, {"z-", "z+"}};
  return names[axis][high];
}

/* Sides that were not named are as in `common`; those of a third axis that is not there are insulated.
 * Without `common` all sides count as named afterwards. */
static void inherit_walls(const cf_scene *scene, cf_param_walls *walls, const cf_param_walls *common) {
  for (int axis = 0; axis < 3; ++axis)
    for (int high = 0; high < 2; ++high) {
      const bool there = axis < scene->dim;
      if (there && walls->given[axis][high]) continue;
      const bool inherit = there && common != NULL;
      walls->walls.kind[axis][high] = inherit ? common->walls.kind[axis][high] : CF_WALL_INSULATED;
      walls->walls.value[axis][high] = inherit ? common->walls.value[axis][high] : cf_fn_constant(0.0);
      walls->text[axis][high] = inherit ? common->text[axis][high] : NULL;
      walls->given[axis][high] = there && common == NULL;
    }
}

static cf_status check_walls(const cf_scene *scene, const char *path, const cf_param_walls *walls) {
  char key[KEY_MAX];
  for (int axis = 0; axis < scene->dim; ++axis)
    for (int high = 0; high < 2; ++high) {
      const char *side = side_name(axis, high), *other = side_name(axis, 1 - high);
      const bool here = walls->walls.kind[axis][high] == CF_WALL_PERIODIC;
      snprintf(key, sizeof key, "%s.%s", path, side);
      if (here && walls->walls.kind[axis][1 - high] != CF_WALL_PERIODIC)
        return cf_scene_fail_at(scene, key, "%s is periodic and %s is not: both are or none", key, other);
      if (here != (scene->domain.walls.walls.kind[axis][high] == CF_WALL_PERIODIC))
        return cf_scene_fail_at(scene, key, "%s: an axis is periodic for all fields or for none", key);
    }
  for (int high = 0; high < 2; ++high) {
    snprintf(key, sizeof key, "%s.%s", path, side_name(2, high));
    if (scene->dim == 2 && cf_scene_has(scene, key))
      return cf_scene_fail_at(scene, key, "%s: the scene has two axes, x and y", key);
  }
  return CF_OK;
}

/* --- fields ----------------------------------------------------------------------------------- */

static cf_status add_field(cf_scene *scene, const char *name) {
  const int count = scene->fields.count;
  void *block;
  CF_TRY(cf_config_new(scene->config, &block, (size_t)(count + 1) * sizeof(cf_scene_field)));
  if (count > 0) memcpy(block, scene->fields.item, (size_t)count * sizeof(cf_scene_field));
  scene->fields.item = block;
  scene->fields.count = count + 1;
  scene->fields.item[count].name = name;
  return cf_config_fill(scene->config, &cf_scene_field_table, &scene->fields.item[count]);
}

/* The scalars that the model has by itself are there, named or not, and no others; a model that takes any has one,
 * phi, where the scene names none. */
static cf_status complete_fields(cf_scene *scene) {
  const cf_model *model = cf_model_of(scene->model);
  char key[KEY_MAX];
  if (!cf_model_reads(model, "fields")) return CF_OK;
  if (model->fields == NULL) return scene->fields.count == 0 ? add_field(scene, "phi") : CF_OK;
  for (int i = 0; i < scene->fields.count; ++i) {
    const char *name = scene->fields.item[i].name, *const *own = model->fields;
    while (*own != NULL && strcmp(*own, name) != 0) ++own;
    snprintf(key, sizeof key, "fields.%s", name);
    if (*own == NULL && !cf_scene_name_is_flux(name))
      return cf_scene_fail_at(scene, key, "%s: `model: %s` has no such field; its first is %s", key,
                              model->name, model->fields[0]);
  }
  for (const char *const *own = model->fields; *own != NULL; ++own)
    if (cf_scene_field_index(scene, *own) < 0) CF_TRY(add_field(scene, *own));
  return CF_OK;
}

static cf_status resolve_flux(cf_scene *scene, cf_scene_field *field) {
  char key[KEY_MAX];
  snprintf(key, sizeof key, "fields.%s", field->name);
  if (cf_scene_flux_scalar(scene, field->name) < 0)
    return cf_scene_fail_at(scene, key, "%s is the flux of a scalar that `fields` does not have",
                            field->name);
  snprintf(key, sizeof key, "fields.%s.diffusion", field->name);
  if (field->given.diffusion)
    return cf_scene_fail_at(scene, key, "%s: a flux has no diffusion of its own", key);
  snprintf(key, sizeof key, "fields.%s.walls", field->name);
  if (field->given.walls) return cf_scene_fail_at(scene, key, "%s: a flux has the walls of its scalar", key);
  snprintf(key, sizeof key, "fields.%s.initial", field->name);
  return cf_scene_check_axes(scene, &field->initial, field->given.initial, scene->dim, key);
}

static cf_status resolve_scalar(cf_scene *scene, cf_scene_field *field) {
  char key[KEY_MAX];
  snprintf(key, sizeof key, "fields.%s.initial", field->name);
  CF_TRY(cf_scene_check_axes(scene, &field->initial, field->given.initial, 1, key));
  CF_TRY(resolve_own_diffusion(scene, field));
  CF_TRY(check_scheme(scene, field));
  inherit_walls(scene, &field->walls, &scene->domain.walls);
  snprintf(key, sizeof key, "fields.%s.walls", field->name);
  return check_walls(scene, key, &field->walls);
}

/* q and q_NAME of the only scalar are two names for one thing. */
static cf_status check_two_names(const cf_scene *scene) {
  const int q = cf_scene_field_index(scene, "q");
  const int scalar = q >= 0 ? cf_scene_flux_scalar(scene, "q") : -1;
  for (int i = 0; i < scene->fields.count; ++i) {
    const char *name = scene->fields.item[i].name;
    char key[KEY_MAX];
    if (i == q || scalar < 0 || cf_scene_flux_scalar(scene, name) != scalar) continue;
    snprintf(key, sizeof key, "fields.%s", name);
    return cf_scene_fail_at(scene, key, "%s and q are both the flux of %s", name,
                            scene->fields.item[scalar].name);
  }
  return CF_OK;
}

cf_status cf_scene_resolve_fields(cf_scene *scene) {
  inherit_walls(scene, &scene->domain.walls, NULL);
  CF_TRY(check_walls(scene, "domain.walls", &scene->domain.walls));
  CF_TRY(cf_scene_resolve_params(scene, "diffusion", &scene->diffusion));
  CF_TRY(complete_fields(scene));
  for (int i = 0; i < scene->fields.count; ++i) {
    cf_scene_field *field = &scene->fields.item[i];
    const bool flux = cf_scene_name_is_flux(field->name);
    CF_TRY(flux ? resolve_flux(scene, field) : resolve_scalar(scene, field));
  }
  return check_two_names(scene);
}
