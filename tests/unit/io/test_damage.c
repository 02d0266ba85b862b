/* SPDX-License-Identifier: MIT
 *
 * Frames and checkpoints that somebody edited with tools for HDF5: whole files, whose contents make no sense. Checkpoints
 * are sealed again, so that their checksums hold.
 */
#define _GNU_SOURCE
#include <math.h>

#include <hdf5.h>

#include "io/checkpoint.h"
#include "io/checkpoint_head.h"
#include "io/frame.h"
#include "io/points.h"
#include "output_case.h"
#include "testing.h"

static int setup(void **state) {
  const cf_frame_plan all = {0};
  output_case_begin(state, 2);
  const output_case *c = *state;
  OK(cf_frame_write(c->folder.text, 4, &c->registry, &all, &c->stamp));
  return 0;
}

static int teardown(void **state) {
  output_case_destroy(*state);
  return 0;
}

/* --- edits ------------------------------------------------------------------------------------------------ */

static hid_t edit(const char *path) {
  const hid_t file = H5Fopen(path, H5F_ACC_RDWR, H5P_DEFAULT);
  assert_true(file >= 0);
  return file;
}

static void drop_attribute(const hid_t file, const char *at, const char *name) {
  assert_true(H5Adelete_by_name(file, at, name, H5P_DEFAULT) >= 0);
}

static void set_attribute(const hid_t file, const char *at, const char *name, const hid_t type,
                          const hsize_t count, const void *value) {
  const hid_t space = count > 1 ? H5Screate_simple(1, &count, NULL) : H5Screate(H5S_SCALAR);
  if (H5Aexists_by_name(file, at, name, H5P_DEFAULT) > 0) drop_attribute(file, at, name);
  const hid_t a = H5Acreate_by_name(file, at, name, type, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
  assert_true(a >= 0 && H5Awrite(a, type, value) >= 0);
  H5Aclose(a);
  H5Sclose(space);
}

static void set_text(const hid_t file, const char *at, const char *name, const char *text) {
  const hid_t type = H5Tcopy(H5T_C_S1);
  assert_true(H5Tset_size(type, strlen(text) + 1) >= 0);
  set_attribute(file, at, name, type, 1, text);
  H5Tclose(type);
}

/* An array of zeros. */
static void set_array(const hid_t file, const char *path, const int rank, const hsize_t *n) {
  const hid_t space = H5Screate_simple(rank, n, NULL);
  if (H5Lexists(file, path, H5P_DEFAULT) > 0) assert_true(H5Ldelete(file, path, H5P_DEFAULT) >= 0);
  const hid_t set = H5Dcreate2(file, path, H5T_NATIVE_DOUBLE, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
  assert_true(set >= 0);
  H5Dclose(set);
  H5Sclose(space);
}

/* --- frames ----------------------------------------------------------------------------------------------- */

static void frame_refused(const output_case *c, const char *says) {
  cf_frame f;
  assert_int_equal(cf_frame_read(&f, case_path(c, "fields_000004.vtkhdf").text), CF_BAD_FILE);
  assert_says(says);
}

static void a_frame_without_sense_is_refused(void **state) {
  const output_case *c = *state;
  const cf_path path = case_path(c, "fields_000004.vtkhdf");
  const int64_t dim = 7, two = 2, extent[6] = {0, 5, 0, 0, 0, 1}, whole[6] = {0, 5, 0, 4, 0, 1};
  const double spacing[3] = {-1, 1, 1};
  hid_t file = edit(path.text);
  set_attribute(file, "/VTKHDF", "Spacing", H5T_NATIVE_DOUBLE, 3, spacing);
  H5Fclose(file);
  frame_refused(c, "has a grid that makes no sense: ");
  file = edit(path.text);
  set_attribute(file, "/", "dim", H5T_NATIVE_INT64, 1, &dim);
  H5Fclose(file);
  frame_refused(c, "has a dimension that makes no sense");
  file = edit(path.text);
  set_attribute(file, "/VTKHDF", "WholeExtent", H5T_NATIVE_INT64, 6, extent);
  H5Fclose(file);
  frame_refused(c, "has an extent that makes no sense");
  file = edit(path.text);
  set_text(file, "/VTKHDF", "Type", "UnstructuredGrid");
  H5Fclose(file);
  frame_refused(c, "holds UnstructuredGrid, expected ImageData");
  file = edit(path.text);
  set_text(file, "/VTKHDF", "Type", "ImageData");
  set_attribute(file, "/VTKHDF", "WholeExtent", H5T_NATIVE_INT64, 6, whole);
  set_attribute(file, "/", "dim", H5T_NATIVE_INT64, 1, &two);
  drop_attribute(file, "/", "time");
  H5Fclose(file);
  frame_refused(c, "/ has no attribute \"time\" of the kind that belongs there");
}

static void a_number_is_asked_for_its_components(void **state) {
  const output_case *c = *state;
  cf_frame f;
  cf_cell values;
  OK(cf_frame_read(&f, case_path(c, "fields_000004.vtkhdf").text));
  OK(cf_cell_create(&values, &f.grid.box));
  OK(cf_frame_read_cell(&f, "phi", 0, values));
  assert_int_equal(cf_frame_read_cell(&f, "phi", 1, values), CF_BAD_ARGUMENT);
  assert_says("component 1 of phi, which has 1");
  cf_cell_destroy(&values, &f.grid.box);
}

static void points_refused(const cf_points *p, const char *name, const int components, const char *says) {
  float *values;
  assert_int_equal(cf_points_attribute(p, name, components, &values), CF_BAD_FILE);
  assert_null(values);
  assert_says(says);
}

static void particles_without_sense_are_refused(void **state) {
  const output_case *c = *state;
  const cf_path path = case_path(c, "particles_000004.vtkhdf");
  const hsize_t flat[2] = {7, 2}, block[3] = {7, 2, 2}, bomb[2] = {(hsize_t)1 << 40, 3};
  cf_points p;
  hid_t file = edit(path.text);
  set_array(file, "/VTKHDF/PointData/block", 3, block);
  set_array(file, "/VTKHDF/PointData/bomb", 2, bomb);
  H5Fclose(file);
  OK(cf_points_read(&p, path.text));
  points_refused(&p, "age", 3, "age has 7 times 1 numbers, expected 7 times 3");
  points_refused(&p, "block", 1, "block has a shape that makes no sense");
  points_refused(&p, "bomb", 3, "bomb says that it is larger than the file can hold");
  file = edit(path.text);
  assert_true(H5Ldelete(file, "/VTKHDF/PointData", H5P_DEFAULT) >= 0);
  H5Fclose(file);
  points_refused(&p, "age", 1, "has no group /VTKHDF/PointData");
  cf_points_clear(&p);
  file = edit(path.text);
  set_array(file, "/VTKHDF/Points", 2, flat);
  H5Fclose(file);
  assert_int_equal(cf_points_read(&p, path.text), CF_BAD_FILE);
  assert_says("places of 2 numbers");
}

/* --- checkpoints ------------------------------------------------------------------------------------------ */

/* The page of text with the checksum of what is there now. */
static void seal(const hid_t file, const char *path) {
  cf_head head;
  hsize_t page;
  const hid_t made = H5Fget_create_plist(file);
  assert_true(H5Pget_userblock(made, &page) >= 0);
  H5Pclose(made);
  H5Fclose(file);
  OK(cf_head_create(&head, 0));
  head.size = (size_t)page;
  OK(cf_head_write(&head, path, path));
  cf_head_destroy(&head);
}

typedef void edit_of(hid_t file);

static void flatten(const hid_t file) {
  const int64_t dim = 3;
  set_attribute(file, "/", "dim", H5T_NATIVE_INT64, 1, &dim);
}

static void change_precision(const hid_t file) { set_text(file, "/", "precision", "quadruple"); }

static void change_kind(const hid_t file) { set_text(file, "/state/phi", "kind", "face"); }

static void spoil_scene(const hid_t file) {
  const hsize_t n = 4;
  set_array(file, "/scene", 1, &n);
}

static void an_edited_checkpoint_is_refused_and_changes_nothing(void **state) {
  static const struct {
    edit_of *edit;
    const char *says;
  } edits[] = {
      {flatten, "has another domain: expected 2D, found 3D"},
      {change_precision, "was written in quadruple precision, this program computes in " CF_PRECISION},
      {change_kind, "\"phi\" is of another kind: expected cell, found face"},
  };
  const output_case *c = *state;
  const cf_path path = case_path(c, "checkpoint_000012.h5");
  cf_checkpoint_facts facts;
  char *scene;
  for (size_t i = 0; i < sizeof edits / sizeof *edits; ++i) {
    OK(cf_checkpoint_write(c->folder.text, &c->registry, &c->stamp, 1));
    hid_t file = edit(path.text);
    edits[i].edit(file);
    seal(file, path.text);
    const cf_real before = c->phi.at[cf_box_at(&c->grid.box, 1, 1, 0)];
    assert_int_equal(cf_checkpoint_read(path.text, &c->registry), CF_BAD_FILE);
    assert_says(edits[i].says);
    assert_true(c->phi.at[cf_box_at(&c->grid.box, 1, 1, 0)] == before);
  }
  OK(cf_checkpoint_write(c->folder.text, &c->registry, &c->stamp, 1));
  const hid_t file = edit(path.text);
  spoil_scene(file);
  seal(file, path.text);
  assert_int_equal(cf_checkpoint_describe(path.text, &facts, &scene), CF_BAD_FILE);
  assert_says("the scene in it is not a text");
  assert_null(scene);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test_setup_teardown(a_frame_without_sense_is_refused, setup, teardown),
      cmocka_unit_test_setup_teardown(a_number_is_asked_for_its_components, setup, teardown),
      cmocka_unit_test_setup_teardown(particles_without_sense_are_refused, setup, teardown),
      cmocka_unit_test_setup_teardown(an_edited_checkpoint_is_refused_and_changes_nothing, setup, teardown),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
