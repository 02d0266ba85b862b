/* SPDX-License-Identifier: MIT
 *
 * Surfaces in files: what is written is read back, what others write is understood, and nothing that is not a mesh
 * does harm.
 *
 * also in single precision
 */
#define _GNU_SOURCE
#include <math.h>

#include "grid/isosurface.h"
#include "io/frame.h"
#include "io/mesh.h"
#include "output_case.h"
#include "testing.h"

static cf_mesh *empty(void) {
  cf_mesh *m;
  OK(cf_mesh_create(&m));
  return m;
}

/* The surface of the case's field, with an attribute. */
static cf_mesh *make(const output_case *c) {
  cf_mesh *m = empty();
  OK(cf_isosurface_make(m, &c->grid, c->phi, &(cf_isosurface){.level = 122, .caps = true}));
  OK(cf_mesh_sample(m, &c->grid, c->phi, "phi", "kg/m^3"));
  assert_true(m->triangles > 20);
  return m;
}

static void put(const cf_path path, const char *text) { OK(cf_file_write(path.text, text, strlen(text))); }

static void what_is_written_is_read(void **state) {
  output_case *c = *state;
  cf_mesh *m = make(c), *back = empty();
  const cf_path path = case_path(c, "mesh_000001.ply");
  OK(cf_ply_write(path.text, m, &c->stamp));
  OK(cf_mesh_read(back, path.text));
  assert_int_equal(back->vertices, m->vertices);
  assert_int_equal(back->triangles, m->triangles);
  assert_memory_equal(back->corner, m->corner, (size_t)m->triangles * sizeof *m->corner);
  assert_int_equal(back->attributes, 1);
  assert_string_equal(back->attribute[0].name, "phi");
  for (int64_t v = 0; v < m->vertices; ++v)
    for (int a = 0; a < 3; ++a) {
      assert_true((float)back->place[v][a] == (float)m->place[v][a]);
      assert_true((float)back->normal[v][a] == (float)m->normal[v][a]);
      assert_true((float)back->attribute[0].at[v] == (float)m->attribute[0].at[v]);
    }
  cf_mesh_destroy(back);
  cf_mesh_destroy(m);
}

static const char ascii[] =
    "ply\r\nformat ascii 1.0\r\ncomment a pyramid\r\n"
    "element vertex 5\r\nproperty double x\r\nproperty float y\r\nproperty float z\r\n"
    "property uchar red\r\nelement edge 1\r\nproperty int a\r\nproperty int b\r\n"
    "element face 5\r\nproperty uchar group\r\nproperty list uchar int vertex_index\r\n"
    "end_header\r\n"
    "0 0 0 9\r\n1 0 0 8\r\n1 1 0 7\r\n0 1 0 6\r\n0.5 0.5 1e0 5\r\n7 7\r\n"
    "1 4 3 2 1 0\r\n1 3 0 1 4\r\n1 3 1 2 4\r\n1 3 2 3 4\r\n1 3 3 0 4\r\n";

static void is_a_pyramid(const cf_mesh *m) {
  cf_mesh_facts f;
  assert_int_equal(m->vertices, 5);
  assert_int_equal(m->triangles, 6);
  OK(cf_mesh_check_closed(m));
  OK(cf_mesh_look(m, &f));
  CLOSE(f.volume, 1.0 / 3, 1e-6);
  assert_non_null(m->normal);
  CLOSE(m->normal[4][2], 1, 1e-6);
}

static void files_of_others_are_understood(void **state) {
  const output_case *c = *state;
  cf_mesh *m = empty();
  const cf_path ply = case_path(c, "others.PLY"), obj = case_path(c, "others.obj");
  put(ply, ascii);
  OK(cf_mesh_read(m, ply.text));
  is_a_pyramid(m);
  assert_int_equal(m->attributes, 1);
  assert_true(m->attribute[0].at[4] == 5);
  put(obj,
      "# a pyramid\nmtllib no.mtl\nv 0 0 0\nv 1 0 0 1.0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvn 0 0 1\nv .5 .5 1\n"
      "f 4 3 \\\n 2 1\nf 1/1 2/1 5/1\nf 2//1 3//1 5//1\nf -3 4 -1\nf 4/1/1 1/1/1 5/1/1\n");
  OK(cf_mesh_read(m, obj.text));
  is_a_pyramid(m);
  cf_mesh_destroy(m);
}

static void both_byte_orders_are_read(void **state) {
  const output_case *c = *state;
  cf_mesh *m = empty();
  const cf_path path = case_path(c, "big.ply");
  for (int big = 0; big < 2; ++big) {
    char file[400];
    int n =
        snprintf(file, sizeof file,
                 "ply\nformat binary_%s_endian 1.0\nelement vertex 3\nproperty short x\nproperty double y\n"
                 "property float z\nelement face 1\nproperty list ushort uchar vertex_indices\nend_header\n",
                 big ? "big" : "little");
    for (int v = 0; v < 3; ++v) {
      const short x = (short)(-300 * v);
      const double y = v == 1 ? 0.1 : 0;
      const float z = (float)v / 3;
      const struct {
        const void *at;
        int size;
      } value[3] = {{&x, 2}, {&y, 8}, {&z, 4}};
      for (int i = 0; i < 3; ++i)
        for (int b = 0; b < value[i].size; ++b)
          file[n++] = ((const char *)value[i].at)[big ? value[i].size - 1 - b : b];
    }
    file[n++] = big ? 0 : 3;
    file[n++] = big ? 3 : 0;
    for (char v = 0; v < 3; ++v) file[n++] = v;
    OK(cf_file_write(path.text, file, (size_t)n));
    OK(cf_mesh_read(m, path.text));
    assert_true(m->place[2][0] == -600 && m->place[1][1] == (cf_real)0.1 && (float)m->place[2][2] == 2 / 3.f);
    assert_int_equal(m->corner[0][2], 2);
  }
  cf_mesh_destroy(m);
}

static void refused(const output_case *c, const char *name, const char *text, const char *why) {
  cf_mesh *m = empty();
  const cf_path path = case_path(c, name);
  put(path, text);
  assert_int_equal(cf_mesh_read(m, path.text), CF_BAD_FILE);
  assert_says(path.text);
  assert_says(why);
  assert_int_equal(m->vertices + m->triangles, 0);
  cf_mesh_destroy(m);
}

#define HEAD  "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
#define FACES "element face 1\nproperty list uchar int vertex_indices\nend_header\n"
#define THREE "0 0 0\n1 0 0\n0 1 0\n"

static void mistakes_are_said(void **state) {
  const output_case *c = *state;
  refused(c, "a.stl", "solid", "a mesh is a file .ply or .obj");
  refused(c, "a.ply", "", "the head has no end");
  refused(c, "a.ply", "solid\n", "is not a PLY file");
  refused(c, "a.ply", "ply\nformat ascii 2.0\n", "a.ply:2: not a format and version 1.0");
  refused(c, "a.ply", "ply\nformat text 1.0\n", "an unknown format: \"text\"");
  refused(c, "a.ply", "ply\nend_header\n", "does not say its format");
  refused(c, "a.ply", "ply\nproperty int x\n", "a.ply:2: a property of no element");
  refused(c, "a.ply", "ply\nelement vertex -3\n", "not an element and its number");
  refused(c, "a.ply", "ply\nelement vertex 3\nproperty real x\n", "a property of an unknown type");
  refused(c, "a.ply", "ply\nelement vertex 3\nproperty list float int x\n", "a property of an unknown type");
  refused(c, "a.ply", HEAD "end_header\n" THREE, "has no faces");
  refused(c, "a.ply", HEAD FACES THREE, "face 0 of 1 is not there");
  refused(c, "a.ply", HEAD FACES "0 0 0\n1 0 zero\n", "vertex 1 of 3 is not there");
  refused(c, "a.ply", HEAD FACES THREE "3 0 1 3\n", "face 0 names vertex 3 of 3");
  refused(c, "a.ply", HEAD FACES THREE "3 0 1 -1\n", "face 0 names vertex -1 of 3");
  refused(c, "a.ply", HEAD FACES THREE "3 0 1 1.5\n", "face 0 names vertex 1.5 of 3");
  refused(c, "a.ply", HEAD FACES THREE "2 0 1\n", "face 0 has 2 corners");
  refused(c, "a.ply", HEAD FACES "0 0 0\n1 0 nan\n0 1 0\n3 0 1 2\n", "vertex 1 is at no place: z is nan");
  refused(c, "a.ply", "ply\nformat ascii 1.0\nelement vertex 4000000000000\nproperty float x\nend_header\n",
          "is cut short: 4000000000000 of vertex");
  refused(c, "a.obj", "v 0 0\n", "a.obj:1: a vertex without its z");
  refused(c, "a.obj", "v 0 0 0\n\nf 1 2 3\n", "a.obj:3: a face names vertex 2; there are 1 so far");
  refused(c, "a.obj", "v 0 0 0\nv 0 1 0\nf 1 2\n", "a.obj:3: a face of 2 corners");
  refused(c, "a.obj", "v 0 0 0\nf one\n", "a.obj:2: \"one\" is no vertex");
  refused(c, "a.obj", "", "has no faces");
  cf_mesh *m = empty();
  assert_int_equal(cf_mesh_read(m, "/no/such/file.ply"), CF_BAD_FILE);
  cf_mesh_destroy(m);
}

/* Cut short anywhere, and with any byte changed: a status, and no crash. */
static void damaged_files_do_no_harm(void **state) {
  output_case *c = *state;
  cf_mesh *m = make(c), *back = empty();
  const cf_path ply = case_path(c, "m.ply"), bad = case_path(c, "bad.ply");
  char *bytes;
  size_t size;
  OK(cf_ply_write(ply.text, m, &c->stamp));
  for (int which = 0; which < 2; ++which) {
    if (which == 1) put(ply, ascii);
    OK(cf_file_read(ply.text, 1 << 20, &bytes, &size));
    for (size_t n = 0; n < size; n += 7) {
      OK(cf_file_write(bad.text, bytes, n));
      assert_int_not_equal(cf_mesh_read(back, bad.text), CF_OK);
    }
    for (size_t i = 0; i < size; i += 3) {
      const char kept = bytes[i];
      bytes[i] = (char)(kept ^ (1 << i % 8));
      OK(cf_file_write(bad.text, bytes, size));
      (void)cf_mesh_read(back, bad.text);
      bytes[i] = kept;
    }
    cf_free(bytes);
  }
  cf_mesh_destroy(back);
  cf_mesh_destroy(m);
}

static void a_frame_has_its_surface(void **state) {
  output_case *c = *state;
  cf_mesh *m = make(c);
  OK(cf_frame_write_mesh(c->folder.text, 4, &c->grid, m, &c->stamp));
  assert_int_equal(files_in(c->folder.text), 2); /* and its series */
  OK(cf_mesh_resize(m, 0, 0, true));
  OK(cf_frame_write_mesh(c->folder.text, 5, &c->grid, m, &c->stamp)); /* nothing there yet */
  OK(cf_ply_write(case_path(c, "mesh_000005.ply").text, m, &c->stamp));
  OK(cf_frame_cut(c->folder.text, 3));
  assert_int_equal(files_in(c->folder.text), 1);
  cf_mesh_destroy(m);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test_setup_teardown(what_is_written_is_read, output_case_3d, output_case_end),
      cmocka_unit_test_setup_teardown(files_of_others_are_understood, output_case_3d, output_case_end),
      cmocka_unit_test_setup_teardown(both_byte_orders_are_read, output_case_3d, output_case_end),
      cmocka_unit_test_setup_teardown(mistakes_are_said, output_case_3d, output_case_end),
      cmocka_unit_test_setup_teardown(damaged_files_do_no_harm, output_case_3d, output_case_end),
      cmocka_unit_test_setup_teardown(a_frame_has_its_surface, output_case_3d, output_case_end),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
