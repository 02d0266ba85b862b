/* SPDX-License-Identifier: MIT
 *
 * Making the hierarchy: every axis that still has the smallest spacing is halved (in a 512 x 4 box the short
 * axis is used up after two levels), until a line or few cells are left, which are solved directly.
 */
#include "solve/multigrid.h"

#include <math.h>
#include <string.h>

#include "base/mem.h"
#include "grid/sweep.h"
#include "solve/box_solver.h"
#include "solve/pcg.h"
#include "solve/transfer.h"
#include "solve/varied.h"
#include "solve/window.h"

/* On the coarsest level: so far beyond any outer tolerance that its error is no part of the cycle's. */
#define COARSEST_TOLERANCE 1e-8

void cf_level_clear(const cf_level *l, const cf_cell x) {
  CF_PARALLEL_ROWS (&l->box, l->threads, r)
    memset(x.at + cf_box_row(&l->box, r), 0, (size_t)l->box.n[0] * sizeof(cf_real));
}

static void level_destroy(cf_level *l, const bool finest) {
  for (int a = 0; a < 3; ++a) {
    cf_axis_clear(&l->axis[a]);
    cf_pairing_clear(&l->pairing[a]);
  }
  cf_cell_destroy(&l->r, &l->box);
  if (!finest) {
    cf_cell_destroy(&l->x, &l->box);
    cf_cell_destroy(&l->b, &l->box);
  }
  cf_free(l->rows);
}

static void coarsest_destroy(cf_helmholtz *A) {
  for (int v = 0; v < 3 && A->coarse_level >= 0; ++v)
    cf_cell_destroy(&A->coarse[v], &A->level[A->coarse_level].box);
  A->coarse_level = -1;
}

void cf_helmholtz_destroy(cf_helmholtz *A) {
  if (A == NULL) return;
  cf_cell_destroy(&A->r, &A->grid.box);
  cf_cell_destroy(&A->p, &A->grid.box);
  cf_cell_destroy(&A->Ap, &A->grid.box);
  cf_cell_destroy(&A->z, &A->grid.box);
  coarsest_destroy(A);
  cf_varied_destroy(A->varied);
  for (int l = 0; l < A->levels; ++l) level_destroy(&A->level[l], l == 0);
  cf_free(A->scratch);
  cf_free(A->line);
  cf_direct_destroy(&A->direct);
  cf_box_solver_destroy(A->box);
  cf_box_solver_destroy(A->around);
  cf_window_destroy(A->window);
  cf_free(A);
}

static void level_seams(cf_level *l) {
  for (int a = 0; a < l->box.dim; ++a)
    if (l->axis[a].periodic) {
      l->has_seam = true;
      l->wrap.rule[a][0] = l->wrap.rule[a][1] = CF_HALO_WRAP;
    }
}

static cf_status finest_create(cf_helmholtz *A, cf_level *l) {
  l->box = A->grid.box;
  l->threads = A->grid.threads;
  for (int a = 0; a < l->box.dim; ++a)
    CF_TRY(cf_axis_create(&l->axis[a], l->box.n[a], A->grid.h, A->walls.kind[a]));
  level_seams(l);
  A->outside = l->wrap;
  for (int a = 0; a < l->box.dim; ++a)
    for (int side = 0; side < 2; ++side)
      if (!l->axis[a].periodic) A->outside.rule[a][side] = CF_HALO_ZERO;
  CF_TRY(cf_cell_create(&l->r, &l->box));
  return CF_NEW(&l->rows, 2 * cf_box_rows(&l->box));
}

/* The axes with the smallest spacing among those that still have cells to join. */
static bool axes_to_coarsen(const cf_level *l, bool coarsened[3]) {
  double smallest = INFINITY;
  for (int a = 0; a < l->box.dim; ++a)
    if (l->axis[a].n > 1) smallest = CF_MIN(smallest, l->axis[a].width[0]);
  for (int a = 0; a < l->box.dim; ++a)
    coarsened[a] = l->axis[a].n > 1 && l->axis[a].width[0] <= 1.5 * smallest;
  return smallest < INFINITY;
}

static cf_status coarser_create(cf_helmholtz *A, cf_level *fine, const bool coarsened[3], cf_level *l) {
  int n[3] = {1, 1, 1};
  for (int a = 0; a < fine->box.dim; ++a)
    n[a] = coarsened[a] ? cf_axis_coarse_count(&fine->axis[a]) : fine->box.n[a];
  CF_TRY(cf_box_init(&l->box, fine->box.dim, n, 1));
  l->threads = fine->threads;
  for (int a = 0; a < fine->box.dim; ++a)
    CF_TRY(cf_axis_coarsen(&fine->axis[a], coarsened[a], A->grid.h, &fine->pairing[a], &l->axis[a]));
  level_seams(l);
  CF_TRY(cf_cell_create(&l->x, &l->box));
  CF_TRY(cf_cell_create(&l->b, &l->box));
  CF_TRY(cf_cell_create(&l->r, &l->box));
  return CF_NEW(&l->rows, 2 * cf_box_rows(&l->box));
}

static bool solved_directly(const cf_level *l) { return cf_level_is_line(l) || cf_level_is_few(l); }

static cf_status hierarchy_create(cf_helmholtz *A) {
  const cf_box *box = &A->grid.box;
  A->levels = 1;
  CF_TRY(finest_create(A, &A->level[0]));
  bool coarsened[3];
  while (!solved_directly(&A->level[A->levels - 1]) && axes_to_coarsen(&A->level[A->levels - 1], coarsened) &&
         A->levels < CF_LEVELS_MAX && (A->wanted == 0 || A->levels < A->wanted)) {
    ++A->levels; /* counted first, so that a failure within frees it */
    CF_TRY(coarser_create(A, &A->level[A->levels - 2], coarsened, &A->level[A->levels - 1]));
  }
  CF_TRY(cf_cell_create(&A->r, box));
  CF_TRY(cf_cell_create(&A->p, box));
  CF_TRY(cf_cell_create(&A->Ap, box));
  CF_TRY(cf_cell_create(&A->z, box));
  CF_TRY(cf_direct_create(&A->direct));
  CF_TRY(CF_NEW(&A->line, 5 * CF_MAX(box->n[0], CF_MAX(box->n[1], box->n[2]))));
  return CF_NEW(&A->scratch, (ptrdiff_t)A->grid.threads * (box->n[0] + 2));
}

cf_status cf_helmholtz_create(cf_helmholtz **A, const cf_grid *g, const cf_walls *walls, const int levels) {
  *A = NULL;
  for (int a = 0; a < g->box.dim; ++a)
    if ((walls->kind[a][0] == CF_WALL_PERIODIC) != (walls->kind[a][1] == CF_WALL_PERIODIC))
      return cf_fail(CF_BAD_ARGUMENT, "walls of axis %d: periodic on one side only", a);
  cf_helmholtz *fresh;
  CF_TRY(CF_NEW(&fresh, 1));
  fresh->grid = *g;
  fresh->walls = *walls;
  fresh->wanted = levels;
  fresh->coarse_level = -1;
  cf_status s = hierarchy_create(fresh);
  if (s == CF_OK) s = cf_helmholtz_set(fresh, &(cf_coefficients){.alpha = 1, .beta = 0});
  if (s != CF_OK) {
    cf_helmholtz_destroy(fresh);
    return s;
  }
  *A = fresh;
  return CF_OK;
}

/* --- coefficients ------------------------------------------------------------------------------------- */

static void set_tables(cf_level *l, const double alpha, const double beta) {
  l->alpha = alpha;
  for (int a = 0; a < l->box.dim; ++a)
    for (int i = 0; i < l->axis[a].n; ++i) {
      l->axis[a].lo[i] = (cf_real)(beta * l->axis[a].lo1[i]);
      l->axis[a].hi[i] = (cf_real)(beta * l->axis[a].hi1[i]);
    }
}

static cf_status set_constant(cf_helmholtz *A, const cf_coefficients *c) {
  for (int l = 0; l < A->levels; ++l) {
    set_tables(&A->level[l], c->alpha, c->beta);
  }
  A->depth = 1;
  while (A->depth < A->levels && cf_level_stiffness(&A->level[A->depth - 1]) > CF_STIFF_ENOUGH) ++A->depth;
  A->beta = c->beta;
  if (A->box == NULL) CF_TRY(cf_box_solver_create(&A->box, A));
  return CF_OK;
}

static bool has_held_wall(const cf_helmholtz *A) {
  for (int a = 0; a < A->grid.box.dim; ++a)
    for (int side = 0; side < 2; ++side)
      if (cf_wall_is_held(A->walls.kind[a][side])) return true;
  return false;
}

/* What solves the coarsest level: an elimination, or work for conjugate gradients. */
static cf_status coarsest_create(cf_helmholtz *A) {
  const int coarsest = A->depth - 1;
  cf_level *l = &A->level[coarsest];
  if (cf_level_is_few(l) && !cf_level_is_line(l)) cf_direct_factor(l, &A->direct);
  if (A->coarse_level == coarsest || coarsest == 0 || solved_directly(l)) return CF_OK;
  coarsest_destroy(A);
  A->coarse_level = coarsest;
  for (int v = 0; v < 3; ++v) {
    const cf_status s = cf_cell_create(&A->coarse[v], &l->box);
    if (s != CF_OK) {
      coarsest_destroy(A);
      return s;
    }
  }
  return CF_OK;
}

/* Numbers in a region: the fast path, if it can. */
static cf_status set_around(cf_helmholtz *A, const cf_coefficients *c) {
  const bool tiles = c->region->tiles != NULL;
  if (A->around != NULL && A->around_tiles != tiles) {
    cf_box_solver_destroy(A->around);
    A->around = NULL;
  }
  if (A->around == NULL) CF_TRY(cf_box_solver_create_around(&A->around, A, A->varied));
  A->around_tiles = tiles;
  CF_TRY(cf_box_solver_set_around(A->around, A, c->alpha, c->beta, &A->in_box));
  A->around_is_set = true;
  return CF_OK;
}

/* The path that is left has no use for its memory. */
static void leave_region(cf_helmholtz *A) {
  A->is_varied = A->around_is_set = A->in_box = false;
  cf_box_solver_destroy(A->around);
  cf_varied_destroy(A->varied);
  A->around = NULL;
  A->varied = NULL;
}

static void leave_window(cf_helmholtz *A) {
  A->in_window = false;
  cf_window_destroy(A->window);
  A->window = NULL;
}

static cf_status set_window(cf_helmholtz *A, const cf_coefficients *c) {
  if (!A->in_window) leave_region(A);
  A->in_window = false;
  CF_TRY(cf_window_set(&A->window, &A->grid, &A->walls, A->wanted, c));
  A->in_window = true;
  return CF_OK;
}

void cf_helmholtz_forbid_windows(cf_helmholtz *A) { A->no_windows = true; }

cf_status cf_helmholtz_set(cf_helmholtz *A, const cf_coefficients *c) {
  if (!(c->alpha >= 0) || !(c->beta >= 0) || !isfinite(c->alpha) || !isfinite(c->beta))
    return cf_fail(CF_BAD_ARGUMENT, "alpha = %g, beta = %g: must be finite and not negative", c->alpha,
                   c->beta);
  if (!A->no_windows && cf_window_pays(&A->grid, &A->walls, c)) return set_window(A, c);
  if (c->region != NULL) leave_window(A);
  A->in_window = false;
  if (A->is_varied && A->around_is_set && cf_varied_has(A->varied, c)) return CF_OK;
  const bool stood = A->is_varied && A->around_is_set, in_box = A->in_box;
  A->around_is_set = false;
  A->is_varied = c->alpha_at != NULL || c->beta_at != NULL || c->region != NULL;
  if (A->is_varied) {
    A->in_box = A->singular = false;
    if (A->varied == NULL) CF_TRY(cf_varied_create(&A->varied, A));
    CF_TRY(cf_varied_set(A->varied, A, c));
    if (stood && cf_varied_stood(A->varied)) {
      A->in_box = in_box;
      A->around_is_set = true;
      return CF_OK;
    }
    return c->region != NULL && c->alpha_at == NULL && c->beta_at == NULL ? set_around(A, c) : CF_OK;
  }
  CF_TRY(set_constant(A, c));
  A->has_held_wall = has_held_wall(A);
  A->singular = c->alpha == 0 && !A->has_held_wall;
  A->in_box = cf_box_solver_set(A->box, A);
  return coarsest_create(A);
}

/* --- the cycle ---------------------------------------------------------------------------------------- */

cf_real cf_level_relaxation(const cf_level *l) {
  const double s = cf_level_stiffness(l), share = isinf(s) ? 1 : s / (1 + s);
  return (cf_real)(1 + 0.2 * share * share);
}

static void cycle(cf_helmholtz *A, const int at, const cf_cell b, const cf_cell x) {
  cf_level *l = &A->level[at];
  if (solved_directly(l)) {
    if (cf_level_is_line(l))
      cf_level_solve_line(l, b, A->line, x);
    else
      cf_direct_solve(l, &A->direct, b, x);
    if (A->singular) cf_level_remove_mean(l, x);
    return;
  }
  cf_level_clear(l, x);
  if (at == A->depth - 1 && at > 0) {
    const cf_solve_options o = {COARSEST_TOLERANCE, 4 * (int)CF_MIN(cf_box_cells(&l->box), 1000)};
    cf_pcg_plain(l, A->singular, b, &o, A->coarse, x);
    return;
  }
  const cf_real omega = cf_level_relaxation(l);
  cf_level_smooth(l, b, omega, x);
  if (at < A->depth - 1) {
    cf_level *below = &A->level[at + 1];
    cf_level_residual(l, x, b, l->r);
    cf_level_restrict(l, l->r, below, below->b, A->scratch);
    cycle(A, at + 1, below->b, below->x);
    cf_level_prolong(below, below->x, l, x, A->scratch);
  }
  cf_level_smooth(l, b, omega, x);
}

void cf_multigrid_cycle(cf_helmholtz *A, const cf_cell r, const cf_cell z) { cycle(A, 0, r, z); }
