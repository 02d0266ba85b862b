/* SPDX-License-Identifier: MIT
 *
 * The front filter: what it keeps, and what it does to the box profile in one dimension (k = tau = 1/4, F_T = 0, a
 * box of half-width 0.1 whose fronts travel 90 of 256 cells), moved by leapfrog with exact relaxation. Known
 * results for such a run: relative L1 .042 and .039 at c dt/h = .7 and .9, total variation 1.03 and 1.00, no
 * overshoot; unfiltered .097 and .068, total variation above 3. Exact values by the Riemann function:
 *   phi = e^{-at} { [f(x - ct) + f(x + ct)]/2 + a/(2c) int f(y) [I0(z) + a t I1(z)/z] dy },
 *   z = a sqrt(t^2 - (x - y)^2/c^2), a = 1/(2 tau).
 */
#include "../physics/advect_flows.h"
#include "stencil/front.h"

#define K_BOX 0.25
#define TAU   0.25
#define HALF  0.1

static double bessel_part(const double z, const double at) {
  double i0 = 1, i1 = 0.5, term0 = 1, term1 = 0.5; /* I0(z), I1(z)/z */
  for (int m = 1; m < 60; ++m) {
    term0 *= z * z / 4 / m / m;
    term1 *= z * z / 4 / m / (m + 1);
    i0 += term0, i1 += term1;
  }
  return i0 + at * i1;
}

static double box(const double x) { return fabs(x) < HALF ? 1 : 0; }

static double exact(const double x, const double t) {
  const double a = 1 / (2 * TAU), c = sqrt(K_BOX / TAU);
  const double low = fmax(-HALF, x - c * t), high = fmin(HALF, x + c * t);
  double sum = 0;
  const int n = 200;
  if (high > low)
    for (int i = 0; i < n; ++i) {
      const double y = low + (high - low) * (i + 0.5) / n;
      const double s = t * t - (x - y) * (x - y) / (c * c);
      sum += bessel_part(a * sqrt(fmax(s, 0)), a * t) * (high - low) / n;
    }
  return exp(-a * t) * ((box(x - c * t) + box(x + c * t)) / 2 + a / (2 * c) * sum);
}

typedef struct box_result {
  double l1, least, most, variation; /* most: above the exact maximum */
} box_result;

static box_result run_box(const double courant, const double weight) {
  const int n = 256;
  const double size = 1, t = 90.0 / 256;
  const int cells[2] = {n, 1};
  const double origin[2] = {-size / 2, 0};
  cf_grid g;
  cf_cell phi, work;
  cf_face q;
  OK(cf_grid_init(&g, 2, cells, size / n, origin));
  OK(cf_cell_create(&phi, &g.box));
  OK(cf_cell_create(&work, &g.box));
  OK(cf_face_create(&q, &g.box));
  const cf_walls walls = walls_all(CF_WALL_INSULATED);
  const double c = sqrt(K_BOX / TAU), nu = cf_front_strength(1, courant, weight);
  const int steps = (int)ceil(t * c / (courant * g.h));
  const double dt = t / steps;
  for (int i = 0; i < n; ++i) phi.at[i] = box(cf_grid_place(&g, 0, i, 0));
  for (int step = 0; step < steps; ++step) {
    const double e = exp(-(step == 0 ? dt / 2 : dt) / TAU);
    for (int i = 1; i < n; ++i)
      q.at[0][i] = e * q.at[0][i] - (1 - e) * K_BOX * (phi.at[i] - phi.at[i - 1]) / g.h;
    if (weight > 0) cf_front_face(&g, &walls, nu, q, work);
    for (int i = 0; i < n; ++i) phi.at[i] -= dt / g.h * (q.at[0][i + 1] - q.at[0][i]);
    if (weight > 0) cf_front_cell(&g, &walls, NULL, nu, phi, work);
  }
  box_result r = {0, 1, 0, 0};
  double all = 0, variation = 0, wrong = 0, top = 0;
  for (int i = 0; i < n; ++i) {
    const double x = cf_grid_place(&g, 0, i, 0), f = exact(x, t);
    wrong += fabs(phi.at[i] - f), all += fabs(f);
    r.least = fmin(r.least, phi.at[i]);
    r.most = fmax(r.most, phi.at[i]);
    top = fmax(top, f);
    if (i > 0) {
      r.variation += fabs(phi.at[i] - phi.at[i - 1]);
      variation += fabs(f - exact(cf_grid_place(&g, 0, i - 1, 0), t));
    }
  }
  r.l1 = wrong / all;
  r.most -= top;
  r.variation /= variation;
  cf_cell_destroy(&phi, &g.box);
  cf_cell_destroy(&work, &g.box);
  cf_face_destroy(&q, &g.box);
  return r;
}

static void front_filter_takes_the_ringing_out_of_a_box(void **state) {
  (void)state;
  const double courant[2] = {0.7, 0.9}, known[2] = {0.042, 0.039};
  for (int i = 0; i < 2; ++i) {
    const box_result with = run_box(courant[i], 0.5), without = run_box(courant[i], 0);
    print_message("c dt/h = %g: L1 %.4f, variation %.3f, below %.1e, above %.1e; plain %.4f, %.2f\n",
                  courant[i], with.l1, with.variation, with.least, with.most, without.l1, without.variation);
    assert_true(fabs(with.l1 - known[i]) < 0.1 * known[i]);
    assert_true(with.variation < 1.03);
    assert_true(with.least > -1e-12);
    assert_true(with.most < 1e-3);
    assert_true(without.l1 > 2 * with.l1 && without.variation > 3);
  }
}

/* --- what it keeps ------------------------------------------------------------------------------------ */

static void fill_noise(const cf_box *b, const int component, cf_real *f, const int64_t stream) {
  for (int k = 0; k < cf_box_extent(b, 2, component); ++k)
    for (int j = 0; j < cf_box_extent(b, 1, component); ++j)
      for (int i = 0; i < cf_box_extent(b, 0, component); ++i)
        f[cf_box_at(b, i, j, k)] = noise((k * 1009 + j) * 1009 + i, stream) < 0.5 ? 0 : 1;
}

static void front_filter_keeps_sums_and_bounds(void **state) {
  (void)state;
  const int cells[2][3] = {{33, 26, 1}, {14, 11, 9}};
  for (int dim = 2; dim <= 3; ++dim)
    for (int kind = CF_WALL_INSULATED; kind <= CF_WALL_PERIODIC; ++kind) {
      scene s;
      cf_cell work;
      scene_open(&s, dim, cells[dim - 2], walls_all((cf_wall)kind));
      OK(cf_cell_create(&work, &s.grid.box));
      fill_noise(&s.grid.box, CF_CENTRES, s.phi.at, kind);
      const cf_range before = range_of(&s);
      double spread = 0;
      for (int pass = 0; pass < 5; ++pass) {
        cf_front_cell(&s.grid, &s.walls, NULL, cf_front_strength(dim, 2, 1), s.phi, work);
        const cf_range now = range_of(&s);
        assert_true(fabs(now.sum - before.sum) < 1e-12 * before.sum);
        assert_true(now.min > -1e-14 && now.max < 1 + 1e-14);
        spread = now.max - now.min;
      }
      assert_true(spread < 0.95); /* and it did something */
      cf_cell_destroy(&work, &s.grid.box);
      scene_close(&s);
    }
}

static void front_filter_treats_faces_like_cells_where_they_wrap(void **state) {
  (void)state;
  const int cells[3] = {9, 7, 8};
  scene s;
  cf_cell work;
  scene_open(&s, 3, cells, walls_all(CF_WALL_PERIODIC));
  const cf_box *b = &s.grid.box;
  OK(cf_cell_create(&work, b));
  fill_noise(b, CF_CENTRES, s.phi.at, 3);
  for (int a = 0; a < 3; ++a)
    for (ptrdiff_t r = 0; r < cf_box_rows(b); ++r)
      for (int i = 0; i < b->n[0]; ++i) s.u.at[a][cf_box_row(b, r) + i] = s.phi.at[cf_box_row(b, r) + i];
  cf_front_cell(&s.grid, &s.walls, NULL, 0.1, s.phi, work);
  cf_front_face(&s.grid, &s.walls, 0.1, s.u, work);
  for (int a = 0; a < 3; ++a) {
    for (ptrdiff_t r = 0; r < cf_box_rows(b); ++r)
      assert_memory_equal(s.u.at[a] + cf_box_row(b, r), s.phi.at + cf_box_row(b, r),
                          (size_t)b->n[0] * sizeof(cf_real));
    assert_true(s.u.at[a][b->n[a] * b->stride[a]] == s.u.at[a][0]);
  }
  cf_cell_destroy(&work, b);
  scene_close(&s);
}

/* An odd and an even extension across closed walls are what a box twice as large would hold. */
static void front_filter_keeps_closed_walls_closed(void **state) {
  (void)state;
  const int cells[2] = {12, 10}, twice[2] = {24, 10};
  scene half, whole;
  cf_cell work_half, work_whole;
  scene_open(&half, 2, cells, walls_all(CF_WALL_INSULATED));
  scene_open(&whole, 2, twice, walls_all(CF_WALL_PERIODIC));
  whole.walls.kind[1][0] = whole.walls.kind[1][1] = CF_WALL_INSULATED;
  OK(cf_cell_create(&work_half, &half.grid.box));
  OK(cf_cell_create(&work_whole, &whole.grid.box));
  for (int j = 0; j < 10; ++j)
    for (int i = 0; i < 24; ++i) {
      const ptrdiff_t p = cf_box_at(&whole.grid.box, i, j, 0);
      const int image = i <= 12 ? i : 24 - i;
      const double v = image == 0 || image == 12 ? 0 : noise(image + 100 * j, 1);
      whole.u.at[0][p] = i <= 12 ? v : -v;
      if (i <= 12) half.u.at[0][cf_box_at(&half.grid.box, i, j, 0)] = v;
    }
  cf_front_face(&half.grid, &half.walls, 0.2, half.u, work_half);
  cf_front_face(&whole.grid, &whole.walls, 0.2, whole.u, work_whole);
  for (int j = 0; j < 10; ++j)
    for (int i = 0; i <= 12; ++i)
      assert_true(half.u.at[0][cf_box_at(&half.grid.box, i, j, 0)] ==
                  whole.u.at[0][cf_box_at(&whole.grid.box, i, j, 0)]);
  assert_true(half.u.at[0][0] == 0 && half.u.at[0][12] == 0);
  cf_cell_destroy(&work_half, &half.grid.box);
  cf_cell_destroy(&work_whole, &whole.grid.box);
  scene_close(&half);
  scene_close(&whole);
}

static double wavy(const double x[3]) { return sin(2 * PI * x[0] + 1) + 0.5 * sin(4 * PI * x[1]); }

static double change_of_smooth(const int n) {
  const int cells[2] = {n, n};
  scene s;
  cf_cell work;
  scene_open(&s, 2, cells, walls_all(CF_WALL_PERIODIC));
  OK(cf_cell_create(&work, &s.grid.box));
  set_cells(&s, wavy);
  cf_front_cell(&s.grid, &s.walls, NULL, 0.25, s.phi, work);
  const double change = error_against(&s, wavy);
  cf_cell_destroy(&work, &s.grid.box);
  scene_close(&s);
  return change;
}

static void front_filter_lets_smooth_fields_be(void **state) {
  (void)state;
  const double coarse = change_of_smooth(32), fine = change_of_smooth(64);
  print_message("smooth: %.2e %.2e, order %.2f\n", coarse, fine, log2(coarse / fine));
  assert_true(fine < 1e-3);
  assert_true(log2(coarse / fine) > 2.5);
}

static void front_filter_gives_the_same_bits_for_any_number_of_threads(void **state) {
  (void)state;
  const int cells[2] = {301, 77};
  cf_cell phi[3], work;
  cf_grid g;
  const cf_walls walls = walls_all(CF_WALL_OPEN);
  for (int threads = 1; threads <= 3; ++threads) {
    OK(cf_grid_init(&g, 2, cells, 0.1, NULL));
    g.threads = threads;
    OK(cf_cell_create(&phi[threads - 1], &g.box));
    OK(cf_cell_create(&work, &g.box));
    fill_noise(&g.box, CF_CENTRES, phi[threads - 1].at, 8);
    for (int pass = 0; pass < 3; ++pass) cf_front_cell(&g, &walls, NULL, 0.2, phi[threads - 1], work);
    cf_cell_destroy(&work, &g.box);
    for (int j = 0; j < 77; ++j)
      assert_memory_equal(phi[0].at + j * g.box.stride[1], phi[threads - 1].at + j * g.box.stride[1],
                          301 * sizeof(cf_real));
  }
  for (int i = 0; i < 3; ++i) cf_cell_destroy(&phi[i], &g.box);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(front_filter_takes_the_ringing_out_of_a_box),
      cmocka_unit_test(front_filter_keeps_sums_and_bounds),
      cmocka_unit_test(front_filter_treats_faces_like_cells_where_they_wrap),
      cmocka_unit_test(front_filter_keeps_closed_walls_closed),
      cmocka_unit_test(front_filter_lets_smooth_fields_be),
      cmocka_unit_test(front_filter_gives_the_same_bits_for_any_number_of_threads),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
