/* SPDX-License-Identifier: MIT
 *
 * What the style `cards` shows: the flakes of a snowfall, those that lie, the ground, and the pictures of the atlas.
 */
#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "app/showing.h"
#include "base/mem.h"
#include "base/real.h"
#include "io/image.h"
#include "model/atlas.h"

typedef struct cf_flock {
  cf_atlas *atlas; /* stays from frame to frame, with its pictures */
  cf_exhibit_kind *kind;
  cf_points air, settled, ground;
  float *turn[2], *radius[2], *number[2], *velocity;
  cf_exhibit_flakes flakes;
} cf_flock;

void cf_flock_clear(cf_flock *f) {
  if (f == NULL) return;
  for (int i = 0; i < 2; ++i) {
    cf_free(f->turn[i]);
    cf_free(f->radius[i]);
    cf_free(f->number[i]);
    f->turn[i] = f->radius[i] = f->number[i] = NULL;
  }
  cf_free(f->velocity);
  f->velocity = NULL;
  cf_points_clear(&f->air);
  cf_points_clear(&f->settled);
  cf_points_clear(&f->ground);
  f->flakes = (cf_exhibit_flakes){.kinds = f->flakes.kinds, .kind = f->flakes.kind};
}

void cf_flock_destroy(cf_flock *f) {
  if (f == NULL) return;
  cf_flock_clear(f);
  for (int k = 0; f->kind != NULL && k < f->flakes.kinds; ++k) cf_flake_picture_destroy(&f->kind[k].picture);
  cf_free(f->kind);
  cf_atlas_destroy(f->atlas);
  cf_free(f);
}

/* --- the atlas ----------------------------------------------------------------------------------------------------------- */

static cf_status read_picture(const cf_atlas *atlas, const char *name, const cf_atlas_flake *flake,
                              int *width, int *height, uint8_t **rgba) {
  cf_path path;
  CF_TRY(cf_path_make(&path, "%s/%s", cf_atlas_folder(atlas), name));
  CF_TRY(cf_image_read_cover(path.text, width, height, rgba));
  if (*width == (int)flake->pixels.value[0] && *height == (int)flake->pixels.value[1]) return CF_OK;
  cf_free(*rgba);
  *rgba = NULL;
  return cf_fail(CF_BAD_FILE, "%s: %d x %d pixels, where the atlas says %ld x %ld", path.text, *width,
                 *height, flake->pixels.value[0], flake->pixels.value[1]);
}

static float tilt_of(const uint8_t *normal) {
  const float x = (float)normal[0] / 127.5f - 1, y = (float)normal[1] / 127.5f - 1;
  return x * x + y * y < 1e-4f ? 0 : sqrtf(x * x + y * y); /* half a grey level is level */
}

/* The root mean square over what the ice covers. */
static float usual_tilt(const uint8_t *rgba, const uint8_t *normal, const size_t texels) {
  double sum = 0, all = 1e-9;
  for (size_t n = 0; n < texels; ++n) {
    const double cover = rgba[4 * n + 3] / 255.0, tilt = (double)tilt_of(normal + 4 * n);
    sum += cover * tilt * tilt, all += cover;
  }
  return fmaxf((float)sqrt(sum / all), 0.01f);
}

/* A texture is square: a picture that is not gets empty margins. Its colour is how much light the ice scatters: rims
 * and ridges, where the normal tilts more than it does elsewhere on this flake, send back more, and let less by, than
 * level faces, which are nearly glass. */
static cf_status make_texture(const uint8_t *rgba, const uint8_t *normal, const int width, const int height,
                              cf_flake_picture *out) {
  const int side = CF_MAX(width, height), off[2] = {(side - width) / 2, (side - height) / 2};
  const size_t texels = (size_t)side * (size_t)side;
  float *values;
  CF_TRY(CF_NEW(&values, 4 * texels));
  float *cover = values, *bright = values + texels;
  float(*slope)[2] = (float(*)[2])(values + 2 * texels);
  const float usual = usual_tilt(rgba, normal, (size_t)width * (size_t)height);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const size_t from = 4 * ((size_t)y * (size_t)width + (size_t)x);
      const size_t to = (size_t)(y + off[1]) * (size_t)side + (size_t)(x + off[0]);
      const float n[3] = {(float)normal[from] / 127.5f - 1, (float)normal[from + 1] / 127.5f - 1,
                          (float)normal[from + 2] / 127.5f - 1};
      const float up = fmaxf(n[2], 0.1f), relief = fminf(tilt_of(normal + from) / (1.5f * usual), 1);
      const float grey = ((float)rgba[from] + (float)rgba[from + 1] + (float)rgba[from + 2]) / 765;
      cover[to] = (0.5f + 0.5f * relief) * (float)rgba[from + 3] / 255;
      bright[to] = grey * (0.55f + 0.45f * relief);
      slope[to][0] = -n[0] / up, slope[to][1] = -n[1] / up;
    }
  const cf_status s = cf_flake_picture_create(out, side, cover, bright, (const float(*)[2])slope);
  cf_free(values);
  return s;
}

static cf_status make_kind(const cf_atlas *atlas, const cf_atlas_flake *flake, cf_exhibit_kind *kind) {
  uint8_t *rgba, *normal = NULL;
  int width, height;
  CF_TRY(read_picture(atlas, flake->rgba, flake, &width, &height, &rgba));
  cf_status s = read_picture(atlas, flake->normal, flake, &width, &height, &normal);
  if (s == CF_OK) s = make_texture(rgba, normal, width, height, &kind->picture);
  cf_free(normal);
  cf_free(rgba);
  const double pixel = flake->metres_per_pixel / flake->radius;
  kind->half = 0.5 * CF_MAX(width, height) * pixel;
  kind->middle[0] = (0.5 * (width - 1) - flake->center.value[0]) * pixel;
  kind->middle[1] = (flake->center.value[1] - 0.5 * (height - 1)) * pixel;
  return s;
}

/* The path of the atlas is relative to the scene. */
static cf_status read_atlas(const cf_showing *s, cf_flock *f) {
  const char *name = s->scene->snowfall.atlas;
  cf_path path;
  if (name == NULL) return cf_fail(CF_BAD_FILE, "%s: its scene has no snowfall.atlas", s->folder);
  if (name[0] == '/')
    CF_TRY(cf_path_make(&path, "%s", name));
  else
    CF_TRY(cf_path_make(&path, "%s/%s", cf_scene_folder(s->scene), name));
  CF_TRY(cf_atlas_read(&f->atlas, path.text));
  CF_TRY(CF_NEW(&f->kind, f->atlas->flakes.count));
  for (int k = 0; k < f->atlas->flakes.count; ++k) {
    f->flakes.kinds = k + 1;
    CF_TRY(make_kind(f->atlas, &f->atlas->flakes.item[k], &f->kind[k]));
  }
  f->flakes.kind = f->kind;
  return CF_OK;
}

/* --- the frame ------------------------------------------------------------------------------------------------------------ */

static cf_status read_set(const cf_showing *s, const char *word, const int64_t number, cf_points *p) {
  cf_path path;
  CF_TRY(cf_path_make(&path, "%s/%s_%06" PRId64 ".vtkhdf", s->folder, word, number));
  return cf_points_read(p, path.text);
}

static cf_status read_flakes(cf_flock *f, const int which, const cf_points *p) {
  CF_TRY(cf_points_attribute(p, "orientation", 4, &f->turn[which]));
  CF_TRY(cf_points_attribute(p, "radius", 1, &f->radius[which]));
  return cf_points_attribute(p, "kind", 1, &f->number[which]);
}

cf_status cf_flock_load(cf_showing *s, const int64_t number) {
  if (s->flock == NULL) {
    CF_TRY(CF_NEW(&s->flock, 1));
    CF_TRY(read_atlas(s, s->flock));
  }
  cf_flock *f = s->flock;
  cf_exhibit_flakes *all = &f->flakes;
  CF_TRY(read_set(s, "particles", number, &f->air));
  CF_TRY(read_set(s, "particles_settled", number, &f->settled));
  CF_TRY(read_set(s, "particles_ground", number, &f->ground));
  CF_TRY(read_flakes(f, 0, &f->air));
  CF_TRY(read_flakes(f, 1, &f->settled));
  CF_TRY(cf_points_attribute(&f->air, "velocity", 3, &f->velocity));
  all->air.count = f->air.count, all->settled.count = f->settled.count;
  all->air.place = (const float(*)[3])f->air.place, all->settled.place = (const float(*)[3])f->settled.place;
  all->air.velocity = (const float(*)[3])f->velocity;
  all->air.turn = (const float(*)[4])f->turn[0], all->settled.turn = (const float(*)[4])f->turn[1];
  all->air.radius = f->radius[0], all->settled.radius = f->radius[1];
  all->air.number = f->number[0], all->settled.number = f->number[1];
  const int across = s->grid.box.n[0], deep = s->grid.box.n[1];
  if (f->ground.count == (int64_t)across * deep) {
    all->columns[0] = across, all->columns[1] = deep;
    all->top = (const float(*)[3])f->ground.place;
  }
  s->exhibit.flakes = all;
  s->exhibit.time = f->air.time;
  return CF_OK;
}
