/* SPDX-License-Identifier: MIT
 *
 * Flakes from runs that are made up: a disc of known size and weight, written as a run writes its last frame, comes back
 * from the atlas as it is.
 */
#define _GNU_SOURCE
#include <math.h>

#include "app/command.h"
#include "io/frame.h"
#include "io/image.h"
#include "model/atlas.h"
#include "output_case.h"

#define CELLS 96
#define H     0.05
#define R     1.6  /* of the disc, unitless as crystals are */
#define THICK 0.04 /* likewise */

typedef struct run {
  cf_path folder, atlas, index;
} run;

static run the_run;

/* How far a cell is inside of a disc whose centre is off the middle, as eta. */
static double disc(const int i, const int j) {
  const double r = hypot((i + 0.5) * H - 2.6, (j + 0.5) * H - 2.2);
  return 0.5 + 0.5 * tanh((R - r) / 0.04);
}

static double nothing(const int i, const int j) { return 0.0 * (i + j); }

static void write_scene(const char *model) {
  char text[300];
  cf_path path;
  const int length =
      snprintf(text, sizeof text,
               "cattaneo: 1\nmodel: %s\ndomain: {size: [4.8, 4.8], cells: [96, 96]}\ntime: {end: 0.4, dt: "
               "0.1, frames: 10}\n%s",
               model, strcmp(model, "phase") == 0 ? "phase: {thickening: 2e-3}\n" : "diffusion: {k: 1}\n");
  assert_int_equal(cf_path_make(&path, "%s/run.yaml", the_run.folder.text), CF_OK);
  assert_int_equal(cf_file_write(path.text, text, (size_t)length), CF_OK);
}

/* A frame of eta and of `name`, which is `value` where there is ice and `elsewhere` where there is none; a thickness ends
 * as smoothly as eta does. */
static void write_frame(const char *name, double (*shape)(int, int), const double value,
                        const double elsewhere) {
  const int cells[3] = {CELLS, CELLS, 1};
  const double origin[3] = {0, 0, 0};
  const cf_frame_plan plan = {.compression = 1};
  const cf_stamp stamp = {.title = "Disc", .scene = "", .time = 0.4, .step = 4};
  cf_grid g;
  cf_registry r;
  cf_cell eta, other;
  const bool smooth = strcmp(name, "thickness") == 0;
  assert_int_equal(cf_grid_init(&g, 2, cells, H, origin), CF_OK);
  assert_int_equal(cf_registry_init(&r, &g), CF_OK);
  assert_int_equal(cf_cell_create(&eta, &g.box), CF_OK);
  assert_int_equal(cf_cell_create(&other, &g.box), CF_OK);
  for (int j = 0; j < CELLS; ++j)
    for (int i = 0; i < CELLS; ++i) {
      const ptrdiff_t p = cf_box_at(&g.box, i, j, 0);
      eta.at[p] = (cf_real)shape(i, j);
      other.at[p] = (cf_real)(smooth ? value * shape(i, j) : shape(i, j) > 1e-3 ? value : elsewhere);
    }
  assert_int_equal(cf_registry_add_cell(&r, "eta", "", eta), CF_OK);
  assert_int_equal(cf_registry_add_cell(&r, name, "", other), CF_OK);
  assert_int_equal(cf_frame_write(the_run.folder.text, 4, &r, &plan, &stamp), CF_OK);
  cf_registry_clear(&r);
  cf_cell_destroy(&eta, &g.box);
  cf_cell_destroy(&other, &g.box);
}

static int setup(void **state) {
  char folder[] = "/tmp/cattaneo-test-XXXXXX";
  (void)state;
  assert_non_null(mkdtemp(folder));
  assert_int_equal(cf_path_make(&the_run.folder, "%s", folder), CF_OK);
  assert_int_equal(cf_path_make(&the_run.atlas, "%s-atlas", folder), CF_OK);
  assert_int_equal(cf_path_make(&the_run.index, "%s-atlas/atlas.json", folder), CF_OK);
  return 0;
}

static int teardown(void **state) {
  (void)state;
  folder_remove(the_run.folder.text);
  folder_remove(the_run.atlas.text);
  return 0;
}

static cf_status make(const bool force, const int runs) {
  char *folders[2] = {the_run.folder.text, the_run.folder.text};
  cf_arguments a = {.operands = runs,
                    .operand = folders,
                    .output = the_run.atlas.text,
                    .radius = 2e-3,
                    .pixels = 128,
                    .force = force};
  return cf_atlas_command(&a);
}

static void check_disc(const double thick, const double tolerance) {
  const double s = 2e-3 / R, area = acos(-1) * 2e-3 * 2e-3;
  cf_atlas *atlas;
  cf_atlas_shape shape;
  assert_int_equal(cf_atlas_read(&atlas, the_run.index.text), CF_OK);
  assert_int_equal(atlas->flakes.count, 1);
  const cf_atlas_flake *f = &atlas->flakes.item[0];
  assert_true(f->radius == 2e-3 && f->symmetry == 6 && f->pixels.value[0] == 128);
  assert_true(fabs(f->area / area - 1) < 0.01);
  assert_true(fabs(f->mean_thickness / (s * thick) - 1) < tolerance);
  assert_true(fabs(f->mass / (917 * area * s * thick) - 1) < tolerance);
  assert_true(fabs(f->height_scale / (s * thick / 2) - 1) < tolerance);
  assert_true(fabs(f->center.value[0] - 63.5) < 0.05 && fabs(f->center.value[1] - 63.5) < 0.05);
  assert_int_equal(cf_atlas_measure(atlas, 0, &shape), CF_OK);
  assert_true(fabs(shape.inertia - 0.125) < 0.01); /* of a disc: m R^2/2 */
  assert_true(hypot(shape.offset[0], shape.offset[1]) < 0.01);
  cf_atlas_destroy(atlas);
}

static void a_disc_weighs_what_it_weighs(void **state) {
  (void)state;
  write_scene("phase");
  write_frame("thickness", disc, THICK, 0);
  assert_int_equal(make(false, 1), CF_OK);
  assert_int_equal(files_in(the_run.atlas.text), 4);
  check_disc(THICK, 0.03);
}

static void without_its_thickness_it_is_what_the_time_since_it_froze_says(void **state) {
  const double thick = sqrt(2 * 2e-3 * (0.3 + 0.4 / 400));
  (void)state;
  write_scene("phase");
  write_frame("arrival", disc, 0.1, -1);
  assert_int_equal(make(false, 1), CF_OK);
  check_disc(thick, 0.03);
  write_frame("age", disc, 0.3, 0);
  assert_int_equal(make(true, 1), CF_OK);
  check_disc(thick, 0.03);
}

/* Of the middle, of the right and of the upper rim. */
static void normals_point_outwards(void **state) {
  const int at[3][2] = {{64, 64}, {64 + 61, 64}, {64, 64 - 61}};
  int width, height;
  uint8_t *rgb;
  cf_path path;
  cf_atlas *atlas;
  (void)state;
  write_scene("phase");
  write_frame("thickness", disc, 1, 0);
  assert_int_equal(make(false, 1), CF_OK);
  assert_int_equal(cf_atlas_read(&atlas, the_run.index.text), CF_OK);
  assert_int_equal(cf_path_make(&path, "%s/%s", the_run.atlas.text, atlas->flakes.item[0].normal), CF_OK);
  assert_int_equal(cf_image_read(path.text, &width, &height, &rgb), CF_OK);
  const uint8_t *n[3];
  for (int i = 0; i < 3; ++i) n[i] = rgb + 3 * (at[i][1] * width + at[i][0]);
  assert_in_range(n[0][0], 127, 128);
  assert_in_range(n[0][1], 127, 128);
  assert_int_equal(n[0][2], 255);
  assert_true(n[1][0] > 200 && n[1][1] < 140 && n[1][1] > 115);
  assert_true(n[2][1] > 200 && n[2][0] < 140 && n[2][0] > 115);
  cf_free(rgb);
  cf_atlas_destroy(atlas);
}

static void runs_of_one_name_become_flakes_of_two(void **state) {
  cf_atlas *atlas;
  (void)state;
  write_scene("phase");
  write_frame("thickness", disc, THICK, 0);
  assert_int_equal(make(false, 2), CF_OK);
  assert_int_equal(files_in(the_run.atlas.text), 7);
  assert_int_equal(cf_atlas_read(&atlas, the_run.index.text), CF_OK);
  assert_int_equal(atlas->flakes.count, 2);
  assert_string_not_equal(atlas->flakes.item[0].rgba, atlas->flakes.item[1].rgba);
  cf_atlas_destroy(atlas);
}

static void refuses(const char *says) {
  assert_int_equal(make(true, 1), CF_BAD_USAGE);
  assert_says(says);
  assert_int_not_equal(access(the_run.atlas.text, F_OK), 0);
}

static void what_is_no_flake_is_refused_and_nothing_written(void **state) {
  (void)state;
  refuses("there is no run in it");
  write_scene("tracer");
  refuses("is no run of model phase");
  write_scene("phase");
  refuses("has no frames");
  write_frame("thickness", nothing, 0, 0);
  refuses("there is no crystal in it");
  write_frame("thickness", disc, 0, 0);
  refuses("its crystal has no thickness");
  write_frame("T", disc, 0, 0);
  refuses("have neither thickness, arrival nor age");
}

static void an_atlas_that_is_there_is_kept_unless_forced(void **state) {
  (void)state;
  write_scene("phase");
  write_frame("thickness", disc, THICK, 0);
  assert_int_equal(make(false, 1), CF_OK);
  assert_int_equal(make(false, 1), CF_BAD_USAGE);
  assert_says("is there already: --force overwrites it");
  assert_int_equal(make(true, 1), CF_OK);
}

static void lengths_have_units(void **state) {
  double r;
  (void)state;
  assert_int_equal(cf_length_read("1.5 mm", &r), CF_OK);
  assert_true(fabs(r - 1.5e-3) < 1e-15);
  assert_int_equal(cf_length_read("2e-3", &r), CF_OK);
  assert_true(r == 2e-3);
  assert_int_equal(cf_length_read("-1 mm", &r), CF_BAD_USAGE);
  assert_int_equal(cf_length_read("2 s", &r), CF_BAD_USAGE);
  assert_int_equal(cf_length_read("", &r), CF_BAD_USAGE);
}

/* Every value, all channels: what is read as 8 bits is the upper half of what was written. */
static void deep_maps_read_back_as_numbers(void **state) {
  enum { SIDE = 16 };
  uint16_t values[SIDE * SIDE * 4];
  int width, height;
  uint8_t *back;
  cf_path path;
  (void)state;
  for (int i = 0; i < SIDE * SIDE * 4; ++i) values[i] = (uint16_t)(i % 4 == 3 ? 0xffff : 257 * (i / 4));
  assert_int_equal(cf_path_make(&path, "%s/deep.png", the_run.folder.text), CF_OK);
  assert_int_equal(cf_image_write_deep(path.text, SIDE, SIDE, 4, values), CF_OK);
  assert_int_equal(cf_image_read_cover(path.text, &width, &height, &back), CF_OK);
  assert_true(width == SIDE && height == SIDE);
  for (int i = 0; i < SIDE * SIDE * 4; ++i) assert_int_equal(back[i], values[i] / 257);
  cf_free(back);
  assert_int_equal(cf_image_write_deep(path.text, SIDE, SIDE, 2, values), CF_BAD_ARGUMENT);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test_setup_teardown(a_disc_weighs_what_it_weighs, setup, teardown),
      cmocka_unit_test_setup_teardown(without_its_thickness_it_is_what_the_time_since_it_froze_says, setup,
                                      teardown),
      cmocka_unit_test_setup_teardown(normals_point_outwards, setup, teardown),
      cmocka_unit_test_setup_teardown(runs_of_one_name_become_flakes_of_two, setup, teardown),
      cmocka_unit_test_setup_teardown(what_is_no_flake_is_refused_and_nothing_written, setup, teardown),
      cmocka_unit_test_setup_teardown(an_atlas_that_is_there_is_kept_unless_forced, setup, teardown),
      cmocka_unit_test_setup_teardown(lengths_have_units, setup, teardown),
      cmocka_unit_test_setup_teardown(deep_maps_read_back_as_numbers, setup, teardown),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
