/* SPDX-License-Identifier: MIT */
#include "model/atlas.h"

#include "base/mem.h"
#include "io/scene.h"

#define CF_PARAM_STRUCT cf_atlas_flake
CF_PARAM_TABLE(cf_atlas_flake, CF_ATLAS_FLAKE_TABLE)
#undef CF_PARAM_STRUCT
#define CF_PARAM_STRUCT cf_atlas
CF_PARAM_TABLE(cf_atlas, CF_ATLAS_TABLE)
#undef CF_PARAM_STRUCT

static cf_status read_into(cf_atlas *atlas, const char *path) {
  const cf_overrides none = {0, NULL};
  CF_TRY(cf_config_open(&atlas->config, &cf_atlas_table, path, &none));
  CF_TRY(cf_config_read(atlas->config, atlas));
  return atlas->flakes.count > 0 ? CF_OK
                                 : cf_config_fail_at(atlas->config, "flakes", "an atlas without a flake");
}

cf_status cf_atlas_read(cf_atlas **atlas, const char *path) {
  *atlas = NULL;
  cf_atlas *fresh;
  CF_TRY(CF_NEW(&fresh, 1));
  const cf_status status = read_into(fresh, path);
  if (status == CF_OK)
    *atlas = fresh;
  else
    cf_atlas_destroy(fresh);
  return status;
}

void cf_atlas_destroy(cf_atlas *atlas) {
  if (atlas == NULL) return;
  cf_config_destroy(atlas->config);
  cf_free(atlas);
}

const char *cf_atlas_folder(const cf_atlas *atlas) { return cf_config_folder(atlas->config); }
