/* SPDX-License-Identifier: MIT
 *
 * Shared by the two files of the fast path: box_cycle.c has its passes and the cycle, box_solver.c what it is made of and
 * the iteration.
 */
#ifndef CF_SOLVE_BOX_PART_H
#define CF_SOLVE_BOX_PART_H

#include "solve/box_solver.h"
#include "solve/direct.h"
#include "solve/multigrid.h"
#include "solve/segments.h"
#include "solve/setting.h"
#include "solve/varied_part.h"
#include "solve/wave.h"

/* Up to this stiffness half sweeps alone are fewer operations, and fewer passes over memory, than cycles with coarse
 * levels: 32 of them, in one pass, do what 5 or 6 cycles do. */
#define CF_BOX_SWEEPS_ENOUGH 10
/* Over-relaxation of the finest level over that of the others, where cycles are not thorough. */
#define CF_BOX_FINEST_OVER 0.85

struct cf_box_solver {
  /* In a region: the finest level alone, on segments, above the coarse levels of this one. NULL: the whole box. */
  cf_varied *varied;
  cf_segments segments;

  int levels, depth;
  cf_split level[CF_LEVELS_MAX];
  cf_wave wave;
  cf_direct direct; /* where the coarsest level has few cells */
  double *line;     /* where it is a line: work */
  double *rows;
  ptrdiff_t sums;
  double alpha, beta, scale; /* scale: the diagonal in the middle of the finest level */
  double jacobi;             /* spectral radius of Jacobi's iteration on the coarsest level */
  bool thorough; /* eight half sweeps a cycle on the finest level, two corrections from each level below */
  double omega[CF_BOX_HALF_SWEEPS]; /* of those half sweeps */
  bool singular, lost; /* no alpha at all (in a region: everywhere, and nothing known); next to none */
  bool free_mean;      /* no wall is held, and alpha is small or 0 */
};

typedef struct cf_box_iteration {
  double scale;      /* of r, a power of two */
  double bb, xx, rr; /* squares */
  double b_sum, x_sum;
  double start;       /* rr where the recursion began */
  double rate;        /* of |r| in the latest pass */
  double shift, lift; /* FORM takes shift from b, the next pass adds lift to x */
  double lifted;      /* the largest lift so far: x has its round-off */
  double step;        /* in a region: how much of the next correction to take */
  bool overshoots;    /* the latest cycle did harm that no step mends */
  bool ready;         /* the first part of the next cycle is done */
} cf_box_iteration;

/* The coarsest level as the direct solution takes it: without an alpha too small to be seen beside beta. */
cf_level cf_box_coarsest(const cf_box_solver *f);

/* In a region: the largest of b and scale x among a few rows. */
double cf_box_sample_around(const cf_box_solver *f, cf_cell b, cf_cell x);

/* In a region: what cells with another parent (coarsen.h) leave to the coarse level, and take from it. */
void cf_box_gather_odds(const cf_box_solver *f);
void cf_box_spread_odds(const cf_box_solver *f);

/* r = b - A x, and the first part of a cycle. */
void cf_box_form(const cf_box_solver *f, const cf_helmholtz *A, cf_cell b, cf_cell x, cf_box_iteration *it);

/* One V-cycle; `last`: the first part of the next one is left away. */
void cf_box_cycle(const cf_box_solver *f, cf_cell b, cf_cell x, bool last, cf_box_iteration *it);

/* One pass of half sweeps that is to gain so much. */
void cf_box_sweeps(const cf_box_solver *f, cf_cell b, cf_cell x, double gain, cf_box_iteration *it);

static inline bool cf_level_is_solved_directly(const cf_level *l) {
  return cf_level_is_line(l) || cf_level_is_few(l);
}

#endif
