/* SPDX-License-Identifier: MIT
 *
 * Tables of parameters: from rows to structs, and what they answer.
 */
#include "base/param.h"

#include <math.h>
#include <string.h>

#include "testing.h"

#define LEG_TABLE(P, R) P(length, number, "1", "m", "(0, inf)", "How long a leg is")
#define TABLE_TABLE(P, R)                                         \
  P(name, key, CF_NONE, "", "", "Its name")                       \
  P(height, number, CF_REQUIRED, "m", "[0, 3]", "How high it is") \
  P(wood, word, "oak", "", "oak|beech|", "What it is made of")    \
  P(size, numbers, CF_NONE, "m", "2..3 of (-1, 5]", "Its sides")  \
  R(record, leg, leg, "The legs")                                 \
  R(list, drawers, leg, "The drawers")

typedef struct leg {
  CF_PARAM_MEMBERS(LEG_TABLE)
} leg;
typedef struct table {
  CF_PARAM_MEMBERS(TABLE_TABLE)
} table;

#define CF_PARAM_STRUCT leg
CF_PARAM_TABLE(leg, LEG_TABLE)
#undef CF_PARAM_STRUCT
#define CF_PARAM_STRUCT table
CF_PARAM_TABLE(table, TABLE_TABLE)
#undef CF_PARAM_STRUCT

static void param_row_knows_where_its_member_is(void **state) {
  (void)state;
  const cf_param *height = cf_param_find(&table_table, "height");
  assert_non_null(height);
  assert_int_equal(height->offset, offsetof(table, height));
  assert_int_equal(height->given, offsetof(table, given) + offsetof(__typeof__(((table *)0)->given), height));
  assert_true(height->fallback == CF_REQUIRED);
  assert_null(cf_param_default(height));
  assert_string_equal(cf_param_default(cf_param_find(&table_table, "wood")), "oak");
  assert_int_equal(table_table.size, sizeof(table));
  assert_int_equal(table_table.count, 6);
}

static void param_key_of_a_map_is_no_key(void **state) {
  (void)state;
  assert_null(cf_param_find(&table_table, "name"));
  assert_null(cf_param_find(&table_table, "heigh"));
}

static void param_list_is_read_and_written_through_items(void **state) {
  (void)state;
  leg legs[2];
  table t;
  memset(&t, 0, sizeof t);
  cf_param_items_set(&t.drawers, (cf_param_items){2, legs});
  assert_int_equal(t.drawers.count, 2);
  assert_ptr_equal(t.drawers.item, legs);
  assert_ptr_equal(cf_param_items_get(&t.drawers).item, legs);
}

static void param_path_finds_rows_of_records_and_lists(void **state) {
  (void)state;
  assert_string_equal(cf_param_find_path(&table_table, "leg.length")->name, "length");
  assert_string_equal(cf_param_find_path(&table_table, "drawers.3.length")->name, "length");
  assert_string_equal(cf_param_find_path(&table_table, "drawers.length")->name, "length");
  assert_string_equal(cf_param_find_path(&table_table, "drawers.3")->name, "drawers");
  assert_string_equal(cf_param_find_path(&table_table, "size.1")->name, "size");
  assert_null(cf_param_find_path(&table_table, "height.1"));
  assert_null(cf_param_find_path(&table_table, "leg.colour"));
  assert_null(cf_param_find_path(&table_table, ""));
}

static void param_distance_counts_slips_of_the_pen(void **state) {
  (void)state;
  assert_int_equal(cf_param_distance("height", "height"), 0);
  assert_int_equal(cf_param_distance("hieght", "height"), 1);
  assert_int_equal(cf_param_distance("heigt", "height"), 1);
  assert_int_equal(cf_param_distance("Height", "height"), 0);
  assert_int_equal(cf_param_distance("depth", "height"), -1);
  assert_int_equal(cf_param_distance("", "height"), -1);
  assert_true(cf_param_distance("diff", "diffusion") > 0);
  char longest[300];
  memset(longest, 'h', sizeof longest - 1);
  longest[sizeof longest - 1] = '\0';
  assert_int_equal(cf_param_distance(longest, "height"), -1);
}

static void param_nearest_finds_what_was_meant(void **state) {
  (void)state;
  char nearest[64];
  assert_string_equal(cf_param_nearest(&table_table, "hight"), "height");
  assert_null(cf_param_nearest(&table_table, "colour"));
  assert_true(cf_param_nearest_path(&table_table, "legg.lenght", nearest, sizeof nearest));
  assert_string_equal(nearest, "leg.length");
  assert_true(cf_param_nearest_path(&table_table, "drawers.2.lenght", nearest, sizeof nearest));
  assert_string_equal(nearest, "drawers.2.length");
  assert_true(cf_param_nearest_path(&table_table, "length", nearest, sizeof nearest));
  assert_string_equal(nearest, "leg.length");
  assert_false(cf_param_nearest_path(&table_table, "colour", nearest, sizeof nearest));
}

static void param_words_have_indices(void **state) {
  (void)state;
  const char *words = "oak|beech|";
  char word[16];
  assert_int_equal(cf_param_word_index(words, "oak", 3), 0);
  assert_int_equal(cf_param_word_index(words, "beech", 5), 1);
  assert_int_equal(cf_param_word_index(words, "bee", 3), -1);
  assert_int_equal(cf_param_word_index(words, "", 0), -1);
  assert_true(cf_param_word_at(words, 1, word, sizeof word));
  assert_string_equal(word, "beech");
  assert_false(cf_param_word_at(words, 2, word, sizeof word));
  assert_true(cf_param_word_nearest(words, "beach", word, sizeof word));
  assert_string_equal(word, "beech");
  assert_false(cf_param_word_nearest(words, "pine", word, sizeof word));
}

static void param_range_has_open_and_closed_ends(void **state) {
  (void)state;
  char sentence[80];
  const cf_param_range height = cf_param_range_of(cf_param_find(&table_table, "height"));
  assert_true(cf_param_range_has(&height, 0) && cf_param_range_has(&height, 3));
  assert_false(cf_param_range_has(&height, -1e-9) || cf_param_range_has(&height, 3.1));
  assert_false(cf_param_range_has(&height, (double)NAN));
  const cf_param_range size = cf_param_range_of(cf_param_find(&table_table, "size"));
  assert_int_equal(size.count_min, 2);
  assert_int_equal(size.count_max, 3);
  assert_false(cf_param_range_has(&size, -1));
  assert_true(cf_param_range_has(&size, 5));
  cf_param_range_sentence(&size, sentence, sizeof sentence);
  assert_string_equal(sentence, "> -1 and <= 5");
  const cf_param_range length = cf_param_range_of(cf_param_find(&leg_table, "length"));
  cf_param_range_sentence(&length, sentence, sizeof sentence);
  assert_string_equal(sentence, "> 0");
  const cf_param_range any = cf_param_range_of(cf_param_find(&table_table, "wood"));
  cf_param_range_sentence(&any, sentence, sizeof sentence);
  assert_string_equal(sentence, "");
  assert_true(cf_param_range_has(&any, -1e300));
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(param_row_knows_where_its_member_is),
      cmocka_unit_test(param_key_of_a_map_is_no_key),
      cmocka_unit_test(param_list_is_read_and_written_through_items),
      cmocka_unit_test(param_path_finds_rows_of_records_and_lists),
      cmocka_unit_test(param_distance_counts_slips_of_the_pen),
      cmocka_unit_test(param_nearest_finds_what_was_meant),
      cmocka_unit_test(param_words_have_indices),
      cmocka_unit_test(param_range_has_open_and_closed_ends),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
