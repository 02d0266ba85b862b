/* SPDX-License-Identifier: MIT
 *
 * The solver on a part of the box: random regions against Gaussian elimination, iterations around obstacles, pockets,
 * and tiles.
 */
#include <math.h>
#include <string.h>

#include "elimination.h"
#include "grid/region.h"
#include "solve/helmholtz.h"
#include "testing.h"

static uint64_t seed = 11;

static int pick(const int count) { return (int)(test_random(&seed) * count); }

/* --- small systems ---------------------------------------------------------------------------------------- */

typedef struct small {
  cf_grid g;
  cf_walls walls;
  cf_helmholtz *A;
  cf_region *region;
  cf_cell x, b, alpha;
  cf_face beta;
  bool alpha_varies, beta_varies;
  double alpha_number, beta_number;
  int cells;
} small;

static void small_begin(small *s) {
  const int dim = 2 + pick(2);
  int n[3];
  for (int a = 0; a < 3; ++a) n[a] = 1 + pick(6);
  *s = (small){0};
  OK(cf_grid_init(&s->g, dim, n, 0.3 + test_random(&seed), NULL));
  s->cells = (int)cf_box_cells(&s->g.box);
  for (int a = 0; a < dim; ++a) {
    const cf_wall kinds[] = {CF_WALL_INSULATED, CF_WALL_OPEN, CF_WALL_VALUE};
    const int periodic = pick(3) == 0;
    for (int side = 0; side < 2; ++side)
      s->walls.kind[a][side] = periodic ? CF_WALL_PERIODIC : kinds[pick(3)];
  }
  OK(cf_helmholtz_create(&s->A, &s->g, &s->walls, pick(2)));
  OK(cf_region_create(&s->region, &s->g));
  OK(cf_cell_create(&s->x, &s->g.box));
  OK(cf_cell_create(&s->b, &s->g.box));
  OK(cf_cell_create(&s->alpha, &s->g.box));
  OK(cf_face_create(&s->beta, &s->g.box));
}

static void small_end(small *s) {
  cf_helmholtz_destroy(s->A);
  cf_region_destroy(s->region);
  cf_cell_destroy(&s->x, &s->g.box);
  cf_cell_destroy(&s->b, &s->g.box);
  cf_cell_destroy(&s->alpha, &s->g.box);
  cf_face_destroy(&s->beta, &s->g.box);
}

static void random_problem(small *s) {
  const double solid = 0.5 * test_random(&seed), known = pick(2) ? 0.2 : 0;
  s->alpha_number = pick(3) == 0 ? 0 : pow(10, 3 * test_random(&seed) - 2);
  s->beta_number = pow(10, 2 * test_random(&seed) - 1);
  s->alpha_varies = pick(2);
  s->beta_varies = pick(2);
  const double spread = pick(2) ? 1 : 3; /* of beta, in decades: different along different axes */
  for (int c = 0; c < s->cells; ++c) {
    const ptrdiff_t p = cell_index(&s->g.box, c);
    int at[3];
    cell_place(&s->g.box, c, at);
    const double u = test_random(&seed);
    s->region->kind[p] = u < solid                 ? CF_CELL_WALL
                         : u < solid + known       ? CF_CELL_HELD
                         : u < solid + 1.2 * known ? CF_CELL_OUTSIDE
                                                   : CF_CELL_INSIDE;
    s->region->value.at[p] = (cf_real)(2 * test_random(&seed) - 1);
    s->alpha.at[p] = (cf_real)(s->alpha_number * (0.2 + test_random(&seed)));
    s->b.at[p] = (cf_real)(2 * test_random(&seed) - 1);
    s->x.at[p] = (cf_real)test_random(&seed);
    for (int a = 0; a < s->g.box.dim; ++a) {
      const double scale = a == 1 ? pow(10, spread - 1) : 1;
      s->beta.at[a][p] = (cf_real)(scale * pow(10, 2 * test_random(&seed) - 1));
      if (at[a] == s->g.box.n[a] - 1)
        s->beta.at[a][p + s->g.box.stride[a]] =
            s->walls.kind[a][0] == CF_WALL_PERIODIC
                ? s->beta.at[a][p - (s->g.box.n[a] - 1) * s->g.box.stride[a]]
                : (cf_real)(scale * pow(10, 2 * test_random(&seed) - 1));
    }
  }
  OK(cf_region_update(s->region));
  cf_coefficients c = {.alpha = s->alpha_number, .beta = s->beta_number, .region = s->region};
  if (s->alpha_varies) c.alpha_at = &s->alpha;
  if (s->beta_varies) c.beta_at = &s->beta;
  OK(cf_helmholtz_set(s->A, &c));
}

/* One face of cell c, which is inside: from the definition. */
static void assemble_face(const small *s, const int c, const int a, const int high, double *held) {
  int at[3];
  cell_place(&s->g.box, c, at);
  const ptrdiff_t p = cell_index(&s->g.box, c);
  const int n = s->g.box.n[a];
  const double h2 = s->g.h * s->g.h;
  const double beta =
      (s->beta_varies ? (double)s->beta.at[a][high ? p + s->g.box.stride[a] : p] : s->beta_number) / h2;
  at[a] += high ? 1 : -1;
  if (at[a] < 0 || at[a] >= n) {
    if (s->walls.kind[a][0] != CF_WALL_PERIODIC) {
      if (cf_wall_is_held(s->walls.kind[a][high])) matrix[c][c] += 2 * beta;
      return;
    }
    if (n == 1) return;
    at[a] = (at[a] + n) % n;
  }
  const int other = at[0] + s->g.box.n[0] * (at[1] + s->g.box.n[1] * at[2]);
  const ptrdiff_t q = cell_index(&s->g.box, other);
  switch (cf_region_kind(s->region, q)) {
    case CF_CELL_INSIDE:
      matrix[c][c] += beta;
      matrix[c][other] -= beta;
      return;
    case CF_CELL_HELD:
      *held += 2 * beta * (double)s->region->value.at[q];
      matrix[c][c] += 2 * beta;
      return;
    case CF_CELL_OUTSIDE:
      matrix[c][c] += 2 * beta;
      return;
    default:
      return;
  }
}

static void assemble(const small *s, double *held) {
  memset(matrix, 0, sizeof matrix);
  for (int c = 0; c < s->cells; ++c) {
    const ptrdiff_t p = cell_index(&s->g.box, c);
    held[c] = 0;
    if (cf_region_kind(s->region, p) != CF_CELL_INSIDE) {
      matrix[c][c] = 1;
      continue;
    }
    matrix[c][c] += s->alpha_varies ? (double)s->alpha.at[p] : s->alpha_number;
    for (int a = 0; a < s->g.box.dim; ++a)
      for (int high = 0; high < 2; ++high) assemble_face(s, c, a, high, &held[c]);
  }
}

static void random_regions_match_elimination(void **state) {
  (void)state;
  static double held[MOST], b[MOST], x[MOST];
  int compared = 0, most = 0;
  for (int round = 0; round < 1500; ++round) {
    small s;
    small_begin(&s);
    random_problem(&s);
    assemble(&s, held);
    for (int c = 0; c < s.cells; ++c) {
      const bool inside = cf_region_kind(s.region, cell_index(&s.g.box, c)) == CF_CELL_INSIDE;
      b[c] = inside ? (double)s.b.at[cell_index(&s.g.box, c)] + held[c]
                    : (double)s.x.at[cell_index(&s.g.box, c)];
    }
    if (eliminate(s.cells, b, x)) {
      cf_solve_report report;
      cf_helmholtz_add_held(s.A, s.b);
      OK(cf_helmholtz_solve(s.A, s.b, &(cf_solve_options){1e-13, 200}, s.x, &report));
      double size = 1e-3;
      for (int c = 0; c < s.cells; ++c) size = fmax(size, fabs(x[c]));
      for (int c = 0; c < s.cells; ++c)
        CLOSE((double)s.x.at[cell_index(&s.g.box, c)] / size, x[c] / size, 1e-7);
      ++compared;
      most = report.iterations > most ? report.iterations : most;
    }
    small_end(&s);
  }
  print_message("%d systems compared, at most %d iterations to 1e-13\n", compared, most);
  assert_true(compared > 700);
  assert_true(most <= 100); /* seams of odd axes and couplings a thousand times apart, to the last digit */
}

/* --- obstacles -------------------------------------------------------------------------------------------- */

typedef struct scene {
  cf_grid g;
  cf_helmholtz *A;
  cf_region *region;
  cf_tiles *tiles;
  cf_cell x, b;
} scene;

static void scene_begin(scene *s, const int dim, const int n, const int nz) {
  *s = (scene){0};
  OK(cf_grid_init(&s->g, dim, (int[]){n, n, nz}, 1.0 / n, NULL));
  s->g.threads = 2;
  OK(cf_helmholtz_create(&s->A, &s->g, &(cf_walls){0}, 0));
  OK(cf_cell_create(&s->x, &s->g.box));
  OK(cf_cell_create(&s->b, &s->g.box));
  OK(cf_region_create(&s->region, &s->g));
}

static void scene_end(scene *s) {
  cf_helmholtz_destroy(s->A);
  cf_region_destroy(s->region);
  cf_tiles_destroy(s->tiles);
  cf_cell_destroy(&s->x, &s->g.box);
  cf_cell_destroy(&s->b, &s->g.box);
}

/* A blob and a little noise. */
static void fill_side(const scene *s) {
  uint64_t noise = 5;
  const cf_box *box = &s->g.box;
  for (int k = 0; k < box->n[2]; ++k)
    for (int j = 0; j < box->n[1]; ++j)
      for (int i = 0; i < box->n[0]; ++i) {
        double r2 = 0;
        for (int a = 0; a < box->dim; ++a) {
          const double d = cf_grid_place(&s->g, a, a == 0 ? i : a == 1 ? j : k, 0) - 0.3;
          r2 += d * d;
        }
        s->b.at[cf_box_at(box, i, j, k)] = (cf_real)(exp(-30 * r2) + 0.1 * (2 * test_random(&noise) - 1));
        s->x.at[cf_box_at(box, i, j, k)] = 0;
      }
}

/* Iterations to a true residual of 1e-6 for this sigma; infinite: Poisson. */
static int iterations(scene *s, const double sigma, const char *what) {
  const double beta = isinf(sigma) ? 1 : sigma * s->g.h * s->g.h;
  OK(cf_region_update(s->region));
  OK(cf_helmholtz_set(s->A,
                      &(cf_coefficients){.alpha = isinf(sigma) ? 0 : 1, .beta = beta, .region = s->region}));
  fill_side(s);
  cf_solve_report report;
  OK(cf_helmholtz_solve(s->A, s->b, &(cf_solve_options){1e-6, 100}, s->x, &report));
  BELOW(cf_helmholtz_residual(s->A, s->x, s->b), 1.001e-6);
  assert_true(report.converged);
  print_message("%s, %d^%d, sigma %g: %d iterations, %d pockets\n", what, s->g.box.n[0], s->g.box.dim, sigma,
                report.iterations, report.pockets);
  return report.iterations;
}

static const double sigmas[] = {16, 1e3, INFINITY};

static void a_ball_costs_little(void **state) {
  (void)state;
  for (int dim = 2; dim <= 3; ++dim)
    for (int kind = 0; kind < 4; ++kind) {
      if (kind == CF_CELL_INSIDE) continue;
      scene s;
      scene_begin(&s, dim, dim == 2 ? 192 : 48, 48);
      const cf_shape ball = cf_shape_sphere((double[]){0.47, 0.53, dim == 3 ? 0.5 : 0}, 0.23);
      OK(cf_region_add(s.region, &ball, NULL, 0, (cf_cell_kind)kind, NULL));
      const int most[] = {4, 5, 6};
      for (int q = 0; q < 3; ++q) BELOW(iterations(&s, sigmas[q], "ball"), most[q]);
      scene_end(&s);
    }
}

/* Nothing fixes the level around a ball in an insulated box: x keeps the mean it came with, whatever mean b has, and cells
 * that have no equation keep what is in them. */
static void a_pocket_keeps_its_mean_and_walls_their_values(void **state) {
  (void)state;
  scene s;
  scene_begin(&s, 3, 48, 48);
  const cf_box *box = &s.g.box;
  const cf_shape ball = cf_shape_sphere((double[]){0.47, 0.53, 0.5}, 0.23);
  OK(cf_region_add(s.region, &ball, NULL, 0, CF_CELL_WALL, NULL));
  OK(cf_region_update(s.region));
  OK(cf_helmholtz_set(s.A, &(cf_coefficients){.alpha = 0, .beta = 1, .region = s.region}));
  fill_side(&s);
  for (int c = 0; c < 48 * 48 * 48; ++c) {
    const ptrdiff_t p = cell_index(box, c);
    s.x.at[p] = s.region->kind[p] == CF_CELL_INSIDE ? 3 : 7;
  }
  cf_solve_report report;
  OK(cf_helmholtz_solve(s.A, s.b, &(cf_solve_options){1e-6, 100}, s.x, &report));
  assert_true(report.converged && report.pockets == 1);
  double sum = 0;
  for (int c = 0; c < 48 * 48 * 48; ++c) {
    const ptrdiff_t p = cell_index(box, c);
    if (s.region->kind[p] == CF_CELL_INSIDE)
      sum += (double)s.x.at[p];
    else
      assert_true(s.x.at[p] == 7);
  }
  BELOW(fabs(sum / (double)s.region->inside - 3), 1e-6);
  scene_end(&s);
}

/* Plates that leave a gap at one side and the other in turn, one or two cells thick, wherever they lie. */
static void slalom(const scene *s, const int plates, const int thickness) {
  const cf_box *b = &s->g.box;
  for (int k = 0; k < b->n[2]; ++k)
    for (int j = 0; j < b->n[1]; ++j)
      for (int v = 1; v <= plates; ++v)
        for (int t = 0; t < thickness; ++t) {
          const double y = (j + 0.5) / b->n[1];
          if (v % 2 ? y < 0.75 : y > 0.25)
            s->region->kind[cf_box_at(b, v * b->n[0] / (plates + 1) + t, j, k)] = CF_CELL_WALL;
        }
}

static void a_slalom_of_plates_costs_little(void **state) {
  (void)state;
  for (int dim = 2; dim <= 3; ++dim)
    for (int plates = 2; plates <= 4; ++plates)
      for (int thickness = 1; thickness <= 2; ++thickness) {
        scene s;
        scene_begin(&s, dim, dim == 2 ? 96 : 48, 40);
        slalom(&s, plates, thickness);
        const int most[] = {dim == 2 ? 4 : 3, dim == 2 ? 6 : 5, dim == 2 ? 8 : 7};
        for (int q = 0; q < 3; ++q) BELOW(iterations(&s, sigmas[q], "slalom"), most[q]);
        scene_end(&s);
      }
}

static void a_porous_block_takes_few_iterations(void **state) {
  (void)state;
  for (int grain = 1; grain <= 4; grain *= 2) {
    scene s;
    scene_begin(&s, 3, 48, 48);
    for (int k = 0; k < 48; k += grain)
      for (int j = 0; j < 48; j += grain)
        for (int i = 0; i < 48; i += grain) {
          if (test_random(&seed) > 0.3) continue;
          for (int c = 0; c < grain * grain * grain; ++c)
            s.region->kind[cf_box_at(&s.g.box, i + c % grain, j + c / grain % grain, k + c / grain / grain)] =
                CF_CELL_WALL;
        }
    /* grains of a single cell leave necks that no coarse cell knows of, and many pockets that little alpha fixes */
    const int most[][3] = {{6, 12, 10}, {4, 6, 6}, {3, 5, 6}}, *of_grain = most[grain / 2];
    for (int q = 0; q < 3; ++q) BELOW(iterations(&s, sigmas[q], "porous"), of_grain[q]);
    scene_end(&s);
  }
}

/* --- the fast path ---------------------------------------------------------------------------------------- */

/* Kinds in random grains; walls of any kind. */
static void random_grains(cf_region *r, const int grain, const double solid, const double known) {
  const cf_box *b = &r->grid.box;
  unsigned char kind[40 * 40 * 40];
  for (int q = 0; q < 40 * 40 * 40; ++q) {
    const double u = test_random(&seed);
    kind[q] = u < solid ? CF_CELL_WALL : u < solid + known ? CF_CELL_HELD : CF_CELL_INSIDE;
    if (u >= solid && u < solid + known / 3) kind[q] = CF_CELL_OUTSIDE;
  }
  for (int k = 0; k < b->n[2]; ++k)
    for (int j = 0; j < b->n[1]; ++j)
      for (int i = 0; i < b->n[0]; ++i)
        r->kind[cf_box_at(b, i, j, k)] = kind[i / grain + 40 * (j / grain) + 1600 * (k / grain)];
  OK(cf_region_update(r));
}

/* The residual is formed afresh, by the operator of the other path. */
static void the_fast_path_solves_in_regions(void **state) {
  (void)state;
  int fast = 0;
  for (int round = 0; round < 60; ++round) {
    const int dim = 2 + round % 2, most = dim == 2 ? 70 : 22;
    int n[3];
    for (int a = 0; a < 3; ++a) n[a] = 14 + pick(most - 14);
    cf_grid g;
    cf_walls walls = {0};
    OK(cf_grid_init(&g, dim, n, 0.1, NULL));
    for (int a = 0; a < dim; ++a)
      for (int side = 0; side < 2; ++side)
        walls.kind[a][side] = round % 5 == a ? CF_WALL_PERIODIC
                              : pick(3) == 0 ? CF_WALL_VALUE
                                             : CF_WALL_INSULATED;
    cf_helmholtz *A;
    cf_region *region;
    cf_cell x, b;
    OK(cf_helmholtz_create(&A, &g, &walls, 0));
    OK(cf_region_create(&region, &g));
    OK(cf_cell_create(&x, &g.box));
    OK(cf_cell_create(&b, &g.box));
    random_grains(region, 3 + pick(6), 0.4 * test_random(&seed), pick(2) ? 0.1 : 0);
    for (ptrdiff_t row = 0; row < cf_box_rows(&g.box); ++row)
      for (int i = 0; i < n[0]; ++i)
        b.at[cf_box_row(&g.box, row) + i] = region->kind[cf_box_row(&g.box, row) + i] == CF_CELL_INSIDE
                                                ? (cf_real)(test_random(&seed) - 0.5)
                                                : (cf_real)NAN;
    const double sigma = pow(10, 4 * test_random(&seed) - 1);
    OK(cf_helmholtz_set(A, &(cf_coefficients){.alpha = 1, .beta = sigma * 0.01, .region = region}));
    cf_solve_report report;
    OK(cf_helmholtz_solve(A, b, &(cf_solve_options){1e-10, 200}, x, &report));
    assert_true(report.converged);
    BELOW(cf_helmholtz_residual(A, x, b), 1.001e-10);
    fast += strcmp(report.method, "multigrid-pcg") != 0 && strcmp(report.method, "pcg") != 0;
    cf_helmholtz_destroy(A);
    cf_region_destroy(region);
    cf_cell_destroy(&x, &g.box);
    cf_cell_destroy(&b, &g.box);
  }
  print_message("%d of 60 without conjugate gradients\n", fast);
  assert_true(fast > 30);
}

/* A source and a sink beside a ball, next to nothing everywhere else: what a few rows show of b is no measure of it. */
static void a_right_side_in_few_cells_is_solved_for(void **state) {
  (void)state;
  scene s;
  scene_begin(&s, 3, 48, 48);
  const cf_shape ball = cf_shape_sphere((double[]){24 * s.g.h, 24 * s.g.h, 24 * s.g.h}, 8 * s.g.h);
  OK(cf_region_add(s.region, &ball, NULL, 0, CF_CELL_WALL, NULL));
  OK(cf_region_update(s.region));
  OK(cf_helmholtz_set(s.A, &(cf_coefficients){.beta = 1, .region = s.region}));
  for (ptrdiff_t row = 0; row < cf_box_rows(&s.g.box); ++row)
    for (int i = 0; i < 48; ++i) {
      const ptrdiff_t p = cf_box_row(&s.g.box, row) + i;
      s.x.at[p] = 0, s.b.at[p] = (cf_real)1e-25;
    }
  s.b.at[cf_box_at(&s.g.box, 14, 24, 24)] = 400;
  s.b.at[cf_box_at(&s.g.box, 34, 24, 24)] = -400;
  cf_solve_report report;
  OK(cf_helmholtz_solve(s.A, s.b, &(cf_solve_options){1e-6, 50}, s.x, &report));
  assert_true(report.converged && report.iterations <= 10);
  BELOW(cf_helmholtz_residual(s.A, s.x, s.b), 1.001e-6);
  scene_end(&s);
}

/* One thread and two; and a region that has changed is another equation. */
static void bits_do_not_depend_on_threads(void **state) {
  (void)state;
  scene s[2];
  for (int v = 0; v < 2; ++v) {
    scene_begin(&s[v], 3, 48, 48);
    if (v == 0) {
      cf_helmholtz_destroy(s[v].A);
      s[v].g.threads = 1;
      OK(cf_helmholtz_create(&s[v].A, &s[v].g, &(cf_walls){0}, 0));
    }
    slalom(&s[v], 2, 1);
  }
  for (int change = 0; change < 2; ++change) {
    for (int v = 0; v < 2; ++v) {
      if (change) s[v].region->kind[cf_box_at(&s[v].g.box, 9, 30, 20)] = CF_CELL_WALL;
      iterations(&s[v], 100, "slalom");
    }
    for (ptrdiff_t row = 0; row < cf_box_rows(&s[0].g.box); ++row)
      assert_memory_equal(s[0].x.at + cf_box_row(&s[0].g.box, row), s[1].x.at + cf_box_row(&s[1].g.box, row),
                          48 * sizeof(cf_real));
  }
  for (int v = 0; v < 2; ++v) scene_end(&s[v]);
}

/* --- tiles ------------------------------------------------------------------------------------------------ */

static void cover_ball(cf_tiles *t, const double c, const double radius) {
  cf_tiles_drop_all(t);
  for (int tk = 0; tk < t->n[2]; ++tk)
    for (int tj = 0; tj < t->n[1]; ++tj)
      for (int ti = 0; ti < t->n[0]; ++ti) {
        double r2 = 0;
        const int at[3] = {ti, tj, tk};
        for (int a = 0; a < 3; ++a) {
          const double low = at[a] * t->edge[a], near = fmin(fmax(c, low), low + t->edge[a]);
          r2 += (near - c) * (near - c);
        }
        if (r2 <= radius * radius) cf_tiles_add(t, ti, tj, tk);
      }
  OK(cf_tiles_update(t));
}

/* A ball in 96^3 that moves: on its tiles alone, and in the whole box. */
static void tiles_give_the_bits_of_the_whole_box(void **state) {
  (void)state;
  scene dense, sparse;
  scene_begin(&dense, 3, 96, 96);
  scene_begin(&sparse, 3, 96, 96);
  const cf_box *box = &dense.g.box;
  cf_region_destroy(sparse.region);
  OK(cf_tiles_create(&sparse.tiles, box, NULL));
  OK(cf_region_create_on(&sparse.region, &sparse.g, sparse.tiles));
  cf_cell_destroy(&sparse.x, box);
  OK(cf_tiles_cell_create(sparse.tiles, &sparse.x));
  for (int step = 0; step < 3; ++step) {
    const double c = 36 + 10 * step, radius = 20, h = dense.g.h;
    const cf_shape ball = cf_shape_sphere((double[]){c * h, c * h, c * h}, radius * h);
    cover_ball(sparse.tiles, c, radius + 1);
    cf_region_retire(sparse.region);
    cf_tiles_retire_cell(sparse.tiles, sparse.x);
    cf_region_fill(dense.region, CF_CELL_WALL);
    cf_region_fill(sparse.region, CF_CELL_WALL);
    scene *both[2] = {&dense, &sparse};
    for (int v = 0; v < 2; ++v) {
      scene *s = both[v];
      OK(cf_region_add(s->region, &ball, NULL, 0, CF_CELL_INSIDE, NULL));
      OK(cf_region_update(s->region));
      OK(cf_helmholtz_set(s->A, &(cf_coefficients){.alpha = 1, .beta = 30 * h * h, .region = s->region}));
      for (int k = 0; k < 96; ++k)
        for (int j = 0; j < 96; ++j)
          for (int i = 0; i < 96; ++i) {
            const ptrdiff_t p = cf_box_at(box, i, j, k);
            s->b.at[p] = (cf_real)sin(0.3 * i + 0.2 * j - 0.1 * k);
            if (s->region->kind[p] == CF_CELL_INSIDE) s->x.at[p] = 0;
          }
      cf_solve_report report;
      OK(cf_helmholtz_solve(s->A, s->b, &(cf_solve_options){1e-8, 50}, s->x, &report));
      assert_true(report.converged);
    }
    assert_int_equal(dense.region->inside, sparse.region->inside);
    for (int k = 0; k < 96; ++k)
      for (int j = 0; j < 96; ++j)
        for (int i = 0; i < 96; ++i) {
          const ptrdiff_t p = cf_box_at(box, i, j, k);
          if (sparse.region->kind[p] == CF_CELL_INSIDE)
            assert_true(dense.x.at[p] == sparse.x.at[p]);
          else if (!cf_tiles_has_cell(sparse.tiles, i, j, k))
            assert_true(sparse.x.at[p] == 0);
        }
  }
  scene_end(&dense);
  scene_end(&sparse);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(random_regions_match_elimination),
      cmocka_unit_test(a_ball_costs_little),
      cmocka_unit_test(a_pocket_keeps_its_mean_and_walls_their_values),
      cmocka_unit_test(a_slalom_of_plates_costs_little),
      cmocka_unit_test(a_porous_block_takes_few_iterations),
      cmocka_unit_test(the_fast_path_solves_in_regions),
      cmocka_unit_test(a_right_side_in_few_cells_is_solved_for),
      cmocka_unit_test(bits_do_not_depend_on_threads),
      cmocka_unit_test(tiles_give_the_bits_of_the_whole_box),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
