/* SPDX-License-Identifier: MIT
 *
 * The second half of reading a scene: see scene_check.c.
 */
#ifndef CF_MODEL_SCENE_CHECK_H
#define CF_MODEL_SCENE_CHECK_H

#include "model/scene.h"

extern const cf_param_table cf_scene_field_table;

/* Works out what was left out and checks what goes together. CF_BAD_SCENE at the key. */
cf_status cf_scene_resolve(cf_scene *scene);

/* The parts: fields with their diffusion and walls (scene_fields.c), sources and output (scene_check.c). */
cf_status cf_scene_resolve_fields(cf_scene *scene);

/* Gives a list of functions one entry an axis for vectors, and checks that it has them: `wanted` entries at
 * `key`. */
cf_status cf_scene_check_axes(cf_scene *scene, cf_param_functions *functions, bool given, int wanted,
                              const char *key);

#endif
