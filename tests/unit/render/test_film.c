/* SPDX-License-Identifier: MIT
 *
 * Lens and film: where rays go and what they reach, the circle of confusion, the tone curve and the dither.
 *
 * also in single precision
 */
#include "testing.h"

#include <math.h>

#include "base/rng.h"
#include "render/camera.h"
#include "render/film.h"
#include "render/sample.h"

/* --- the lens ------------------------------------------------------------------------------------------------------------- */

/* Rays through all of the lens meet the plane at distance z within the circle of confusion, and fill it. */
static void the_circle_of_confusion_has_its_size(void **state) {
  const cf_camera c = {.eye = {1, 2, 3}, .aim = {1, 7, 3}, .angle = 30, .focus = 4, .aperture = 0.3};
  cf_lens l;
  (void)state;
  OK(cf_lens_grind(&l, &c, 640, 480));
  for (double z = 1; z < 20; z *= 1.7) {
    double widest = 0;
    for (int i = 0; i < 400; ++i) {
      const double a = 2 * acos(-1.0) * i / 400;
      const float disc[2] = {(float)cos(a), (float)sin(a)};
      const cf_ray r = cf_lens_ray(&l, 320, 240, disc);
      const float t = (float)z / cf_vec_dot(r.along, l.forward);
      const cf_vec off = cf_vec_sub(cf_vec_along(r.from, t, r.along), (cf_vec){1, 2 + (float)z, 3});
      widest = fmax(widest, (double)cf_vec_length(off));
    }
    CLOSE(2 * widest, 0.3 * fabs(z - 4) / 4, 1e-4);
    CLOSE(cf_lens_blur(&l, (float)z), 0.15 * fabs(z - 4) / 4 * (double)cf_lens_scale(&l, (float)z), 1e-3);
  }
}

static void what_is_projected_is_where_its_ray_goes(void **state) {
  const cf_camera c = {.eye = {3, -2, 5}, .aim = {0, 1, 0.5}, .angle = 40};
  const float pin[2] = {0, 0};
  cf_lens l;
  float x, y;
  (void)state;
  OK(cf_lens_grind(&l, &c, 300, 200));
  const cf_ray r = cf_lens_ray(&l, 77.5f, 31.25f, pin);
  assert_true(cf_lens_project(&l, cf_vec_along(r.from, 3.3f, r.along), &x, &y) > 0);
  CLOSE(x, 77.5, 1e-3);
  CLOSE(y, 31.25, 1e-3);
  assert_true(cf_lens_project(&l, cf_vec_along(r.from, -1, r.along), &x, &y) < 0);
}

static void a_box_that_is_looked_around_is_all_in_the_picture(void **state) {
  const double low[3] = {-1, 2, 0}, high[3] = {4, 3, 2};
  (void)state;
  for (double turn = 0; turn < 360; turn += 35)
    for (double rise = -90; rise <= 90; rise += 30) {
      const cf_camera c = cf_camera_around(low, high, turn, rise, 25, 1.5);
      cf_lens l;
      double most = 0;
      OK(cf_lens_grind(&l, &c, 300, 200));
      for (int n = 0; n < 8; ++n) {
        const double at[3] = {n & 1 ? 4 : -1, n & 2 ? 3 : 2, n & 4 ? 2 : 0};
        float x, y;
        assert_true(cf_lens_project(&l, cf_vec_of(at), &x, &y) > 0);
        most = fmax(most, fmax(fabs((double)x / 300 - 0.5), fabs((double)y / 200 - 0.5)));
      }
      assert_true(most < 0.5 && most > 0.3);
    }
}

/* Whether a line from inside of the lens meets the box: slabs. */
static bool meets(const cf_ray *r, const cf_vec low, const cf_vec high) {
  const float from[3] = {r->from.x, r->from.y, r->from.z}, along[3] = {r->along.x, r->along.y, r->along.z};
  const float l[3] = {low.x, low.y, low.z}, h[3] = {high.x, high.y, high.z};
  float near = 0, far = INFINITY;
  for (int a = 0; a < 3; ++a) {
    const float p = (l[a] - from[a]) / along[a], q = (h[a] - from[a]) / along[a];
    near = fmaxf(near, fminf(p, q)), far = fminf(far, fmaxf(p, q));
  }
  return near <= far;
}

static float chance(uint64_t *n, const float low, const float high) {
  return low + (high - low) * (float)cf_random(5, 6, 7, (*n)++);
}

/* Boxes, tiles and lenses by chance: where no ray should reach none does, and that is said of most that are far off. */
static void parts_of_a_picture_that_a_box_cannot_reach_are_known(void **state) {
  (void)state;
  uint64_t n = 0;
  int spared = 0, missed = 0;
  for (int i = 0; i < 2000; ++i) {
    const cf_camera c = {.eye = {0, -2, 0.3},
                         .aim = {chance(&n, -1, 1), 0, chance(&n, -1, 1)},
                         .angle = chance(&n, 10, 90),
                         .focus = chance(&n, 0.1f, 3),
                         .aperture = i % 3 ? chance(&n, 0, 0.1f) : 0};
    const float x = chance(&n, 0, 90), y = chance(&n, 0, 70), pixels[4] = {x, y, x + 10, y + 10};
    const cf_vec low = {chance(&n, -2, 2), chance(&n, -3, 2), chance(&n, -2, 2)};
    const cf_vec high = {low.x + chance(&n, 0, 1), low.y + chance(&n, 0, 1), low.z + chance(&n, 0, 1)};
    cf_lens l;
    bool met = false;
    OK(cf_lens_grind(&l, &c, 100, 80));
    for (int k = 0; k < 200; ++k) {
      const float at[2] = {chance(&n, 0, 1), chance(&n, 0, 1)};
      float disc[2];
      cf_sample_disc(at, disc);
      const cf_ray r = cf_lens_ray(&l, chance(&n, x, x + 10), chance(&n, y, y + 10), disc);
      met = met || meets(&r, low, high);
    }
    const bool reaches = cf_lens_reaches(&l, pixels, low, high);
    assert_true(reaches || !met);
    missed += met ? 0 : 1, spared += reaches ? 0 : 1;
  }
  assert_true(spared > 0.8 * missed);
}

/* --- film --------------------------------------------------------------------------------------------------------------------- */

static void the_tone_curve_rises_from_black_to_white(void **state) {
  const cf_develop how[] = {
      {.contrast = 1}, {.contrast = 1.2, .white = 4}, {.contrast = 1.5, .white = 1}, {.white = 8}};
  (void)state;
  for (size_t n = 0; n < sizeof how / sizeof *how; ++n) {
    const double white = how[n].white > 0 ? how[n].white : 1;
    double before = 0;
    CLOSE(cf_film_tone(&how[n], 0), 0, 0);
    CLOSE(cf_film_tone(&how[n], white), 1, 1e-12);
    CLOSE(cf_film_tone(&how[n], 0.18), 0.18, 1e-12);
    for (double x = 1e-3; x < 2 * white; x *= 1.1) {
      const double y = cf_film_tone(&how[n], x);
      assert_true(y > before);
      before = y;
    }
  }
}

static void grey_is_developed_to_its_code(void **state) {
  const cf_develop straight = {.plain = true}, brighter = {.plain = true, .exposure = 1};
  cf_canvas c;
  cf_film f;
  (void)state;
  OK(cf_film_create(&f, 4, 2));
  for (int p = 0; p < 8; ++p) f.light[p] = (cf_vec){0.2158605f, 0.2158605f, 0.2158605f};
  OK(cf_film_develop(&f, &straight, &c));
  assert_int_equal(c.rgb[0], 128); /* sRGB 128 */
  cf_canvas_destroy(&c);
  OK(cf_film_develop(&f, &brighter, &c));
  assert_int_equal(c.rgb[5], (int)floor(255 * (double)cf_colour_encoded(2 * 0.2158605f) + 0.5));
  cf_canvas_destroy(&c);
  cf_film_destroy(&f);
}

/* Dither makes of a level between two codes both, in the right proportion. */
static void dither_keeps_the_mean(void **state) {
  const cf_develop how = {.contrast = 1};
  const float level = cf_colour_linear(100.3f / 255);
  cf_canvas c;
  cf_film f;
  double sum = 0;
  (void)state;
  OK(cf_film_create(&f, 128, 128));
  for (int p = 0; p < 128 * 128; ++p) f.light[p] = (cf_vec){level, level, level};
  OK(cf_film_develop(&f, &how, &c));
  for (int p = 0; p < 128 * 128; ++p) {
    assert_in_range(c.rgb[3 * p], 100, 101);
    sum += c.rgb[3 * p];
  }
  CLOSE(sum / (128 * 128), 100.3, 0.02);
  cf_canvas_destroy(&c);
  cf_film_destroy(&f);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(the_circle_of_confusion_has_its_size),
      cmocka_unit_test(what_is_projected_is_where_its_ray_goes),
      cmocka_unit_test(a_box_that_is_looked_around_is_all_in_the_picture),
      cmocka_unit_test(the_tone_curve_rises_from_black_to_white),
      cmocka_unit_test(grey_is_developed_to_its_code),
      cmocka_unit_test(dither_keeps_the_mean),
      cmocka_unit_test(parts_of_a_picture_that_a_box_cannot_reach_are_known),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
