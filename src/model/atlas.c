/* SPDX-License-Identifier: MIT */
#include "model/atlas.h"

#include <stdint.h>
#include <stdio.h>

#include "base/mem.h"
#include "io/image.h"
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

/* --- shapes ----------------------------------------------------------------------------------------------- */

/* Moments of the thickness (8 bits are enough for them), and of the silhouette, wherever there is any ice. */
static bool add_up(const cf_atlas_flake *f, const uint8_t *rgb, cf_atlas_shape *shape) {
  const int n = (int)f->pixels.value[0], m = (int)f->pixels.value[1];
  double mass = 0, turning = 0, area = 0, middle[2] = {0, 0};
  for (int j = 0; j < m; ++j)
    for (int i = 0; i < n; ++i) {
      const double h = rgb[3 * ((ptrdiff_t)j * n + i)], x = i - f->center.value[0],
                   y = f->center.value[1] - j;
      if (h == 0) continue;
      mass += h;
      turning += h * (x * x + y * y);
      area += 1;
      middle[0] += x;
      middle[1] += y;
    }
  if (mass == 0) return false;
  const double D = 2 * f->radius / f->metres_per_pixel;
  shape->inertia = turning / (mass * D * D);
  for (int a = 0; a < 2; ++a) shape->offset[a] = middle[a] / (area * D);
  return true;
}

cf_status cf_atlas_measure(const cf_atlas *atlas, const int i, cf_atlas_shape *shape) {
  const cf_atlas_flake *f = &atlas->flakes.item[i];
  char path[1024];
  int width, height;
  uint8_t *rgb;
  const int length = snprintf(path, sizeof path, "%s/%s", cf_atlas_folder(atlas), f->height);
  if (length >= (int)sizeof path) return cf_fail(CF_BAD_FILE, "%.200s...: the path is too long", path);
  CF_TRY(cf_image_read(path, &width, &height, &rgb));
  const bool fits = width == f->pixels.value[0] && height == f->pixels.value[1];
  const bool ice = fits && add_up(f, rgb, shape);
  cf_free(rgb);
  if (!fits)
    return cf_fail(CF_BAD_FILE, "%s: %d x %d pixels, the atlas says %ld x %ld: grow the flakes again", path,
                   width, height, f->pixels.value[0], f->pixels.value[1]);
  return ice ? CF_OK : cf_fail(CF_BAD_FILE, "%s: there is no ice in it: grow the flakes again", path);
}

const char *cf_atlas_folder(const cf_atlas *atlas) { return cf_config_folder(atlas->config); }
