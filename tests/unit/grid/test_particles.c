/* SPDX-License-Identifier: MIT
 *
 * Sets of particles: growing, sorting, removing, whatever the number of threads.
 *
 * also in single precision
 */
#include "grid/particles.h"

#include <math.h>
#include <string.h>

#include "base/mem.h"
#include "base/rng.h"
#include "testing.h"

#define MANY 30000 /* enough for more than one thread */

/* Position and three more attributes that are functions of the id. */
static cf_particles *make(const int64_t n) {
  cf_particles *s;
  int64_t first;
  OK(cf_particles_create(&s, "gel", 3, 4));
  OK(cf_particles_attribute(s, "F", "", 9, CF_CARRIED, NULL));
  OK(cf_particles_attribute(s, "S", "", 1, CF_CARRIED, NULL));
  OK(cf_particles_attribute(s, "stress", "Pa", 1, CF_DERIVED, NULL));
  OK(cf_particles_append(s, n, &first));
  assert_int_equal(first, 0);
  for (int a = 0; a < 3; ++a)
    for (int c = 0; c < s->attribute[a].components; ++c)
      for (int64_t i = 0; i < n; ++i) s->attribute[a].at[c][i] = (cf_real)(i + 100000 * a + 1000000 * c);
  return s;
}

/* Everything a particle has is still its own. */
static void belongs_together(const cf_particles *s) {
  for (int a = 0; a < 3; ++a)
    for (int c = 0; c < s->attribute[a].components; ++c)
      for (int64_t i = 0; i < s->count; ++i)
        assert_true(s->attribute[a].at[c][i] == (cf_real)(s->id[i] + 100000 * a + 1000000 * c));
}

static void sorting_is_stable_and_carries_everything(void **state) {
  (void)state;
  static const uint32_t most[] = {1, 5, 2000, 3000000, 4000000000u};
  for (size_t m = 0; m < sizeof most / sizeof *most; ++m) {
    int64_t *expected = NULL;
    for (int threads = 1; threads <= 3; ++threads) {
      cf_particles *s = make(MANY);
      for (int64_t i = 0; i < MANY; ++i)
        s->key[i] = (uint32_t)((double)most[m] * cf_random(7, (uint64_t)i, 0, 0));
      uint32_t *key_of;
      OK(CF_NEW(&key_of, MANY));
      memcpy(key_of, s->key, MANY * sizeof *key_of);
      cf_particles_sort(s, threads);
      belongs_together(s);
      for (int64_t i = 0; i < MANY; ++i) {
        assert_int_equal(s->key[i], key_of[s->id[i]]);
        if (i == 0) continue;
        assert_true(s->key[i - 1] < s->key[i] || (s->key[i - 1] == s->key[i] && s->id[i - 1] < s->id[i]));
      }
      if (expected == NULL) {
        OK(CF_NEW(&expected, MANY));
        memcpy(expected, s->id, MANY * sizeof *expected);
      }
      assert_memory_equal(expected, s->id, MANY * sizeof *expected);
      cf_free(key_of);
      cf_particles_destroy(s);
    }
    cf_free(expected);
  }
}

static void removed_ones_are_gone_and_ids_are_not_used_again(void **state) {
  (void)state;
  cf_particles *s = make(1000);
  int64_t first;
  for (int64_t i = 0; i < s->count; ++i) s->key[i] = i % 3 == 0;
  cf_particles_remove(s, 2);
  assert_int_equal(s->count, 666);
  belongs_together(s);
  for (int64_t i = 0; i < s->count; ++i) assert_true(s->id[i] % 3 != 0 && s->key[i] == 0);
  OK(cf_particles_append(s, 2000, &first));
  assert_int_equal(first, 666);
  assert_int_equal(s->id[first], 1000);
  assert_int_equal(s->next_id, 3000);
  assert_true(s->attribute[2].at[0][first] == 0);
  s->count = 666;
  belongs_together(s);
  cf_particles_destroy(s);
}

static void what_is_not_finite_is_found(void **state) {
  (void)state;
  for (int threads = 1; threads <= 3; threads += 2) {
    cf_particles *s = make(MANY);
    cf_particles_place where;
    assert_true(cf_particles_finite(s, threads, &where));
    s->attribute[3].at[0][5] = (cf_real)NAN; /* derived: nobody's business */
    assert_true(cf_particles_finite(s, threads, &where));
    s->attribute[2].at[0][3] = (cf_real)NAN;
    s->attribute[1].at[8][MANY - 1] = (cf_real)INFINITY;
    s->attribute[1].at[8][MANY - 7] = -(cf_real)INFINITY;
    assert_false(cf_particles_finite(s, threads, &where));
    assert_int_equal(where.attribute, 1);
    assert_int_equal(where.component, 8);
    assert_int_equal(where.index, MANY - 7);
    cf_particles_destroy(s);
  }
}

static void failing_memory_changes_nothing(void **state) {
  (void)state;
  cf_particles *s = make(100);
  cf_status status = CF_NO_MEMORY;
  for (long n = 1; status != CF_OK; ++n) {
    cf_mem_fail_at(n);
    status = cf_particles_append(s, 5000, NULL);
    cf_mem_fail_at(0);
    if (status == CF_OK) break;
    assert_int_equal(status, CF_NO_MEMORY);
    assert_int_equal(s->count, 100);
    belongs_together(s);
  }
  cf_particles_destroy(s);
  status = CF_NO_MEMORY;
  for (long n = 1; status != CF_OK; ++n) {
    cf_mem_fail_at(n);
    status = cf_particles_create(&s, "gel", 2, 10);
    cf_mem_fail_at(0);
    if (status != CF_OK) assert_null(s);
  }
  cf_particles_destroy(s);
}

static void mistakes_are_said(void **state) {
  (void)state;
  cf_particles *s;
  assert_int_equal(cf_particles_create(&s, "a.b", 3, 1), CF_BAD_ARGUMENT);
  assert_int_equal(cf_particles_create(&s, "gel", 4, 1), CF_BAD_ARGUMENT);
  assert_int_equal(cf_particles_create(&s, "gel", 3, (int64_t)1 << 40), CF_OVER_LIMIT);
  OK(cf_particles_create(&s, "gel", 3, 0));
  assert_int_equal(cf_particles_attribute(s, "position", "m", 3, CF_CARRIED, NULL), CF_BAD_ARGUMENT);
  assert_int_equal(cf_particles_attribute(s, "id", "m", 3, CF_CARRIED, NULL), CF_BAD_ARGUMENT);
  assert_int_equal(cf_particles_attribute(s, "F", "", 10, CF_CARRIED, NULL), CF_BAD_ARGUMENT);
  assert_int_equal(cf_particles_append(s, INT64_C(3000000000), NULL), CF_OVER_LIMIT);
  cf_particles_destroy(s);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(sorting_is_stable_and_carries_everything),
      cmocka_unit_test(removed_ones_are_gone_and_ids_are_not_used_again),
      cmocka_unit_test(what_is_not_finite_is_found),
      cmocka_unit_test(failing_memory_changes_nothing),
      cmocka_unit_test(mistakes_are_said),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
