/* SPDX-License-Identifier: MIT
 *
 * With the nonsymmetric cycle as preconditioner M the direction is made A-conjugate by the Polak-Ribiere form
 *
 *     beta = z . (r - r_old) / (z_old . r_old),   and since r - r_old = -a A p_old,   = -a (z . A p_old) / (z_old . r_old),
 *
 * which needs no old residual (flexible CG: Golub and Ye 1999; Notay 2000).
 */
#include "solve/pcg.h"

#include <math.h>

#include "grid/sweep.h"
#include "solve/box_solver.h"
#include "solve/multigrid.h"
#include "solve/varied.h"
#include "solve/window.h"

/* A start that leaves more than this of the residual's square has met round-off. */
#define START_GAIN 0.25

CF_CLONES static void add_row(const int n, const cf_real factor, const cf_real *from, cf_real *to) {
  CF_ROW_LOOP
  for (int i = 0; i < n; ++i) to[i] += factor * from[i];
}

CF_CLONES static void scale_add_row(const int n, const cf_real factor, const cf_real *from, cf_real *to) {
  CF_ROW_LOOP
  for (int i = 0; i < n; ++i) to[i] = from[i] + factor * to[i];
}

CF_CLONES static void shift_row(const int n, const cf_real amount, cf_real *x) {
  CF_ROW_LOOP
  for (int i = 0; i < n; ++i) x[i] += amount;
}

/* to += factor from. */
static void add_scaled(const cf_level *l, const double factor, const cf_cell from, const cf_cell to) {
  CF_PARALLEL_ROWS (&l->box, l->threads, r) {
    const ptrdiff_t p = cf_box_row(&l->box, r);
    add_row(l->box.n[0], (cf_real)factor, from.at + p, to.at + p);
  }
}

/* to = from + factor to. */
static void scale_and_add(const cf_level *l, const double factor, const cf_cell from, const cf_cell to) {
  CF_PARALLEL_ROWS (&l->box, l->threads, r) {
    const ptrdiff_t p = cf_box_row(&l->box, r);
    scale_add_row(l->box.n[0], (cf_real)factor, from.at + p, to.at + p);
  }
}

void cf_level_shift(const cf_level *l, const double amount, const cf_cell x) {
  CF_PARALLEL_ROWS (&l->box, l->threads, r)
    shift_row(l->box.n[0], (cf_real)amount, x.at + cf_box_row(&l->box, r));
}

static double volume(const cf_level *l) {
  double v = 1;
  for (int a = 0; a < l->box.dim; ++a) {
    double length = 0;
    for (int i = 0; i < l->axis[a].n; ++i) length += l->axis[a].width[i];
    v *= length;
  }
  return v;
}

static double mean_of(const cf_level *l, const cf_cell x) { return cf_level_sum(l, x) / volume(l); }

void cf_level_remove_mean(const cf_level *l, const cf_cell x) { cf_level_shift(l, -mean_of(l, x), x); }

int cf_pcg_plain(cf_level *l, const bool singular, const cf_cell b, const cf_solve_options *o,
                 const cf_cell work[3], const cf_cell x) {
  const cf_cell r = work[0], p = work[1], Ap = work[2];
  cf_level_clear(l, x);
  cf_level_clear(l, r);
  cf_level_clear(l, p);
  add_scaled(l, 1, b, r);
  if (singular) cf_level_remove_mean(l, r);
  double rr = cf_level_dot(l, r, r);
  const double enough = o->tolerance * o->tolerance * rr;
  int it = 0;
  double beta = 0;
  while (rr > enough && it < o->max_iterations) {
    scale_and_add(l, beta, r, p);
    cf_level_apply(l, p, Ap);
    const double pAp = cf_level_dot(l, p, Ap);
    if (!(pAp > 0)) break; /* only a null space is left */
    const double a = rr / pAp;
    add_scaled(l, a, p, x);
    add_scaled(l, -a, Ap, r);
    const double next = cf_level_dot(l, r, r);
    beta = next / rr;
    rr = next;
    ++it;
  }
  if (singular) cf_level_remove_mean(l, x);
  return it;
}

/* A caller's field may hold anything in its ghosts. */
static void set_outside(const cf_helmholtz *A, const cf_cell x) {
  cf_halo_fill(&A->grid.box, &A->outside, 1, -1, x.at);
}

void cf_helmholtz_apply(cf_helmholtz *A, const cf_cell x, const cf_cell y) {
  if (A->in_window) {
    cf_window_apply(A->window, x, y);
    return;
  }
  if (A->is_varied) {
    cf_varied_apply(A->varied, x, y);
    return;
  }
  set_outside(A, x);
  cf_level_apply(&A->level[0], x, y);
}

double cf_helmholtz_residual(cf_helmholtz *A, const cf_cell x, const cf_cell b) {
  if (A->in_window) return cf_window_residual(A->window, x, b);
  if (A->is_varied) return cf_varied_residual(A->varied, x, b);
  cf_level *l = &A->level[0];
  set_outside(A, x);
  cf_level_residual(l, x, b, A->z);
  const double bb = cf_level_dot(l, b, b);
  return bb > 0 ? sqrt(cf_level_dot(l, A->z, A->z) / bb) : sqrt(cf_level_dot(l, A->z, A->z));
}

/* Conjugate gradients from the residual in A->r until its recursion's square is `enough`. */
static void iterate(cf_helmholtz *A, const double enough, const cf_solve_options *o, const cf_cell x,
                    int *iterations) {
  cf_level *l = &A->level[0];
  const cf_cell r = A->r, p = A->p, Ap = A->Ap, z = A->z;
  const int first = *iterations;
  double zr_old = 0, a = 0, rr = INFINITY;
  while (rr > enough && *iterations < o->max_iterations) {
    cf_multigrid_cycle(A, r, z);
    if (A->singular) cf_level_remove_mean(l, z);
    const double beta = *iterations == first ? 0 : -a * cf_level_dot(l, z, Ap) / zr_old;
    const double zr = cf_level_dot(l, z, r);
    if (*iterations == first) cf_level_clear(l, p); /* 0 times what a breakdown left is not 0 */
    scale_and_add(l, beta, z, p);
    cf_level_apply(l, p, Ap);
    const double pAp = cf_level_dot(l, p, Ap), pr = cf_level_dot(l, p, r);
    if (!(pAp > 0)) break; /* round-off is all that is left */
    a = pr / pAp;
    add_scaled(l, a, p, x);
    add_scaled(l, -a, Ap, r);
    zr_old = zr;
    rr = cf_level_dot(l, r, r);
    ++*iterations;
  }
}

/* The square of the residual that rounding of x leaves. */
static double floor_of(const cf_helmholtz *A, const cf_cell x) {
  const double h = A->grid.h, diagonal = A->level[0].alpha + 2 * A->grid.box.dim * A->beta / (h * h);
  const double size = CF_REAL_EPSILON * diagonal;
  return size * size * cf_level_dot(&A->level[0], x, x);
}

/* The residual is formed anew at the end of an iteration: rounding makes it differ from the recursion. Then the next one
 * starts from there, as long as that gains something. */
static cf_status solve_plain(cf_helmholtz *A, const cf_cell b, const cf_solve_options *o, const cf_cell x,
                             cf_solve_report *report) {
  cf_level *l = &A->level[0];
  const double bb = cf_level_dot(l, b, b), enough = o->tolerance * o->tolerance * bb;
  set_outside(A, x);
  cf_level_residual(l, x, b, A->r);
  double rr = cf_level_dot(l, A->r, A->r), before = INFINITY;
  if (!isfinite(bb) || !isfinite(rr))
    return cf_fail(CF_NOT_FINITE,
                   "the equation to solve holds a value that is not finite (|b| = %g, |b - A x| = %g)",
                   sqrt(bb), sqrt(rr));
  if (bb == 0) cf_level_clear(l, x);
  while (bb > 0 && rr > enough && rr <= START_GAIN * before && report->iterations < o->max_iterations) {
    before = rr;
    iterate(A, enough, o, x, &report->iterations);
    set_outside(A, x);
    cf_level_residual(l, x, b, A->r);
    rr = cf_level_dot(l, A->r, A->r);
  }
  report->residual = bb > 0 ? sqrt(rr / bb) : 0;
  report->converged = bb == 0 || rr <= CF_MAX(enough, CF_MIN(floor_of(A, x), CF_ROUNDING_PASSES * bb));
  return CF_OK;
}

const char *cf_helmholtz_method(const cf_helmholtz *A) {
  if (A->in_window) return cf_window_method(A->window);
  if (A->is_varied && A->in_box) return cf_box_solver_method(A->around);
  if (A->is_varied) return cf_varied_method(A->varied);
  if (cf_level_is_line(&A->level[0])) return "line";
  if (A->depth == 1 && cf_level_is_few(&A->level[0])) return "direct";
  return A->in_box ? cf_box_solver_method(A->box) : "multigrid-pcg";
}

cf_status cf_helmholtz_solve(cf_helmholtz *A, const cf_cell b, const cf_solve_options *o, const cf_cell x,
                             cf_solve_report *report) {
  if (A->in_window) return cf_window_solve(A->window, b, o, x, report);
  cf_level *l = &A->level[0];
  *report = (cf_solve_report){.levels = A->depth, .pockets = A->singular, .method = cf_helmholtz_method(A)};
  bool finished = false;
  if (A->in_box) CF_TRY(cf_box_solver_run(A->is_varied ? A->around : A->box, A, b, o, x, report, &finished));
  if (finished) return CF_OK;
  if (A->in_box) report->method = "multigrid-pcg";
  if (A->is_varied) {
    report->levels = cf_varied_depth(A->varied);
    return cf_varied_solve(A->varied, b, o, x, report);
  }
  if (A->singular) cf_level_remove_mean(l, b);
  const double mean = A->singular ? mean_of(l, x) : 0;
  CF_TRY(solve_plain(A, b, o, x, report));
  if (A->singular) cf_level_shift(l, mean - mean_of(l, x), x);
  return CF_OK;
}

void cf_helmholtz_add_walls(const cf_helmholtz *A, const cf_wall_values *v, const cf_cell b) {
  const cf_level *l = &A->level[0];
  for (int a = 0; a < l->box.dim; ++a)
    for (int side = 0; side < 2; ++side) {
      if (v->at[a][side] == NULL) continue;
      const cf_wall_side w = cf_wall_side_of(&l->box, a, side);
      const double table = side == 0 ? l->axis[a].lo1[0] : l->axis[a].hi1[l->axis[a].n - 1];
      for (int i_c = 0; i_c < w.n_c; ++i_c)
        for (int i_b = 0; i_b < w.n_b; ++i_b) {
          const ptrdiff_t p = cf_wall_cell(&l->box, &w, i_b, i_c);
          const ptrdiff_t face = side == 0 ? p : p + w.outward;
          const double beta = A->in_window   ? cf_window_wall_beta(A->window, a, p, face)
                              : A->is_varied ? cf_varied_wall_beta(A->varied, a, face)
                                             : A->beta;
          b.at[p] += (cf_real)(table * beta * v->at[a][side][i_b + (ptrdiff_t)w.n_b * i_c]);
        }
    }
}

void cf_helmholtz_add_held(const cf_helmholtz *A, const cf_cell b) {
  if (A->in_window)
    cf_window_add_held(A->window, b);
  else if (A->is_varied)
    cf_varied_add_held(A->varied, b);
}
