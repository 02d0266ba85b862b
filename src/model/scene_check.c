/* SPDX-License-Identifier: MIT
 *
 * What a scene must fulfil beyond its tables, and what follows from what it says: the same number of axes
 * everywhere, one spacing, sources that have what they need, outputs that exist. Fields are in
 * scene_fields.c.
 */
#include "model/scene_check.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "io/scene.h"
#include "model/model.h"
#include "model/obstacles.h"

enum { KEY_MAX = 160, FRAMES_MAX = 999999 };
#define CELLS_MAX 0x1p40
#define STEPS_MAX 1e12

/* --- axes ------------------------------------------------------------------------------------- */

static cf_status check_count(const cf_scene *scene, const int count, const char *key) {
  if (count == scene->dim) return CF_OK;
  return cf_scene_fail_at(scene, key, "%s has %d entries, domain.size has %d", key, count, scene->dim);
}

cf_status cf_scene_check_axes(cf_scene *scene, cf_param_functions *functions, const bool given,
                              const int wanted, const char *key) {
  if (!given)
    for (int a = 1; a < wanted; ++a) functions->axis[a] = functions->axis[0];
  if (!given) functions->count = wanted;
  if (functions->count == wanted) return CF_OK;
  if (wanted == 1)
    return cf_scene_fail_at(scene, key, "%s: a scalar has one expression, here are %d", key,
                            functions->count);
  return cf_scene_fail_at(scene, key, "%s: one expression an axis is wanted, %d in all, here %s %d", key,
                          wanted, functions->count == 1 ? "is" : "are", functions->count);
}

/* --- domain and time -------------------------------------------------------------------------- */

static cf_status check_spacing(cf_scene *scene) {
  const cf_scene_domain *domain = &scene->domain;
  double cells = 1.0;
  scene->spacing = domain->size.value[0] / (double)domain->cells.value[0];
  for (int a = 0; a < scene->dim; ++a) {
    const double h = domain->size.value[a] / (double)domain->cells.value[a];
    cells *= (double)domain->cells.value[a];
    if (!(fabs(h - scene->spacing) <= 1e-6 * scene->spacing))
      return cf_scene_fail_at(scene, "domain.cells",
                              "domain.cells: the spacing is %.10g on x and %.10g on %c, it must be the same",
                              scene->spacing, h, "xyz"[a]);
  }
  if (scene->spacing < 1e-100 || scene->spacing > 1e100)
    return cf_scene_fail_at(scene, "domain.size", "domain.size: cells of %.3g m cannot be computed with",
                            scene->spacing);
  if (cells > CELLS_MAX)
    return cf_scene_fail_at(scene, "domain.cells", "domain.cells: %.3g cells in all, at most %.3g", cells,
                            CELLS_MAX);
  return CF_OK;
}

static cf_status resolve_domain(cf_scene *scene) {
  cf_scene_domain *domain = &scene->domain;
  scene->dim = domain->size.count;
  CF_TRY(check_count(scene, domain->cells.count, "domain.cells"));
  if (!domain->given.origin) domain->origin.count = scene->dim;
  domain->given.origin = true;
  CF_TRY(check_count(scene, domain->origin.count, "domain.origin"));
  return check_spacing(scene);
}

static cf_status check_time(const cf_scene *scene) {
  const double steps = scene->time.end / scene->time.dt; /* NaN: chosen by the model */
  if (steps > STEPS_MAX)
    return cf_scene_fail_at(scene, "time.dt", "time.dt: %.3g steps in all, at most %.3g", steps, STEPS_MAX);
  const double frames = scene->time.end * scene->time.frames;
  if (frames > FRAMES_MAX)
    return cf_scene_fail_at(scene, "time.frames", "time.frames: %.3g frames in all, at most %d", frames,
                            FRAMES_MAX);
  return CF_OK;
}

/* --- names ------------------------------------------------------------------------------------ */

/* What a run can show: the fields of the scene, and the flow if there is one. */
static cf_status check_field_name(const cf_scene *scene, const char *key, const char *name) {
  const char *meant = NULL;
  const cf_model *model = cf_model_of(scene->model);
  if (strncmp(key, "output.", 7) == 0 && model->shows != NULL && model->shows(scene, name)) return CF_OK;
  if (strncmp(key, "output.", 7) == 0 && strcmp(name, "solid") == 0 && scene->obstacles.count > 0 &&
      model->obstacles != NULL)
    return CF_OK;
  if (cf_scene_field_index(scene, name) >= 0 || cf_scene_flux_scalar(scene, name) >= 0) return CF_OK;
  for (int i = 0; i < scene->fields.count && meant == NULL; ++i)
    if (cf_param_distance(name, scene->fields.item[i].name) >= 0) meant = scene->fields.item[i].name;
  if (meant != NULL)
    return cf_scene_fail_at(scene, key, "%s: there is no field %.60s: did you mean %s?", key, name, meant);
  return cf_scene_fail_at(scene, key, "%s: there is no field %.60s", key, name);
}

/* --- sources ---------------------------------------------------------------------------------- */

/* A source under check, with its number for messages. */
typedef struct cf_source_check {
  cf_scene *scene;
  cf_scene_source *source;
  int number;
} cf_source_check;

static const char *source_key(const cf_source_check *check, const char *name, char *key) {
  snprintf(key, KEY_MAX, "sources.%d%s%s", check->number, name[0] != '\0' ? "." : "", name);
  return key;
}

static cf_status fail_source(const cf_source_check *check, const char *name, const char *sentence) {
  char key[KEY_MAX];
  source_key(check, name, key);
  return cf_scene_fail_at(check->scene, key, "%s %s", key, sentence);
}

/* Left out, the field is phi, or the only scalar there is. */
static cf_status source_field(const cf_source_check *check) {
  const cf_scene *scene = check->scene;
  char key[KEY_MAX];
  const int only = cf_scene_flux_scalar(scene, "q");
  if (!check->source->given.field && cf_scene_field_index(scene, check->source->field) < 0 && only >= 0)
    check->source->field = scene->fields.item[only].name;
  return check_field_name(scene, source_key(check, "field", key), check->source->field);
}

/* A point: at and amount, nothing else. */
static cf_status check_point(const cf_source_check *check) {
  const cf_scene_source *s = check->source;
  const cf_scene_domain *domain = &check->scene->domain;
  char key[KEY_MAX];
  if (!s->given.at) return fail_source(check, "amount", "needs `at`, the place of the point");
  if (!s->given.amount) return fail_source(check, "at", "needs `amount` beside it");
  if (s->given.shape) return fail_source(check, "shape", "does not go with `at`: a point has no shape");
  if (s->given.center) return fail_source(check, "center", "does not go with `at`");
  if (s->given.half) return fail_source(check, "half", "does not go with `at`");
  if (s->given.radius) return fail_source(check, "radius", "does not go with `at`");
  if (cf_scene_name_is_flux(s->field))
    return fail_source(check, "field", "is a flux: a point source adds to a scalar");
  CF_TRY(check_count(check->scene, s->at.count, source_key(check, "at", key)));
  for (int a = 0; a < check->scene->dim; ++a) {
    const double from = domain->origin.value[a], to = from + domain->size.value[a];
    if (s->at.value[a] < from || s->at.value[a] > to)
      return cf_scene_fail_at(check->scene, key, "%s: %c = %.10g lies outside the box, %.10g to %.10g", key,
                              "xyz"[a], s -> at.value[a], from, to);
  }
  return CF_OK;
}

static cf_status check_shape(const cf_source_check *check) {
  const cf_scene_source *s = check->source;
  char key[KEY_MAX];
  if (!s->given.shape)
    return fail_source(check, "", "needs a shape: box, sphere or everywhere (or `at` and `amount`)");
  const bool box = s->shape == CF_SCENE_SHAPE_BOX, sphere = s->shape == CF_SCENE_SHAPE_SPHERE;
  if ((box || sphere) && !s->given.center) return fail_source(check, "", "needs center");
  if (box && !s->given.half) return fail_source(check, "", "needs half, half of the sides of the box");
  if (sphere && !s->given.radius) return fail_source(check, "", "needs radius");
  if (!box && s->given.half) return fail_source(check, "half", "goes with shape: box only");
  if (!sphere && s->given.radius) return fail_source(check, "radius", "goes with shape: sphere only");
  if (!box && !sphere && s->given.center)
    return fail_source(check, "center", "does not go with shape: everywhere");
  if (s->given.center) CF_TRY(check_count(check->scene, s->center.count, source_key(check, "center", key)));
  if (s->given.half) CF_TRY(check_count(check->scene, s->half.count, source_key(check, "half", key)));
  return CF_OK;
}

static cf_status check_source(const cf_source_check *check) {
  cf_scene_source *s = check->source;
  char key[KEY_MAX];
  const int acts = (s->given.rate ? 1 : 0) + (s->given.value ? 1 : 0) + (s->given.amount ? 1 : 0);
  CF_TRY(source_field(check));
  if (acts == 0 && s->given.at) return fail_source(check, "at", "needs `amount` beside it");
  if (acts == 0) return fail_source(check, "", "does nothing: it needs rate or value (or `at` and `amount`)");
  if (acts > 1)
    return fail_source(check, s->given.value ? "value" : "amount", "is one too many: rate, value or amount");
  CF_TRY(s->given.at || s->given.amount ? check_point(check) : check_shape(check));
  const int wanted = cf_scene_name_is_flux(s->field) ? check->scene->dim : 1;
  if (s->given.rate)
    CF_TRY(cf_scene_check_axes(check->scene, &s->rate, true, wanted, source_key(check, "rate", key)));
  if (s->given.value)
    CF_TRY(cf_scene_check_axes(check->scene, &s->value, true, wanted, source_key(check, "value", key)));
  return CF_OK;
}

/* --- the model's keys ------------------------------------------------------------------------- */

/* A key that other models read and this one does not would be ignored without a word. */
static cf_status check_keys(const cf_scene *scene) {
  const cf_model *model = cf_model_of(scene->model);
  for (int i = 0; i < cf_scene_table.count; ++i) {
    const char *key = cf_scene_table.param[i].name;
    if (cf_scene_has(scene, key) && !cf_model_reads(model, key))
      return cf_scene_fail_at(scene, key, "%s is not a key of `model: %s`", key, model->name);
  }
  return CF_OK;
}

/* --- output ----------------------------------------------------------------------------------- */

static cf_status default_outputs(cf_scene *scene) {
  const char *const *own = cf_model_of(scene->model)->outputs;
  cf_param_texts *fields = &scene->output.fields;
  const bool points = own == NULL && scene->points.count > 0;
  int count = scene->fields.count;
  void *block;
  if (own != NULL)
    for (count = 0; own[count] != NULL;) ++count;
  count += points;
  CF_TRY(cf_config_new(scene->config, &block, (size_t)count * sizeof *fields->item));
  fields->item = block;
  fields->count = count;
  for (int i = 0; i < count - points; ++i)
    fields->item[i] = own != NULL ? own[i] : scene->fields.item[i].name;
  if (points) fields->item[count - 1] = "points";
  scene->output.given.fields = true;
  return CF_OK;
}

/* Frames around obstacles show them. */
static cf_status add_solid(cf_scene *scene) {
  cf_param_texts *fields = &scene->output.fields;
  void *block;
  if (scene->obstacles.count == 0 || cf_model_of(scene->model)->obstacles == NULL) return CF_OK;
  for (int i = 0; i < fields->count; ++i)
    if (strcmp(fields->item[i], "solid") == 0) return CF_OK;
  CF_TRY(cf_config_new(scene->config, &block, (size_t)(fields->count + 1) * sizeof *fields->item));
  if (fields->count > 0) memcpy(block, fields->item, (size_t)fields->count * sizeof *fields->item);
  fields->item = block;
  fields->item[fields->count++] = "solid";
  return CF_OK;
}

static cf_status resolve_output_fields(cf_scene *scene) {
  cf_scene_output *output = &scene->output;
  char key[KEY_MAX];
  if (!output->given.fields) CF_TRY(default_outputs(scene));
  CF_TRY(add_solid(scene));
  for (int i = 0; i < output->fields.count; ++i) {
    const char *name = output->fields.item[i];
    snprintf(key, sizeof key, "output.fields.%d", i);
    CF_TRY(check_field_name(scene, key, name));
    for (int j = 0; j < i; ++j)
      if (strcmp(output->fields.item[j], name) == 0)
        return cf_scene_fail_at(scene, key, "%s: %s is in the list twice", key, name);
  }
  return CF_OK;
}

static cf_status resolve_preview(cf_scene *scene) {
  cf_scene_preview *preview = &scene->output.preview;
  const cf_param_texts *fields = &scene->output.fields;
  const char *const *own = cf_model_of(scene->model)->outputs;
  if (preview->field[0] == '\0')
    preview->field = fields->count > 0 ? fields->item[0] : own != NULL ? own[0] : scene->fields.item[0].name;
  CF_TRY(check_field_name(scene, "output.preview.field", preview->field));
  if (preview->range.count == 2 && !(preview->range.value[0] < preview->range.value[1]))
    return cf_scene_fail_at(scene, "output.preview.range",
                            "output.preview.range: the first must be below the second");
  return CF_OK;
}

/* --- all -------------------------------------------------------------------------------------- */

cf_status cf_scene_resolve(cf_scene *scene) {
  const cf_model *model = cf_model_of(scene->model);
  CF_TRY(check_keys(scene));
  CF_TRY(resolve_domain(scene));
  CF_TRY(check_time(scene));
  CF_TRY(cf_scene_resolve_fields(scene));
  CF_TRY(cf_scene_check_axes(scene, &scene->velocity, scene->given.velocity, scene->dim, "velocity"));
  for (int i = 0; i < scene->sources.count; ++i)
    CF_TRY(check_source(&(cf_source_check){scene, &scene->sources.item[i], i}));
  CF_TRY(cf_obstacles_resolve(scene));
  if (model->resolve != NULL) CF_TRY(model->resolve(scene));
  CF_TRY(resolve_output_fields(scene));
  return resolve_preview(scene);
}
