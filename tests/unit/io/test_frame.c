/* SPDX-License-Identifier: MIT
 *
 * What other programs see in the files is checked by support/check_vtkhdf.py.
 * also in single precision
 */
#define _GNU_SOURCE
#include <math.h>
#include <signal.h>
#include <sys/resource.h>

#include "io/frame.h"
#include "output_case.h"

static cf_status write_frame(output_case *c, const int64_t frame, const int compression) {
  const cf_frame_plan all = {.compression = compression};
  c->stamp.time = 0.25 * (double)frame;
  return cf_frame_write(c->folder.text, frame, &c->registry, &all, &c->stamp);
}

static void frame_reads_back_as_written(void **state) {
  output_case *c = *state;
  cf_frame f;
  cf_cell back;
  for (int compression = 0; compression < 2; ++compression) {
    assert_int_equal(write_frame(c, 12, compression), CF_OK);
    const cf_path path = case_path(c, "fields_000012.vtkhdf");
    assert_int_equal(cf_frame_read(&f, path.text), CF_OK);
    assert_int_equal(f.count, 2);
    assert_string_equal(f.field[0].name, "phi");
    assert_string_equal(f.field[0].unit, "kg/m^3");
    assert_int_equal(f.field[1].components, 3);
    assert_string_equal(f.title, c->stamp.title);
    assert_string_equal(f.precision, CF_PRECISION);
    assert_true(f.time == 3 && f.frame == 12 && f.step == 12 && f.grid.h == 0.25);
    assert_true(f.grid.origin[0] == -1 && f.grid.origin[1] == 0.5);
    const cf_box *b = &f.grid.box;
    assert_true(b->dim == c->grid.box.dim && b->n[0] == 5 && b->n[1] == 4 && b->n[2] == c->grid.box.n[2]);
    assert_int_equal(cf_cell_create(&back, b), CF_OK);
    assert_int_equal(cf_frame_read_cell(&f, "phi", 0, back), CF_OK);
    for (int k = 0; k < b->n[2]; ++k)
      for (int j = 0; j < b->n[1]; ++j)
        assert_memory_equal(&back.at[cf_box_at(b, 0, j, k)], &c->phi.at[cf_box_at(&c->grid.box, 0, j, k)],
                            5 * sizeof(cf_real));
    assert_int_equal(cf_frame_read_cell(&f, "q", 1, back), CF_OK);
    const cf_real *qy = c->q.at[1] + cf_box_at(&c->grid.box, 2, 1, 0);
    assert_true(back.at[cf_box_at(b, 2, 1, 0)] == (qy[0] + qy[c->grid.box.stride[1]]) / 2);
    assert_int_equal(cf_frame_read_cell(&f, "q", CF_MAGNITUDE, back), CF_OK);
    assert_true(back.at[0] > 1000);
    assert_int_equal(cf_frame_read_cell(&f, "fi", 0, back), CF_BAD_ARGUMENT);
    assert_says("has no field \"fi\"; it has: phi, q");
    cf_cell_destroy(&back, b);
  }
}

static void names_choose_what_is_written(void **state) {
  output_case *c = *state;
  cf_frame f;
  const char *const phi[] = {"phi"}, *const ink[] = {"ink"}, *const none[] = {"fi"};
  cf_frame_plan plan = {.choice = {1, phi}};
  assert_int_equal(cf_frame_write(c->folder.text, 3, &c->registry, &plan, &c->stamp), CF_OK);
  assert_int_equal(cf_frame_read(&f, case_path(c, "fields_000003.vtkhdf").text), CF_OK);
  assert_int_equal(f.count, 1);
  assert_int_equal(files_in(c->folder.text), 2); /* and the series */
  plan.choice.names = ink;
  assert_int_equal(cf_frame_write(c->folder.text, 3, &c->registry, &plan, &c->stamp), CF_OK);
  assert_int_equal(files_in(c->folder.text), 4);
  assert_int_equal(cf_frame_read(&f, case_path(c, "particles_000003.vtkhdf").text), CF_BAD_FILE);
  assert_says("is not a frame of fields");
  plan.choice.names = none;
  assert_int_equal(cf_frame_write(c->folder.text, 3, &c->registry, &plan, &c->stamp), CF_BAD_ARGUMENT);
  assert_says("there are phi, q, ink, ink.position, ink.age");
}

static void read_text(const output_case *c, const char *name, char *text, const size_t size) {
  char *all;
  size_t length;
  assert_int_equal(cf_file_read(case_path(c, name).text, 1 << 20, &all, &length), CF_OK);
  snprintf(text, size, "%s", all);
  cf_free(all);
}

static void series_lists_the_times(void **state) {
  output_case *c = *state;
  char text[1024];
  for (int64_t frame = 0; frame < 4; ++frame) assert_int_equal(write_frame(c, frame, 0), CF_OK);
  assert_int_equal(write_frame(c, 2, 0), CF_OK); /* again: what came after is of another course */
  read_text(c, "fields.vtkhdf.series", text, sizeof text);
  assert_string_equal(text,
                      "{\n  \"file-series-version\": \"1.0\",\n  \"files\": [\n"
                      "    {\"name\": \"fields_000000.vtkhdf\", \"time\": 0},\n"
                      "    {\"name\": \"fields_000001.vtkhdf\", \"time\": 0.25},\n"
                      "    {\"name\": \"fields_000002.vtkhdf\", \"time\": 0.5}\n  ]\n}\n");
  assert_int_equal(cf_frame_cut(c->folder.text, 1), CF_OK);
  read_text(c, "particles.vtkhdf.series", text, sizeof text);
  assert_non_null(strstr(text, "\"particles_000001.vtkhdf\", \"time\": 0.25}\n"));
  assert_null(strstr(text, "000002"));
  assert_int_equal(files_in(c->folder.text), 6);
  assert_int_equal(cf_frame_cut(c->folder.text, -1), CF_OK);
  assert_int_equal(files_in(c->folder.text), 2);
}

static void same_frame_same_bytes(void **state) {
  output_case *c = *state;
  char *a, *b;
  size_t n, m;
  for (int compression = 0; compression < 2; ++compression) {
    const cf_path path = case_path(c, "fields_000001.vtkhdf");
    assert_int_equal(write_frame(c, 1, compression), CF_OK);
    assert_int_equal(cf_file_read(path.text, 1 << 24, &a, &n), CF_OK);
    sleep(1);
    assert_int_equal(write_frame(c, 1, compression), CF_OK);
    assert_int_equal(cf_file_read(path.text, 1 << 24, &b, &m), CF_OK);
    assert_int_equal(n, m);
    assert_memory_equal(a, b, n);
    cf_free(a);
    cf_free(b);
  }
}

/* Whatever the byte at which there is no more room. */
static void a_full_disk_leaves_the_earlier_frames(void **state) {
  output_case *c = *state;
  struct rlimit old;
  char *bytes;
  size_t size;
  assert_int_equal(write_frame(c, 1, 0), CF_OK);
  assert_int_equal(cf_file_read(case_path(c, "fields_000001.vtkhdf").text, 1 << 24, &bytes, &size), CF_OK);
  cf_free(bytes);
  const int before = files_in(c->folder.text);
  signal(SIGXFSZ, SIG_IGN);
  assert_int_equal(getrlimit(RLIMIT_FSIZE, &old), 0);
  for (rlim_t most = 0; most < size; most += 97) {
    const struct rlimit limit = {most, old.rlim_max};
    assert_int_equal(setrlimit(RLIMIT_FSIZE, &limit), 0);
    const cf_status s = write_frame(c, 2, 0);
    assert_int_equal(setrlimit(RLIMIT_FSIZE, &old), 0);
    assert_int_equal(s, CF_CANNOT_WRITE);
    assert_says("fields_000002.vtkhdf: cannot ");
    assert_says("File too large");
    assert_int_equal(files_in(c->folder.text), before);
  }
}

static void a_missing_folder_is_said(void **state) {
  output_case *c = *state;
  const cf_frame_plan all = {0};
  assert_int_equal(cf_frame_write("/no/such/folder", 0, &c->registry, &all, &c->stamp), CF_CANNOT_WRITE);
  assert_says("/no/such/folder/fields_000000.vtkhdf: cannot create the file: No such file or directory");
}

static void no_particles_make_an_empty_file(void **state) {
  output_case *c = *state;
  c->ink->count = 0;
  assert_int_equal(write_frame(c, 0, 0), CF_OK);
}

static void failing_memory_leaves_no_half_file(void **state) {
  output_case *c = *state;
  cf_status s = CF_NO_MEMORY;
  for (long n = 1; s != CF_OK; ++n) {
    cf_frame f;
    cf_mem_fail_at(n);
    s = write_frame(c, 0, 0);
    cf_mem_fail_at(0);
    assert_true(s == CF_OK || s == CF_NO_MEMORY);
    if (access(case_path(c, "fields_000000.vtkhdf").text, F_OK) == 0)
      assert_int_equal(cf_frame_read(&f, case_path(c, "fields_000000.vtkhdf").text), CF_OK);
  }
  assert_int_equal(files_in(c->folder.text), 4);
}

static void files_that_are_no_frames_are_refused(void **state) {
  output_case *c = *state;
  cf_frame f;
  const cf_path path = case_path(c, "fields_000000.vtkhdf");
  assert_int_equal(cf_frame_read(&f, path.text), CF_BAD_FILE);
  assert_says("No such file");
  assert_int_equal(cf_file_write(path.text, "no frame", 8), CF_OK);
  assert_int_equal(cf_frame_read(&f, path.text), CF_BAD_FILE);
  assert_says("is neither a frame nor a checkpoint, or is damaged");
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test_setup_teardown(frame_reads_back_as_written, output_case_3d, output_case_end),
      cmocka_unit_test_setup_teardown(names_choose_what_is_written, output_case_2d, output_case_end),
      cmocka_unit_test_setup_teardown(series_lists_the_times, output_case_2d, output_case_end),
      cmocka_unit_test_setup_teardown(same_frame_same_bytes, output_case_3d, output_case_end),
      cmocka_unit_test_setup_teardown(a_full_disk_leaves_the_earlier_frames, output_case_3d, output_case_end),
      cmocka_unit_test_setup_teardown(a_missing_folder_is_said, output_case_2d, output_case_end),
      cmocka_unit_test_setup_teardown(no_particles_make_an_empty_file, output_case_2d, output_case_end),
      cmocka_unit_test_setup_teardown(failing_memory_leaves_no_half_file, output_case_2d, output_case_end),
      cmocka_unit_test_setup_teardown(files_that_are_no_frames_are_refused, output_case_2d, output_case_end),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
