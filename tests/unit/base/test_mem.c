/* SPDX-License-Identifier: MIT
 *
 * Blocks and pages: zeroed, aligned, refused when they cannot be had, and failing on request.
 */
#include "base/mem.h"

#include <stdint.h>
#include <string.h>

#include "base/real.h"
#include "testing.h"

static void blocks_are_zeroed_and_aligned(void **state) {
  (void)state;
  for (size_t n = 1; n < 300; n += 7) {
    double *block;
    OK(CF_NEW(&block, n));
    assert_int_equal((uintptr_t)block % CF_ALIGN, 0);
    for (size_t i = 0; i < n; ++i) assert_true(block[i] == 0);
    memset(block, 0xff, n * sizeof *block); /* so that the next one would show it */
    cf_free(block);
  }
}

static void an_empty_block_is_a_block(void **state) {
  (void)state;
  char *block;
  OK(CF_NEW(&block, 0));
  assert_non_null(block);
  cf_free(block);
  cf_free(NULL);
}

static void impossible_sizes_are_refused(void **state) {
  (void)state;
  void *block = &block;
  assert_int_equal(cf_new_array(&block, SIZE_MAX, 8), CF_NO_MEMORY);
  assert_null(block);
  assert_int_equal(cf_new_array(&block, SIZE_MAX / 8, 8), CF_NO_MEMORY);
  assert_null(block);
  assert_int_equal(cf_new_array(&block, SIZE_MAX - 8, 1), CF_NO_MEMORY);
  assert_null(block);
  void *pages = &pages;
  assert_int_equal(cf_pages_reserve(&pages, (size_t)1 << 60, true), CF_NO_MEMORY);
  assert_null(pages);
  assert_true(strlen(cf_status_sentence()) > 10);
}

static void text_is_copied_with_its_end(void **state) {
  (void)state;
  char *copy;
  OK(cf_new_text(&copy, "Cattaneo-Fourier", 8));
  assert_string_equal(copy, "Cattaneo");
  cf_free(copy);
}

static void pages_are_zero_and_cost_nothing_until_touched(void **state) {
  (void)state;
  const size_t size = (size_t)1 << (test_memory_is_watched() ? 30 : 36); /* 64 GiB of address space */
  void *pages;
  for (int dense = 0; dense < 2; ++dense) {
    OK(cf_pages_reserve(&pages, size, dense));
    const char *at = pages;
    assert_true(at[0] == 0 && at[size / 2] == 0 && at[size - 1] == 0);
    cf_pages_release(pages, size);
  }
  cf_pages_release(NULL, 10);
}

static void the_chosen_allocation_fails_and_no_other(void **state) {
  (void)state;
  void *block;
  for (int n = 1; n <= 4; ++n) {
    cf_mem_fail_at(n);
    for (int i = 1; i <= 6; ++i) {
      const cf_status s = i % 2 ? cf_new_array(&block, 4, 4) : cf_pages_reserve(&block, 4096, false);
      assert_int_equal(s, i == n ? CF_NO_MEMORY : CF_OK);
      if (s != CF_OK) assert_null(block);
      if (s == CF_OK && i % 2) cf_free(block);
      if (s == CF_OK && i % 2 == 0) cf_pages_release(block, 4096);
    }
    cf_mem_fail_at(0);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(blocks_are_zeroed_and_aligned),
      cmocka_unit_test(an_empty_block_is_a_block),
      cmocka_unit_test(impossible_sizes_are_refused),
      cmocka_unit_test(text_is_copied_with_its_end),
      cmocka_unit_test(pages_are_zero_and_cost_nothing_until_touched),
      cmocka_unit_test(the_chosen_allocation_fails_and_no_other),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
/* also in single precision */
