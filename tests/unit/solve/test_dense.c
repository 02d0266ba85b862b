/* SPDX-License-Identifier: MIT
 *
 * The solver against Gaussian elimination on small random systems, whose matrix is assembled here from the
 * definition alone: alpha x_p + sum over faces of beta (x_p - x_neighbour)/h^2, twice that towards a held wall.
 */
#include <math.h>
#include <string.h>

#include "elimination.h"
#include "grid/wall.h"
#include "solve/helmholtz.h"
#include "testing.h"

typedef struct small {
  cf_grid g;
  cf_walls walls;
  int cells;
  double alpha[MOST], face[3][MOST][2]; /* beta of the low and high face of each cell */
} small;

static uint64_t seed = 1;

static int pick(const int count) { return (int)(test_random(&seed) * count); }

static int number(const small *s, const int at[3]) {
  return at[0] + s->g.box.n[0] * (at[1] + s->g.box.n[1] * at[2]);
}

/* The neighbour of a cell; -1: none (a wall, or an axis of one cell joined to itself). */
static int neighbour(const small *s, const int cell, const int a, const int high) {
  int at[3];
  cell_place(&s->g.box, cell, at);
  const int n = s->g.box.n[a];
  at[a] += high ? 1 : -1;
  if (at[a] < 0 || at[a] >= n) {
    if (s->walls.kind[a][0] != CF_WALL_PERIODIC || n == 1) return -1;
    at[a] = (at[a] + n) % n;
  }
  return number(s, at);
}

static void random_box(small *s) {
  const int dim = 2 + pick(2);
  int n[3];
  for (int a = 0; a < 3; ++a) n[a] = 1 + pick(7);
  memset(s, 0, sizeof *s);
  OK(cf_grid_init(&s->g, dim, n, 0.25 + test_random(&seed), NULL));
  s->cells = (int)cf_box_cells(&s->g.box);
  for (int a = 0; a < dim; ++a) {
    const cf_wall kinds[] = {CF_WALL_INSULATED, CF_WALL_OPEN, CF_WALL_VALUE};
    const int periodic = pick(3) == 0;
    for (int side = 0; side < 2; ++side)
      s->walls.kind[a][side] = periodic ? CF_WALL_PERIODIC : kinds[pick(3)];
  }
}

/* Random faces between 1/10 and 10, a share of them closed; the same value seen from both cells. */
static void random_faces(small *s, const double closed, const cf_face beta) {
  for (int a = 0; a < s->g.box.dim; ++a)
    for (int c = 0; c < s->cells; ++c) {
      const double b = test_random(&seed) < closed ? 0 : pow(10, 2 * test_random(&seed) - 1);
      const int below = neighbour(s, c, a, 0);
      int at[3];
      cell_place(&s->g.box, c, at);
      s->face[a][c][0] = b;
      beta.at[a][cell_index(&s->g.box, c)] = (cf_real)b;
      if (below >= 0) s->face[a][below][1] = b;
      if (at[a] == s->g.box.n[a] - 1 && neighbour(s, c, a, 1) < 0) {
        const double wall = pow(10, 2 * test_random(&seed) - 1);
        s->face[a][c][1] = wall;
        beta.at[a][cell_index(&s->g.box, c) + s->g.box.stride[a]] = (cf_real)wall;
      }
    }
}

static void assemble(const small *s) {
  const double h2 = s->g.h * s->g.h;
  memset(matrix, 0, sizeof matrix);
  for (int c = 0; c < s->cells; ++c) {
    matrix[c][c] += s->alpha[c];
    for (int a = 0; a < s->g.box.dim; ++a)
      for (int high = 0; high < 2; ++high) {
        const int other = neighbour(s, c, a, high);
        const double b = s->face[a][c][high] / h2;
        if (other >= 0) {
          matrix[c][c] += b;
          matrix[c][other] -= b;
        } else if (cf_wall_is_held(s->walls.kind[a][high])) {
          matrix[c][c] += 2 * b;
        }
      }
  }
}

typedef struct work {
  cf_cell x, y, b, alpha;
  cf_face beta;
  cf_helmholtz *A;
} work;

static void work_begin(const small *s, const int levels, work *w) {
  const cf_box *box = &s->g.box;
  OK(cf_cell_create(&w->x, box));
  OK(cf_cell_create(&w->y, box));
  OK(cf_cell_create(&w->b, box));
  OK(cf_cell_create(&w->alpha, box));
  OK(cf_face_create(&w->beta, box));
  OK(cf_helmholtz_create(&w->A, &s->g, &s->walls, levels));
}

static void work_end(const small *s, work *w) {
  const cf_box *box = &s->g.box;
  cf_helmholtz_destroy(w->A);
  cf_cell_destroy(&w->x, box);
  cf_cell_destroy(&w->y, box);
  cf_cell_destroy(&w->b, box);
  cf_cell_destroy(&w->alpha, box);
  cf_face_destroy(&w->beta, box);
}

/* A random operator: form 0 numbers, 1 alpha a field, 2 beta a field, 3 both; `closed` is the share of closed faces. */
static void random_operator(small *s, const int form, const double alpha, const double closed, work *w) {
  const double beta = pow(10, 4 * test_random(&seed) - 2);
  cf_coefficients c = {.alpha = alpha, .beta = beta};
  for (int i = 0; i < s->cells; ++i) {
    s->alpha[i] = alpha * (form & 1 ? 0.2 + test_random(&seed) : 1);
    w->alpha.at[cell_index(&s->g.box, i)] = (cf_real)s->alpha[i];
    for (int a = 0; a < 3; ++a) s->face[a][i][0] = s->face[a][i][1] = beta;
  }
  if (form & 1) c.alpha_at = &w->alpha;
  if (form & 2) {
    random_faces(s, closed, w->beta);
    c.beta_at = &w->beta;
  }
  OK(cf_helmholtz_set(w->A, &c));
}

static void solutions_match_elimination(void **state) {
  (void)state;
  static small s;
  static double b[MOST], x[MOST];
  int compared = 0;
  for (int round = 0; round < 1500; ++round) {
    random_box(&s);
    work w;
    work_begin(&s, pick(4), &w);
    const double alpha = pick(3) == 0 ? 0 : pow(10, 4 * test_random(&seed) - 2);
    const int form = pick(4); /* one draw a line: the order of arguments is the compiler's */
    random_operator(&s, form, alpha, pick(2) ? 0.3 : 0, &w);
    for (int i = 0; i < s.cells; ++i) {
      b[i] = 2 * test_random(&seed) - 1;
      w.b.at[cell_index(&s.g.box, i)] = b[i];
      w.x.at[cell_index(&s.g.box, i)] = test_random(&seed);
    }
    assemble(&s);
    if (eliminate(s.cells, b, x)) {
      cf_solve_report report;
      OK(cf_helmholtz_solve(w.A, w.b, &(cf_solve_options){1e-14, 200}, w.x, &report));
      double size = 0;
      for (int i = 0; i < s.cells; ++i) size = fmax(size, fabs(x[i]));
      for (int i = 0; i < s.cells; ++i)
        CLOSE((double)w.x.at[cell_index(&s.g.box, i)] / size, x[i] / size, 1e-9);
      ++compared;
    }
    work_end(&s, &w);
  }
  print_message("%d systems compared\n", compared);
  assert_true(compared > 1000);
}

/* alpha = 0 and closed faces: regions without any equation for their level. What b = A y asks for is met. */
static void cut_off_regions_do_no_harm(void **state) {
  (void)state;
  static small s;
  for (int round = 0; round < 1500; ++round) {
    random_box(&s);
    work w;
    work_begin(&s, pick(4), &w);
    random_operator(&s, 2, 0, 0.1 + 0.8 * test_random(&seed), &w);
    for (int i = 0; i < s.cells; ++i) w.y.at[cell_index(&s.g.box, i)] = 2 * test_random(&seed) - 1;
    cf_helmholtz_apply(w.A, w.y, w.b);
    cf_solve_report report;
    OK(cf_helmholtz_solve(w.A, w.b, &(cf_solve_options){1e-6, 300}, w.x, &report));
    const double residual = cf_helmholtz_residual(w.A, w.x, w.b);
    if (!report.converged || !(residual <= 1.1e-6))
      fail_msg("round %d, %d x %d x %d: %d iterations, residual %.3g", round, s.g.box.n[0], s.g.box.n[1],
               s.g.box.n[2], report.iterations, residual);
    work_end(&s, &w);
  }
}

static double dot(const small *s, const cf_cell x, const cf_cell y) {
  double sum = 0;
  for (int i = 0; i < s->cells; ++i) sum += x.at[cell_index(&s->g.box, i)] * y.at[cell_index(&s->g.box, i)];
  return sum;
}

static void operator_is_symmetric_and_matches_its_definition(void **state) {
  (void)state;
  static small s;
  for (int round = 0; round < 300; ++round) {
    random_box(&s);
    work w;
    work_begin(&s, 0, &w);
    const int form = pick(4);
    random_operator(&s, form, test_random(&seed), 0.2, &w);
    for (int i = 0; i < s.cells; ++i) {
      w.x.at[cell_index(&s.g.box, i)] = 2 * test_random(&seed) - 1;
      w.y.at[cell_index(&s.g.box, i)] = 2 * test_random(&seed) - 1;
    }
    assemble(&s);
    cf_helmholtz_apply(w.A, w.x, w.b);
    double largest = 0;
    for (int i = 0; i < s.cells; ++i) largest = fmax(largest, matrix[i][i]);
    for (int i = 0; i < s.cells; ++i) {
      double sum = 0;
      for (int j = 0; j < s.cells; ++j) sum += matrix[i][j] * w.x.at[cell_index(&s.g.box, j)];
      CLOSE(w.b.at[cell_index(&s.g.box, i)] / largest, sum / largest, 1e-14);
    }
    const double Axy = dot(&s, w.b, w.y);
    cf_helmholtz_apply(w.A, w.y, w.b);
    CLOSE(Axy / largest, dot(&s, w.x, w.b) / largest, 1e-12);
    work_end(&s, &w);
  }
}

/* x is linear between held walls: the right side that puts their values there leaves nothing to solve for. */
static void held_walls_enter_the_right_side(void **state) {
  (void)state;
  for (int dim = 2; dim <= 3; ++dim)
    for (int axis = 0; axis < dim; ++axis) {
      small s = {0};
      const int n[3] = {6, 5, 7};
      OK(cf_grid_init(&s.g, dim, n, 0.5, NULL));
      s.cells = (int)cf_box_cells(&s.g.box);
      s.walls.kind[axis][0] = s.walls.kind[axis][1] = CF_WALL_VALUE;
      s.walls.value[axis][0] = cf_fn_constant(2);
      s.walls.value[axis][1] = cf_fn_constant(-1);
      work w;
      work_begin(&s, 0, &w);
      cf_wall_values v;
      OK(cf_wall_values_create(&v, &s.g, &s.walls));
      cf_wall_values_sample(&v, 0);
      OK(cf_helmholtz_set(w.A, &(cf_coefficients){.alpha = 0, .beta = 3}));
      cf_helmholtz_add_walls(w.A, &v, w.b);
      cf_solve_report report;
      OK(cf_helmholtz_solve(w.A, w.b, &(cf_solve_options){1e-13, 50}, w.x, &report));
      for (int i = 0; i < s.cells; ++i) {
        int at[3];
        cell_place(&s.g.box, i, at);
        CLOSE(w.x.at[cell_index(&s.g.box, i)], 2 - 3 * (at[axis] + 0.5) / n[axis], 1e-11);
      }
      cf_wall_values_destroy(&v);
      work_end(&s, &w);
    }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(solutions_match_elimination),
      cmocka_unit_test(cut_off_regions_do_no_harm),
      cmocka_unit_test(operator_is_symmetric_and_matches_its_definition),
      cmocka_unit_test(held_walls_enter_the_right_side),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
