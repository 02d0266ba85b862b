/* SPDX-License-Identifier: MIT
 *
 * The list of state: what is added is found, names are unique and fit, and the list grows.
 */
#include "grid/registry.h"

#include <string.h>

#include "base/mem.h"
#include "testing.h"

static void every_kind_is_found_by_name(void **state) {
  (void)state;
  cf_grid g;
  OK(cf_grid_init(&g, 3, (int[3]){4, 4, 4}, 1, NULL));
  cf_registry r;
  OK(cf_registry_init(&r, &g));
  cf_real cells = 0;
  double number[3];
  int64_t counter = 0;
  OK(cf_registry_add_cell(&r, "density", "1", (cf_cell){&cells}));
  OK(cf_registry_add_face(&r, "flux", "m/s", (cf_face){{&cells, &cells, &cells}}));
  OK(cf_registry_add_numbers(&r, "ledger", "", number, 3));
  OK(cf_registry_add_counter(&r, "steps", &counter));
  cf_particles *ink;
  OK(cf_particles_create(&ink, "ink", 3, 10));
  OK(cf_registry_add_particles(&r, ink));
  assert_int_equal(r.count, 5);
  assert_int_equal(cf_registry_find(&r, "density")->kind, CF_KIND_CELL);
  assert_int_equal(cf_registry_find(&r, "flux")->components, 3);
  assert_string_equal(cf_registry_find(&r, "flux")->unit, "m/s");
  assert_ptr_equal(cf_registry_find(&r, "ledger")->number, number);
  assert_ptr_equal(cf_registry_find(&r, "steps")->counter, &counter);
  assert_ptr_equal(cf_registry_find(&r, "ink")->particles, ink);
  assert_null(cf_registry_find(&r, "dens"));
  assert_null(cf_registry_find(&r, ""));
  cf_particles_destroy(ink);
  cf_registry_clear(&r);
  assert_int_equal(r.count, 0);
  cf_registry_clear(&r);
}

static void names_are_unique_and_of_fair_length(void **state) {
  (void)state;
  cf_grid g;
  OK(cf_grid_init(&g, 2, (int[3]){4, 4, 1}, 1, NULL));
  cf_registry r;
  OK(cf_registry_init(&r, &g));
  double x;
  OK(cf_registry_add_numbers(&r, "time", "s", &x, 1));
  assert_int_equal(cf_registry_add_numbers(&r, "time", "s", &x, 1), CF_BAD_ARGUMENT);
  assert_non_null(strstr(cf_status_sentence(), "\"time\""));
  assert_int_equal(cf_registry_add_cell(&r, "time", "s", (cf_cell){NULL}), CF_BAD_ARGUMENT);
  assert_int_equal(cf_registry_add_numbers(&r, "", "s", &x, 1), CF_BAD_ARGUMENT);
  char name[CF_NAME_MAX + 1];
  memset(name, 'n', CF_NAME_MAX);
  name[CF_NAME_MAX] = '\0';
  assert_int_equal(cf_registry_add_numbers(&r, name, "s", &x, 1), CF_BAD_ARGUMENT);
  name[CF_NAME_MAX - 1] = '\0';
  OK(cf_registry_add_numbers(&r, name, "s", &x, 1));
  assert_non_null(cf_registry_find(&r, name));
  assert_int_equal(r.count, 2);
  cf_registry_clear(&r);
}

static void the_list_grows_and_survives_a_refusal(void **state) {
  (void)state;
  cf_grid g;
  OK(cf_grid_init(&g, 2, (int[3]){4, 4, 1}, 1, NULL));
  cf_registry r;
  cf_mem_fail_at(1);
  assert_int_equal(cf_registry_init(&r, &g), CF_NO_MEMORY);
  cf_mem_fail_at(0);
  cf_registry_clear(&r);
  OK(cf_registry_init(&r, &g));
  static double x[200];
  char name[16];
  for (int i = 0; i < 200; ++i) {
    snprintf(name, sizeof name, "n%d", i);
    if (r.count == r.room) {
      cf_mem_fail_at(1);
      assert_int_equal(cf_registry_add_numbers(&r, name, "", &x[i], 1), CF_NO_MEMORY);
      cf_mem_fail_at(0);
      assert_int_equal(r.count, i);
    }
    OK(cf_registry_add_numbers(&r, name, "", &x[i], 1));
  }
  for (int i = 0; i < 200; ++i) {
    snprintf(name, sizeof name, "n%d", i);
    assert_ptr_equal(cf_registry_find(&r, name)->number, &x[i]);
  }
  cf_registry_clear(&r);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(every_kind_is_found_by_name),
      cmocka_unit_test(names_are_unique_and_of_fair_length),
      cmocka_unit_test(the_list_grows_and_survives_a_refusal),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
/* also in single precision */
