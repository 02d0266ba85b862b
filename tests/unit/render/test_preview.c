/* SPDX-License-Identifier: MIT
 *
 * also in single precision
 */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <string.h>

#include <cmocka.h>

#include "base/mem.h"
#include "grid/field.h"
#include "render/plane.h"

typedef struct one_field {
  cf_grid grid;
  cf_cell f;
} one_field;

static one_field make(const int dim, const int nx, const int ny, const int nz) {
  one_field o;
  const int n[3] = {nx, ny, nz};
  assert_int_equal(cf_grid_init(&o.grid, dim, n, 0.5, NULL), CF_OK);
  assert_int_equal(cf_cell_create(&o.f, &o.grid.box), CF_OK);
  return o;
}

static void drop(one_field *o) { cf_cell_destroy(&o->f, &o->grid.box); }

static void fill(const one_field *o, double (*value)(int i, int j, int k)) {
  const cf_box *b = &o->grid.box;
  for (int k = 0; k < b->n[2]; ++k)
    for (int j = 0; j < b->n[1]; ++j)
      for (int i = 0; i < b->n[0]; ++i) o->f.at[cf_box_at(b, i, j, k)] = (cf_real)value(i, j, k);
}

static cf_scale scale_of(const one_field *o, const cf_preview *p) {
  const cf_grid *g = &o->grid;
  const cf_real *f = o->f.at;
  cf_scale s;
  assert_int_equal(cf_preview_scale(&s, 1, &g, &f, p), CF_OK);
  return s;
}

static double ramp(const int i, const int j, const int k) { return 1 + i + 0.01 * j + k; }
static double high_ramp(const int i, const int j, const int k) { return 1000 + ramp(i, j, k); }
static double both_signs(const int i, const int j, const int k) { return ramp(i, j, k) - 12; }
static double negative(const int i, const int j, const int k) { return -ramp(i, j, k); }
static double constant(const int i, const int j, const int k) { return 3 + 0 * (i + j + k); }
static double nothing(const int i, const int j, const int k) { return 0 * (i + j + k); }
static double slight_undershoot(const int i, const int j, const int k) { return ramp(i, j, k) - 1.5; }
static double one_hot(const int i, const int j, const int k) {
  return i == 7 && j == 9 ? 1e6 : ramp(i, j, k);
}
static double one_alone(const int i, const int j, const int k) { return i == 7 && j == 9 ? 1e6 : 0 * k; }
static double no_number(const int i, const int j, const int k) { return (double)NAN + i + j + k; }
static double some_missing(const int i, const int j, const int k) {
  return i == 3 ? (double)NAN : ramp(i, j, k);
}

static void range_follows_the_rule(void **state) {
  const struct {
    double (*value)(int, int, int);
    double low, high;
    cf_colormap map;
  } rule[] = {{ramp, 0, 20.2, CF_COLORMAP_ember},
              {high_ramp, 1001, 1020.2, CF_COLORMAP_ember},
              {both_signs, -11, 11, CF_COLORMAP_balance},
              {negative, -20.2, 0, CF_COLORMAP_ember},
              {constant, 0, 3, CF_COLORMAP_ember},
              {nothing, 0, 1, CF_COLORMAP_ember},
              {slight_undershoot, 0, 18.7, CF_COLORMAP_ember},
              {one_hot, 0, 20.2, CF_COLORMAP_ember},
              {one_alone, 0, 1e6, CF_COLORMAP_ember},
              {no_number, 0, 1, CF_COLORMAP_ember},
              {some_missing, 0, 20.2, CF_COLORMAP_ember}};
  const cf_preview p = cf_preview_default("phi", "");
  one_field o = make(2, 20, 20, 1);
  (void)state;
  for (size_t i = 0; i < sizeof rule / sizeof rule[0]; ++i) {
    fill(&o, rule[i].value);
    const cf_scale s = scale_of(&o, &p);
    assert_true(fabs(s.low - rule[i].low) < 0.15);
    assert_true(fabs(s.high - rule[i].high) < 0.15);
    assert_int_equal(s.map, rule[i].map);
  }
  drop(&o);
}

static void a_few_hot_cells_do_not_set_the_range(void **state) {
  const cf_preview p = cf_preview_default("phi", "");
  one_field o = make(2, 100, 100, 1);
  (void)state;
  fill(&o, ramp);
  for (int i = 0; i < 20; ++i) o.f.at[i] = 500;
  const cf_scale s = scale_of(&o, &p);
  assert_true(s.high < 110 && s.above && !s.below);
  drop(&o);
}

static void given_range_and_map_are_kept(void **state) {
  one_field o = make(2, 20, 20, 1);
  cf_preview p = cf_preview_default("phi", "");
  (void)state;
  fill(&o, ramp);
  p.low = 2, p.high = 5, p.map = "ice";
  const cf_scale s = scale_of(&o, &p);
  assert_true(s.low == 2 && s.high == 5 && s.map == CF_COLORMAP_ice && s.below && s.above);
  p.map = "rainbow";
  cf_canvas c;
  assert_int_equal(cf_preview_draw(&c, &o.grid, o.f.at, &p), CF_BAD_ARGUMENT);
  assert_null(c.rgb);
  drop(&o);
}

static void slices_and_means_of_three_dimensions(void **state) {
  one_field o = make(3, 4, 6, 8);
  cf_preview p = cf_preview_default("phi", "");
  cf_plane plane;
  (void)state;
  fill(&o, ramp);
  assert_int_equal(cf_plane_create(&plane, &o.grid, o.f.at, &p), CF_OK);
  assert_true(plane.n[0] == 4 && plane.n[1] == 6 && plane.along == 2 && plane.middle == 2);
  assert_true(fabs(plane.at[2 * 4 + 1] - (ramp(1, 2, 3) + ramp(1, 2, 4)) / 2) < 1e-5);
  cf_plane_destroy(&plane);
  p.axis = 0, p.view = CF_VIEW_MEAN;
  assert_int_equal(cf_plane_create(&plane, &o.grid, o.f.at, &p), CF_OK);
  assert_true(plane.n[0] == 6 && plane.n[1] == 8 && plane.axis[0] == 1 && plane.axis[1] == 2);
  assert_true(fabs(plane.at[3 * 6 + 2] - (ramp(1, 2, 3) + ramp(2, 2, 3)) / 2) < 1e-5);
  cf_plane_destroy(&plane);
  drop(&o);
}

/* A slice between a cell of a body, which holds 0, and one beside it that holds 5. */
static void a_slice_takes_nothing_from_bodies(void **state) {
  (void)state;
  one_field o = make(3, 4, 4, 4), body = make(3, 4, 4, 4);
  const cf_box *b = &o.grid.box;
  for (int k = 0; k < 4; ++k)
    for (int j = 0; j < 4; ++j)
      for (int i = 0; i < 4; ++i) {
        body.f.at[cf_box_at(b, i, j, k)] = (cf_real)(k == 2 && i > 1 ? 0.9 : 0);
        o.f.at[cf_box_at(b, i, j, k)] = (cf_real)(k == 2 && i > 1 ? 0 : 5);
      }
  cf_preview p = cf_preview_default("T", "");
  cf_plane plane;
  p.solid = body.f.at;
  assert_int_equal(cf_plane_create(&plane, &o.grid, o.f.at, &p), CF_OK);
  for (int i = 0; i < 16; ++i) assert_true(plane.at[i] == 5);
  cf_plane_destroy(&plane);
  drop(&o);
  drop(&body);
}

/* Cell (0, 0) is at the lower left. */
static void resampling_keeps_places_and_bounds(void **state) {
  const cf_preview p = cf_preview_default("phi", "");
  static double values[60 * 60];
  one_field o = make(2, 6, 6, 1);
  cf_plane plane;
  (void)state;
  fill(&o, nothing);
  o.f.at[cf_box_at(&o.grid.box, 1, 0, 0)] = 1;
  o.f.at[cf_box_at(&o.grid.box, 4, 3, 0)] = -1;
  assert_int_equal(cf_plane_create(&plane, &o.grid, o.f.at, &p), CF_OK);
  for (int cells = 0; cells < 2; ++cells) {
    double least = 1, largest = -1;
    assert_int_equal(cf_plane_resample(&plane, 60, 60, cells != 0, values), CF_OK);
    for (int i = 0; i < 3600; ++i) {
      least = fmin(least, values[i]);
      largest = fmax(largest, values[i]);
    }
    assert_true(least >= -1 && largest <= 1);
    assert_true(values[59 * 60 + 15] > 0.9 && values[(59 - 35) * 60 + 45] < -0.9);
    assert_true(fabs(values[59 * 60 + 35]) < 1e-12);
    if (cells)
      assert_true(values[59 * 60 + 10] == 1 && values[59 * 60 + 19] == 1 && values[59 * 60 + 20] == 0);
  }
  assert_int_equal(cf_plane_resample(&plane, 2, 3, false, values), CF_OK);
  assert_true(fabs(values[2 * 2] - 1.0 / 6) < 1e-12 && fabs(values[1 * 2 + 1] + 1.0 / 6) < 1e-12);
  cf_plane_destroy(&plane);
  drop(&o);
}

static void same_field_same_picture_and_sides_are_even(void **state) {
  one_field o = make(2, 33, 21, 1);
  cf_preview p = cf_preview_default("phi", "kg/m^3");
  cf_canvas a, b;
  (void)state;
  p.title = "A title", p.time = 0.5, p.size = 411;
  fill(&o, both_signs);
  assert_int_equal(cf_preview_draw(&a, &o.grid, o.f.at, &p), CF_OK);
  assert_int_equal(cf_preview_draw(&b, &o.grid, o.f.at, &p), CF_OK);
  assert_true(a.width % 2 == 0 && a.height % 2 == 0);
  assert_true(a.width >= 410 && a.width <= 412 && a.height < a.width);
  assert_memory_equal(a.rgb, b.rgb, (size_t)a.width * (size_t)a.height * 3);
  cf_canvas_destroy(&a);
  cf_canvas_destroy(&b);
  drop(&o);
}

static void a_line_is_drawn_where_it_belongs(void **state) {
  one_field o = make(2, 40, 40, 1); /* 20 m wide */
  cf_preview p = cf_preview_default("phi", "");
  const double diagonal[][2] = {{0, 0}, {20, 20}};
  const cf_polyline line = {.count = 2, .at = diagonal, .colour = {0, 255, 0}, .width = 3, .label = "x"};
  cf_canvas plain, drawn;
  int changed = 0, off = 0;
  (void)state;
  fill(&o, ramp);
  assert_int_equal(cf_preview_draw(&plain, &o.grid, o.f.at, &p), CF_OK);
  p.lines = 1, p.line = &line;
  assert_int_equal(cf_preview_draw(&drawn, &o.grid, o.f.at, &p), CF_OK);
  assert_true(plain.width == drawn.width && plain.height == drawn.height);
  double first_x = 0, first_y = 0;
  for (int y = 0; y < drawn.height; ++y)
    for (int x = 0; x < drawn.width; ++x) {
      const uint8_t *d = drawn.rgb + 3 * (y * drawn.width + x);
      if (d[0] != 0 || d[1] != 255 || d[2] != 0) continue;
      if (changed++ == 0) first_x = x, first_y = y;
      if (fabs((x - first_x) + (y - first_y)) > 6) ++off;
    }
  assert_true(changed > 1000);
  assert_true(off < 60); /* the label */
  cf_canvas_destroy(&plain);
  cf_canvas_destroy(&drawn);
  drop(&o);
}

static void odd_shapes_can_be_drawn(void **state) {
  static const int shapes[][4] = {{2, 1, 1, 1}, {2, 1, 500, 1}, {2, 3000, 2, 1},
                                  {3, 1, 1, 1}, {3, 2, 90, 3},  {2, 1500, 1500, 1}};
  (void)state;
  for (size_t i = 0; i < sizeof shapes / sizeof shapes[0]; ++i)
    for (int size = 1; size < 2000; size = size * 7 + 90) {
      one_field o = make(shapes[i][0], shapes[i][1], shapes[i][2], shapes[i][3]);
      cf_preview p = cf_preview_default("a_field_with_quite_a_long_name", "kg/m^3");
      cf_canvas c;
      p.title = "A title that is longer than many of these pictures are wide, so that it must be cut";
      p.size = size, p.time = 1e-30, p.cells = i % 2 == 0;
      fill(&o, i % 2 == 0 ? ramp : some_missing);
      assert_int_equal(cf_preview_draw(&c, &o.grid, o.f.at, &p), CF_OK);
      assert_true(c.width >= 60 && c.height >= 60 && c.width <= 3000 && c.height <= 3000);
      cf_canvas_destroy(&c);
      drop(&o);
    }
}

static void a_sheet_has_one_scale(void **state) {
  one_field small = make(2, 20, 30, 1), large = make(2, 20, 30, 1);
  const cf_grid *grids[2] = {&small.grid, &large.grid};
  const cf_real *fields[2] = {small.f.at, large.f.at};
  const cf_panel panels[3] = {{&small.grid, small.f.at, "small", 0, NULL},
                              {&large.grid, large.f.at, "large", 0, NULL},
                              {&large.grid, large.f.at, NULL, 0, NULL}};
  cf_preview p = cf_preview_default("phi", "");
  cf_scale s;
  cf_canvas c;
  (void)state;
  fill(&small, constant);
  fill(&large, ramp);
  assert_int_equal(cf_preview_scale(&s, 2, grids, fields, &p), CF_OK);
  assert_true(s.low == 0 && s.high > 19);
  for (int columns = 1; columns < 5; ++columns) {
    assert_int_equal(cf_sheet_draw(&c, 3, panels, columns, &p), CF_OK);
    assert_int_equal(c.width, 1200);
    cf_canvas_destroy(&c);
  }
  assert_int_equal(cf_sheet_draw(&c, 0, panels, 1, &p), CF_BAD_ARGUMENT);
  drop(&small);
  drop(&large);
}

static void pictures_are_put_side_by_side(void **state) {
  cf_canvas red, blue, c;
  const cf_canvas *pictures[3] = {&red, &blue, &red};
  const char *captions[3] = {"red", "blue", NULL};
  (void)state;
  assert_int_equal(cf_canvas_create(&red, 300, 200, (cf_colour){255, 0, 0}), CF_OK);
  assert_int_equal(cf_canvas_create(&blue, 300, 200, (cf_colour){0, 0, 255}), CF_OK);
  assert_int_equal(cf_sheet_pictures(&c, 3, pictures, captions, 2, 400), CF_OK);
  assert_true(c.width >= 398 && c.width <= 402);
  const uint8_t *left = c.rgb + 3 * (80 * c.width + 100), *right = c.rgb + 3 * (80 * c.width + 300);
  assert_true(left[0] == 255 && left[2] == 0 && right[0] == 0 && right[2] == 255);
  cf_canvas_destroy(&c);
  cf_canvas_destroy(&red);
  cf_canvas_destroy(&blue);
}

static void failing_memory_leaks_nothing(void **state) {
  const double ends[][2] = {{0, 0}, {20, 20}};
  const cf_polyline line = {.count = 2, .at = ends, .label = "line"};
  one_field o = make(2, 20, 20, 1);
  cf_preview p = cf_preview_default("phi", "");
  const cf_panel panel = {&o.grid, o.f.at, "one", 1, &line};
  (void)state;
  fill(&o, ramp);
  p.title = "title", p.lines = 1, p.line = &line, p.size = 200;
  for (int sheet = 0; sheet < 2; ++sheet) {
    cf_status s = CF_NO_MEMORY;
    for (long n = 1; s != CF_OK; ++n) {
      cf_canvas c;
      cf_mem_fail_at(n);
      s = sheet ? cf_sheet_draw(&c, 1, &panel, 1, &p) : cf_preview_draw(&c, &o.grid, o.f.at, &p);
      cf_mem_fail_at(0);
      assert_true(s == CF_OK || (s == CF_NO_MEMORY && c.rgb == NULL));
      cf_canvas_destroy(&c);
    }
  }
  drop(&o);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(range_follows_the_rule),
      cmocka_unit_test(a_few_hot_cells_do_not_set_the_range),
      cmocka_unit_test(given_range_and_map_are_kept),
      cmocka_unit_test(slices_and_means_of_three_dimensions),
      cmocka_unit_test(a_slice_takes_nothing_from_bodies),
      cmocka_unit_test(resampling_keeps_places_and_bounds),
      cmocka_unit_test(same_field_same_picture_and_sides_are_even),
      cmocka_unit_test(a_line_is_drawn_where_it_belongs),
      cmocka_unit_test(odd_shapes_can_be_drawn),
      cmocka_unit_test(a_sheet_has_one_scale),
      cmocka_unit_test(pictures_are_put_side_by_side),
      cmocka_unit_test(failing_memory_leaks_nothing),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
