/* SPDX-License-Identifier: MIT
 *
 * Model snowfall: its mass is all accounted for, it lands as often as it falls, and neither the number of threads nor
 * a stop changes a bit.
 */
/* also in single precision */
#include <math.h>
#include <string.h>

#include "base/mem.h"
#include "io/image.h"
#include "model/atlas.h"
#include "scene_run.h"

static const char *const atlas_text =
    "{\"cattaneo_atlas\": 1, \"flakes\": [\n"
    "{\"name\": \"star\", \"rgba\": \"a.png\", \"height\": \"b.png\", \"normal\": \"c.png\", \"pixels\": "
    "[64, 64],\n"
    " \"metres_per_pixel\": 1e-4, \"center\": [31.5, 31.5], \"radius\": 2e-3, \"area\": 4e-6,\n"
    " \"mean_thickness\": 4e-5, \"height_scale\": 5e-5, \"mass\": 1.5e-7, \"symmetry\": 6},\n"
    "{\"name\": \"plate\", \"rgba\": \"a.png\", \"height\": \"b.png\", \"normal\": \"c.png\", \"pixels\": "
    "[64, 64],\n"
    " \"metres_per_pixel\": 1e-4, \"center\": [31.5, 31.5], \"radius\": 1e-3, \"area\": 2e-6,\n"
    " \"mean_thickness\": 4e-5, \"height_scale\": 5e-5, \"mass\": 7e-8}]}\n";

/* Both flakes are rings of ice between 10 and 20 pixels about the middle, and a dot at the right. */
static void write_atlas(const char *folder) {
  static uint8_t rgb[64][64][3];
  char path[1200];
  for (int j = 0; j < 64; ++j)
    for (int i = 0; i < 64; ++i) {
      const double r = hypot(i - 31.5, j - 31.5);
      const bool ice = (r > 10 && r < 20) || (i == 62 && j == 10);
      for (int c = 0; c < 3; ++c) rgb[j][i][c] = ice ? 200 : 0;
    }
  file_write(folder, "atlas.json", atlas_text);
  snprintf(path, sizeof path, "%s/b.png", folder);
  OK(cf_image_write(path, 64, 64, &rgb[0][0][0], 0, NULL));
}

static void open_snow(scene_run *r, const char *name, const char *more, const int threads) {
  char text[2048];
  snprintf(text, sizeof text,
           "cattaneo: 1\nmodel: snowfall\ndomain: {size: [1, 1, 1], cells: [16, 16, 16]}\n"
           "time: {end: 1}\nsnowfall:\n  atlas: atlas.json\n  stands_for: 50\n%s",
           more);
  const char *path = scene_path(name, text), *slash = strrchr(path, '/');
  char folder[1024];
  snprintf(folder, sizeof folder, "%.*s", (int)(slash - path), path);
  write_atlas(folder);
  OK(cf_scene_read(&r->scene, path, 0, NULL));
  OK(cf_sim_create(&r->sim, r->scene, threads));
}

static const char *const gusty = "  flakes: 400\n  wind: [0.5, 0.2, 0]\n  gust_strength: 0.4\n  slope: 500\n";

static const cf_particles *set_of(const scene_run *r, const char *name) {
  const cf_entry *e = cf_registry_find(&r->sim->registry, name);
  assert_non_null(e);
  return e->particles;
}

static void all_snow_is_accounted_for(void **state) {
  (void)state;
  scene_run r;
  open_snow(&r, "snow_mass", gusty, 2);
  OK(cf_sim_run(r.sim, INFINITY, NULL, NULL));
  assert_true(scene_metric(&r, "in_air") == 400);
  assert_true(scene_metric(&r, "landed") > 100);
  BELOW(fabs(scene_metric(&r, "error_snow")), sizeof(cf_real) == 4 ? 1e-5 : 1e-13);
  /* everything stays inside, sideways, and above what lies there */
  const cf_particles *f = set_of(&r, "flakes");
  for (int64_t i = 0; i < f->count; ++i)
    for (int a = 0; a < 2; ++a) assert_true(f->attribute[0].at[a][i] >= 0 && f->attribute[0].at[a][i] <= 1);
  scene_close(&r);
}

/* A box and a ball stand in the snow: the ground is their top, and no flake in the air is within them. */
static void snow_comes_to_lie_on_obstacles(void **state) {
  (void)state;
  scene_run r;
  open_snow(&r, "snow_obstacles",
            "  flakes: 400\n  wind: [0.3, 0, 0]\nobstacles:\n"
            "  - {shape: box, center: [0.5, 0.5, 0.2], half: [0.2, 0.2, 0.2]}\n"
            "  - {shape: ball, center: [0.85, 0.15, 0], radius: 0.14}\n",
            2);
  const cf_particles *ground = set_of(&r, "ground");
  const cf_particles *flakes = set_of(&r, "flakes");
  OK(cf_sim_run(r.sim, INFINITY, NULL, NULL));
  int high = 0;
  for (int64_t c = 0; c < ground->count; ++c) {
    const double x = (double)ground->attribute[0].at[0][c], y = (double)ground->attribute[0].at[1][c];
    const double base = (double)ground->attribute[1].at[0][c], away = hypot(x - 0.85, y - 0.15);
    const bool on_box = fabs(x - 0.5) < 0.2 && fabs(y - 0.5) < 0.2;
    const double top = on_box ? 0.4 : away < 0.14 ? sqrt(0.14 * 0.14 - away * away) : 0;
    BELOW(fabs(base - top), 1e-5);
    high += on_box;
  }
  assert_true(high > 30);
  for (int64_t i = 0; i < flakes->count; ++i) {
    double in = 1;
    for (int a = 0; a < 3; ++a)
      in = fmin(in, 0.2 - fabs((double)flakes->attribute[0].at[a][i] - (a == 2 ? 0.2 : 0.5)));
    assert_true(in < 0);
  }
  assert_true(scene_metric(&r, "landed") > 50);
  BELOW(fabs(scene_metric(&r, "error_snow")), sizeof(cf_real) == 4 ? 1e-5 : 1e-13);
  scene_close(&r);
}

/* The resolved scene is put elsewhere, and still finds it. */
static void the_atlas_is_beside_the_scene_wherever_that_is_written_to(void **state) {
  (void)state;
  scene_run r;
  cf_scene *again;
  char *text;
  open_snow(&r, "snow_path", gusty, 1);
  assert_true(r.scene->snowfall.atlas[0] == '/');
  OK(cf_scene_write(r.scene, &text));
  OK(cf_scene_read(&again, scene_path("snow_elsewhere", text), 0, NULL));
  assert_string_equal(again->snowfall.atlas, r.scene->snowfall.atlas);
  cf_free(text);
  cf_scene_destroy(again);
  scene_close(&r);
}

/* Without wind every flake falls at its own terminal speed, so that N v/H of them land in a second. */
static void as_many_land_as_fall(void **state) {
  (void)state;
  scene_run r;
  open_snow(&r, "snow_rate", "  flakes: 1500\n  flutter: 0\n  imperfection: 0\n  radius: [2e-3, 2e-3]\n", 2);
  OK(cf_sim_run(r.sim, INFINITY, NULL, NULL));
  const double v = scene_metric(&r, "mean_speed");
  assert_true(v > 0.2 && v < 1.2);
  CLOSE(scene_metric(&r, "landed"), 1500 * v, 4 * sqrt(1500 * v) + 0.03 * 1500 * v);
  scene_close(&r);
}

static void expect_same(const scene_run *a, const scene_run *b, const char *name) {
  const cf_particles *p = set_of(a, name), *q = set_of(b, name);
  assert_true(p->count == q->count && p->attributes == q->attributes);
  assert_memory_equal(p->id, q->id, (size_t)p->count * sizeof *p->id);
  for (int n = 0; n < p->attributes; ++n)
    for (int c = 0; c < p->attribute[n].components; ++c)
      assert_memory_equal(p->attribute[n].at[c], q->attribute[n].at[c], (size_t)p->count * sizeof(cf_real));
}

static void threads_do_not_change_a_bit(void **state) {
  (void)state;
  scene_run one, three;
  open_snow(&one, "snow_one", gusty, 1);
  open_snow(&three, "snow_three", gusty, 3);
  OK(cf_sim_run(one.sim, 0.6, NULL, NULL));
  OK(cf_sim_run(three.sim, 0.6, NULL, NULL));
  expect_same(&one, &three, "flakes");
  expect_same(&one, &three, "settled");
  expect_same(&one, &three, "ground");
  scene_close(&one);
  scene_close(&three);
}

static void saved_and_loaded_it_goes_on_to_the_same_bits(void **state) {
  (void)state;
  scene_run whole, again;
  char path[1200];
  open_snow(&whole, "snow_whole", gusty, 2);
  snprintf(path, sizeof path, "%s/half.h5", cf_scene_folder(whole.scene));
  while (cf_sim_step_count(whole.sim) < 40) OK(cf_sim_step(whole.sim, NULL));
  OK(cf_sim_save(whole.sim, path));
  while (cf_sim_step_count(whole.sim) < 80) OK(cf_sim_step(whole.sim, NULL));
  OK(cf_sim_create(&again.sim, whole.scene, 1));
  OK(cf_sim_load(again.sim, path));
  while (cf_sim_step_count(again.sim) < 80) OK(cf_sim_step(again.sim, NULL));
  expect_same(&whole, &again, "flakes");
  expect_same(&whole, &again, "settled");
  expect_same(&whole, &again, "ground");
  cf_sim_destroy(again.sim);
  scene_close(&whole);
}

/* A ring of even thickness: inertia (r1^2 + r2^2)/2; the dot pulls the middle of the silhouette towards itself. */
static void an_atlas_is_measured_from_its_pictures(void **state) {
  (void)state;
  const char *folder = folder_fresh("atlas_ring");
  char path[1200];
  cf_atlas *atlas;
  cf_atlas_shape shape;
  write_atlas(folder);
  snprintf(path, sizeof path, "%s/atlas.json", folder);
  OK(cf_atlas_read(&atlas, path));
  OK(cf_atlas_measure(atlas, 0, &shape)); /* radius 2e-3 is 20 pixels, D 40 */
  CLOSE(shape.inertia, (100 + 400) / 2.0 / 1600, 0.006);
  assert_true(shape.offset[0] > 0 && shape.offset[1] > 0 && shape.offset[0] < 0.002);
  snprintf(path, sizeof path, "%s/b.png", folder);
  remove(path);
  assert_int_equal(cf_atlas_measure(atlas, 0, &shape), CF_BAD_FILE);
  uint8_t black[3 * 16] = {0};
  OK(cf_image_write(path, 4, 4, black, 0, NULL));
  assert_int_equal(cf_atlas_measure(atlas, 0, &shape), CF_BAD_FILE);
  assert_non_null(strstr(cf_status_sentence(), "the atlas says 64 x 64"));
  cf_atlas_destroy(atlas);
}

static void bad_scenes_say_what_is_wrong(void **state) {
  (void)state;
  static const char *const cases[][2] = {
      {"cattaneo: 1\nmodel: snowfall\ndomain: {size: [1, 1], cells: [8, 8]}\ntime: {end: 1}\nsnowfall: "
       "{atlas: a}\n",
       "snow falls in three dimensions"},
      {"cattaneo: 1\nmodel: snowfall\ndomain: {size: [1, 1, 1], cells: [8, 8, 8]}\ntime: {end: 1}\n",
       "snowfall.atlas is missing"},
      {"cattaneo: 1\nmodel: snowfall\ndomain: {size: [1, 1, 1], cells: [8, 8, 8]}\ntime: {end: 1}\n"
       "snowfall: {atlas: a, radius: [2e-3, 1e-3]}\n",
       "the first must not be above the second"},
      {"cattaneo: 1\nmodel: snowfall\ndomain: {size: [1, 1, 1], cells: [8, 8, 8]}\ntime: {end: 1}\n"
       "snowfall: {atlas: a}\nvelocity: [0, 0, 0]\n",
       "velocity is not a key of `model: snowfall`"}};
  for (size_t i = 0; i < sizeof cases / sizeof *cases; ++i) {
    cf_scene *scene;
    assert_int_equal(cf_scene_read(&scene, scene_path("snow_bad", cases[i][0]), 0, NULL), CF_BAD_SCENE);
    if (strstr(cf_status_sentence(), cases[i][1]) == NULL)
      fail_msg("\"%s\" does not say: %s", cf_status_sentence(), cases[i][1]);
  }
}

static void an_atlas_without_a_mass_is_told_with_its_place(void **state) {
  (void)state;
  cf_atlas *atlas;
  const char *folder = folder_fresh("atlas_bad");
  char path[1200];
  snprintf(path, sizeof path, "%s/atlas.json", folder);
  file_write(folder, "atlas.json", "{\"cattaneo_atlas\": 1, \"flakes\": [{\"name\": \"a\"}]}");
  assert_int_equal(cf_atlas_read(&atlas, path), CF_BAD_SCENE);
  assert_non_null(strstr(cf_status_sentence(), "atlas.json:1"));
  file_write(folder, "atlas.json", "{\"cattaneo_atlas\": 1, \"flakes\": []}");
  assert_int_equal(cf_atlas_read(&atlas, path), CF_BAD_SCENE);
  assert_non_null(strstr(cf_status_sentence(), "without a flake"));
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(all_snow_is_accounted_for),
      cmocka_unit_test(snow_comes_to_lie_on_obstacles),
      cmocka_unit_test(the_atlas_is_beside_the_scene_wherever_that_is_written_to),
      cmocka_unit_test(as_many_land_as_fall),
      cmocka_unit_test(threads_do_not_change_a_bit),
      cmocka_unit_test(saved_and_loaded_it_goes_on_to_the_same_bits),
      cmocka_unit_test(an_atlas_is_measured_from_its_pictures),
      cmocka_unit_test(bad_scenes_say_what_is_wrong),
      cmocka_unit_test(an_atlas_without_a_mass_is_told_with_its_place)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
