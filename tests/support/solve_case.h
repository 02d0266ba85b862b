/* SPDX-License-Identifier: MIT
 *
 * One linear system for the tests of the solver: a box with walls, coefficients of a chosen kind and a right side.
 *
 * Walls are written as one letter an axis: i insulated, o open, p periodic, h open below and insulated above,
 * g insulated below and open above. sigma = beta/(alpha h^2) where h = 1; infinite: Poisson's equation, alpha = 0.
 */
#ifndef CF_TESTS_SOLVE_CASE_H
#define CF_TESTS_SOLVE_CASE_H

#include <math.h>

#include "grid/halo.h"
#include "solve/helmholtz.h"
#include "testing.h"

typedef enum case_beta { BETA_NUMBER, BETA_SMOOTH, BETA_CHECKERS, BETA_BLOCKS } case_beta;
typedef enum case_side { SIDE_SMOOTH, SIDE_NOISY, SIDE_MIXED } case_side;

typedef struct solve_case {
  int dim, n[3];
  const char *walls; /* dim letters */
  double sigma;
  case_beta beta;
  int alpha_varies;
  case_side side;
  int levels, threads;
} solve_case;

typedef struct solve_setup {
  cf_grid g;
  cf_walls walls;
  cf_helmholtz *A;
  cf_cell x, b, alpha;
  cf_face beta;
} solve_setup;

static inline cf_walls case_walls(const int dim, const char *letters) {
  cf_walls w = {0};
  for (int a = 0; a < dim; ++a) {
    const char c = letters[a];
    w.kind[a][0] = c == 'p' ? CF_WALL_PERIODIC : c == 'o' || c == 'h' ? CF_WALL_OPEN : CF_WALL_INSULATED;
    w.kind[a][1] = c == 'p' ? CF_WALL_PERIODIC : c == 'o' || c == 'g' ? CF_WALL_OPEN : CF_WALL_INSULATED;
  }
  return w;
}

/* k of a cell, between 1 and 10; periodic in the box. */
static inline double case_k(const solve_case *c, const int at[3]) {
  const double pi = acos(-1);
  double wave = 1;
  int sum = 0;
  for (int a = 0; a < c->dim; ++a) {
    const int n = c->n[a], i = (at[a] % n + n) % n;
    wave *= cos(2 * pi * (i + 0.5) / n);
    sum += c->beta == BETA_CHECKERS ? i / 4 : 4 * i / n;
  }
  if (c->beta == BETA_SMOOTH) return 5.5 + 4.5 * wave;
  return sum % 2 == 0 ? 1 : 10;
}

static inline void case_fill_beta(const solve_case *c, const cf_box *b, const double scale,
                                  const cf_face beta) {
  for (int a = 0; a < c->dim; ++a)
    for (int k = 0; k < cf_box_extent(b, 2, a); ++k)
      for (int j = 0; j < cf_box_extent(b, 1, a); ++j)
        for (int i = 0; i < cf_box_extent(b, 0, a); ++i) {
          int low[3] = {i, j, k};
          const int high[3] = {i, j, k};
          --low[a];
          const double k0 = case_k(c, low), k1 = case_k(c, high);
          beta.at[a][cf_box_at(b, i, j, k)] = (cf_real)(scale * 2 * k0 * k1 / (k0 + k1));
        }
}

static inline void case_fill_side(const solve_case *c, const cf_box *box, const cf_cell b) {
  uint64_t seed = 7;
  for (int k = 0; k < box->n[2]; ++k)
    for (int j = 0; j < box->n[1]; ++j)
      for (int i = 0; i < box->n[0]; ++i) {
        const double x = (i + 0.5) / box->n[0] - 0.4, y = (j + 0.5) / box->n[1] - 0.55,
                     z = box->dim == 3 ? (k + 0.5) / box->n[2] - 0.5 : 0;
        const double smooth =
            exp(-30 * (x * x + y * y + z * z)) - 0.5 * exp(-60 * ((x - 0.3) * (x - 0.3) + y * y + z * z));
        const double noise = 2 * test_random(&seed) - 1;
        const double part = c->side == SIDE_SMOOTH ? 0 : c->side == SIDE_NOISY ? 1 : 0.1;
        b.at[cf_box_at(box, i, j, k)] = (cf_real)((c->side == SIDE_NOISY ? 0 : smooth) + part * noise);
      }
}

static inline void case_fill_alpha(const cf_box *box, const double alpha, const cf_cell f) {
  for (int k = 0; k < box->n[2]; ++k)
    for (int j = 0; j < box->n[1]; ++j)
      for (int i = 0; i < box->n[0]; ++i)
        f.at[cf_box_at(box, i, j, k)] = (cf_real)(alpha * (1 + 0.5 * sin(0.7 * i + 1.3 * j + 0.4 * k)));
}

static inline void case_begin(const solve_case *c, solve_setup *s) {
  *s = (solve_setup){0};
  OK(cf_grid_init(&s->g, c->dim, c->n, 1, NULL));
  s->g.threads = c->threads > 0 ? c->threads : 1;
  s->walls = case_walls(c->dim, c->walls);
  OK(cf_cell_create(&s->x, &s->g.box));
  OK(cf_cell_create(&s->b, &s->g.box));
  OK(cf_helmholtz_create(&s->A, &s->g, &s->walls, c->levels));
  const double alpha = isinf(c->sigma) ? 0 : 1, beta = isinf(c->sigma) ? 1 : c->sigma;
  cf_coefficients set = {.alpha = alpha, .beta = beta};
  if (c->beta != BETA_NUMBER) {
    OK(cf_face_create(&s->beta, &s->g.box));
    case_fill_beta(c, &s->g.box, beta, s->beta);
    set.beta_at = &s->beta;
  }
  if (c->alpha_varies && alpha > 0) {
    OK(cf_cell_create(&s->alpha, &s->g.box));
    case_fill_alpha(&s->g.box, alpha, s->alpha);
    set.alpha_at = &s->alpha;
  }
  OK(cf_helmholtz_set(s->A, &set));
  case_fill_side(c, &s->g.box, s->b);
}

static inline void case_end(solve_setup *s) {
  const cf_box *b = &s->g.box;
  cf_helmholtz_destroy(s->A);
  cf_cell_destroy(&s->x, b);
  cf_cell_destroy(&s->b, b);
  cf_cell_destroy(&s->alpha, b);
  cf_face_destroy(&s->beta, b);
}

#endif
