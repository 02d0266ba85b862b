/* SPDX-License-Identifier: MIT
 *
 * Ghost cells, against what each rule says cell by cell: any extents (1 included), widths up to 3, cells and
 * faces, every mix of rules, corners included; and the ghosts that put a value on a wall.
 */
#include "grid/halo.h"

#include "grid/wall.h"
#include "testing.h"

static uint64_t seed = 5;

static int pick(const int count) { return (int)(test_random(&seed) * count); }

static int inside(const cf_box *b, const int component, const int at[3]) {
  for (int a = 0; a < 3; ++a)
    if (at[a] < 0 || at[a] >= cf_box_extent(b, a, component)) return 0;
  return 1;
}

/* The index that a ghost's value comes from along one axis: -1 for zero, -2 for left alone. */
static int source(const cf_box *b, const cf_halo *h, const int component, const int a, const int i) {
  const int extent = cf_box_extent(b, a, component), n = b->n[a];
  const int low = i < 0, high = i >= extent, seam = a == component && i == n;
  if (a >= b->dim) return i;
  const cf_halo_rule rule = h->rule[a][low ? 0 : 1];
  if (!low && !high && !(seam && rule == CF_HALO_WRAP)) return i;
  if (rule == CF_HALO_NONE) return -2;
  if (rule == CF_HALO_ZERO) return -1;
  if (rule == CF_HALO_WRAP) return ((i % n) + n) % n;
  return low ? 0 : extent - 1;
}

static void every_ghost_follows_its_rule(void **state) {
  (void)state;
  for (int round = 0; round < 4000; ++round) {
    const int dim = 2 + pick(2), width = 1 + pick(3);
    int n[3];
    for (int a = 0; a < 3; ++a) n[a] = 1 + pick(6);
    cf_box b;
    OK(cf_box_init(&b, dim, n, 3));
    const int component = pick(dim + 1) - 1;
    cf_halo h = {0};
    for (int a = 0; a < dim; ++a) {
      const int wrap = pick(3) == 0;
      for (int side = 0; side < 2; ++side)
        h.rule[a][side] =
            wrap ? CF_HALO_WRAP : (const cf_halo_rule[]){CF_HALO_NONE, CF_HALO_COPY, CF_HALO_ZERO}[pick(3)];
    }
    cf_cell f, before;
    OK(cf_cell_create(&f, &b));
    OK(cf_cell_create(&before, &b));
    const int z = dim == 3 ? 3 : 0;
    int at[3], from[3];
    for (at[2] = -z; at[2] < b.n[2] + z; ++at[2])
      for (at[1] = -3; at[1] < b.n[1] + 3; ++at[1])
        for (at[0] = -3; at[0] < b.n[0] + 3; ++at[0])
          f.at[cf_box_at(&b, at[0], at[1], at[2])] = before.at[cf_box_at(&b, at[0], at[1], at[2])] =
              (cf_real)(1 + 13 * at[0] + 171 * at[1] + 2003 * at[2]) +
              (inside(&b, component, at) ? 0 : (cf_real)0.5);
    cf_halo_fill(&b, &h, width, component, f.at);
    const int w = dim == 3 ? width : 0;
    for (at[2] = -w; at[2] < b.n[2] + w; ++at[2])
      for (at[1] = -width; at[1] < b.n[1] + width; ++at[1])
        for (at[0] = -width; at[0] < b.n[0] + width; ++at[0]) {
          int alone = 0, zero = 0;
          for (int a = 0; a < 3; ++a) {
            from[a] = source(&b, &h, component, a, at[a]);
            alone |= from[a] == -2;
            zero |= from[a] == -1;
          }
          const double value = (double)f.at[cf_box_at(&b, at[0], at[1], at[2])];
          if (alone) continue; /* nothing is promised beyond a side that is left alone */
          CLOSE(value, zero ? 0 : (double)before.at[cf_box_at(&b, from[0], from[1], from[2])], 0);
        }
    /* what is inside stays, but for the seam of a wrapped face field */
    for (at[2] = 0; at[2] < b.n[2]; ++at[2])
      for (at[1] = 0; at[1] < b.n[1]; ++at[1])
        for (at[0] = 0; at[0] < b.n[0]; ++at[0])
          assert_true(f.at[cf_box_at(&b, at[0], at[1], at[2])] ==
                      before.at[cf_box_at(&b, at[0], at[1], at[2])]);
    cf_cell_destroy(&f, &b);
    cf_cell_destroy(&before, &b);
  }
}

/* Layers of more cells than one thread takes alone. */
static void threads_fill_the_same_ghosts(void **state) {
  (void)state;
  cf_box b;
  OK(cf_box_init(&b, 3, (int[3]){80, 70, 66}, 1));
  const size_t row = (size_t)(b.n[0] + 2) * sizeof(cf_real);
  cf_cell f[2];
  for (int way = 0; way < 2; ++way) {
    cf_halo h = {
        .rule = {{CF_HALO_WRAP, CF_HALO_WRAP}, {CF_HALO_COPY, CF_HALO_ZERO}, {CF_HALO_COPY, CF_HALO_COPY}},
        .threads = way == 0 ? 0 : 3};
    OK(cf_cell_create(&f[way], &b));
    for (ptrdiff_t r = 0; r < cf_box_rows(&b); ++r)
      for (int i = 0; i < b.n[0]; ++i) f[way].at[cf_box_row(&b, r) + i] = (cf_real)(1 + (r * 7 + i) % 1009);
    cf_halo_fill(&b, &h, 1, CF_CENTRES, f[way].at);
  }
  for (int k = -1; k <= b.n[2]; ++k)
    for (int j = -1; j <= b.n[1]; ++j)
      assert_memory_equal(f[0].at + cf_box_at(&b, -1, j, k), f[1].at + cf_box_at(&b, -1, j, k), row);
  for (int way = 0; way < 2; ++way) cf_cell_destroy(&f[way], &b);
}

static void a_side_left_alone_keeps_its_ghosts(void **state) {
  (void)state;
  cf_box b;
  OK(cf_box_init(&b, 2, (int[3]){4, 3, 1}, 2));
  cf_cell f;
  OK(cf_cell_create(&f, &b));
  f.at[-1] = 7;
  cf_halo h = {0};
  h.rule[1][0] = CF_HALO_COPY;
  cf_halo_fill(&b, &h, 2, CF_CENTRES, f.at);
  assert_true(f.at[-1] == 7);
  cf_cell_destroy(&f, &b);
}

static void width_zero_closes_the_seam_of_faces_only(void **state) {
  (void)state;
  cf_box b;
  OK(cf_box_init(&b, 2, (int[3]){4, 3, 1}, 1));
  cf_cell f;
  OK(cf_cell_create(&f, &b));
  for (int j = 0; j < 3; ++j)
    for (int i = 0; i <= 4; ++i) f.at[cf_box_at(&b, i, j, 0)] = (cf_real)(1 + i + 10 * j);
  f.at[-1] = 99;
  cf_halo h = {0};
  h.rule[0][0] = h.rule[0][1] = CF_HALO_WRAP;
  cf_halo_fill(&b, &h, 0, 0, f.at);
  for (int j = 0; j < 3; ++j) CLOSE(f.at[cf_box_at(&b, 4, j, 0)], 1 + 10 * j, 0);
  assert_true(f.at[-1] == 99);
  cf_cell_destroy(&f, &b);
}

static void rise(const void *context, int n, const double *x, const double *y, const double *z, double t,
                 double *out) {
  (void)context;
  for (int i = 0; i < n; ++i) out[i] = 1 + x[i] + 2 * y[i] + 4 * z[i] + 8 * t;
}

/* The mean of a cell and its ghost is the wall's value, at the place of the wall face and the sampled time. */
static void wall_ghosts_put_the_value_on_the_wall(void **state) {
  (void)state;
  for (int dim = 2; dim <= 3; ++dim) {
    cf_grid g;
    OK(cf_grid_init(&g, dim, (int[3]){4, 3, 5}, 0.25, (double[3]){1, -1, 2}));
    cf_walls walls = {0};
    for (int a = 0; a < dim; ++a) {
      walls.kind[a][0] = CF_WALL_VALUE;
      walls.kind[a][1] = a == 0 ? CF_WALL_OPEN : a == 1 ? CF_WALL_VALUE : CF_WALL_INSULATED;
      for (int side = 0; side < 2; ++side) walls.value[a][side] = (cf_fn){.eval = rise, .in_time = true};
    }
    cf_wall_values v;
    OK(cf_wall_values_create(&v, &g, &walls));
    cf_cell f;
    OK(cf_cell_create(&f, &g.box));
    for (ptrdiff_t r = 0; r < cf_box_rows(&g.box); ++r)
      for (int i = 0; i < g.box.n[0]; ++i) f.at[cf_box_row(&g.box, r) + i] = (cf_real)(3 + i * i + (int)r);
    for (int step = 0; step < 2; ++step) {
      const double t = 0.5 + step;
      cf_wall_values_sample(&v, t);
      cf_wall_ghosts(&v, f);
      for (int a = 0; a < dim; ++a)
        for (int side = 0; side < 2; ++side) {
          const cf_wall_side w = cf_wall_side_of(&g.box, a, side);
          for (int c = 0; c < w.n_c; ++c)
            for (int b = 0; b < w.n_b; ++b) {
              const ptrdiff_t p = cf_wall_cell(&g.box, &w, b, c);
              const double cell = (double)f.at[p], ghost = (double)f.at[p + w.outward];
              if (walls.kind[a][side] == CF_WALL_INSULATED) CLOSE(ghost, cell, 0);
              if (walls.kind[a][side] == CF_WALL_OPEN) CLOSE(ghost, -cell, 0);
              if (walls.kind[a][side] != CF_WALL_VALUE) continue;
              double place[3] = {0, 0, 0}, value;
              place[w.b] = cf_grid_place(&g, w.b, b, 0);
              if (dim == 3) place[w.c] = cf_grid_place(&g, w.c, c, 0);
              place[a] = g.origin[a] + (side ? g.box.n[a] : 0) * g.h;
              rise(NULL, 1, &place[0], &place[1], &place[2], t, &value);
              CLOSE((cell + ghost) / 2, value, 64 * CF_REAL_EPSILON);
            }
        }
    }
    cf_cell_destroy(&f, &g.box);
    cf_wall_values_destroy(&v);
    cf_wall_values_destroy(&v);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(every_ghost_follows_its_rule),
      cmocka_unit_test(threads_fill_the_same_ghosts),
      cmocka_unit_test(a_side_left_alone_keeps_its_ghosts),
      cmocka_unit_test(width_zero_closes_the_seam_of_faces_only),
      cmocka_unit_test(wall_ghosts_put_the_value_on_the_wall),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
/* also in single precision */
