/* SPDX-License-Identifier: MIT
 *
 * Pictures and arrays in place of expressions: a crystal grown with one is that grown with the other.
 */
#include "io/image.h"
#include "scene_run.h"

enum { CELLS = 64 };

static const char *const frame =
    "cattaneo: 1\nmodel: phase\n"
    "domain: {size: [2, 2], cells: [64, 64], origin: [-1, -1]}\n"
    "time: {end: 0.01}\n"
    "phase:\n  width: 0.012\n  tau_1: 3e-4\n"
    "  seeds: [{center: [0, 0], radius: 0.2}]\n%s";

/* The scene with these further keys of `phase`, grown; its eta is the caller's. */
static void grow(const char *name, const char *keys, cf_real *eta) {
  char text[1024];
  scene_run r;
  cf_view v;
  snprintf(text, sizeof text, frame, keys);
  scene_open(&r, name, text, 1);
  OK(cf_sim_run(r.sim, 0.01, NULL, NULL));
  OK(cf_sim_field(r.sim, "eta", 0, &v));
  for (int j = 0; j < CELLS; ++j)
    for (int i = 0; i < CELLS; ++i) eta[CELLS * j + i] = v.at[i * v.stride[0] + j * v.stride[1]];
  scene_close(&r);
}

static double unlike(const cf_real *a, const cf_real *b) {
  double most = 0;
  for (int i = 0; i < CELLS * CELLS; ++i) most = fmax(most, fabs((double)(a[i] - b[i])));
  return most;
}

/* White where `white` says so of a cell, x to the right and y upwards. */
static void write_picture(const char *folder, const char *name, bool (*white)(int i, int j)) {
  static uint8_t rgb[3 * CELLS * CELLS];
  char path[1024];
  snprintf(path, sizeof path, "%s/%s", folder, name);
  for (int j = 0; j < CELLS; ++j)
    for (int i = 0; i < CELLS; ++i) memset(rgb + 3 * (CELLS * (CELLS - 1 - j) + i), white(i, j) ? 255 : 0, 3);
  OK(cf_image_write(path, CELLS, CELLS, rgb, 0, NULL));
}

/* A plane of distances, y to the line at y = 0.25. */
static void write_distances(const char *folder, const char *name) {
  char path[1024];
  snprintf(path, sizeof path, "%s/%s", folder, name);
  FILE *f = fopen(path, "wb");
  assert_non_null(f);
  fwrite("\x93NUMPY\1\0\x76\0", 1, 10, f);
  fprintf(f, "%-117s\n", "{'descr': '<f4', 'fortran_order': False, 'shape': (64, 64), }");
  for (int j = 0; j < CELLS; ++j)
    for (int i = 0; i < CELLS; ++i) {
      const float d = -1.25f + 0.03125f * ((float)j + 0.5f);
      fwrite(&d, sizeof d, 1, f);
    }
  fclose(f);
}

static bool left_part(const int i, const int j) {
  (void)j;
  return i < 36;
}

static bool upper_half(const int i, const int j) {
  (void)i;
  return j >= CELLS / 2;
}

static void crystal_keeps_to_the_white_of_a_picture(void **state) {
  (void)state;
  static cf_real free[CELLS * CELLS], expression[CELLS * CELLS], map[CELLS * CELLS];
  char keys[1200];
  const char *folder = folder_fresh("maps_mask");
  write_picture(folder, "mask.png", left_part);
  snprintf(keys, sizeof keys, "  maps: {mask: {file: %s/mask.png}}\n", folder);
  grow("maps_free", "", free);
  grow("maps_expression", "  mask: \"x < 0.125 ? 1 : 0\"\n", expression);
  grow("maps_map", keys, map);
  assert_true(unlike(map, expression) == 0);
  assert_true(unlike(map, free) > 0.4);
}

static void crystal_keeps_to_the_inside_of_distances(void **state) {
  (void)state;
  static cf_real expression[CELLS * CELLS], map[CELLS * CELLS];
  char keys[1200];
  const char *folder = folder_fresh("maps_distance");
  write_distances(folder, "d.npy");
  snprintf(keys, sizeof keys, "  maps: {distance: {file: %s/d.npy}}\n", folder);
  grow("maps_expression", "  distance: \"y - 0.25\"\n", expression);
  grow("maps_map", keys, map);
  assert_true(unlike(map, expression) == 0);
}

static void axes_and_strengths_come_from_pictures(void **state) {
  (void)state;
  static cf_real plain[CELLS * CELLS], expression[CELLS * CELLS], map[CELLS * CELLS];
  char keys[2400];
  const char *folder = folder_fresh("maps_angle");
  write_picture(folder, "a.png", upper_half);
  snprintf(keys, sizeof keys,
           "  maps:\n    angle: {file: %s/a.png, range: [0, 30]}\n"
           "    strength: {file: %s/a.png, range: [0.01, 0.025]}\n",
           folder, folder);
  grow("maps_plain", "", plain);
  grow("maps_expression", "  anisotropy: {angle: \"y < 0 ? 0 : 30\", strength: \"y < 0 ? 0.01 : 0.025\"}\n",
       expression);
  grow("maps_map", keys, map);
  BELOW(unlike(map, expression), sizeof(cf_real) == 4 ? 1e-3 : 1e-7);
  assert_true(unlike(map, plain) > 1e-3);
}

static void what_is_wrong_with_a_map_is_told_at_its_key(void **state) {
  (void)state;
  static const struct {
    const char *keys, *sentence;
  } cases[] = {
      {"  maps: {mask: {file: none.png}}\n", "phase.maps.mask.file: "},
      {"  maps: {angle: {file: a.txt}}\n", "must be a picture (.png) or an array (.npy)"},
      {"  maps: {mask: {file: none.png}}\n  mask: 1\n", "phase.maps.mask: phase.mask says the same already"},
  };
  for (size_t i = 0; i < sizeof cases / sizeof *cases; ++i) {
    char text[1024];
    cf_scene *scene = NULL;
    snprintf(text, sizeof text, frame, cases[i].keys);
    assert_int_equal(cf_scene_read(&scene, scene_path("maps_wrong", text), 0, NULL), CF_BAD_SCENE);
    if (strstr(cf_status_sentence(), cases[i].sentence) == NULL) fail_msg("%s", cf_status_sentence());
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(crystal_keeps_to_the_white_of_a_picture),
      cmocka_unit_test(crystal_keeps_to_the_inside_of_distances),
      cmocka_unit_test(axes_and_strengths_come_from_pictures),
      cmocka_unit_test(what_is_wrong_with_a_map_is_told_at_its_key),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
