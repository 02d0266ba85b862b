/* SPDX-License-Identifier: MIT */
#include "render/studio.h"

#include "base/mem.h"
#include "base/real.h"
#include "grid/sweep.h"
#include "render/rays.h"
#include "render/surface.h"

enum { TILE = 32, BLOCK = 8, SAMPLES_FIRST = 4, SAMPLES_MOST = 65536, SIDE_MOST = 16384 };

/* --- what stands there ---------------------------------------------------------------------------------------- */

static cf_status add_all(const cf_studio *s, cf_stage *stage) {
  unsigned object;
  for (int i = 0; i < s->solids; ++i) {
    const cf_solid *b = &s->solid[i];
    CF_TRY(cf_rays_add_mesh(stage->rays, b->vertices, b->at, b->triangles, b->corner, &object));
    stage->thing[object] = (cf_thing){.solid = b, .material = &b->material};
  }
  for (int i = 0; i < s->balls; ++i) {
    const cf_balls *b = &s->ball[i];
    CF_TRY(cf_rays_add_balls(stage->rays, b->count, b->at, b->moved, &object));
    stage->thing[object] = (cf_thing){.balls = b, .material = &b->material};
  }
  return cf_rays_ready(stage->rays);
}

/* --- one ray ------------------------------------------------------------------------------------------------------ */

/* What a clear body does with a ray: reflect it, or bend it. */
static void pass_on(const cf_point *p, cf_ray *ray, const float chance) {
  const float n = p->material->index > 0 ? p->material->index : 1, ratio = p->leaving ? n : 1 / n;
  const float cosine = -cf_vec_dot(ray->along, p->normal), rest = 1 - ratio * ratio * (1 - cosine * cosine);
  if (rest <= 0 || chance < cf_surface_mirror(p, cosine)) {
    ray->along = cf_vec_unit(cf_vec_along(ray->along, 2 * cosine, p->normal));
    ray->from = cf_vec_along(p->at, p->skin, p->flat);
    return;
  }
  const float turn = ratio * cosine - sqrtf(rest);
  ray->along = cf_vec_unit(cf_vec_along(cf_vec_scale(ratio, ray->along), turn, p->normal));
  ray->from = cf_vec_along(p->at, -p->skin, p->flat);
}

static void cross_media(const cf_studio *s, const cf_ray *ray, const float far, cf_dice *dice, cf_vec *light,
                        cf_vec *through) {
  for (int i = 0; i < s->media; ++i)
    cf_medium_march(s->medium[i], ray, 0, far, cf_dice_one(dice), light, through);
}

static void cross_haze(const cf_haze *haze, const float far, cf_vec *light, cf_vec *through) {
  if (haze->fade.x <= 0 && haze->fade.y <= 0 && haze->fade.z <= 0) return;
  const cf_vec kept = cf_vec_fade(cf_vec_scale(far, haze->fade));
  const cf_vec lost = {1 - kept.x, 1 - kept.y, 1 - kept.z};
  *light = cf_vec_add(*light, cf_vec_times(*through, cf_vec_times(lost, haze->colour)));
  *through = cf_vec_times(*through, kept);
}

enum { TURNS = 12 };
#define BRIGHTEST 16.0f

/* `behind` is what the ray sees if nothing is in its way; *distance how far it came before it met something. */
static cf_vec see(const cf_stage *stage, cf_ray ray, const cf_vec behind, cf_dice *dice, float *distance) {
  const cf_studio *s = stage->studio;
  cf_vec light = {0, 0, 0}, through = {1, 1, 1};
  bool lamps = true; /* are seen through what is all clear; through jelly they would only be specks */
  *distance = INFINITY;
  for (int turn = 0; turn < TURNS; ++turn) {
    cf_hit hit;
    cf_point p;
    const bool met = cf_rays_hit(stage->rays, &ray, 0, INFINITY, &hit);
    cross_media(s, &ray, met ? hit.distance : INFINITY, dice, &light, &through);
    if (!met) {
      const cf_vec seen = turn == 0 ? behind : cf_surface_around(stage, ray.along, lamps);
      return cf_vec_add(light, cf_vec_times(through, seen));
    }
    if (turn == 0) *distance = hit.distance;
    cf_surface_meet(stage, &ray, &hit, &p);
    if (p.leaving)
      through = cf_vec_times(through, cf_vec_fade(cf_vec_scale(hit.distance, p.material->absorb)));
    else
      cross_haze(&s->haze, hit.distance, &light, &through);
    float chance[2];
    cf_dice_pair(dice, chance);
    if (chance[0] >= p.material->clear)
      return cf_vec_add(light, cf_vec_times(through, cf_surface_light(stage, &ray, &p, dice)));
    lamps = lamps && p.material->clear >= 1;
    pass_on(&p, &ray, chance[1]);
  }
  return light;
}

/* --- all rays ------------------------------------------------------------------------------------------------------- */

/* A number in [0, 1) as one in -1 .. 1 with the density of a tent: neighbouring pixels share what lies between. */
static float tent(const float s) { return s < 0.5f ? sqrtf(2 * s) - 1 : 1 - sqrtf(2 - 2 * s); }

/* Samples of a pixel, added up: light, those that met something, and how far that was. */
typedef struct exposure {
  cf_vec light;
  float met, far;
} exposure;

/* Samples first .. end - 1. */
static void expose_pixel(const cf_stage *stage, const cf_lens *lens, const int pixel[2], const int first,
                         const int end, exposure *e) {
  const cf_studio *s = stage->studio;
  const float wide = (float)s->width, tall = (float)s->height;
  const uint64_t p = (uint64_t)pixel[1] * (uint64_t)s->width + (uint64_t)pixel[0];
  for (int i = first; i < end; ++i) {
    cf_dice dice = {.pixel = cf_random_mix(s->seed) ^ p, .sample = (uint32_t)i};
    float at[2], disc[2], distance;
    cf_dice_pair(&dice, at);
    const float px = (float)pixel[0] + 0.5f + tent(at[0]), py = (float)pixel[1] + 0.5f + tent(at[1]);
    cf_dice_pair(&dice, at);
    cf_sample_disc(at, disc);
    cf_ray ray = cf_lens_ray(lens, px, py, disc);
    ray.time = cf_dice_one(&dice);
    const cf_vec behind = cf_backdrop_at(&s->backdrop, px / wide, py / tall, wide / tall);
    const cf_vec seen = see(stage, ray, behind, &dice, &distance);
    /* One sample that finds a lamp through a drop must not outshine all others. */
    const float most = fmaxf(seen.x, fmaxf(seen.y, seen.z));
    e->light = cf_vec_along(e->light, fminf(1, BRIGHTEST / fmaxf(most, BRIGHTEST)), seen);
    if (distance < INFINITY) e->met += 1, e->far += distance * cf_vec_dot(ray.along, lens->forward);
  }
}

/* By how much the eye sees a and b differ, squared. */
static float unlike(const cf_vec a, const cf_vec b) {
  const cf_vec d = {sqrtf(a.x) - sqrtf(b.x), sqrtf(a.y) - sqrtf(b.y), sqrtf(a.z) - sqrtf(b.z)};
  return cf_vec_dot(d, d) / 3;
}

/* Pixels x0 <= x < x1, y0 <= y < y1. */
static void expose_block(const cf_stage *stage, const cf_lens *lens, const int at[4], cf_film *f) {
  const cf_studio *s = stage->studio;
  exposure sum[BLOCK * BLOCK] = {{{0, 0, 0}, 0, 0}};
  int done = 0, pixels = (at[2] - at[0]) * (at[3] - at[1]);
  float noise = INFINITY;
  while (done < s->samples && !(noise < s->noise)) {
    const int goal = done == 0 ? CF_MIN(SAMPLES_FIRST, s->samples) : CF_MIN(2 * done, s->samples);
    float square = 0;
    for (int y = at[1], n = 0; y < at[3]; ++y)
      for (int x = at[0]; x < at[2]; ++x, ++n) {
        const size_t p = (size_t)y * (size_t)f->width + (size_t)x;
        const cf_vec before = f->light[p];
        expose_pixel(stage, lens, (int[2]){x, y}, done, goal, &sum[n]);
        f->light[p] = cf_vec_scale(1 / (float)goal, sum[n].light);
        f->distance[p] = sum[n].met > 0 ? sum[n].far / sum[n].met : INFINITY;
        f->share[p] = sum[n].met / (float)goal;
        square += done == 0 ? INFINITY : unlike(before, f->light[p]);
      }
    noise = sqrtf(square / (float)pixels);
    done = goal;
  }
}

/* Where nothing can be met: the backdrop alone. */
static void expose_backdrop(const cf_studio *s, const int at[4], cf_film *f) {
  const float wide = (float)s->width, tall = (float)s->height;
  for (int y = at[1]; y < at[3]; ++y)
    for (int x = at[0]; x < at[2]; ++x) {
      const size_t p = (size_t)y * (size_t)f->width + (size_t)x;
      f->distance[p] = INFINITY;
      f->light[p] =
          cf_backdrop_at(&s->backdrop, ((float)x + 0.5f) / wide, ((float)y + 0.5f) / tall, wide / tall);
    }
}

static void expose_all(const cf_stage *stage, const cf_lens *lens, cf_film *f) {
  cf_vec low, high;
  const bool some = cf_rays_bounds(stage->rays, &low, &high);
  const int across = (f->width + TILE - 1) / TILE, tiles = across * ((f->height + TILE - 1) / TILE);
  CF_PRAGMA(omp parallel for schedule(dynamic) num_threads(CF_MAX(stage->studio->threads, 1)))
  for (int t = 0; t < tiles; ++t) {
    const int x0 = t % across * TILE, y0 = t / across * TILE;
    const int x1 = CF_MIN(x0 + TILE, f->width), y1 = CF_MIN(y0 + TILE, f->height);
    const float pixels[4] = {(float)x0 - 1, (float)y0 - 1, (float)x1 + 1,
                             (float)y1 + 1}; /* tents reach out */
    const bool full = stage->studio->media > 0 || (some && cf_lens_reaches(lens, pixels, low, high));
    for (int y = y0; y < y1; y += BLOCK)
      for (int x = x0; x < x1; x += BLOCK) {
        const int block[4] = {x, y, CF_MIN(x + BLOCK, x1), CF_MIN(y + BLOCK, y1)};
        if (full)
          expose_block(stage, lens, block, f);
        else
          expose_backdrop(stage->studio, block, f);
      }
  }
}

static cf_status check(const cf_studio *s) {
  if (s->width < 1 || s->height < 1 || s->width > SIDE_MOST || s->height > SIDE_MOST)
    return cf_fail(CF_BAD_ARGUMENT, "a picture of %d x %d pixels: sides must be 1 to %d", s->width, s->height,
                   SIDE_MOST);
  if (s->samples < 1 || s->samples > SAMPLES_MOST)
    return cf_fail(CF_BAD_ARGUMENT, "%d samples a pixel: must be 1 to %d", s->samples, SAMPLES_MOST);
  return CF_OK;
}

cf_status cf_studio_expose(const cf_studio *s, cf_film *f) {
  cf_stage stage = {.studio = s};
  cf_lens lens;
  *f = (cf_film){.light = NULL};
  CF_TRY(check(s));
  CF_TRY(cf_lens_grind(&lens, &s->camera, s->width, s->height));
  CF_TRY(cf_rays_create(&stage.rays));
  cf_status status = add_all(s, &stage);
  if (status == CF_OK) status = cf_film_create(f, s->width, s->height);
  if (status == CF_OK) expose_all(&stage, &lens, f);
  cf_rays_destroy(stage.rays);
  return status;
}
