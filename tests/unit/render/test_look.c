/* SPDX-License-Identifier: MIT
 *
 * Looks: every style makes a picture of an exhibit that has what it shows and says what is missing of one that has not;
 * ranges; what is turned upright is the same thing.
 *
 * also in single precision
 */
#include "testing.h"

#include <math.h>
#include <string.h>

#include "base/mem.h"
#include "grid/isosurface.h"
#include "render/graph.h"
#include "render/look.h"
#include "render/turn.h"

enum { CELLS = 20 };

typedef struct one_ball {
  cf_grid grid;
  cf_cell f;
} one_ball;

/* 1 in a ball off the middle, 0 outside. */
static one_ball make(const int dim) {
  const int n[3] = {CELLS, CELLS, dim == 3 ? CELLS + 4 : 1};
  one_ball b;
  OK(cf_grid_init(&b.grid, dim, n, 0.1, NULL));
  OK(cf_cell_create(&b.f, &b.grid.box));
  for (int k = 0; k < b.grid.box.n[2]; ++k)
    for (int j = 0; j < CELLS; ++j)
      for (int i = 0; i < CELLS; ++i) {
        const double z = dim == 3 ? k - 12 : 0;
        const double r = sqrt((i - 10) * (i - 10) + (j - 8) * (j - 8) + z * z);
        b.f.at[cf_box_at(&b.grid.box, i, j, k)] = (cf_real)(0.5 - 0.5 * tanh(r - 5));
      }
  return b;
}

static void drop(one_ball *b) { cf_cell_destroy(&b->f, &b->grid.box); }

static cf_exhibit exhibit_of(const one_ball *b) {
  return (cf_exhibit){.title = "a ball", .grid = &b->grid, .fields = 1, .field = {{"eta", "", b->f.at}}};
}

static cf_look small(const cf_style style) {
  cf_look l = cf_look_default(style);
  l.width = 96, l.height = 64, l.samples = 2;
  return l;
}

static double spread_of(const cf_canvas *c) {
  int low = 255, high = 0;
  for (int i = 0; i < 3 * c->width * c->height; ++i) {
    if (c->rgb[i] < low) low = c->rgb[i];
    if (c->rgb[i] > high) high = c->rgb[i];
  }
  return high - low;
}

static void every_style_of_a_field_makes_a_picture_whatever_the_threads(void **state) {
  static const cf_style styles[] = {CF_STYLE_INK,  CF_STYLE_SMOKE, CF_STYLE_CORAL,
                                    CF_STYLE_MESH, CF_STYLE_GEL,   CF_STYLE_CRYSTAL};
  (void)state;
  for (size_t n = 0; n < sizeof styles / sizeof *styles; ++n) {
    one_ball b = make(styles[n] == CF_STYLE_CRYSTAL ? 2 : 3);
    const cf_exhibit e = exhibit_of(&b);
    cf_look l = small(styles[n]);
    cf_canvas one, two;
    OK(cf_look_draw(&l, &e, &one));
    l.threads = 3;
    OK(cf_look_draw(&l, &e, &two));
    assert_int_equal(one.width, 96);
    assert_int_equal(one.height, 64);
    assert_true(spread_of(&one) > 60);
    assert_memory_equal(one.rgb, two.rgb, 3 * 96 * 64);
    cf_canvas_destroy(&two);
    cf_canvas_destroy(&one);
    drop(&b);
  }
}

/* More ink is darker, and the backdrop beside it stays. */
static void stronger_ink_is_darker(void **state) {
  one_ball b = make(3);
  const cf_exhibit e = exhibit_of(&b);
  int seen[2];
  (void)state;
  for (int n = 0; n < 2; ++n) {
    cf_look l = small(CF_STYLE_INK);
    cf_canvas c;
    l.strength = n == 0 ? 0.2 : 1;
    OK(cf_look_draw(&l, &e, &c));
    seen[n] = c.rgb[3 * (32 * 96 + 48)];
    assert_true(c.rgb[0] > 150);
    cf_canvas_destroy(&c);
  }
  assert_true(seen[1] + 20 < seen[0]);
  drop(&b);
}

static void particles_are_seen(void **state) {
  float place[50][3], value[50];
  cf_exhibit e = {.particles = 50, .place = (const float(*)[3])place, .value = value};
  const cf_look l = small(CF_STYLE_PARTICLES);
  double low = (double)INFINITY, high = -(double)INFINITY;
  cf_canvas c;
  (void)state;
  for (int i = 0; i < 50; ++i) {
    for (int a = 0; a < 3; ++a) place[i][a] = (float)((i * (7 + 3 * a)) % 11);
    value[i] = (float)i;
  }
  OK(cf_exhibit_range(&l, &e, &low, &high));
  CLOSE(low, 0, 0);
  CLOSE(high, 49, 0);
  OK(cf_look_draw(&l, &e, &c));
  assert_true(spread_of(&c) > 60);
  cf_canvas_destroy(&c);
}

static void what_is_missing_is_said(void **state) {
  one_ball flat = make(2);
  const cf_exhibit nothing = {.grid = &flat.grid}, plane = exhibit_of(&flat);
  cf_canvas c;
  (void)state;
  for (int style = 0; style < CF_STYLES; ++style) {
    const cf_look l = small((cf_style)style);
    assert_int_equal(cf_look_draw(&l, &nothing, &c), CF_BAD_ARGUMENT);
    assert_non_null(strstr(cf_status_sentence(), "shows"));
    assert_null(c.rgb);
  }
  const cf_look ink = small(CF_STYLE_INK);
  assert_int_equal(cf_look_draw(&ink, &plane, &c), CF_BAD_ARGUMENT);
  assert_non_null(strstr(cf_status_sentence(), "two dimensions"));
  cf_look tiny = small(CF_STYLE_FIELD);
  tiny.width = 3;
  assert_int_equal(cf_look_draw(&tiny, &plane, &c), CF_BAD_ARGUMENT);
  assert_int_equal(cf_style_find("ink"), CF_STYLE_INK);
  assert_int_equal(cf_style_find("inky"), CF_STYLES);
  drop(&flat);
}

/* A few hot cells do not set the range of ink. */
static void ink_is_measured_by_what_there_is_of_it(void **state) {
  one_ball b = make(3);
  const cf_exhibit e = exhibit_of(&b);
  const cf_look ink = small(CF_STYLE_INK), mesh = small(CF_STYLE_MESH);
  double low = (double)INFINITY, high = -(double)INFINITY;
  (void)state;
  b.f.at[cf_box_at(&b.grid.box, 10, 8, 12)] = 20;
  OK(cf_exhibit_range(&ink, &e, &low, &high));
  CLOSE(low, 0, 0);
  assert_true(high > 0.5 && high < 2);
  OK(cf_exhibit_range(&mesh, &e, &low, &high));
  CLOSE(high, 20, 0);
  drop(&b);
}

/* --- upright ---------------------------------------------------------------------------------------------------------- */

/* The surface of a turned field is the turned surface of the field. */
static void what_is_turned_is_the_same_thing(void **state) {
  one_ball b = make(3);
  const cf_isosurface rule = {.level = 0.5};
  (void)state;
  for (int up = 0; up < 3; ++up) {
    cf_grid turned;
    cf_cell f;
    cf_mesh *one, *other;
    cf_mesh_facts p, q;
    OK(cf_turn_grid(up, &b.grid, &turned));
    OK(cf_cell_create(&f, &turned.box));
    cf_turn_field(up, &b.grid, b.f.at, &turned, f.at);
    OK(cf_mesh_create(&one));
    OK(cf_mesh_create(&other));
    OK(cf_isosurface_make(one, &b.grid, b.f, &rule));
    OK(cf_isosurface_make(other, &turned, f, &rule));
    cf_turn_mesh(up, one);
    OK(cf_mesh_look(one, &p));
    OK(cf_mesh_look(other, &q));
    for (int a = 0; a < 3; ++a) CLOSE(p.low[a], q.low[a], 1e-5);
    CLOSE(p.volume, q.volume, 0.02 * q.volume);
    assert_true(p.volume > 0); /* still the right way out */
    const double size[3] = {2, 2, 2.4};
    double axis[3] = {1, 2, 3};
    cf_turn_vector(up, axis);
    CLOSE(axis[2], up + 1, 0);
    CLOSE(turned.h * turned.box.n[2], size[up], 1e-9);
    cf_mesh_destroy(other);
    cf_mesh_destroy(one);
    cf_cell_destroy(&f, &turned.box);
  }
  drop(&b);
}

/* --- curves and lines ------------------------------------------------------------------------------------------------- */

static void curves_are_drawn_and_gaps_left(void **state) {
  const double x[5] = {0, 1, 2, 3, 4}, y[5] = {0, 1, (double)NAN, 1, 0};
  const cf_curve curve[2] = {{5, x, y, {200, 0, 0}, "one"}, {0, NULL, NULL, {0, 0, 200}, "none"}};
  const cf_graph g = {.title = "two", .x_name = "t (s)", .curves = 2, .curve = curve, .now = 1};
  cf_canvas c;
  int red = 0;
  (void)state;
  OK(cf_graph_draw(&g, 300, 200, &c));
  for (int i = 0; i < 300 * 200; ++i) red += c.rgb[3 * i] > 150 && c.rgb[3 * i + 1] < 60;
  assert_true(red > 50);
  cf_canvas_destroy(&c);
  assert_int_equal(cf_graph_draw(&g, 30, 20, &c), CF_BAD_ARGUMENT);
}

/* Lines of equal value of a ramp lie where the value is. */
static void contours_lie_where_the_value_is(void **state) {
  one_ball b = make(2);
  cf_canvas with, without;
  (void)state;
  for (int j = 0; j < CELLS; ++j)
    for (int i = 0; i < CELLS; ++i) b.f.at[cf_box_at(&b.grid.box, i, j, 0)] = (cf_real)(i + 0.5);
  cf_preview p = cf_preview_default("phi", "");
  p.low = 0, p.high = CELLS;
  OK(cf_preview_draw(&without, &b.grid, b.f.at, &p));
  p.contours = 1;
  OK(cf_preview_draw(&with, &b.grid, b.f.at, &p));
  int changed = 0, least = with.width, most = 0;
  for (int i = 0; i < with.width * with.height; ++i) {
    if (memcmp(with.rgb + 3 * i, without.rgb + 3 * i, 3) == 0) continue;
    ++changed;
    if (i % with.width < least) least = i % with.width;
    if (i % with.width > most) most = i % with.width;
  }
  assert_true(changed > 200 && most - least <= 3);
  cf_canvas_destroy(&with);
  cf_canvas_destroy(&without);
  drop(&b);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(every_style_of_a_field_makes_a_picture_whatever_the_threads),
      cmocka_unit_test(stronger_ink_is_darker),
      cmocka_unit_test(particles_are_seen),
      cmocka_unit_test(what_is_missing_is_said),
      cmocka_unit_test(ink_is_measured_by_what_there_is_of_it),
      cmocka_unit_test(what_is_turned_is_the_same_thing),
      cmocka_unit_test(curves_are_drawn_and_gaps_left),
      cmocka_unit_test(contours_lie_where_the_value_is),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
