/* SPDX-License-Identifier: MIT
 */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <string.h>

#include <cmocka.h>

#include "render/colormap.h"

#define STEPS 48

static double lightness(const cf_colormap map, const double s) {
  double lab[3];
  cf_colour_oklab(cf_colormap_at(map, s), lab);
  return lab[0];
}

/* The ends and the middle of oklab: white, black, grey, and a colour worked out by hand. */
static void oklab_of_known_colours(void **state) {
  double lab[3];
  (void)state;
  cf_colour_oklab((cf_colour){255, 255, 255}, lab);
  assert_true(fabs(lab[0] - 1) < 1e-6 && hypot(lab[1], lab[2]) < 1e-6);
  cf_colour_oklab((cf_colour){0, 0, 0}, lab);
  assert_true(fabs(lab[0]) < 1e-12);
  cf_colour_oklab((cf_colour){119, 119, 119}, lab);
  assert_true(fabs(lab[0] - 0.568) < 2e-3 && hypot(lab[1], lab[2]) < 1e-6);
  cf_colour_oklab((cf_colour){255, 0, 0}, lab);
  assert_true(fabs(lab[0] - 0.628) < 1e-3 && fabs(lab[1] - 0.225) < 1e-3 && fabs(lab[2] - 0.126) < 1e-3);
}

static void lightness_runs_evenly(void **state) {
  (void)state;
  for (int m = 0; m < CF_COLORMAP_COUNT; ++m) {
    const cf_colormap map = (cf_colormap)m;
    const double end = cf_colormap_is_signed(map) ? 0.5 : 1;
    const double rise = (lightness(map, end) - lightness(map, 0)) / STEPS;
    assert_true(fabs(rise) > 0.5 / STEPS);
    for (int i = 0; i < STEPS; ++i) {
      const double step = lightness(map, end * (i + 1) / STEPS) - lightness(map, end * i / STEPS);
      /* 8 bits a channel leave a few thousandths; darkest grey has the coarsest. */
      assert_true(fabs(step - rise) < 0.006 || (map == CF_COLORMAP_grey && i < 8));
      assert_true(step * rise > 0 || (map == CF_COLORMAP_grey && i < 3));
    }
  }
}

static void signed_maps_are_balanced(void **state) {
  (void)state;
  for (int m = 0; m < CF_COLORMAP_COUNT; ++m) {
    const cf_colormap map = (cf_colormap)m;
    if (!cf_colormap_is_signed(map)) continue;
    for (int i = 0; i <= STEPS; ++i)
      assert_true(fabs(lightness(map, 0.5 + 0.5 * i / STEPS) - lightness(map, 0.5 - 0.5 * i / STEPS)) <
                  0.006);
    double lab[3];
    cf_colour_oklab(cf_colormap_at(map, 0.5), lab);
    assert_true(hypot(lab[1], lab[2]) < 0.01);
  }
}

/* No step of a map looks much larger than another. */
static void steps_look_alike(void **state) {
  (void)state;
  for (int m = 0; m < CF_COLORMAP_COUNT; ++m) {
    double least = 1, largest = 0, a[3], b[3];
    for (int i = 0; i < STEPS; ++i) {
      cf_colour_oklab(cf_colormap_at((cf_colormap)m, (double)i / STEPS), a);
      cf_colour_oklab(cf_colormap_at((cf_colormap)m, (i + 1.0) / STEPS), b);
      const double step = sqrt(pow(a[0] - b[0], 2) + pow(a[1] - b[1], 2) + pow(a[2] - b[2], 2));
      least = fmin(least, step);
      largest = fmax(largest, step);
    }
    if (m != CF_COLORMAP_grey) assert_true(largest < 2 * least);
  }
}

static void values_outside_take_the_ends(void **state) {
  (void)state;
  const cf_colour low = cf_colormap_at(CF_COLORMAP_ember, 0), high = cf_colormap_at(CF_COLORMAP_ember, 1);
  cf_colour c = cf_colormap_at(CF_COLORMAP_ember, -5);
  assert_memory_equal(&c, &low, sizeof c);
  c = cf_colormap_at(CF_COLORMAP_ember, 5);
  assert_memory_equal(&c, &high, sizeof c);
  c = cf_colormap_at(CF_COLORMAP_ember, NAN);
  assert_memory_equal(&c, &low, sizeof c);
}

static void names_are_found(void **state) {
  cf_colormap map;
  (void)state;
  for (int m = 0; m < CF_COLORMAP_COUNT; ++m) {
    assert_int_equal(cf_colormap_find(cf_colormap_name((cf_colormap)m), &map), CF_OK);
    assert_int_equal(map, m);
  }
  assert_int_equal(cf_colormap_find("jet", &map), CF_BAD_ARGUMENT);
  assert_non_null(strstr(cf_status_sentence(), "\"jet\"; there are: ember ice"));
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(oklab_of_known_colours),       cmocka_unit_test(lightness_runs_evenly),
      cmocka_unit_test(signed_maps_are_balanced),     cmocka_unit_test(steps_look_alike),
      cmocka_unit_test(values_outside_take_the_ends), cmocka_unit_test(names_are_found),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
