/* SPDX-License-Identifier: MIT
 *
 * Masks, distances, orientations and strengths that a scene gives as a picture or an array in place of an expression:
 * a map fills the whole box, its values stand at the centres of equal parts of it, and between them it is linear. An
 * orientation is not: between crystals of 5 and 55 degrees there is none of 30, so there the nearest value counts.
 *
 * Of a picture the mean of red, green and blue is taken as written (on white where it is transparent), its first row at
 * the upper end of y. Maps of two axes are the same for all z.
 */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "base/mem.h"
#include "io/image.h"
#include "io/npy.h"
#include "model/phase_part.h"

static const char *const names[CF_CRYSTAL_MAPS] = {"mask", "distance", "angle", "strength"};

static const cf_scene_phase_map *keys_of(const cf_scene *scene, const int which) {
  const cf_scene_phase_maps *all = &scene->phase.maps;
  const cf_scene_phase_map *const maps[CF_CRYSTAL_MAPS] = {&all->mask, &all->distance, &all->angle,
                                                           &all->strength};
  return maps[which];
}

bool cf_crystal_has_map(const cf_scene *scene, const int which) { return keys_of(scene, which)->given.file; }

static cf_fn written(const cf_scene *scene, const int which) {
  const cf_scene_phase *s = &scene->phase;
  const cf_fn all[CF_CRYSTAL_MAPS] = {s->mask.fn, s->distance.fn, s->anisotropy.angle.fn,
                                      s->anisotropy.strength.fn};
  return all[which];
}

bool cf_crystal_is_constant(const cf_scene *scene, const int which) {
  const cf_fn f = written(scene, which);
  return !cf_crystal_has_map(scene, which) && cf_fn_is_constant(&f);
}

/* --- reading ---------------------------------------------------------------------------------------------- */

static cf_status read_picture(const cf_scene_phase_map *k, cf_crystal_map *map) {
  uint8_t *rgb;
  CF_TRY(cf_image_read(k->file, &map->n[0], &map->n[1], &rgb));
  const cf_status s = CF_NEW(&map->value, (size_t)map->n[0] * (size_t)map->n[1]);
  const double low = k->range.value[0], per = (k->range.value[1] - low) / (3 * 255);
  map->n[2] = 1;
  for (int j = 0; s == CF_OK && j < map->n[1]; ++j)
    for (int i = 0; i < map->n[0]; ++i) {
      const uint8_t *c = rgb + 3 * ((size_t)(map->n[1] - 1 - j) * (size_t)map->n[0] + (size_t)i);
      map->value[(size_t)j * (size_t)map->n[0] + (size_t)i] = (float)(low + per * (c[0] + c[1] + c[2]));
    }
  cf_free(rgb);
  return s;
}

static cf_status read_array(const cf_scene_phase_map *k, const int dim, cf_crystal_map *map) {
  int axes;
  CF_TRY(cf_npy_read(k->file, &axes, map->n, &map->value));
  if (axes <= dim) return CF_OK;
  return cf_fail(CF_BAD_FILE, "%s: has %d axes, the scene has %d", k->file, axes, dim);
}

static bool ends_with(const char *text, const char *end) {
  const size_t n = strlen(text), m = strlen(end);
  return n >= m && strcmp(text + n - m, end) == 0;
}

static cf_status read_map(const cf_scene *scene, const int which, cf_crystal_map *map) {
  const cf_scene_phase_map *k = keys_of(scene, which);
  *map = (cf_crystal_map){.nearest = which == CF_CRYSTAL_ANGLE};
  cf_status s = CF_OK;
  if (ends_with(k->file, ".png"))
    s = read_picture(k, map);
  else if (ends_with(k->file, ".npy"))
    s = read_array(k, scene->dim, map);
  else
    s = cf_fail(CF_BAD_FILE, "%s: must be a picture (.png) or an array (.npy)", k->file);
  for (int a = 0; s == CF_OK && a < scene->dim; ++a) {
    map->origin[a] = a < scene->domain.origin.count ? scene->domain.origin.value[a] : 0;
    map->per_part[a] = map->n[a] / scene->domain.size.value[a];
  }
  if (s == CF_OK || s == CF_NO_MEMORY) return s;
  char why[CF_SENTENCE_MAX], key[64];
  snprintf(why, sizeof why, "%s", cf_status_sentence());
  snprintf(key, sizeof key, "phase.maps.%s.file", names[which]);
  return cf_scene_fail_at(scene, key, "%s: %s", key, why);
}

cf_status cf_crystal_read_maps(const cf_scene *scene, cf_crystal_map map[CF_CRYSTAL_MAPS]) {
  for (int i = 0; i < CF_CRYSTAL_MAPS; ++i)
    if (cf_crystal_has_map(scene, i)) CF_TRY(read_map(scene, i, &map[i]));
  return CF_OK;
}

void cf_crystal_drop_maps(cf_crystal_map map[CF_CRYSTAL_MAPS]) {
  for (int i = 0; i < CF_CRYSTAL_MAPS; ++i) {
    cf_free(map[i].value);
    map[i].value = NULL;
  }
}

/* --- asking ----------------------------------------------------------------------------------------------- */

/* The part of axis a that x is in, and how far towards the next. */
static int part_of(const cf_crystal_map *map, const int a, const double x, double *beyond) {
  const double u = (x - map->origin[a]) * map->per_part[a] - 0.5, last = map->n[a] - 1;
  const double at = fmax(0, fmin(last, map->nearest ? floor(u + 0.5) : u)), low = floor(at);
  *beyond = at - low;
  return (int)low;
}

static double value_at(const cf_crystal_map *map, const double x[3]) {
  double beyond[3] = {0}, sum = 0;
  int low[3] = {0};
  for (int a = 0; a < 3; ++a)
    if (map->n[a] > 1) low[a] = part_of(map, a, x[a], &beyond[a]);
  for (int c = 0; c < 8; ++c) {
    double weight = 1;
    size_t at[3];
    for (int a = 0; a < 3; ++a) {
      const int up = c >> a & 1;
      weight *= up ? beyond[a] : 1 - beyond[a];
      at[a] = (size_t)(low[a] + up);
    }
    if (weight > 0)
      sum += weight * (double)map->value[at[0] + (size_t)map->n[0] * (at[1] + (size_t)map->n[1] * at[2])];
  }
  return sum;
}

static void eval(const void *context, const int n, const double *x, const double *y, const double *z,
                 const double t, double *out) {
  (void)t;
  for (int i = 0; i < n; ++i) out[i] = value_at(context, (double[3]){x[i], y[i], z[i]});
}

cf_fn cf_crystal_map_fn(const cf_crystal *m, const int which) {
  if (m->map[which].value == NULL) return written(m->scene, which);
  return (cf_fn){.eval = eval, .context = &m->map[which]};
}
