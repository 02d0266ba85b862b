/* SPDX-License-Identifier: MIT
 *
 * Surfaces: closed and without crowded edges for every way to go through a cube, as large as they should be, with
 * normals that point outwards, the same for any number of threads; and their distances.
 *
 * also in single precision
 */
#include "grid/mesh.h"

#include <math.h>
#include <string.h>

#include "base/mem.h"
#include "base/rng.h"
#include "grid/isosurface.h"
#include "grid/sweep.h"
#include "testing.h"

#define PI 3.14159265358979323846

typedef struct sample {
  cf_grid grid;
  cf_cell f;
  cf_mesh *mesh;
} sample;

static sample make(const int n, const double h) {
  sample s;
  OK(cf_grid_init(&s.grid, 3, (int[3]){n, n, n}, h, (double[3]){-n * h / 2, -n * h / 2, 100}));
  OK(cf_cell_create(&s.f, &s.grid.box));
  OK(cf_mesh_create(&s.mesh));
  return s;
}

static void drop(sample *s) {
  cf_mesh_destroy(s->mesh);
  cf_cell_destroy(&s->f, &s->grid.box);
}

static double centre(const sample *s, const int a, const int i) {
  return s->grid.origin[a] + (i + 0.5) * s->grid.h;
}

/* Distance from the middle of the box. */
static double from_middle(const sample *s, const double x[3]) {
  const double up = x[2] - 100 - s->grid.box.n[2] * s->grid.h / 2;
  return sqrt(x[0] * x[0] + x[1] * x[1] + up * up);
}

static void fill_ball(const sample *s, const double radius) {
  const int n = s->grid.box.n[0];
  for (int k = 0; k < n; ++k)
    for (int j = 0; j < n; ++j)
      for (int i = 0; i < n; ++i) {
        const double x[3] = {centre(s, 0, i), centre(s, 1, j), centre(s, 2, k)};
        s->f.at[cf_box_at(&s->grid.box, i, j, k)] = (cf_real)(from_middle(s, x) - radius);
      }
}

static void fill_noise(const sample *s, const uint64_t seed) {
  const int n = s->grid.box.n[0];
  for (int k = 0; k < n; ++k)
    for (int j = 0; j < n; ++j)
      for (int i = 0; i < n; ++i) {
        const ptrdiff_t p = cf_box_at(&s->grid.box, i, j, k);
        s->f.at[p] = (cf_real)(cf_random(seed, 1, 0, (uint64_t)p) - 0.5);
      }
}

static cf_mesh_facts look(const cf_mesh *mesh) {
  cf_mesh_facts f;
  OK(cf_mesh_look(mesh, &f));
  return f;
}

static void is_closed(const cf_mesh *mesh) {
  const cf_mesh_facts f = look(mesh);
  assert_int_equal(f.open_edges, 0);
  assert_int_equal(f.crowded_edges, 0);
  assert_int_equal(f.turned_edges, 0);
  assert_int_equal(f.degenerate, 0);
  assert_true(f.volume > 0);
  OK(cf_mesh_check_closed(mesh));
}

/* Noise goes through cubes in every possible way. */
static void noise_has_a_closed_surface(void **state) {
  (void)state;
  sample s = make(16, 0.1);
  for (uint64_t seed = 0; seed < 12; ++seed)
    for (int below = 0; below < 2; ++below) {
      fill_noise(&s, seed);
      if (seed == 11) s.f.at[0] = 0; /* exactly at the level */
      OK(cf_isosurface_make(s.mesh, &s.grid, s.f, &(cf_isosurface){.below = below, .caps = true}));
      assert_true(s.mesh->triangles > 1000);
      is_closed(s.mesh);
    }
  drop(&s);
}

static void without_caps_the_surface_ends_at_walls_only(void **state) {
  (void)state;
  sample s = make(16, 0.1);
  fill_noise(&s, 3);
  OK(cf_isosurface_make(s.mesh, &s.grid, s.f, &(cf_isosurface){.level = 0.1}));
  const cf_mesh_facts f = look(s.mesh);
  assert_true(f.open_edges > 0);
  assert_int_equal(f.crowded_edges + f.turned_edges, 0);
  assert_int_equal(cf_mesh_check_closed(s.mesh), CF_BAD_ARGUMENT);
  assert_non_null(strstr(cf_status_sentence(), " open edges"));
  drop(&s);
}

static double ball_errors(const int n, double *normal_error) {
  const double radius = 0.3;
  sample s = make(n, 1.0 / n);
  fill_ball(&s, radius);
  OK(cf_isosurface_make(s.mesh, &s.grid, s.f, &(cf_isosurface){.below = true, .caps = true}));
  is_closed(s.mesh);
  const cf_mesh_facts f = look(s.mesh);
  assert_int_equal(f.euler, 2);
  *normal_error = 0;
  for (int64_t v = 0; v < s.mesh->vertices; ++v) {
    const double x[3] = {s.mesh->place[v][0], s.mesh->place[v][1], s.mesh->place[v][2] - 100 - 0.5};
    const double r = sqrt(x[0] * x[0] + x[1] * x[1] + x[2] * x[2]);
    for (int a = 0; a < 3; ++a)
      *normal_error = fmax(*normal_error, fabs((double)s.mesh->normal[v][a] - x[a] / r));
  }
  const double exact = 4 * PI / 3 * radius * radius * radius;
  CLOSE(f.area, 4 * PI * radius * radius, 0.02);
  drop(&s);
  return fabs(f.volume - exact) / exact;
}

static void a_ball_is_round_to_second_order(void **state) {
  (void)state;
  double normal_16, normal_32;
  const double e_16 = ball_errors(16, &normal_16), e_32 = ball_errors(32, &normal_32);
  BELOW(e_16, 0.03);
  BELOW(e_32 / e_16, 0.3);
  BELOW(normal_32, 0.01);
  BELOW(normal_32 / normal_16, 0.4);
}

static void caps_lie_on_the_walls(void **state) {
  (void)state;
  sample s = make(8, 0.5);
  for (ptrdiff_t p = 0; p < s.grid.box.size; ++p) s.f.at[p - s.grid.box.first] = 1;
  OK(cf_isosurface_make(s.mesh, &s.grid, s.f, &(cf_isosurface){.level = 0.5, .caps = true}));
  is_closed(s.mesh);
  const cf_mesh_facts f = look(s.mesh);
  for (int a = 0; a < 3; ++a) {
    CLOSE(f.low[a], s.grid.origin[a], 1e-5);
    CLOSE(f.high[a], s.grid.origin[a] + 4, 1e-5);
  }
  OK(cf_isosurface_make(s.mesh, &s.grid, s.f, &(cf_isosurface){.level = 2, .caps = true}));
  assert_int_equal(s.mesh->triangles + s.mesh->vertices, 0);
  drop(&s);
}

static void any_number_of_threads_makes_the_same_mesh(void **state) {
  (void)state;
  sample s = make(24, 0.1), other = s;
  fill_noise(&s, 5);
  OK(cf_mesh_create(&other.mesh));
  const cf_isosurface rule = {.level = 0.1, .caps = true, .low = {1, 2, 3}, .high = {20, 24, 23}};
  OK(cf_isosurface_make(s.mesh, &s.grid, s.f, &rule));
  OK(cf_mesh_sample(s.mesh, &s.grid, s.f, "f", "1"));
  for (int threads = 2; threads < 4; ++threads) {
    other.grid.threads = threads;
    OK(cf_isosurface_make(other.mesh, &other.grid, s.f, &rule));
    OK(cf_mesh_sample(other.mesh, &other.grid, s.f, "f", "1"));
    assert_int_equal(s.mesh->vertices, other.mesh->vertices);
    assert_int_equal(s.mesh->triangles, other.mesh->triangles);
    const size_t vertices = (size_t)s.mesh->vertices;
    assert_memory_equal(s.mesh->place, other.mesh->place, vertices * sizeof *s.mesh->place);
    assert_memory_equal(s.mesh->normal, other.mesh->normal, vertices * sizeof *s.mesh->normal);
    assert_memory_equal(s.mesh->corner, other.mesh->corner,
                        (size_t)s.mesh->triangles * sizeof *s.mesh->corner);
    assert_memory_equal(s.mesh->attribute[0].at, other.mesh->attribute[0].at, vertices * sizeof(cf_real));
  }
  cf_mesh_destroy(other.mesh);
  drop(&s);
}

/* Vertices lie on edges of the lattice, where the field is linear: it has the level there. */
static void sampled_values_are_the_level(void **state) {
  (void)state;
  sample s = make(12, 0.1);
  fill_ball(&s, 0.4);
  OK(cf_isosurface_make(s.mesh, &s.grid, s.f, &(cf_isosurface){.level = 0.01, .below = true}));
  OK(cf_mesh_sample(s.mesh, &s.grid, s.f, "f", "m"));
  for (int64_t v = 0; v < s.mesh->vertices; ++v) CLOSE(s.mesh->attribute[0].at[v], 0.01, 2e-4);
  assert_int_equal(cf_mesh_attribute_add(s.mesh, "f", "", NULL), CF_BAD_ARGUMENT);
  drop(&s);
}

/* The cosine between a corner's normal and its triangle's. */
static double cosine_at(const cf_mesh *m, const int64_t t, const int c) {
  double p[3][3], n[3], dot = 0, size = 0;
  for (int q = 0; q < 3; ++q)
    for (int a = 0; a < 3; ++a)
      p[q][a] = (double)m->place[m->corner[t][q]][a] - (double)m->place[m->corner[t][0]][a];
  for (int a = 0; a < 3; ++a) {
    n[a] = p[1][(a + 1) % 3] * p[2][(a + 2) % 3] - p[1][(a + 2) % 3] * p[2][(a + 1) % 3];
    dot += n[a] * (double)m->normal[m->corner[t][c]][a];
    size += n[a] * n[a];
  }
  return dot / sqrt(size);
}

/* Blobs and grooves of two or three cells. With central differences alone 3.8 % of the corners look away. */
static void normals_of_a_rough_surface_look_outwards(void **state) {
  (void)state;
  sample s = make(32, 1), other = make(32, 1);
  int64_t away = 0;
  fill_noise(&s, 5);
  for (int pass = 0; pass < 4; ++pass) {
    for (int k = 1; k < 31; ++k)
      for (int j = 1; j < 31; ++j)
        for (int i = 1; i < 31; ++i) {
          const ptrdiff_t p = cf_box_at(&s.grid.box, i, j, k);
          other.f.at[p] = s.f.at[p] / 2;
          for (int a = 0; a < 3; ++a)
            other.f.at[p] += (s.f.at[p + s.grid.box.stride[a]] + s.f.at[p - s.grid.box.stride[a]]) / 12;
        }
    const cf_cell kept = s.f;
    s.f = other.f;
    other.f = kept;
  }
  CF_PARALLEL_ROWS (&s.grid.box, 1, r)
    for (int i = 0; i < 32; ++i)
      s.f.at[cf_box_row(&s.grid.box, r) + i] =
          (cf_real)tanh(25 * (double)s.f.at[cf_box_row(&s.grid.box, r) + i]);
  OK(cf_isosurface_make(s.mesh, &s.grid, s.f, &(cf_isosurface){.below = true, .caps = false}));
  for (int64_t t = 0; t < s.mesh->triangles; ++t)
    for (int c = 0; c < 3; ++c) away += cosine_at(s.mesh, t, c) < 0;
  printf("%.4f of the corners look away\n", (double)away / (double)(3 * s.mesh->triangles));
  BELOW((double)away / (double)(3 * s.mesh->triangles), 0.025);
  drop(&s);
  drop(&other);
}

static void the_distance_of_a_ball_is_known(void **state) {
  (void)state;
  sample s = make(32, 1.0 / 32);
  cf_samples d;
  fill_ball(&s, 0.3);
  OK(cf_isosurface_make(s.mesh, &s.grid, s.f, &(cf_isosurface){.below = true, .caps = true}));
  OK(cf_mesh_distance(s.mesh, 0.04, 3, &d));
  for (int k = 0; k < d.n[2]; ++k)
    for (int j = 0; j < d.n[1]; ++j)
      for (int i = 0; i < d.n[0]; ++i) {
        const double x[3] = {d.place[0] + i * d.h, d.place[1] + j * d.h, d.place[2] + k * d.h};
        CLOSE(d.value[i + d.n[0] * (j + d.n[1] * k)], from_middle(&s, x) - 0.3, 0.004);
      }
  cf_samples_destroy(&d);
  drop(&s);
}

/* A cube whose faces go through lattice points and whose diagonals do so as well; and with a triangle missing. */
static void a_cube_on_the_lattice_has_an_inside(void **state) {
  (void)state;
  static const int face[6][4] = {{0, 2, 6, 4}, {1, 5, 7, 3}, {0, 4, 5, 1},
                                 {2, 3, 7, 6}, {0, 1, 3, 2}, {4, 6, 7, 5}};
  cf_mesh *m;
  OK(cf_mesh_create(&m));
  for (int missing = 0; missing < 2; ++missing) {
    OK(cf_mesh_resize(m, 8, 12 - missing, false));
    for (int c = 0; c < 8; ++c)
      for (int a = 0; a < 3; ++a) m->place[c][a] = (cf_real)(c >> a & 1);
    for (int t = 0; t < 12 - missing; ++t)
      for (int c = 0; c < 3; ++c) m->corner[t][2 - c] = face[t / 2][c == 0 ? 0 : c + t % 2];
    cf_samples d;
    OK(cf_mesh_distance(m, 0.125, 2, &d));
    if (missing == 0) is_closed(m);
    if (missing == 1) {
      assert_int_equal(cf_mesh_check_closed(m), CF_BAD_ARGUMENT);
      assert_string_equal(cf_status_sentence(), "the mesh is not closed: 3 open edges: fill its holes");
    }
    for (int k = 0; k < d.n[2]; ++k)
      for (int j = 0; j < d.n[1]; ++j)
        for (int i = 0; i < d.n[0]; ++i) {
          const double x[3] = {d.place[0] + i * d.h, d.place[1] + j * d.h, d.place[2] + k * d.h};
          double out = 0, in = -1;
          for (int a = 0; a < 3; ++a) {
            const double beyond = fabs(x[a] - 0.5) - 0.5;
            out += beyond > 0 ? beyond * beyond : 0;
            in = fmax(in, beyond);
          }
          const float found = d.value[i + d.n[0] * (j + d.n[1] * k)];
          const double exact = in < 0 ? in : sqrt(out);
          if (missing == 0) CLOSE(found, exact, 1e-6);
          if (missing == 1 && fabs(exact) > 1e-6) assert_true((found < 0) == (exact < 0));
        }
    cf_samples_destroy(&d);
  }
  cf_mesh_destroy(m);
}

static void mistakes_are_said(void **state) {
  (void)state;
  cf_grid plane;
  cf_mesh *m;
  cf_samples d;
  OK(cf_mesh_create(&m));
  OK(cf_grid_init(&plane, 2, (int[2]){4, 4}, 1, NULL));
  assert_int_equal(cf_isosurface_make(m, &plane, (cf_cell){0}, &(cf_isosurface){0}), CF_BAD_ARGUMENT);
  assert_int_equal(cf_mesh_check_closed(m), CF_BAD_ARGUMENT);
  assert_int_equal(cf_mesh_distance(m, 0.1, 1, &d), CF_BAD_ARGUMENT);
  OK(cf_mesh_resize(m, 3, 1, false));
  for (int c = 0; c < 3; ++c) m->corner[0][c] = c, m->place[c][c] = 1;
  assert_int_equal(cf_mesh_distance(m, 1e-5, 1, &d), CF_OVER_LIMIT);
  m->place[0][0] = (cf_real)NAN;
  m->place[1][0] = (cf_real)INFINITY;
  assert_int_equal(cf_mesh_distance(m, 0.1, 1, &d), CF_BAD_ARGUMENT);
  assert_int_equal(cf_mesh_resize(m, (int64_t)1 << 40, 1, false), CF_OVER_LIMIT);
  cf_mesh_destroy(m);
}

static void failing_memory_leaves_an_empty_mesh(void **state) {
  (void)state;
  sample s = make(8, 0.1);
  fill_noise(&s, 1);
  cf_status status = CF_NO_MEMORY;
  for (long n = 1; status != CF_OK; ++n) {
    cf_mem_fail_at(n);
    status = cf_isosurface_make(s.mesh, &s.grid, s.f, &(cf_isosurface){.caps = true});
    cf_mem_fail_at(0);
    assert_true(status == CF_OK || (status == CF_NO_MEMORY && s.mesh->triangles == 0));
  }
  status = CF_NO_MEMORY;
  for (long n = 1; status != CF_OK; ++n) {
    cf_samples d;
    cf_mem_fail_at(n);
    status = cf_mesh_distance(s.mesh, 0.1, 1, &d);
    cf_mem_fail_at(0);
    if (status == CF_OK) cf_samples_destroy(&d);
  }
  drop(&s);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(noise_has_a_closed_surface),
      cmocka_unit_test(without_caps_the_surface_ends_at_walls_only),
      cmocka_unit_test(a_ball_is_round_to_second_order),
      cmocka_unit_test(caps_lie_on_the_walls),
      cmocka_unit_test(any_number_of_threads_makes_the_same_mesh),
      cmocka_unit_test(sampled_values_are_the_level),
      cmocka_unit_test(normals_of_a_rough_surface_look_outwards),
      cmocka_unit_test(the_distance_of_a_ball_is_known),
      cmocka_unit_test(a_cube_on_the_lattice_has_an_inside),
      cmocka_unit_test(mistakes_are_said),
      cmocka_unit_test(failing_memory_leaves_an_empty_mesh),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
