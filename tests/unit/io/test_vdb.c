/* SPDX-License-Identifier: MIT
 *
 * Volumes as OpenVDB reads them back: names, classes, places, values, sparseness.
 *
 * also in single precision
 */
#define _GNU_SOURCE
#include <math.h>
#include <signal.h>
#include <sys/resource.h>

#include "io/vdb.h"
#include "io/vdb_shim.h"
#include "output_case.h"
#include "testing.h"

#ifdef CF_WITH_OPENVDB

typedef struct found {
  int grids;
  cf_vdb_facts facts[8];
} found;

static void visit(void *context, const cf_vdb_facts *facts) {
  found *f = context;
  if (f->grids < 8) f->facts[f->grids++] = *facts;
}

static found look(const cf_path path) {
  found f = {0};
  char why[256] = "";
  if (!cf_vdb_shim_look(path.text, &(cf_vdb_viewer){.grid = visit, .context = &f}, why, sizeof why))
    fail_msg("%s: %s", path.text, why);
  return f;
}

static const cf_vdb_facts *find(const found *f, const char *name) {
  for (int i = 0; i < f->grids; ++i)
    if (strcmp(f->facts[i].name, name) == 0) return &f->facts[i];
  fail_msg("there is no grid %s", name);
  return NULL;
}

static void value_at(const cf_path path, const char *name, const int i, const int j, const int k,
                     float v[3]) {
  char why[256] = "";
  if (!cf_vdb_shim_probe(path.text, name, (int[3]){i, j, k}, v, why, sizeof why)) fail_msg("%s", why);
}

static cf_status write_frame(const output_case *c, const cf_vdb_plan *plan) {
  return cf_vdb_write(c->folder.text, 3, &c->registry, plan, &c->stamp);
}

static void fields_are_where_and_what_they_were(void **state) {
  output_case *c = *state;
  const cf_path path = case_path(c, "fields_000003.vdb");
  OK(write_frame(c, &(cf_vdb_plan){.rate = 24}));
  const found f = look(path);
  assert_int_equal(f.grids, 2);
  const cf_vdb_facts *density = find(&f, "density"), *q = find(&f, "q");
  assert_string_equal(density->kind, "fog volume");
  assert_string_equal(density->unit, "kg/m^3");
  assert_string_equal(q->kind, "staggered");
  assert_int_equal(density->active, 60);
  assert_int_equal(q->active, 60 + 12 + 15 + 20);
  for (int a = 0; a < 3; ++a) CLOSE(density->place[a], cf_grid_place(&c->grid, a, 0, 0), 1e-12);
  CLOSE(density->h, 0.25, 1e-12);
  float v[3];
  value_at(path, "density", 4, 3, 2, v);
  assert_true(v[0] == (float)c->phi.at[cf_box_at(&c->grid.box, 4, 3, 2)]);
  value_at(path, "density", 5, 3, 2, v);
  assert_true(v[0] == 0);
  value_at(path, "q", 2, 1, 1, v);
  for (int a = 0; a < 3; ++a) assert_true(v[a] == (float)c->q.at[a][cf_box_at(&c->grid.box, 2, 1, 1)]);
  value_at(path, "q", 5, 1, 1, v); /* the high wall */
  assert_true(v[0] == (float)c->q.at[0][cf_box_at(&c->grid.box, 5, 1, 1)] && v[1] == 0 && v[2] == 0);
}

static void small_values_are_left_out(void **state) {
  output_case *c = *state;
  const char *const phi[] = {"phi"};
  for (int k = 0; k < 3; ++k)
    for (int j = 0; j < 4; ++j)
      for (int i = 0; i < 5; ++i) c->phi.at[cf_box_at(&c->grid.box, i, j, k)] = i == 2 ? -100 : (cf_real)1e-5;
  OK(write_frame(c, &(cf_vdb_plan){.choice = {1, phi}, .half = true, .prune = 1e-6}));
  found f = look(case_path(c, "fields_000003.vdb"));
  assert_int_equal(f.grids, 1);
  assert_int_equal(f.facts[0].active, 12);
  assert_true(f.facts[0].half);
  OK(write_frame(c, &(cf_vdb_plan){.choice = {1, phi}}));
  f = look(case_path(c, "fields_000003.vdb"));
  assert_int_equal(f.facts[0].active, 60);
  assert_false(f.facts[0].half);
}

static void a_plane_is_one_voxel_thick(void **state) {
  output_case *c = *state;
  OK(write_frame(c, &(cf_vdb_plan){0}));
  const found f = look(case_path(c, "fields_000003.vdb"));
  assert_int_equal(find(&f, "density")->active, 20);
  CLOSE(find(&f, "density")->place[2], 0.125, 1e-12);
}

static void same_fields_same_bytes(void **state) {
  output_case *c = *state;
  const cf_path path = case_path(c, "fields_000003.vdb");
  char *bytes[2];
  size_t size[2];
  for (int i = 0; i < 2; ++i) {
    OK(write_frame(c, &(cf_vdb_plan){0}));
    OK(cf_file_read(path.text, 1 << 24, &bytes[i], &size[i]));
  }
  assert_int_equal(size[0], size[1]);
  assert_memory_equal(bytes[0], bytes[1], size[0]);
  cf_free(bytes[0]);
  cf_free(bytes[1]);
}

static void a_full_disk_is_said(void **state) {
  output_case *c = *state;
  struct rlimit old;
  signal(SIGXFSZ, SIG_IGN);
  assert_int_equal(getrlimit(RLIMIT_FSIZE, &old), 0);
  for (rlim_t most = 0; most < 2000; most += 199) {
    const struct rlimit limit = {most, old.rlim_max};
    assert_int_equal(setrlimit(RLIMIT_FSIZE, &limit), 0);
    const cf_status s = write_frame(c, &(cf_vdb_plan){0});
    assert_int_equal(setrlimit(RLIMIT_FSIZE, &old), 0);
    assert_int_equal(s, CF_CANNOT_WRITE);
    assert_says("fields_000003.vdb: cannot be written: ");
    assert_int_equal(files_in(c->folder.text), 0);
  }
  assert_int_equal(cf_vdb_write("/no/such/folder", 0, &c->registry, &(cf_vdb_plan){0}, &c->stamp),
                   CF_CANNOT_WRITE);
  assert_says("No such file or directory");
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test_setup_teardown(fields_are_where_and_what_they_were, output_case_3d, output_case_end),
      cmocka_unit_test_setup_teardown(small_values_are_left_out, output_case_3d, output_case_end),
      cmocka_unit_test_setup_teardown(a_plane_is_one_voxel_thick, output_case_2d, output_case_end),
      cmocka_unit_test_setup_teardown(same_fields_same_bytes, output_case_3d, output_case_end),
      cmocka_unit_test_setup_teardown(a_full_disk_is_said, output_case_3d, output_case_end),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}

#else

static void without_openvdb_it_says_so(void **state) {
  const output_case *c = *state;
  assert_int_equal(cf_vdb_write(c->folder.text, 3, &c->registry, &(cf_vdb_plan){0}, &c->stamp), CF_BAD_USAGE);
  assert_says("libopenvdb-dev");
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test_setup_teardown(without_openvdb_it_says_so, output_case_3d, output_case_end),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}

#endif
