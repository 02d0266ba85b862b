/* SPDX-License-Identifier: MIT
 *
 * The tables of the scene as constants, and reading, writing and explaining with them. What a scene must
 * fulfil beyond the tables is in scene_check.c and scene_fields.c.
 */
#include "model/scene.h"

#include <stdarg.h>
#include <string.h>

#include "base/locale.h"
#include "base/mem.h"
#include "io/scene.h"
#include "model/model.h"
#include "model/scene_check.h"

#define CF_PARAM_STRUCT cf_scene_domain
CF_PARAM_TABLE(cf_scene_domain, CF_DOMAIN_TABLE)
#undef CF_PARAM_STRUCT
#define CF_PARAM_STRUCT cf_scene_time
CF_PARAM_TABLE(cf_scene_time, CF_TIME_TABLE)
#undef CF_PARAM_STRUCT
#define CF_PARAM_STRUCT cf_scene_diffusion
CF_PARAM_TABLE(cf_scene_diffusion, CF_DIFFUSION_TABLE)
#undef CF_PARAM_STRUCT
#define CF_PARAM_STRUCT cf_scene_advection
CF_PARAM_TABLE(cf_scene_advection, CF_ADVECTION_TABLE)
#undef CF_PARAM_STRUCT
#define CF_PARAM_STRUCT cf_scene_field
CF_PARAM_TABLE(cf_scene_field, CF_FIELD_TABLE)
#undef CF_PARAM_STRUCT
#define CF_PARAM_STRUCT cf_scene_source
CF_PARAM_TABLE(cf_scene_source, CF_SOURCE_TABLE)
#undef CF_PARAM_STRUCT
#define CF_PARAM_STRUCT cf_scene_solver
CF_PARAM_TABLE(cf_scene_solver, CF_SOLVER_TABLE)
#undef CF_PARAM_STRUCT
#define CF_PARAM_STRUCT cf_scene_checkpoint
CF_PARAM_TABLE(cf_scene_checkpoint, CF_CHECKPOINT_TABLE)
#undef CF_PARAM_STRUCT
#define CF_PARAM_STRUCT cf_scene_preview
CF_PARAM_TABLE(cf_scene_preview, CF_PREVIEW_TABLE)
#undef CF_PARAM_STRUCT
#define CF_PARAM_STRUCT cf_scene_vdb
CF_PARAM_TABLE(cf_scene_vdb, CF_VDB_TABLE)
#undef CF_PARAM_STRUCT
#define CF_PARAM_STRUCT cf_scene_output
CF_PARAM_TABLE(cf_scene_output, CF_OUTPUT_TABLE)
#undef CF_PARAM_STRUCT
#define CF_PARAM_STRUCT cf_scene_sparse
CF_PARAM_TABLE(cf_scene_sparse, CF_SPARSE_TABLE)
#undef CF_PARAM_STRUCT
#define CF_PARAM_STRUCT cf_scene_points
CF_PARAM_TABLE(cf_scene_points, CF_POINTS_TABLE)
#undef CF_PARAM_STRUCT
#define CF_PARAM_STRUCT cf_scene_flow_wall
CF_PARAM_TABLE(cf_scene_flow_wall, CF_FLOW_WALL_TABLE)
#undef CF_PARAM_STRUCT
#define CF_PARAM_STRUCT cf_scene_flow_inlet
CF_PARAM_TABLE(cf_scene_flow_inlet, CF_FLOW_INLET_TABLE)
#undef CF_PARAM_STRUCT
#define CF_PARAM_STRUCT cf_scene_flow
CF_PARAM_TABLE(cf_scene_flow, CF_FLOW_TABLE)
#undef CF_PARAM_STRUCT
#define CF_PARAM_STRUCT cf_scene_obstacle_stop
CF_PARAM_TABLE(cf_scene_obstacle_stop, CF_OBSTACLE_STOP_TABLE)
#undef CF_PARAM_STRUCT
#define CF_PARAM_STRUCT cf_scene_obstacle_field
CF_PARAM_TABLE(cf_scene_obstacle_field, CF_OBSTACLE_FIELD_TABLE)
#undef CF_PARAM_STRUCT
#define CF_PARAM_STRUCT cf_scene_obstacle
CF_PARAM_TABLE(cf_scene_obstacle, CF_OBSTACLE_TABLE)
#undef CF_PARAM_STRUCT
#define CF_PARAM_STRUCT cf_scene_gel_body
CF_PARAM_TABLE(cf_scene_gel_body, CF_GEL_BODY_TABLE)
#undef CF_PARAM_STRUCT
#define CF_PARAM_STRUCT cf_scene_gel_water
CF_PARAM_TABLE(cf_scene_gel_water, CF_GEL_WATER_TABLE)
#undef CF_PARAM_STRUCT
#define CF_PARAM_STRUCT cf_scene_gel
CF_PARAM_TABLE(cf_scene_gel, CF_GEL_TABLE)
#undef CF_PARAM_STRUCT
#define CF_PARAM_STRUCT cf_scene_phase_anisotropy
CF_PARAM_TABLE(cf_scene_phase_anisotropy, CF_PHASE_ANISOTROPY_TABLE)
#undef CF_PARAM_STRUCT
#define CF_PARAM_STRUCT cf_scene_phase_seed
CF_PARAM_TABLE(cf_scene_phase_seed, CF_PHASE_SEED_TABLE)
#undef CF_PARAM_STRUCT
#define CF_PARAM_STRUCT cf_scene_phase_map
CF_PARAM_TABLE(cf_scene_phase_map, CF_PHASE_MAP_TABLE)
#undef CF_PARAM_STRUCT
#define CF_PARAM_STRUCT cf_scene_phase_maps
CF_PARAM_TABLE(cf_scene_phase_maps, CF_PHASE_MAPS_TABLE)
#undef CF_PARAM_STRUCT
#define CF_PARAM_STRUCT cf_scene_phase_noise
CF_PARAM_TABLE(cf_scene_phase_noise, CF_PHASE_NOISE_TABLE)
#undef CF_PARAM_STRUCT
#define CF_PARAM_STRUCT cf_scene_phase_window
CF_PARAM_TABLE(cf_scene_phase_window, CF_PHASE_WINDOW_TABLE)
#undef CF_PARAM_STRUCT
#define CF_PARAM_STRUCT cf_scene_phase
CF_PARAM_TABLE(cf_scene_phase, CF_PHASE_TABLE)
#undef CF_PARAM_STRUCT
#define CF_PARAM_STRUCT cf_scene_snowfall
CF_PARAM_TABLE(cf_scene_snowfall, CF_SNOWFALL_TABLE)
#undef CF_PARAM_STRUCT
#define CF_PARAM_STRUCT cf_scene_camera
CF_PARAM_TABLE(cf_scene_camera, CF_RENDER_CAMERA_TABLE)
#undef CF_PARAM_STRUCT
#define CF_PARAM_STRUCT cf_scene_light
CF_PARAM_TABLE(cf_scene_light, CF_RENDER_LIGHT_TABLE)
#undef CF_PARAM_STRUCT
#define CF_PARAM_STRUCT cf_scene_render
CF_PARAM_TABLE(cf_scene_render, CF_RENDER_TABLE)
#undef CF_PARAM_STRUCT
#define CF_PARAM_STRUCT cf_scene
CF_PARAM_TABLE(cf_scene, CF_SCENE_TABLE)
#undef CF_PARAM_STRUCT

/* Before anything else is looked at: a later format may have other keys. */
static cf_status check_version(const cf_config *config) {
  const char *version = cf_config_scalar(config, "cattaneo");
  if (!cf_config_has(config, "cattaneo"))
    return cf_config_fail_at(config, "cattaneo", "cattaneo is missing: a scene starts with `cattaneo: 1`");
  if (version == NULL || strcmp(version, "1") != 0)
    return cf_config_fail_at(config, "cattaneo",
                             "cattaneo: %.40s is not a version this program knows: it reads 1",
                             version != NULL ? version : "this");
  return CF_OK;
}

static cf_status read_into(cf_scene *scene, const char *path, const cf_overrides *overrides) {
  CF_TRY(cf_config_open(&scene->config, &cf_scene_table, path, overrides));
  CF_TRY(check_version(scene->config));
  CF_TRY(cf_config_read(scene->config, scene));
  return cf_scene_resolve(scene);
}

cf_status cf_scene_read(cf_scene **scene, const char *path, const int overrides, const char *const *set) {
  const cf_overrides given = {overrides, set};
  *scene = NULL;
  cf_scene *fresh;
  CF_TRY(CF_NEW(&fresh, 1));
  void *before = cf_locale_plain();
  const cf_status status = read_into(fresh, path, &given);
  cf_locale_back(before);
  if (status != CF_OK) {
    cf_scene_destroy(fresh);
    return status;
  }
  *scene = fresh;
  return CF_OK;
}

void cf_scene_destroy(cf_scene *scene) {
  if (scene == NULL) return;
  cf_config_destroy(scene->config);
  cf_free(scene);
}

const char *cf_scene_path(const cf_scene *scene) { return cf_config_path(scene->config); }
const char *cf_scene_folder(const cf_scene *scene) { return cf_config_folder(scene->config); }
bool cf_scene_has(const cf_scene *scene, const char *key) { return cf_config_has(scene->config, key); }

cf_status cf_scene_fail_at(const cf_scene *scene, const char *key, const char *format, ...) {
  char sentence[CF_SENTENCE_MAX];
  va_list values;
  va_start(values, format);
  vsnprintf(sentence, sizeof sentence, format, values);
  va_end(values);
  return cf_config_fail_at(scene->config, key, "%s", sentence);
}

static bool is_read(const void *scene, const char *key) {
  return cf_model_reads(cf_model_of(((const cf_scene *)scene)->model), key);
}

cf_status cf_scene_write(const cf_scene *scene, char **text) {
  void *before = cf_locale_plain();
  const cf_status status = cf_config_write(&cf_scene_table, scene, is_read, text);
  cf_locale_back(before);
  return status;
}

cf_status cf_scene_explain(const char *key, char **text) {
  void *before = cf_locale_plain();
  const cf_status status = cf_config_explain(&cf_scene_table, key, text);
  cf_locale_back(before);
  return status;
}

/* --- names ------------------------------------------------------------------------------------ */

bool cf_scene_name_is_flux(const char *name) { return strcmp(name, "q") == 0 || strncmp(name, "q_", 2) == 0; }

int cf_scene_field_index(const cf_scene *scene, const char *name) {
  for (int i = 0; i < scene->fields.count; ++i)
    if (strcmp(scene->fields.item[i].name, name) == 0) return i;
  return -1;
}

int cf_scene_flux_scalar(const cf_scene *scene, const char *name) {
  int scalars = 0, last = -1;
  if (!cf_scene_name_is_flux(name)) return -1;
  if (name[1] == '_') {
    const int index = cf_scene_name_is_flux(name + 2) ? -1 : cf_scene_field_index(scene, name + 2);
    return index;
  }
  for (int i = 0; i < scene->fields.count; ++i) {
    if (cf_scene_name_is_flux(scene->fields.item[i].name)) continue;
    ++scalars;
    last = i;
  }
  return scalars == 1 ? last : cf_scene_field_index(scene, "phi");
}
