/* SPDX-License-Identifier: MIT
 *
 * Snowfall: the snow on the ground as a surface with fine sparkle, and over it the flakes, those that lie and those in
 * the air, at dusk, with a low warm light from behind and a cold one from the side.
 */
#include "base/mem.h"
#include "base/real.h"
#include "base/rng.h"
#include "render/look_part.h"

/* --- flakes -------------------------------------------------------------------------------------------------------- */

/* v turned by the unit quaternion q. */
static cf_vec turned(const float q[4], const cf_vec v) {
  const cf_vec u = {q[1], q[2], q[3]}, t = cf_vec_scale(2, cf_vec_cross(u, v));
  return cf_vec_add(cf_vec_along(v, q[0], t), cf_vec_cross(u, t));
}

static cf_card card_of(const cf_exhibit_flakes *f, const float place[3], const float turn[4],
                       const float radius, const float number) {
  const int n = CF_MIN(CF_MAX((int)lrintf(number), 0), f->kinds - 1);
  const cf_exhibit_kind *kind = &f->kind[n];
  const cf_vec x = turned(turn, (cf_vec){1, 0, 0}), y = turned(turn, (cf_vec){0, 1, 0});
  cf_vec at = {place[0], place[1], place[2]};
  at = cf_vec_along(cf_vec_along(at, radius * (float)kind->middle[0], x), radius * (float)kind->middle[1], y);
  return (cf_card){.at = at,
                   .right = cf_vec_scale(radius * (float)kind->half, x),
                   .up = cf_vec_scale(radius * (float)kind->half, y),
                   .picture = n};
}

static cf_status make_cards(const cf_exhibit_flakes *f, cf_cards *all, cf_flake_picture **picture,
                            cf_card **card) {
  all->count = f->air.count + f->settled.count, all->pictures = f->kinds;
  CF_TRY(CF_NEW(picture, f->kinds));
  CF_TRY(CF_NEW(card, CF_MAX(all->count, 1)));
  for (int k = 0; k < f->kinds; ++k) (*picture)[k] = f->kind[k].picture;
  for (int64_t i = 0; i < f->air.count; ++i) {
    cf_card *c = &(*card)[i];
    *c = card_of(f, f->air.place[i], f->air.turn[i], f->air.radius[i], f->air.number[i]);
    if (f->air.velocity != NULL)
      c->velocity = (cf_vec){f->air.velocity[i][0], f->air.velocity[i][1], f->air.velocity[i][2]};
  }
  for (int64_t i = 0; i < f->settled.count; ++i) {
    cf_card *c = &(*card)[f->air.count + i];
    *c = card_of(f, f->settled.place[i], f->settled.turn[i], f->settled.radius[i], f->settled.number[i]);
    c->at.z += 0.15f * f->settled.radius[i]; /* on the snow, not half in it */
  }
  all->picture = *picture, all->card = *card;
  return CF_OK;
}

/* --- ground -------------------------------------------------------------------------------------------------------------- */

/* The columns, and around them once more as much on every side: the box repeats itself sideways, and the picture
 * should not end where it does. */
typedef struct ground {
  int64_t vertices, triangles;
  float (*at)[3], (*normal)[3], (*colour)[3];
  uint32_t (*corner)[3];
} ground;

static void ground_destroy(ground *g) {
  cf_free(g->at);
  cf_free(g->normal);
  cf_free(g->colour);
  cf_free(g->corner);
}

static int wrapped(const int i, const int n) { return ((i % n) + n) % n; }

/* A grain of snow is a little lighter or darker than the next. */
static void set_vertex(const ground *g, const cf_exhibit_flakes *f, const double side[2], const int i,
                       const int j, const int64_t v) {
  const int n = f->columns[0], m = f->columns[1], a = wrapped(i, n), b = wrapped(j, m);
  const float *top = f->top[b * n + a];
  g->at[v][0] = top[0] + (float)(side[0] * floor((double)i / n));
  g->at[v][1] = top[1] + (float)(side[1] * floor((double)j / m));
  g->at[v][2] = top[2];
  const float east = f->top[b * n + wrapped(i + 1, n)][2], west = f->top[b * n + wrapped(i - 1, n)][2];
  const float north = f->top[wrapped(j + 1, m) * n + a][2], south = f->top[wrapped(j - 1, m) * n + a][2];
  const cf_vec up = cf_vec_unit(
      (cf_vec){(west - east) * (float)(n / (2 * side[0])), (south - north) * (float)(m / (2 * side[1])), 1});
  const float grain = 0.90f + 0.10f * (float)cf_random(11, (uint64_t)a, (uint64_t)b, 0);
  g->normal[v][0] = up.x, g->normal[v][1] = up.y, g->normal[v][2] = up.z;
  g->colour[v][0] = 0.86f * grain, g->colour[v][1] = 0.90f * grain, g->colour[v][2] = 0.97f * grain;
}

static cf_status ground_create(const cf_exhibit *e, ground *g) {
  const cf_exhibit_flakes *f = e->flakes;
  const int across = 3 * f->columns[0], rows = 3 * f->columns[1];
  const double side[2] = {e->grid->h * e->grid->box.n[0], e->grid->h * e->grid->box.n[1]};
  g->vertices = (int64_t)across * rows;
  g->triangles = 2 * (int64_t)(across - 1) * (rows - 1);
  CF_TRY(CF_NEW(&g->at, g->vertices));
  CF_TRY(CF_NEW(&g->normal, g->vertices));
  CF_TRY(CF_NEW(&g->colour, g->vertices));
  CF_TRY(CF_NEW(&g->corner, CF_MAX(g->triangles, 1)));
  int64_t t = 0;
  for (int j = 0; j < rows; ++j)
    for (int i = 0; i < across; ++i) {
      const int64_t v = (int64_t)j * across + i;
      set_vertex(g, f, side, i - f->columns[0], j - f->columns[1], v);
      if (i + 1 == across || j + 1 == rows) continue;
      const uint32_t p = (uint32_t)v, q = p + (uint32_t)across;
      const uint32_t two[2][3] = {{p, p + 1, q + 1}, {p, q + 1, q}};
      for (int n = 0; n < 2; ++n, ++t)
        for (int c = 0; c < 3; ++c) g->corner[t][c] = two[n][c];
    }
  return CF_OK;
}

/* --- the picture --------------------------------------------------------------------------------------------------------- */

/* What is sharp lies as near as it can with no flake higher than a third of the picture, and a dozen flakes between 0.7
 * and 1.4 times that distance. */
static double sharp_distance(const cf_exhibit_flakes *f, const cf_stand *stand, const double aspect) {
  const double high = 2 * tan(0.5 * stand->angle * acos(-1.0) / 180);
  double volume = 1, radius = 0;
  for (int a = 0; a < 3; ++a) volume *= stand->high[a] - stand->low[a];
  for (int64_t i = 0; i < f->air.count; ++i) radius = CF_MAX(radius, (double)f->air.radius[i]);
  const double dense = CF_MAX((double)f->air.count, 1) / volume;
  const double many = cbrt(12 / (0.8 * dense * high * high * aspect));
  return CF_MIN(CF_MAX(many, 2 * radius * 16 / (5 * high)), 0.5 * (stand->high[1] - stand->low[1]));
}

/* The camera stands at the front of the box, a little above the ground. */
static void dusk(const cf_look *look, const cf_exhibit *e, cf_studio *s) {
  cf_stand stand = {.turn = 0, .rise = 3, .angle = 32};
  const cf_vec night = cf_or_colour(look->background, (cf_vec){0.020f, 0.032f, 0.060f});
  cf_look_box(e, stand.low, stand.high);
  const double deep = stand.high[1] - stand.low[1], tall = stand.high[2] - stand.low[2];
  cf_look_stand(look, &stand, s);
  if (isnan(look->eye[0]) && isnan(look->turn)) {
    const double eye[3] = {0.5 * (stand.low[0] + stand.high[0]), stand.low[1], stand.low[2] + 0.32 * tall};
    for (int a = 0; a < 3; ++a) s->camera.eye[a] = eye[a], s->camera.aim[a] = cf_or(look->aim[a], eye[a]);
    const double sharp = sharp_distance(e->flakes, &stand, (double)look->width / look->height);
    if (isnan(look->aim[1])) s->camera.aim[1] = eye[1] + sharp;
    s->camera.focus = cf_or(look->focus, sharp);
    s->camera.aperture = cf_or(look->aperture, 0.025 * s->camera.focus);
  }
  cf_look_key(look, 150, 24, (cf_vec){1.25f, 1.12f, 0.95f}, 3, s);
  s->light[s->lights++] = (cf_light){cf_light_toward(-70, 38), {0.30f, 0.46f, 0.80f}, 0.25f};
  s->sky = (cf_sky){{0.10f, 0.14f, 0.22f}, {0.05f, 0.07f, 0.11f}, {0.02f, 0.02f, 0.03f}};
  s->bounce = 0.6f;
  s->backdrop = (cf_backdrop){night, cf_vec_scale(0.16f, night), {0.5f, 0.55f}, 1.0f};
  const float fade = (float)(3.6 / deep); /* the far side is nearly lost in it */
  s->haze = (cf_haze){{fade, 0.92f * fade, 0.85f * fade}, cf_vec_scale(0.5f, night)};
}

static cf_status take(const cf_look *look, const cf_studio *s, const cf_cards *all, cf_canvas *c) {
  const cf_develop how = {
      .exposure = look->exposure, .contrast = 1.15, .white = 3, .glow = 0.10, .vignette = 0.3};
  const cf_cards_light light = {.lights = s->lights,
                                .light = s->light,
                                .sky = s->sky,
                                .tint = {0.92f, 0.96f, 1.0f},
                                .glint = 1.6f,
                                .haze = s->haze.fade,
                                .haze_colour = s->haze.colour};
  cf_film film;
  CF_TRY(cf_studio_expose(s, &film));
  const double shutter = look->shutter > 0 ? look->shutter : 1.0 / 1000;
  cf_status status = cf_cards_draw(all, &light, &s->camera, shutter, look->threads, &film);
  if (status == CF_OK) status = cf_film_develop(&film, &how, c);
  cf_film_destroy(&film);
  return status;
}

cf_status cf_draw_cards(const cf_look *look, const cf_exhibit *e, cf_canvas *c) {
  cf_studio s = {.seed = 1};
  cf_cards all = {.count = 0};
  cf_flake_picture *picture = NULL;
  cf_card *card = NULL;
  float corners[4][3];
  ground g = {.at = NULL};
  if (e->flakes == NULL || e->flakes->kinds == 0) return cf_look_no(look, "flakes with an atlas");
  dusk(look, e, &s);
  const cf_material snow = {
      .tint = {0.5f, 0.52f, 0.56f}, .gloss = 0.02f, .roughness = 0.55f, .through = 0.0f};
  cf_status status = make_cards(e->flakes, &all, &picture, &card);
  if (e->flakes->columns[0] > 0) {
    if (status == CF_OK) status = ground_create(e, &g);
    s.solid[0] = (cf_solid){.vertices = g.vertices,
                            .triangles = g.triangles,
                            .at = (const float(*)[3])g.at,
                            .normal = (const float(*)[3])g.normal,
                            .colour = (const float(*)[3])g.colour,
                            .corner = (const uint32_t(*)[3])g.corner};
  } else {
    double low[3], high[3];
    cf_look_box(e, low, high);
    s.solid[0] = cf_look_floor(low, high, low[2], 3, corners);
  }
  s.solid[0].material = snow, s.solids = 1;
  if (status == CF_OK) status = take(look, &s, &all, c);
  ground_destroy(&g);
  cf_free(card);
  cf_free(picture);
  return status;
}
