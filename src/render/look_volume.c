/* SPDX-License-Identifier: MIT
 *
 * Ink and smoke. The density is the value's part of the range; `strength` is the optical depth of a tenth of the box's
 * shortest side at its upper end, so pictures of one scene with one range and one strength can be compared.
 *
 * Ink is what it lets through: the colour c is white light behind the depth 1, so that absorb = -ln c times the depth.
 * Thin veils are pale, thick ink is nearly black, and the hue deepens between, as Beer and Lambert say.
 */
#include "render/look_part.h"

#include "base/real.h"

static double shortest(const cf_grid *g) {
  double side = g->h * g->box.n[0];
  for (int a = 1; a < g->box.dim; ++a) side = CF_MIN(side, g->h * g->box.n[a]);
  return side;
}

static cf_status check(const cf_look *look, const cf_exhibit *e) {
  if (e->fields == 0) return cf_look_no(look, "a field of three dimensions");
  if (e->grid->box.dim != 3)
    return cf_fail(CF_BAD_ARGUMENT, "%s is a field of two dimensions: style field shows it",
                   e->field[0].name);
  return CF_OK;
}

/* The field as a medium whose density is 1 at the upper end of the range. */
static cf_status make_medium(const cf_look *look, const cf_exhibit *e, cf_medium *m) {
  double low = look->low, high = look->high;
  if (isnan(low) || isnan(high)) {
    low = (double)INFINITY, high = -(double)INFINITY;
    CF_TRY(cf_exhibit_range(look, e, &low, &high));
    low = CF_MAX(low, 0);
  }
  return cf_medium_create(m, e->grid, e->field[0].at, low, high > low ? 1 / (high - low) : 0, true);
}

static float depth_of(const cf_look *look, const cf_exhibit *e, const double usual) {
  return (float)(cf_or(look->strength, usual) / (0.1 * shortest(e->grid)));
}

cf_status cf_draw_ink(const cf_look *look, const cf_exhibit *e, cf_canvas *c) {
  const cf_vec lets = cf_or_colour(look->colour, (cf_vec){0.30f, 0.46f, 0.76f});
  cf_studio s = {.seed = 1};
  cf_stand stand = {.turn = 0, .rise = 3, .angle = 22};
  cf_medium m;
  CF_TRY(check(look, e));
  cf_look_box(e, stand.low, stand.high);
  cf_look_stand(look, &stand, &s);
  const cf_vec white = cf_or_colour(look->background, (cf_vec){0.97f, 0.965f, 0.95f});
  s.backdrop = (cf_backdrop){white, cf_vec_times(white, (cf_vec){0.70f, 0.735f, 0.77f}), {0.5f, 0.47f}, 1.0f};
  CF_TRY(make_medium(look, e, &m));
  const float depth = depth_of(look, e, 2);
  m.absorb = (cf_vec){-depth * logf(CF_MAX(lets.x, 1e-4f)), -depth * logf(CF_MAX(lets.y, 1e-4f)),
                      -depth * logf(CF_MAX(lets.z, 1e-4f))};
  s.media = 1, s.medium[0] = &m;
  const cf_status status = cf_look_take(look, &s, (cf_develop){.contrast = 1.08, .white = 1}, c);
  cf_medium_destroy(&m);
  return status;
}

cf_status cf_draw_smoke(const cf_look *look, const cf_exhibit *e, cf_canvas *c) {
  const cf_vec albedo = cf_or_colour(look->colour, (cf_vec){0.96f, 0.96f, 0.965f});
  cf_studio s = {.seed = 1};
  cf_stand stand = {.turn = 0, .rise = 8, .angle = 24};
  cf_medium m;
  CF_TRY(check(look, e));
  cf_look_box(e, stand.low, stand.high);
  cf_look_stand(look, &stand, &s);
  cf_look_key(look, 70, 40, (cf_vec){4.6f, 4.2f, 3.7f}, 2, &s);
  s.light[s.lights++] =
      (cf_light){cf_light_toward(-140, 20), {0.8f, 1.25f, 2.1f}, 0.05f}; /* a cold rim from behind */
  s.sky = (cf_sky){{0.16f, 0.19f, 0.25f}, {0.1f, 0.1f, 0.12f}, {0.03f, 0.03f, 0.03f}};
  const cf_vec ground = cf_or_colour(look->background, (cf_vec){0.034f, 0.040f, 0.052f});
  s.backdrop = (cf_backdrop){ground, cf_vec_scale(0.22f, ground), {0.5f, 0.5f}, 1.0f};
  CF_TRY(make_medium(look, e, &m));
  const float depth = depth_of(look, e, 2.5);
  m.scatter = cf_vec_scale(depth, albedo);
  m.absorb = (cf_vec){depth * (1 - albedo.x), depth * (1 - albedo.y), depth * (1 - albedo.z)};
  m.forward = 0.25f;
  s.media = 1, s.medium[0] = &m;
  cf_status status =
      cf_medium_illuminate(&m, s.lights, s.light, s.sky.zenith, cf_vec_of(s.camera.eye), look->threads);
  if (status == CF_OK)
    status = cf_look_take(look, &s, (cf_develop){.contrast = 1.2, .white = 4, .vignette = 0.2}, c);
  cf_medium_destroy(&m);
  return status;
}
