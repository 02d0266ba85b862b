/* SPDX-License-Identifier: MIT
 *
 * Particles as balls that nearly touch, on a floor, with the shadows of their neighbours: what tells their depth.
 */
#include "base/mem.h"
#include "base/real.h"
#include "render/look_part.h"

typedef struct heap {
  float (*at)[4], (*moved)[3], (*colour)[3];
  double low[3], high[3];
} heap;

static void heap_destroy(heap *h) {
  cf_free(h->at);
  cf_free(h->moved);
  cf_free(h->colour);
}

/* Half the distance of neighbours if they fill their box evenly, or, if that is flat, its largest face. */
static double usual_radius(const heap *h, const int64_t count) {
  double side[3], volume = 1;
  for (int a = 0; a < 3; ++a) side[a] = h->high[a] - h->low[a];
  const double most = CF_MAX(side[0], CF_MAX(side[1], side[2]));
  int axes = 0;
  for (int a = 0; a < 3; ++a)
    if (side[a] > 1e-3 * most) volume *= side[a], ++axes;
  if (axes == 0) return 0.01;
  return 0.55 * pow(volume / (double)count, 1.0 / axes);
}

static cf_status heap_create(const cf_look *look, const cf_exhibit *e, heap *h) {
  *h = (heap){.at = NULL};
  CF_TRY(CF_NEW(&h->at, e->particles));
  CF_TRY(CF_NEW(&h->colour, e->particles));
  if (e->velocity != NULL && look->shutter > 0) CF_TRY(CF_NEW(&h->moved, e->particles));
  for (int64_t i = 0; i < e->particles; ++i)
    for (int a = 0; a < 3; ++a) {
      h->at[i][a] = e->place[i][a];
      h->low[a] = i == 0 ? (double)h->at[i][a] : CF_MIN(h->low[a], (double)h->at[i][a]);
      h->high[a] = i == 0 ? (double)h->at[i][a] : CF_MAX(h->high[a], (double)h->at[i][a]);
      if (h->moved != NULL) h->moved[i][a] = (float)look->shutter * e->velocity[i][a];
    }
  const double radius = e->radius > 0 ? e->radius : usual_radius(h, e->particles);
  for (int64_t i = 0; i < e->particles; ++i) h->at[i][3] = (float)radius;
  for (int a = 0; a < 3; ++a) h->low[a] -= radius, h->high[a] += radius;
  return CF_OK;
}

static void colour(const cf_look *look, const cf_exhibit *e, const heap *h) {
  cf_look l = *look;
  if (e->value != NULL && (isnan(l.low) || isnan(l.high))) {
    double low = (double)INFINITY, high = -(double)INFINITY;
    (void)cf_exhibit_range(look, e, &low, &high);
    l.low = low, l.high = high;
  }
  const cf_vec plain = cf_or_colour(look->colour, (cf_vec){0.18f, 0.42f, 0.66f});
  if (e->value != NULL) {
    cf_look_colours(&l, "moss", e->particles, e->value, h->colour);
    return;
  }
  for (int64_t i = 0; i < e->particles; ++i)
    h->colour[i][0] = plain.x, h->colour[i][1] = plain.y, h->colour[i][2] = plain.z;
}

static void set_up(const cf_look *look, const cf_exhibit *e, const heap *h, float corners[4][3],
                   cf_studio *s) {
  cf_stand stand = {.turn = 28, .rise = 22, .angle = 24};
  for (int a = 0; a < 3; ++a) stand.low[a] = h->low[a], stand.high[a] = h->high[a];
  cf_look_stand(look, &stand, s);
  cf_look_key(look, 40, 50, (cf_vec){1.9f, 1.8f, 1.65f}, 8, s);
  s->light[s->lights++] = (cf_light){cf_light_toward(-80, 25), {0.25f, 0.32f, 0.42f}, 0.4f};
  s->sky = (cf_sky){{0.50f, 0.55f, 0.62f}, {0.35f, 0.36f, 0.38f}, {0.10f, 0.10f, 0.10f}};
  s->bounce = 0.5f;
  const cf_vec paper = cf_or_colour(look->background, (cf_vec){0.60f, 0.62f, 0.65f});
  s->backdrop = (cf_backdrop){paper, cf_vec_scale(0.55f, paper), {0.5f, 0.4f}, 1.1f};
  s->balls = 1;
  s->ball[0] = (cf_balls){.count = e->particles,
                          .at = (const float(*)[4])h->at,
                          .moved = (const float(*)[3])h->moved,
                          .colour = (const float(*)[3])h->colour,
                          .material = {.tint = {1, 1, 1}, .gloss = 0.03f, .roughness = 0.4f}};
  if (!look->floor) return;
  s->solid[0] = cf_look_floor(h->low, h->high, h->low[2], 40, corners);
  s->solid[0].material = (cf_material){.tint = cf_vec_scale(0.72f, paper)};
  s->solids = 1;
}

cf_status cf_draw_particles(const cf_look *look, const cf_exhibit *e, cf_canvas *c) {
  const cf_develop how = {.contrast = 1.2, .white = 3.5, .vignette = 0.2};
  cf_studio s = {.seed = 1};
  float corners[4][3];
  heap h;
  if (e->particles == 0) return cf_look_no(look, "particles");
  cf_status status = heap_create(look, e, &h);
  if (status == CF_OK) {
    colour(look, e, &h);
    set_up(look, e, &h, corners, &s);
    status = cf_look_take(look, &s, how, c);
  }
  heap_destroy(&h);
  return status;
}
