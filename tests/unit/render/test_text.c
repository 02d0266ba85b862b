/* SPDX-License-Identifier: MIT
 */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <string.h>

#include <cmocka.h>

#include "base/mem.h"
#include "render/alphabet.h"
#include "render/text.h"
#include "render/ticks.h"

static const cf_colour white = {255, 255, 255}, black = {0, 0, 0};

/* How much ink is in a box, in pixels of black. */
static double ink(const cf_canvas *c, const int x0, const int y0, const int x1, const int y1) {
  double sum = 0;
  for (int y = y0; y < y1; ++y)
    for (int x = x0; x < x1; ++x) sum += 1 - c->rgb[3 * (y * c->width + x)] / 255.0;
  return sum;
}

static double ink_of(const char *text) {
  cf_canvas c;
  const cf_lettering l = {.size = 20, .colour = {0, 0, 0}};
  assert_int_equal(cf_canvas_create(&c, 400, 60, white), CF_OK);
  assert_int_equal(cf_text_draw(&c, &l, 10, 40, text), CF_OK);
  const double sum = ink(&c, 0, 0, 400, 60);
  cf_canvas_destroy(&c);
  return sum;
}

static void every_printable_letter_has_a_glyph_of_its_own(void **state) {
  (void)state;
  for (uint32_t code = ' '; code < 127; ++code) {
    const cf_glyph *g = cf_alphabet_find(code);
    assert_true(g->code == code);
    assert_true((g->path[0] == '\0') == (code == ' '));
  }
  static const uint32_t greek[] = {0x3b1, 0x3b8, 0x3bb, 0x3c0, 0x3c3,  0x3c4,
                                   0x3c6, 0x3c9, 0x394, 0x3a9, 0x2207, 0xd7};
  for (size_t i = 0; i < sizeof greek / sizeof greek[0]; ++i)
    assert_true(cf_alphabet_find(greek[i])->code == greek[i]);
  assert_true(cf_alphabet_find(0x4e00)->code == 0xfffd);
}

static void letters_stay_between_foot_and_top(void **state) {
  cf_canvas c;
  const cf_lettering l = {.size = 14, .colour = {0, 0, 0}};
  (void)state;
  assert_int_equal(cf_canvas_create(&c, 900, 40, white), CF_OK);
  assert_int_equal(cf_text_draw(&c, &l, 10, 25, "ABCXYZ abcdefghijklmnopqrstuvwxyz 0123456789"), CF_OK);
  assert_true(ink(&c, 0, 0, 900, 40) > 400);
  assert_true(ink(&c, 0, 0, 900, 13) == 0);
  assert_true(ink(&c, 0, 30, 900, 40) == 0);
  assert_true(ink(&c, 0, 0, 8, 40) == 0);
  assert_true(ink(&c, 10 + (int)cf_text_width(14, "ABCXYZ abcdefghijklmnopqrstuvwxyz 0123456789") + 2, 0, 900,
                  40) == 0);
  cf_canvas_destroy(&c);
}

static void alignment_moves_the_text(void **state) {
  (void)state;
  for (int align = 0; align < 3; ++align) {
    cf_canvas c;
    const cf_lettering l = {.size = 14, .colour = {0, 0, 0}, .align = align / 2.0};
    assert_int_equal(cf_canvas_create(&c, 201, 40, white), CF_OK);
    assert_int_equal(cf_text_draw(&c, &l, 100, 25, "HHHH"), CF_OK);
    const double left = ink(&c, 0, 0, 100, 40), right = ink(&c, 100, 0, 201, 40);
    if (align == 0) assert_true(left < 1 && right > 50);
    if (align == 1) assert_true(fabs(left - right) < 0.35 * (left + right));
    if (align == 2) assert_true(left > 50 && right < 1);
    cf_canvas_destroy(&c);
  }
}

static void raised_and_lowered_letters_take_less_room(void **state) {
  (void)state;
  assert_true(cf_text_width(40, "m^2") < cf_text_width(40, "m2"));
  assert_true(fabs(cf_text_width(40, "m^2") - cf_text_width(40, "m\xc2\xb2")) < 1e-9);
  assert_true(cf_text_width(40, "H_c") < cf_text_width(40, "Hc"));
  /* names keep their underscore, a lone mark is itself */
  assert_true(cf_text_width(40, "my_run") > cf_text_width(40, "myrun") + 5);
  assert_true(cf_text_width(40, "a_b_c") > cf_text_width(40, "abc") + 10);
  assert_true(cf_text_width(40, "x_") > cf_text_width(40, "x") + 5);
  assert_true(cf_text_width(40, "x^") > cf_text_width(40, "x") + 5);
  assert_true(cf_text_width(40, "T_{max}") < cf_text_width(40, "Tmax"));
}

static void strange_bytes_do_no_harm(void **state) {
  static const char *const texts[] = {
      "\xff\xfe", "\xc3", "\xe2\x82", "\xf0\x9f\x98\x80", "^",       "_", "a^{", "a_{}",
      "a^{}b",    "a_{b", "^{}",      "\x01\x02",         "a_{\xc3", "",  "{}",  "^^^",
      "___",      "a^-",  "a^-}"};
  (void)state;
  for (size_t i = 0; i < sizeof texts / sizeof texts[0]; ++i) {
    const double width = cf_text_width(14, texts[i]);
    assert_true(width >= 0 && width < 200);
    assert_true(ink_of(texts[i]) >= 0);
  }
}

static void an_accent_adds_ink(void **state) {
  (void)state;
  assert_true(ink_of("\xc3\xa9") > ink_of("e") + 2);
  assert_true(ink_of("\xc3\x89") > ink_of("E") + 2);
  assert_true(fabs(cf_text_width(40, "\xc3\xa9") - cf_text_width(40, "e")) < 1e-9);
}

static void ticks_are_round_and_inside(void **state) {
  static const double ends[][2] = {{0, 1},           {-3.7, 12.1}, {1e-9, 7e-9}, {-2e7, 5e7},
                                   {299.95, 300.05}, {0, 0.3},     {-1, 0}};
  (void)state;
  for (size_t i = 0; i < sizeof ends / sizeof ends[0]; ++i)
    for (int wanted = 2; wanted < 12; ++wanted) {
      const double low = ends[i][0], high = ends[i][1];
      const cf_ticks t = cf_ticks_between(low, high, wanted);
      assert_true(t.count >= 1 && t.count <= wanted + 1);
      for (int n = 0; n < t.count; ++n) {
        assert_true(t.at[n] >= low - 1e-6 * (high - low) && t.at[n] <= high + 1e-6 * (high - low));
        if (n > 0) assert_string_not_equal(t.label[n], t.label[n - 1]);
      }
    }
  const cf_ticks t = cf_ticks_between(-2e-6, 2e-6, 5);
  assert_string_equal(t.factor,
                      "\xc3\x97"
                      "10^-6");
  assert_string_equal(t.label[0],
                      "\xe2\x88\x92"
                      "2");
  assert_string_equal(t.label[2], "0");
  assert_int_equal(cf_ticks_between(1, 1, 5).count, 0);
  assert_int_equal(cf_ticks_between(NAN, 1, 5).count, 0);
  assert_int_equal(cf_ticks_between(0, INFINITY, 5).count, 0);
}

static void crossing_strokes_are_not_darker(void **state) {
  cf_canvas c;
  const cf_pen pen = {.colour = {128, 128, 128}, .width = 3};
  const double cross[][2] = {{5, 5}, {35, 35}, {35, 5}, {5, 35}};
  (void)state;
  assert_int_equal(cf_canvas_create(&c, 40, 40, black), CF_OK);
  assert_int_equal(cf_canvas_stroke(&c, &pen, 4, cross), CF_OK);
  for (int i = 0; i < 40 * 40 * 3; ++i) assert_true(c.rgb[i] <= 128);
  assert_int_equal(c.rgb[3 * (20 * 40 + 20)], 128);
  cf_canvas_destroy(&c);
}

static void lines_far_outside_are_cut(void **state) {
  cf_canvas c;
  const cf_pen pen = {.colour = {0, 0, 0}, .width = 2, .dash = 6, .gap = 4, .clip = {10, 10, 20, 20}};
  const double line[][2] = {{-1e12, -1e12}, {1e12, 1e12}, {NAN, 3}, {5, 5}};
  (void)state;
  assert_int_equal(cf_canvas_create(&c, 40, 40, white), CF_OK);
  assert_int_equal(cf_canvas_stroke(&c, &pen, 4, line), CF_OK);
  assert_true(ink(&c, 10, 10, 30, 30) > 10);
  assert_true(ink(&c, 0, 0, 40, 10) == 0 && ink(&c, 0, 30, 40, 40) == 0);
  cf_canvas_destroy(&c);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(every_printable_letter_has_a_glyph_of_its_own),
      cmocka_unit_test(letters_stay_between_foot_and_top),
      cmocka_unit_test(alignment_moves_the_text),
      cmocka_unit_test(raised_and_lowered_letters_take_less_room),
      cmocka_unit_test(strange_bytes_do_no_harm),
      cmocka_unit_test(an_accent_adds_ink),
      cmocka_unit_test(ticks_are_round_and_inside),
      cmocka_unit_test(crossing_strokes_are_not_darker),
      cmocka_unit_test(lines_far_outside_are_cut),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
