/* SPDX-License-Identifier: MIT */
/* also in single precision */
#include "../physics/advect_flows.h"
#include "stencil/sample.h"

#define TOLERANCE (50 * (double)CF_REAL_EPSILON)

static double plane(const double x[3]) { return 1 + 2 * x[0] - x[1] + 0.5 * x[2]; }

/* A linear field, ghosts and all. */
static void fill(const cf_grid *g, const int component, cf_real *f) {
  const cf_box *b = &g->box;
  const int deep = b->dim == 3 ? 1 : 0;
  for (int k = -deep; k < b->n[2] + deep; ++k)
    for (int j = -1; j <= b->n[1]; ++j)
      for (int i = -1; i <= b->n[0]; ++i) {
        const double x[3] = {cf_grid_place(g, 0, i, component == 0), cf_grid_place(g, 1, j, component == 1),
                             b->dim == 3 ? cf_grid_place(g, 2, k, component == 2) : 0};
        f[cf_box_at(b, i, j, k)] = (cf_real)plane(x);
      }
}

static void sampling_reproduces_linear_fields(void **state) {
  (void)state;
  const int cells[3] = {7, 5, 6};
  const double origin[3] = {-0.3, 0.2, 0.1};
  for (int dim = 2; dim <= 3; ++dim) {
    cf_grid g;
    cf_cell f;
    cf_face u;
    OK(cf_grid_init(&g, dim, cells, 0.1, origin));
    OK(cf_cell_create(&f, &g.box));
    OK(cf_face_create(&u, &g.box));
    fill(&g, CF_CENTRES, f.at);
    for (int a = 0; a < dim; ++a) fill(&g, a, u.at[a]);
    for (int n = 0; n < 500; ++n) {
      double x[3] = {0}, inside[3] = {0};
      for (int a = 0; a < dim; ++a) { /* some outside: they count as the nearest point of the box */
        const double size = cells[a] * g.h, low = origin[a];
        x[a] = low + size * (1.4 * noise(n, a) - 0.2);
        inside[a] = fmin(fmax(x[a], low), low + size);
      }
      cf_real v[3];
      assert_true(fabs((double)cf_sample(&g, CF_CENTRES, f.at, x) - plane(inside)) < TOLERANCE);
      cf_sample_face(&g, u, x, v);
      for (int a = 0; a < dim; ++a) assert_true(fabs((double)v[a] - plane(inside)) < TOLERANCE);
    }
    cf_cell_destroy(&f, &g.box);
    cf_face_destroy(&u, &g.box);
  }
}

static void sampling_a_row_gives_what_the_points_give(void **state) {
  (void)state;
  const int cells[2] = {6, 6};
  scene s;
  scene_open(&s, 2, cells, walls_all(CF_WALL_OPEN));
  for (ptrdiff_t p = -s.grid.box.first; p < s.grid.box.size - s.grid.box.first; ++p)
    s.phi.at[p] = (cf_real)noise(p, 1);
  double x[9], y[9];
  cf_real row[9];
  for (int i = 0; i < 9; ++i) x[i] = noise(i, 2), y[i] = noise(i, 3);
  cf_sample_row(&s.grid, CF_CENTRES, s.phi.at, 9, (const double *const[3]){x, y, NULL}, row);
  for (int i = 0; i < 9; ++i)
    assert_true(row[i] == cf_sample(&s.grid, CF_CENTRES, s.phi.at, (const double[3]){x[i], y[i], 0}));
  scene_close(&s);
}

static void sampling_survives_any_point(void **state) {
  (void)state;
  const int cells[3] = {1, 2, 1};
  scene s;
  scene_open(&s, 3, cells, walls_all(CF_WALL_OPEN));
  const double odd[5] = {NAN, INFINITY, -INFINITY, 1e300, -1e-300};
  for (int i = 0; i < 5; ++i)
    for (int j = 0; j < 5; ++j) {
      const double x[3] = {odd[i], odd[j], odd[i]};
      for (int c = -1; c < 3; ++c) assert_true(cf_sample(&s.grid, c, c < 0 ? s.phi.at : s.u.at[c], x) == 0);
    }
  scene_close(&s);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(sampling_reproduces_linear_fields),
      cmocka_unit_test(sampling_a_row_gives_what_the_points_give),
      cmocka_unit_test(sampling_survives_any_point),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
