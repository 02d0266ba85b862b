/* SPDX-License-Identifier: MIT
 *
 * What the files of the varied path share.
 */
#ifndef CF_SOLVE_VARIED_PART_H
#define CF_SOLVE_VARIED_PART_H

#include "solve/band.h"
#include "solve/clusters.h"
#include "solve/coarsen.h"
#include "solve/fields.h"
#include "solve/multigrid.h"
#include "solve/pockets.h"
#include "solve/renewal.h"
#include "solve/varied.h"

struct cf_varied {
  const cf_helmholtz *A;
  const cf_region *region; /* NULL: the whole box */
  const cf_tiles *tiles;   /* of the region */
  cf_coupled level[CF_LEVELS_MAX];
  int levels, depth; /* made; in use */
  bool sweeps;       /* half sweeps alone do; `jacobi`: the most that diffusion has of a diagonal */
  double jacobi;
  float excess[2]; /* of the level below the finest (amend.h) */
  bool careful;    /* the cycle is symmetric: slower, and never led astray */
  bool thorough;   /* two corrections from each level below, without sweeps of their own near walls */
  cf_band_sweeps band_sweeps; /* near walls, before and after the coarse correction */
  cf_band band;
  cf_clusters clusters; /* for the present coefficients, where they have been called for */
  bool clustered;       /* the cycle goes by them */
  cf_pockets pockets;
  cf_pockets loose;     /* pockets that alpha alone fixes, for conjugate gradients: */
  uint64_t loose_stamp; /* of the region that they were found in */

  /* The operator in the precision of the state: alpha and what faces with known values add (a field or, where `at` is
   * NULL, a number), beta on faces (closed ones 0). Fields of the caller or our own. */
  cf_cell alpha, own_alpha;
  cf_face beta, own_beta;
  double alpha_number, beta_number;
  cf_face given_beta;     /* the caller's; NULL: the number */
  cf_real *lo[3], *hi[3]; /* 1/h^2 along each axis, with the walls of the box (level.h) */

  uint64_t stamp;     /* of the region that numbers are set in, 0: none */
  cf_renewal renewal; /* since then */
  ptrdiff_t renewed;  /* cells of all levels that were made anew when coefficients were set last */

  cf_cell r, p, Ap; /* of conjugate gradients */
  cf_cell best;     /* the solution that an iteration starts from */
  double scale;     /* of the levels: theirs over the equation's own */
  bool apart;       /* the finest level is `fields`, and level[0] says no more than what it is like */
  cf_fields fields;
  double *sums;    /* three for every row of the box */
  cf_run *busy[2]; /* of half sweeps: where x or b is not 0, per row of the box; and scratch */
};

/* --- from coefficients to couplings (varied_fill.c) ---------------------------------------------------- */

/* The largest alpha and beta that the equation meets, and the least alpha; sample: of some rows of the whole box. */
void cf_varied_find_range(const cf_varied *v, const cf_coefficients *c, bool sample, double *alpha,
                          double *least, double *beta);

/* Fills a part of the finest level and finishes it. CF_NO_MEMORY. */
cf_status cf_varied_fill(cf_varied *v, const cf_coefficients *c, const cf_part *w);

/* Fills level[0] where the finest level is apart by colour, for what works on couplings in natural order. CF_NO_MEMORY. */
cf_status cf_varied_make_plain(cf_varied *v);

/* --- the cycle (varied_precondition.c) and what it works on --------------------------------------------- */

/* Whether the last level is eliminated (band.h). */
bool cf_varied_eliminates(const cf_varied *v);

/* level[at].e = one V-cycle on level[at].r. */
void cf_varied_cycle(const cf_varied *v, int at);

/* Ghosts of x beside visited cells: the other side of a seam, or 0. */
void cf_varied_set_ghosts(const cf_varied *v, cf_cell x);

/* x = 0 on the cells inside. */
void cf_varied_clear(const cf_varied *v, cf_cell x);

void cf_varied_copy(const cf_varied *v, cf_cell from, cf_cell to);

/* --- passes of conjugate gradients (varied_rows.c) ----------------------------------------------------- */

typedef struct cf_varied_sums {
  double first, second, third;
} cf_varied_sums;

/* r = b - A x; the squares of r, of b, and of x times the diagonal (as level 0 has it). */
cf_varied_sums cf_varied_form(const cf_varied *v, cf_cell x, cf_cell b);

/* The part `run` of row (j, k), which begins at a whole number of lanes, with the first two sums, for half sweeps; and as
 * many sums of all rows. */
void cf_varied_form_run(const cf_varied *v, int j, int k, const cf_run *run, cf_cell x, cf_cell b);
cf_varied_sums cf_varied_add_up(const cf_varied *v, int count);

/* Residual and convergence from what has been formed. CF_NOT_FINITE. */
cf_status cf_varied_judge(const cf_varied *v, const cf_varied_sums *s, const cf_solve_options *o,
                          cf_solve_report *report);

/* level[0].r = scale r: the cycle's right side. */
void cf_varied_convert(const cf_varied *v, double scale);

/* z . A p and z . r, with z the cycle's correction; then p = z + beta p. */
cf_varied_sums cf_varied_test_correction(const cf_varied *v);
void cf_varied_turn(const cf_varied *v, double beta);

/* A p; p . A p and p . r. */
cf_varied_sums cf_varied_probe(const cf_varied *v);

/* x += a p, r -= a A p, and the next right side of the cycle; the square of r. */
double cf_varied_advance(const cf_varied *v, double a, double scale, cf_cell x);

/* --- stationary cycles (varied_cycles.c) ---------------------------------------------------------------- */

/* What one residual that is not formed anew can tell of the first one. */
#define CF_CYCLES_TELL 2e-7

/* Whether the present equation is one for them. */
bool cf_varied_can_cycle(const cf_varied *v);

/* Their state: r is in units of 1/unit; the squares of r, of b, of x when they were formed last, and on a finest level apart by
 * colour the sums of b and x; what the first is to be. What x was before it changed is in v->best if it has been kept there. */
typedef struct cf_cycling {
  const cf_varied *v;
  cf_cell x, b;
  double unit, rr, bb, xx, b_sum, x_sum, target;
  bool kept;
} cf_cycling;

/* r from x, and half sweeps before the first coarse correction. */
void cf_varied_begin(cf_cycling *w);

/* Cycles until the target or the limit is reached, or one does not gain what it should. */
void cf_varied_run_cycles(cf_cycling *w, int limit, int *iterations);

/* level[at].e from level[at].r, `at` below the finest one: a W-cycle. */
void cf_varied_correct(const cf_varied *v, int at);

/* --- on a finest level apart by colour (fields_cycle.c) ------------------------------------------------- */

/* Up to this share of couplings in the diagonals half sweeps do there without any cycle. */
#define CF_FIELDS_ALONE 0.97

/* As above; the coarse correction, half sweeps after it, x and r, and those before the next one unless this is thought to be the
 * last; these alone. */
void cf_fields_begin(cf_cycling *w);
void cf_fields_go_up(cf_cycling *w, bool last);
void cf_fields_go_down(cf_cycling *w);

/* The squares of b - A x, of b, and of x; r and e are scratch. */
cf_varied_sums cf_fields_form(const cf_varied *v, cf_cell x, cf_cell b);

/* --- half sweeps alone (varied_sweeps.c) --------------------------------------------------------------- */

/* Up to this stiffness (share of diffusion in the diagonal over alpha's) they do. */
#define CF_SWEEPS_ENOUGH 10

/* Whether they do here, with alpha the least one; fills the diagonal. */
bool cf_varied_set_sweeps(cf_varied *v, double alpha, double stiffness);

cf_status cf_varied_sweep(cf_varied *v, cf_cell b, const cf_solve_options *o, cf_cell x,
                          cf_solve_report *report);

#endif
