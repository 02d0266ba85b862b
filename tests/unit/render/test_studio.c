/* SPDX-License-Identifier: MIT
 *
 * Light against closed forms: Beer and Lambert through a slab, single scattering, a ball's shading, haze; where sampling
 * ends; and the same bits for any number of threads.
 *
 * also in single precision
 */
#include "testing.h"

#include <math.h>
#include <string.h>

#include "base/mem.h"
#include "base/rng.h"
#include "render/rays.h"
#include "render/sample.h"
#include "render/studio.h"

/* A studio with a white backdrop and a camera that looks along y at the origin from `away`. */
static cf_studio plain(const int side, const double away) {
  return (cf_studio){.width = side,
                     .height = side,
                     .samples = 4,
                     .threads = 1,
                     .camera = {.eye = {0, -away, 0}, .angle = 20},
                     .backdrop = {.middle = {1, 1, 1}, .edge = {1, 1, 1}}};
}

static cf_medium slab(const double density, const int cells) {
  const int n[3] = {cells, cells, cells};
  cf_grid g;
  cf_cell f;
  cf_medium m;
  OK(cf_grid_init(&g, 3, n, 2.0 / cells, (const double[]){-1, -1, -1}));
  OK(cf_cell_create(&f, &g.box));
  for (int k = 0; k < cells; ++k)
    for (int j = 0; j < cells; ++j)
      for (int i = 0; i < cells; ++i) f.at[cf_box_at(&g.box, i, j, k)] = (cf_real)density;
  OK(cf_medium_create(&m, &g, f.at, 0, 1, cells < 16));
  cf_cell_destroy(&f, &g.box);
  return m;
}

static cf_vec middle_of(const cf_film *f) {
  return f->light[(size_t)(f->height / 2) * (size_t)f->width + (size_t)(f->width / 2)];
}

static void a_slab_lets_through_what_beer_and_lambert_say(void **state) {
  (void)state;
  for (int cells = 8; cells <= 24; cells += 16) {
    cf_medium m = slab(0.7, cells);
    m.absorb = (cf_vec){0.2f, 1.0f, 3.0f};
    cf_vec light = {0, 0, 0}, through = {1, 1, 1};
    const cf_ray across = {.from = {0.1f, -5, 0.05f}, .along = {0, 1, 0}};
    cf_medium_march(&m, &across, 0, INFINITY, 0.5f, &light, &through);
    CLOSE(through.x, exp(-0.2 * 0.7 * 2), 2e-5);
    CLOSE(through.y, exp(-1.0 * 0.7 * 2), 2e-5);
    CLOSE(through.z, exp(-3.0 * 0.7 * 2), 2e-5);
    /* Askew the way is longer; from inside it is shorter. */
    const cf_vec askew = cf_vec_unit((cf_vec){0.6f, 0.8f, 0});
    const cf_ray slanted = {.from = cf_vec_scale(-9, askew), .along = askew};
    through = (cf_vec){1, 1, 1};
    cf_medium_march(&m, &slanted, 0, INFINITY, 0.3f, &light, &through);
    CLOSE(through.y, exp(-0.7 * 2 / 0.8), 1e-4);
    const cf_ray inside = {.from = {0, 0.5f, 0}, .along = {0, 1, 0}};
    through = (cf_vec){1, 1, 1};
    cf_medium_march(&m, &inside, 0, INFINITY, 0.9f, &light, &through);
    CLOSE(through.y, exp(-0.7 * 0.5), 1e-4);
    cf_medium_destroy(&m);
  }
}

static void ink_in_a_picture_is_as_dark_as_its_depth(void **state) {
  cf_medium m = slab(1, 8);
  cf_studio s = plain(33, 12);
  cf_film f;
  (void)state;
  m.absorb = (cf_vec){0.1f, 0.4f, 1.2f};
  s.media = 1, s.medium[0] = &m;
  OK(cf_studio_expose(&s, &f));
  const cf_vec v = middle_of(&f);
  CLOSE(v.x, exp(-0.2), 3e-3);
  CLOSE(v.y, exp(-0.8), 3e-3);
  CLOSE(v.z, exp(-2.4), 3e-3);
  CLOSE(f.light[0].z, 1, 1e-6);
  cf_film_destroy(&f);
  cf_medium_destroy(&m);
}

/* Light along -z from above into a slab: the depth at height z is (1 - z) d, whatever the cells. */
static void light_in_a_slab_fades_with_its_depth(void **state) {
  cf_medium m = slab(0.5, 24);
  const cf_light sun[2] = {{.toward = {0, 0, 1}, .colour = {1, 1, 1}},
                           {.toward = cf_vec_unit((cf_vec){0.5f, 0, 1}), .colour = {1, 1, 1}}};
  (void)state;
  m.scatter = (cf_vec){1, 1, 1};
  OK(cf_medium_illuminate(&m, 2, sun, (cf_vec){0, 0, 0}, (cf_vec){0, -5, 0}, 2));
  for (double z = -0.9; z < 1; z += 0.3) {
    const cf_vec at = {0, 0, (float)z};
    CLOSE(cf_medium_shade(&m, 0, at).x, exp(-0.5 * (1 - z)), 2e-3);
    if (z > 0) CLOSE(cf_medium_shade(&m, 1, at).x, exp(-0.5 * (1 - z) * sqrt(1.25)), 2e-2);
  }
  CLOSE(cf_medium_shade(&m, 0, (cf_vec){0, 0, 5}).x, 1, 0);
  cf_medium_destroy(&m);
}

/* A thin medium: what it sends is scatter d E/4 times the way, for one order without forward scattering and two more. */
static void thin_smoke_scatters_in_proportion(void **state) {
  const cf_light sun = {.toward = {0, 0, 1}, .colour = {1, 1, 1}};
  const cf_ray across = {.from = {0, -5, 0}, .along = {0, 1, 0}};
  double sent[2];
  (void)state;
  for (int n = 0; n < 2; ++n) {
    cf_medium m = slab(n == 0 ? 1e-3 : 2e-3, 24);
    cf_vec light = {0, 0, 0}, through = {1, 1, 1};
    m.scatter = (cf_vec){1, 1, 1};
    OK(cf_medium_illuminate(&m, 1, &sun, (cf_vec){0, 0, 0}, (cf_vec){0, -5, 0}, 1));
    cf_medium_march(&m, &across, 0, INFINITY, 0.5f, &light, &through);
    sent[n] = (double)light.x;
    cf_medium_destroy(&m);
  }
  const double orders = 1 + 0.45 + 0.45 * 0.45;
  CLOSE(sent[0], 0.25 * orders * 2e-3, 1e-5);
  CLOSE(sent[1] / sent[0], 2, 0.01);
}

/* --- surfaces ----------------------------------------------------------------------------------------------------------- */

static void a_balls_normal_is_its_radius(void **state) {
  const float at[1][4] = {{0.3f, -0.2f, 0.5f, 0.7f}};
  cf_rays *r;
  unsigned object;
  int met = 0;
  (void)state;
  OK(cf_rays_create(&r));
  OK(cf_rays_add_balls(r, 1, at, NULL, &object));
  OK(cf_rays_ready(r));
  for (int i = 0; i < 200; ++i) {
    const float pair[2] = {(float)cf_random(1, 0, (uint64_t)i, 0), (float)cf_random(1, 1, (uint64_t)i, 0)};
    const cf_vec middle = {0.3f, -0.2f, 0.5f}, way = cf_sample_cosine(pair, (cf_vec){0, 0, 1});
    const cf_ray ray = {cf_vec_along(middle, 3, way), cf_vec_unit(cf_vec_scale(-1, way)), 0};
    cf_hit hit;
    if (!cf_rays_hit(r, &ray, 0, INFINITY, &hit)) continue;
    ++met;
    CLOSE(hit.distance, 3 - 0.7, 1e-4);
    CLOSE(cf_vec_dot(cf_vec_unit(hit.normal), way), 1, 1e-5);
  }
  assert_int_equal(met, 200);
  cf_rays_destroy(r);
}

/* A matt floor of albedo a seen from above under a light at this angle sends a E cos(angle); so it does where the
 * normals of its corners say nonsense, that they look away from it. */
static void a_floor_is_lit_by_lamberts_cosine(void **state) {
  static const float away[4][3] = {{1, 0, -0.2f}, {1, 0, -0.2f}, {1, 0, -0.2f}, {1, 0, -0.2f}};
  const float at[4][3] = {{-9, -9, 0}, {9, -9, 0}, {9, 9, 0}, {-9, 9, 0}};
  const uint32_t corner[2][3] = {{0, 1, 2}, {0, 2, 3}};
  (void)state;
  for (double rise = 90; rise > 20; rise -= 30) {
    cf_studio s = plain(9, 1);
    cf_film f;
    s.camera = (cf_camera){.eye = {0, 0, 5}, .up = {0, 1, 0}, .angle = 10};
    s.lights = 1;
    s.light[0] = (cf_light){cf_light_toward(30, rise), {2, 2, 2}, 0};
    s.solids = 1;
    s.solid[0] = (cf_solid){
        .vertices = 4, .triangles = 2, .at = at, .corner = corner, .material = {.tint = {0.5f, 0.25f, 1}}};
    OK(cf_studio_expose(&s, &f));
    const double cosine = sin(rise * acos(-1.0) / 180);
    CLOSE(middle_of(&f).x, 0.5 * 2 * cosine, 1e-4);
    CLOSE(middle_of(&f).y, 0.25 * 2 * cosine, 1e-4);
    CLOSE(f.distance[40], 5, 1e-2);
    cf_film_destroy(&f);
    s.solid[0].normal = away;
    OK(cf_studio_expose(&s, &f));
    CLOSE(middle_of(&f).x, 0.5 * 2 * cosine, 1e-4);
    cf_film_destroy(&f);
  }
}

/* Under a white sky alone a floor of albedo 1 is as bright as the sky, and darker beside a wall that hands nothing on. */
static void a_crevice_sees_less_of_the_sky(void **state) {
  static const float at[8][3] = {{-90, -90, 0}, {90, -90, 0}, {90, 90, 0}, {-90, 90, 0},
                                 {0, -90, 0},   {0, 90, 0},   {0, 90, 90}, {0, -90, 90}};
  static const uint32_t corner[4][3] = {{0, 1, 2}, {0, 2, 3}, {4, 5, 6}, {4, 6, 7}};
  double seen[2];
  (void)state;
  for (int wall = 0; wall < 2; ++wall) {
    cf_studio s = plain(9, 1);
    cf_film f;
    s.samples = 256;
    s.camera = (cf_camera){.eye = {0.3, 0, 4}, .aim = {0.3, 0, 0}, .up = {0, 1, 0}, .angle = 1};
    s.sky = (cf_sky){{1, 1, 1}, {1, 1, 1}, {1, 1, 1}};
    s.solids = 1;
    s.solid[0] = (cf_solid){.vertices = 8,
                            .triangles = wall ? 4 : 2,
                            .at = at,
                            .corner = corner,
                            .material = {.tint = {1, 1, 1}}};
    OK(cf_studio_expose(&s, &f));
    seen[wall] = (double)middle_of(&f).x;
    cf_film_destroy(&f);
  }
  CLOSE(seen[0], 1, 1e-6);
  CLOSE(seen[1], 0.5, 0.02); /* an endless wall hides half of the cosine's sky */
}

static void haze_hides_what_is_far(void **state) {
  const float at[1][4] = {{0, 0, 0, 1}};
  cf_studio s = plain(9, 6);
  cf_film f;
  (void)state;
  s.balls = 1;
  s.ball[0] = (cf_balls){.count = 1, .at = at, .material = {.tint = {0, 0, 0}}};
  s.haze = (cf_haze){{0.1f, 0.2f, 0.4f}, {1, 1, 1}};
  OK(cf_studio_expose(&s, &f));
  CLOSE(middle_of(&f).x, 1 - exp(-0.1 * 5), 2e-3);
  CLOSE(middle_of(&f).z, 1 - exp(-0.4 * 5), 2e-3);
  cf_film_destroy(&f);
}

/* Glass of index 1 is not there, and a thick one of any index lets a straight ray through less two reflections. */
static void clear_bodies_reflect_what_fresnel_says(void **state) {
  const float at[1][4] = {{0, 0, 0, 1}};
  const double index[2] = {1, 1.5};
  (void)state;
  for (int n = 0; n < 2; ++n) {
    cf_studio s = plain(3, 60);
    cf_film f;
    s.samples = 4096;
    s.camera.angle = 0.05;
    s.sky = (cf_sky){{0, 0, 0}, {0, 0, 0}, {0, 0, 0}};
    s.balls = 1;
    s.ball[0] = (cf_balls){
        .count = 1, .at = at, .material = {.tint = {1, 1, 1}, .clear = 1, .index = (float)index[n]}};
    s.light[0] = (cf_light){{0, 1, 0}, {1, 1, 1}, 0.5f};
    s.lights = 1;
    OK(cf_studio_expose(&s, &f));
    const double r = pow((index[n] - 1) / (index[n] + 1), 2), strength = 1 / pow(sin(0.5), 2);
    CLOSE(middle_of(&f).x, strength * (1 - r) * (1 - r), 0.06);
    cf_film_destroy(&f);
  }
}

/* --- samples -------------------------------------------------------------------------------------------------------------------- */

/* 64 pairs of a pixel fall one into each cell of 8 x 8, of 64 x 1 and of 1 x 64, in every pair that is taken. */
static void samples_are_spread_evenly(void **state) {
  (void)state;
  for (uint64_t pixel = 0; pixel < 20; ++pixel)
    for (uint32_t pair = 0; pair < 4; ++pair) {
      int square[64] = {0}, column[64] = {0}, row[64] = {0};
      for (uint32_t i = 0; i < 64; ++i) {
        cf_dice d = {cf_random_mix(pixel), i, pair};
        float at[2];
        cf_dice_pair(&d, at);
        assert_true(at[0] >= 0 && at[0] < 1 && at[1] >= 0 && at[1] < 1);
        ++square[(int)(8 * at[0]) * 8 + (int)(8 * at[1])];
        ++column[(int)(64 * at[0])], ++row[(int)(64 * at[1])];
      }
      for (int n = 0; n < 64; ++n) {
        assert_int_equal(square[n], 1);
        assert_int_equal(column[n], 1);
        assert_int_equal(row[n], 1);
      }
    }
}

/* Light on the floor below a ball, rough and with soft shadows: noise in some places, none in others. */
static void take_noisy(const int samples, const float noise, cf_film *film) {
  const float ball[1][4] = {{0, 0, 0, 0.5f}};
  const float corners[4][3] = {{-3, -3, -0.6f}, {3, -3, -0.6f}, {3, 3, -0.6f}, {-3, 3, -0.6f}};
  const uint32_t triangles[2][3] = {{0, 1, 2}, {0, 2, 3}};
  const cf_material paper = {.tint = {0.5f, 0.5f, 0.5f}};
  cf_studio s = plain(48, 4);
  s.samples = samples, s.noise = noise;
  s.camera.eye[2] = 1.5;
  s.balls = 1, s.ball[0] = (cf_balls){.count = 1, .at = ball, .material = paper};
  s.solids = 1;
  s.solid[0] =
      (cf_solid){.vertices = 4, .at = corners, .triangles = 2, .corner = triangles, .material = paper};
  s.lights = 1, s.light[0] = (cf_light){cf_light_toward(40, 50), {1, 1, 1}, 0.5f};
  s.sky = (cf_sky){{0.5f, 0.5f, 0.5f}, {0.1f, 0.1f, 0.1f}, {0, 0, 0}};
  OK(cf_studio_expose(&s, film));
}

static double noise_of(const cf_film *film, const cf_film *exact) {
  double square = 0;
  const int pixels = film->width * film->height;
  for (int p = 0; p < pixels; ++p)
    square += pow(sqrt((double)film->light[p].x) - sqrt((double)exact->light[p].x), 2);
  return sqrt(square / pixels);
}

static void sampling_ends_where_the_noise_is_small(void **state) {
  cf_film exact, few, all, some, ended;
  (void)state;
  take_noisy(2048, 0, &exact);
  take_noisy(8, 0, &few), take_noisy(512, 1, &ended); /* it takes two looks to see noise: 4 samples and 8 */
  assert_memory_equal(few.light, ended.light, sizeof *few.light * 48 * 48);
  take_noisy(512, 0, &all), take_noisy(512, 0.01f, &some);
  const double worst = noise_of(&few, &exact), best = noise_of(&all, &exact), got = noise_of(&some, &exact);
  assert_true(best < 0.5 * got && got < 0.5 * worst);
  assert_true(got < 0.01);
  cf_film *const films[] = {&exact, &few, &all, &some, &ended};
  for (int i = 0; i < 5; ++i) cf_film_destroy(films[i]);
}

static void any_number_of_threads_takes_the_same_picture(void **state) {
  float at[40][4], moved[40][3];
  cf_film one, many;
  (void)state;
  for (int i = 0; i < 40; ++i)
    for (int a = 0; a < 4; ++a) {
      at[i][a] = a < 3 ? (float)cf_random(2, (uint64_t)a, (uint64_t)i, 0) - 0.5f : 0.1f;
      if (a < 3) moved[i][a] = 0.1f * (float)cf_random(3, (uint64_t)a, (uint64_t)i, 0);
    }
  cf_medium m = slab(0.2, 8);
  cf_studio s = plain(70, 4);
  m.absorb = (cf_vec){0.5f, 0.6f, 0.7f};
  s.camera.aperture = 0.1;
  s.samples = 32, s.noise = 0.02f;
  s.media = 1, s.medium[0] = &m;
  s.balls = 1;
  s.ball[0] = (cf_balls){.count = 40,
                         .at = (const float(*)[4])at,
                         .moved = (const float(*)[3])moved,
                         .material = {.tint = {0.8f, 0.7f, 0.6f},
                                      .gloss = 0.04f,
                                      .roughness = 0.3f,
                                      .through = 0.4f,
                                      .clear = 0.3f,
                                      .index = 1.3f}};
  s.lights = 1, s.light[0] = (cf_light){cf_light_toward(40, 50), {2, 2, 2}, 0.1f};
  s.sky = (cf_sky){{1, 1, 1}, {0.5f, 0.5f, 0.5f}, {0, 0, 0}};
  OK(cf_studio_expose(&s, &one));
  s.threads = 3;
  OK(cf_studio_expose(&s, &many));
  assert_memory_equal(one.light, many.light, 70 * 70 * sizeof *one.light);
  assert_memory_equal(one.distance, many.distance, 70 * 70 * sizeof *one.distance);
  cf_film_destroy(&many);
  cf_film_destroy(&one);
  cf_medium_destroy(&m);
}

/* --- what is wrong ---------------------------------------------------------------------------------------------------------------- */

static void wrong(const cf_studio *s, const char *word) {
  cf_film f;
  assert_int_equal(cf_studio_expose(s, &f), CF_BAD_ARGUMENT);
  if (strstr(cf_status_sentence(), word) == NULL)
    fail_msg("%s: says nothing of %s", cf_status_sentence(), word);
  assert_null(f.light);
}

static void what_cannot_be_taken_is_said(void **state) {
  const float at[3][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  const uint32_t corner[1][3] = {{0, 1, 3}};
  cf_studio s = plain(8, 1);
  (void)state;
  s.samples = 0, wrong(&s, "samples");
  s = plain(0, 1), wrong(&s, "pixels");
  s = plain(8, 0), wrong(&s, "stands");
  s = plain(8, 1), s.camera.up[1] = 1, wrong(&s, "up");
  s = plain(8, 1), s.camera.angle = 200, wrong(&s, "angle");
  s = plain(8, 1), s.camera.aperture = -1, wrong(&s, "aperture");
  s = plain(8, 1), s.solids = 1;
  s.solid[0] = (cf_solid){.vertices = 3, .triangles = 1, .at = at, .corner = corner};
  wrong(&s, "corner");
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(a_slab_lets_through_what_beer_and_lambert_say),
      cmocka_unit_test(ink_in_a_picture_is_as_dark_as_its_depth),
      cmocka_unit_test(light_in_a_slab_fades_with_its_depth),
      cmocka_unit_test(thin_smoke_scatters_in_proportion),
      cmocka_unit_test(a_balls_normal_is_its_radius),
      cmocka_unit_test(a_floor_is_lit_by_lamberts_cosine),
      cmocka_unit_test(a_crevice_sees_less_of_the_sky),
      cmocka_unit_test(haze_hides_what_is_far),
      cmocka_unit_test(clear_bodies_reflect_what_fresnel_says),
      cmocka_unit_test(samples_are_spread_evenly),
      cmocka_unit_test(sampling_ends_where_the_noise_is_small),
      cmocka_unit_test(any_number_of_threads_takes_the_same_picture),
      cmocka_unit_test(what_cannot_be_taken_is_said),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
