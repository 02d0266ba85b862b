/* SPDX-License-Identifier: MIT
 */
#define _GNU_SOURCE
#include <math.h>

#include "io/checkpoint.h"
#include "io/frame.h"
#include "io/info.h"
#include "io/mesh.h"
#include "io/vdb.h"
#include "output_case.h"

static output_case the_case;

static int setup(void **state) {
  const cf_frame_plan all = {0};
  output_case_create(&the_case, 2);
  assert_int_equal(cf_frame_write(the_case.folder.text, 4, &the_case.registry, &all, &the_case.stamp), CF_OK);
  assert_int_equal(cf_checkpoint_write(the_case.folder.text, &the_case.registry, &the_case.stamp, 2), CF_OK);
  *state = &the_case;
  return 0;
}

static int teardown(void **state) {
  output_case_destroy(*state);
  return 0;
}

static void assert_info(const char *path, const char *const *parts) {
  char *text;
  assert_int_equal(cf_info_text(path, &text), CF_OK);
  for (; *parts != NULL; ++parts)
    if (strstr(text, *parts) == NULL) fail_msg("\"%s\" is not in:\n%s", *parts, text);
  cf_free(text);
}

/* The checksum that stands in the line of a field. */
static void find_checksum(const char *path, const char *field, char checksum[17]) {
  char *text, line[64];
  assert_int_equal(cf_info_text(path, &text), CF_OK);
  snprintf(line, sizeof line, "\n  %s ", field);
  const char *at = strstr(text, line);
  assert_non_null(at);
  at = strchr(at + 1, '\n') - 16;
  snprintf(checksum, 17, "%s", at);
  cf_free(text);
}

static void a_frame_tells_its_fields(void **state) {
  const output_case *c = *state;
  const char *const parts[] = {"a frame",
                               "scene    A cone, H_c = 2",
                               "time     0.1",
                               "step 12",
                               "5 x 4 x 1 cells",
                               "phi ",
                               "kg/m^3",
                               "q/x",
                               NULL};
  const char *const ink[] = {"a frame", "age ", "id ", "checksum of all arrays", NULL};
  assert_info(case_path(c, "fields_000004.vtkhdf").text, parts);
  assert_info(case_path(c, "particles_000004.vtkhdf").text, ink);
}

static void a_checkpoint_tells_its_state(void **state) {
  const output_case *c = *state;
  const char *const parts[] = {
      "a checkpoint, whole", "ledger", "step ", "ink/position.x", "phi ", "q/y", NULL};
  assert_info(case_path(c, "checkpoint_000012.h5").text, parts);
}

static void a_folder_tells_what_it_holds(void **state) {
  const output_case *c = *state;
  const char *const parts[] = {"frames       1",
                               "checkpoints  2",
                               "step 12: whole",
                               "step 13: not usable",
                               "cut short",
                               "phi ",
                               "age ",
                               "Points.y",
                               NULL};
  the_case.stamp.step = 13;
  assert_int_equal(cf_checkpoint_write(c->folder.text, &c->registry, &c->stamp, 2), CF_OK);
  assert_int_equal(truncate(case_path(c, "checkpoint_000013.h5").text, 2000), 0);
  assert_info(c->folder.text, parts);
}

static void equal_values_have_equal_checksums(void **state) {
  output_case *c = *state;
  char frame[17], checkpoint[17], other[17];
  find_checksum(case_path(c, "fields_000004.vtkhdf").text, "phi", frame);
  find_checksum(case_path(c, "checkpoint_000012.h5").text, "phi", checkpoint);
  assert_string_equal(frame, checkpoint);
  c->phi.at[1] = (cf_real)(c->phi.at[1] * (1 + CF_REAL_EPSILON));
  c->stamp.step = 13;
  assert_int_equal(cf_checkpoint_write(c->folder.text, &c->registry, &c->stamp, 2), CF_OK);
  find_checksum(case_path(c, "checkpoint_000013.h5").text, "phi", other);
  assert_string_not_equal(frame, other);
}

static void a_value_that_is_not_finite_is_named(void **state) {
  output_case *c = *state;
  const char *const parts[] = {"NOT FINITE at (2, 1, 0)", NULL};
  c->phi.at[cf_box_at(&c->grid.box, 2, 1, 0)] = (cf_real)NAN;
  assert_int_equal(cf_checkpoint_write(c->folder.text, &c->registry, &c->stamp, 2), CF_OK);
  assert_info(case_path(c, "checkpoint_000012.h5").text, parts);
}

/* A tetrahedron of side 1 along the axes, or without its slanted face. */
static void write_tetrahedron(const cf_path path, const int faces, const cf_stamp *stamp) {
  static const int32_t corner[4][3] = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};
  cf_mesh *mesh;
  cf_real *T;
  assert_int_equal(cf_mesh_create(&mesh), CF_OK);
  assert_int_equal(cf_mesh_resize(mesh, 4, faces, false), CF_OK);
  assert_int_equal(cf_mesh_attribute_add(mesh, "T", "K", &T), CF_OK);
  for (int a = 0; a < 3; ++a) mesh->place[a + 1][a] = 1;
  memcpy(mesh->corner, corner, (size_t)faces * sizeof *corner);
  T[2] = 7;
  assert_int_equal(cf_ply_write(path.text, mesh, stamp), CF_OK);
  cf_mesh_destroy(mesh);
}

static void a_surface_tells_its_size_and_whether_it_is_closed(void **state) {
  const output_case *c = *state;
  const cf_path path = case_path(c, "mesh_000004.ply");
  const char *const whole[] = {"a surface",
                               "title A cone, H_c = 2",
                               "4 vertices, 4 triangles",
                               "(0, 0, 0) to (1, 1, 1) m",
                               "closed ",
                               "volume 0.166666667 m^3",
                               "Points.z         m ",
                               "T                K ",
                               " 7 ",
                               "checksum of all arrays",
                               NULL};
  const char *const open[] = {"open ", "with one triangle: 3, with more than two: 0", NULL};
  write_tetrahedron(path, 4, &c->stamp);
  assert_info(path.text, whole);
  write_tetrahedron(path, 3, &c->stamp);
  assert_info(path.text, open);
}

static void a_volume_tells_its_grids(void **state) {
  const output_case *c = *state;
  const cf_path path = case_path(c, "fields_000004.vdb");
  const char *const parts[] = {"a volume",
                               "A cone, H_c = 2",
                               "density: fog volume, 20 voxels in use, h = 0.25 m",
                               "kg/m^3, stored with 32 bits",
                               "q: staggered",
                               "lengths of vectors from ",
                               NULL};
  char *text;
  if (cf_vdb_built()) {
    assert_int_equal(cf_vdb_write(c->folder.text, 4, &c->registry, &(cf_vdb_plan){0}, &c->stamp), CF_OK);
    assert_info(path.text, parts);
  }
  assert_int_equal(cf_file_write(path.text, "no volume", 9), CF_OK);
  assert_int_equal(cf_info_text(path.text, &text), CF_BAD_FILE);
  assert_says(cf_vdb_built() ? "not a VDB file" : "without OpenVDB");
}

/* A run that wrote no VTKHDF files has frames all the same. */
static void a_folder_of_surfaces_alone_counts_them(void **state) {
  const output_case *c = *state;
  const char *const parts[] = {"frames       2", "mesh_000005.ply: a surface", NULL};
  assert_int_equal(cf_frame_cut(c->folder.text, -1), CF_OK);
  write_tetrahedron(case_path(c, "mesh_000004.ply"), 4, &c->stamp);
  write_tetrahedron(case_path(c, "mesh_000005.ply"), 4, &c->stamp);
  assert_info(c->folder.text, parts);
}

static void other_files_are_refused(void **state) {
  const output_case *c = *state;
  char *text;
  assert_int_equal(cf_info_text(case_path(c, "fields.vtkhdf.series").text, &text), CF_BAD_FILE);
  assert_null(text);
  assert_int_equal(cf_info_text("/no/such/file", &text), CF_BAD_FILE);
  assert_says("/no/such/file: cannot be opened: No such file or directory");
}

static void failing_memory_leaks_nothing(void **state) {
  const output_case *c = *state;
  cf_status s = CF_NO_MEMORY;
  for (long n = 1; s != CF_OK; ++n) {
    char *text;
    cf_mem_fail_at(n);
    s = cf_info_text(case_path(c, "checkpoint_000012.h5").text, &text);
    cf_mem_fail_at(0);
    assert_true(s == CF_OK || s == CF_NO_MEMORY);
    cf_free(text);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test_setup_teardown(a_frame_tells_its_fields, setup, teardown),
      cmocka_unit_test_setup_teardown(a_checkpoint_tells_its_state, setup, teardown),
      cmocka_unit_test_setup_teardown(a_folder_tells_what_it_holds, setup, teardown),
      cmocka_unit_test_setup_teardown(equal_values_have_equal_checksums, setup, teardown),
      cmocka_unit_test_setup_teardown(a_value_that_is_not_finite_is_named, setup, teardown),
      cmocka_unit_test_setup_teardown(a_surface_tells_its_size_and_whether_it_is_closed, setup, teardown),
      cmocka_unit_test_setup_teardown(a_volume_tells_its_grids, setup, teardown),
      cmocka_unit_test_setup_teardown(a_folder_of_surfaces_alone_counts_them, setup, teardown),
      cmocka_unit_test_setup_teardown(other_files_are_refused, setup, teardown),
      cmocka_unit_test_setup_teardown(failing_memory_leaks_nothing, setup, teardown),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
