/* SPDX-License-Identifier: MIT
 *
 * also in single precision
 */
#define _GNU_SOURCE
#include "io/npy.h"
#include "output_case.h"

/* Checks the head of a file and returns its values: *bytes is to be freed. */
static const cf_real *values_of(const output_case *c, const char *name, const char *shape, const size_t count,
                                char **bytes) {
  char wanted[128];
  size_t size;
  assert_int_equal(cf_file_read(case_path(c, name).text, 1 << 20, bytes, &size), CF_OK);
  assert_memory_equal(*bytes, "\x93NUMPY\x01\x00", 8);
  const size_t head = 10 + (unsigned char)(*bytes)[8] + 256u * (unsigned char)(*bytes)[9];
  assert_int_equal(head % 64, 0);
  assert_int_equal((*bytes)[head - 1], '\n');
  snprintf(wanted, sizeof wanted, "{'descr': '<f%d', 'fortran_order': False, 'shape': %s, }",
           (int)sizeof(cf_real), shape);
  assert_memory_equal(*bytes + 10, wanted, strlen(wanted));
  assert_int_equal(size, head + count * sizeof(cf_real));
  return (const cf_real *)(const void *)(*bytes + head);
}

static cf_status write_all(const output_case *c) {
  const char *const names[] = {"phi", "q", "ink", "ledger"};
  return cf_npy_write(c->folder.text, 12, &c->registry, &(cf_choice){4, names});
}

static void arrays_are_in_c_order_without_ghosts(void **state) {
  const output_case *c = *state;
  char *bytes;
  assert_int_equal(write_all(c), CF_OK);
  const cf_real *v = values_of(c, "fields_000012_phi.npy", "(3, 4, 5)", 60, &bytes);
  for (int k = 0; k < 3; ++k)
    for (int j = 0; j < 4; ++j)
      for (int i = 0; i < 5; ++i)
        assert_true(v[(k * 4 + j) * 5 + i] == c->phi.at[cf_box_at(&c->grid.box, i, j, k)]);
  cf_free(bytes);
  v = values_of(c, "fields_000012_q_y.npy", "(3, 5, 5)", 75, &bytes);
  for (int k = 0; k < 3; ++k)
    for (int j = 0; j < 5; ++j)
      for (int i = 0; i < 5; ++i)
        assert_true(v[(k * 5 + j) * 5 + i] == c->q.at[1][cf_box_at(&c->grid.box, i, j, k)]);
  cf_free(bytes);
  assert_int_equal(files_in(c->folder.text), 7);
}

static void two_dimensions_are_two(void **state) {
  output_case *c = *state;
  char *bytes;
  assert_int_equal(write_all(c), CF_OK);
  values_of(c, "fields_000012_phi.npy", "(4, 5)", 20, &bytes);
  cf_free(bytes);
  values_of(c, "fields_000012_q_x.npy", "(4, 6)", 24, &bytes);
  cf_free(bytes);
  values_of(c, "particles_000012_position.npy", "(7, 2)", 14, &bytes);
  cf_free(bytes);
  const cf_real *v = values_of(c, "particles_000012_age.npy", "(7,)", 7, &bytes);
  assert_memory_equal(v, c->ink->attribute[c->age].at[0], 7 * sizeof *v);
  cf_free(bytes);
  c->ink->count = 0;
  assert_int_equal(write_all(c), CF_OK);
  values_of(c, "particles_000012_age.npy", "(0,)", 0, &bytes);
  cf_free(bytes);
}

static void unknown_names_and_folders_are_said(void **state) {
  const output_case *c = *state;
  const char *const names[] = {"fi"}, *const phi[] = {"phi"};
  assert_int_equal(cf_npy_write(c->folder.text, 1, &c->registry, &(cf_choice){1, names}), CF_BAD_ARGUMENT);
  assert_says("there is no field \"fi\"");
  assert_int_equal(cf_npy_write("/no/such/folder", 1, &c->registry, &(cf_choice){1, phi}), CF_CANNOT_WRITE);
  assert_says("/no/such/folder/fields_000001_phi.npy: cannot be written: No such file or directory");
}

static void failing_memory_leaves_no_half_file(void **state) {
  const output_case *c = *state;
  cf_status s = CF_NO_MEMORY;
  for (long n = 1; s != CF_OK; ++n) {
    cf_mem_fail_at(n);
    s = write_all(c);
    cf_mem_fail_at(0);
    assert_true(s == CF_OK || s == CF_NO_MEMORY);
  }
  assert_int_equal(files_in(c->folder.text), 7);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test_setup_teardown(arrays_are_in_c_order_without_ghosts, output_case_3d, output_case_end),
      cmocka_unit_test_setup_teardown(two_dimensions_are_two, output_case_2d, output_case_end),
      cmocka_unit_test_setup_teardown(unknown_names_and_folders_are_said, output_case_3d, output_case_end),
      cmocka_unit_test_setup_teardown(failing_memory_leaves_no_half_file, output_case_3d, output_case_end),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
