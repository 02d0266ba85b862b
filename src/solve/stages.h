/* SPDX-License-Identifier: MIT
 *
 * What the fast path does to the rows of a level, as stages that a pass strings together (wave.h).
 *
 * With A' e = r the equation of the correction and d the diagonal:
 *
 *     FORM         r = (b - A x) / scale in double, and the sums of squares of b - A x, b and x; then FIRST
 *     FIRST        red: e = omega r / d, what a half sweep does to e = 0 (a part of FORM, UPDATE, RESTRICT)
 *     SECOND       black: e = omega (r + neighbours) / d, what the next half sweep does
 *     RED, BLACK   a half sweep of over-relaxed Gauss-Seidel
 *     RED_EDGES, BLACK_EDGES  the same on segments at edges (segments.h) alone
 *     LAST         a black half sweep that leaves the residual behind in r
 *     UPDATE       red: r -= A' e; all: x += gain e, and the sum of r^2; then FIRST on the new r
 *     ADD          x += gain e; on levels of fields alone (fields.h)
 *     RESTRICT     the residual of SECOND, averaged over the children of a coarse cell; FIRST on the coarse level
 *     RESTRICT_RED the same after a black half sweep with omega = 1, which leaves nothing on black cells
 *     PROLONG      e += interpolated correction of the coarse level; on black cells alone if the red half sweep that
 *                  follows has omega = 1, and so makes e of red cells from that of black ones, whatever it was
 *
 * The black half after SECOND or LAST needs no stencil for its residual: the half sweep took it out but for what
 * over-relaxation did, (1 - omega) of what was there, since its neighbours, red ones all, have not changed.
 * Across the seam of an odd periodic axis neighbours do share a colour; levels that have one take
 *
 *     CLEAR        e = 0
 *     RESIDUAL     r -= A' e for all cells (UPDATE then leaves r alone), and RESTRICT with stencils everywhere.
 *
 * r and the e added to x stay true to each other to about 1e-8 of the r at the start: A' e is formed from
 * differences, which are exact where e is smooth, and the change of r from the change of e as it was stored.
 */
#ifndef CF_SOLVE_STAGES_H
#define CF_SOLVE_STAGES_H

#include "solve/split.h"

typedef enum cf_pass_stage {
  CF_PASS_FORM,
  CF_PASS_FIRST,
  CF_PASS_SECOND,
  CF_PASS_RED,
  CF_PASS_BLACK,
  CF_PASS_RED_EDGES,
  CF_PASS_BLACK_EDGES,
  CF_PASS_LAST,
  CF_PASS_ADD,
  CF_PASS_UPDATE,
  CF_PASS_RESTRICT,
  CF_PASS_RESTRICT_RED,
  CF_PASS_PROLONG,
  CF_PASS_CLEAR,
  CF_PASS_RESIDUAL
} cf_pass_stage;

/* Longest list of stages in one pass. */
#define CF_PASS_STAGES 40

/* What FORM adds up along every row; UPDATE does so for the residual and, if asked, x. */
typedef enum cf_pass_sum {
  CF_SUM_RESIDUAL, /* of the squares of b - A x (FORM) or r (UPDATE) */
  CF_SUM_X2,
  CF_SUM_X,
  CF_SUM_B2,
  CF_SUM_B,
  CF_SUM_BLACK, /* in a region UPDATE and LAST add up the products of r before and after, */
  CF_SUM_RED,   /* for either colour */
  CF_PASS_SUMS
} cf_pass_sum;

typedef struct cf_pass {
  const cf_split *at, *coarse;    /* coarse: NULL on the coarsest level */
  const struct cf_coupled *below; /* the coarse level of one that has segments or fields */
  int count;
  cf_pass_stage stage[CF_PASS_STAGES];
  float omega[CF_PASS_STAGES]; /* of the half sweep; 0: the level's */

  /* of the finest level alone */
  cf_real *x;
  const cf_real *b;
  double alpha, beta; /* not scaled */
  double shift;       /* FORM subtracts it from b - A x */
  double scale;       /* FORM divides by it */
  cf_real *keep;      /* on levels of fields: where x goes before it is changed; NULL: nowhere */
  double gain, lift;  /* UPDATE: x += gain e + lift */
  double step;        /* in a region LAST and UPDATE take so much of the correction; gain contains it */
  bool sums_of_x;     /* UPDATE adds up x and its squares as well */
  ptrdiff_t sums;     /* pieces of rows that the level has */
  double *rows;       /* `sums` numbers of each kind of cf_pass_sum */
} cf_pass;

static inline void cf_pass_push(cf_pass *p, const cf_pass_stage stage, const double omega) {
  p->omega[p->count] = (float)omega;
  p->stage[p->count++] = stage;
}

/* omega of half sweep v, at least 1, after one with `omega` (1 for the first), that damp all errors alike; j2: the square of the radius
 * of Jacobi's iteration (Golub and Varga 1961). */
static inline double cf_omega_after(const int v, const double j2, const double omega) {
  return v == 1 ? 1 / (1 - j2 / 2) : 1 / (1 - j2 * omega / 4);
}

/* Pieces of some rows of a plane, elements [from, to) of their halves, and a thread's own memory. */
typedef struct cf_strip {
  int j, end; /* rows [j, end) */
  int k, from, to;
  int next_j, next_k; /* the rows that the same stage will have next: fetched meanwhile; next_k < 0: none */
  ptrdiff_t sum,
      sum_step; /* where in `rows` the sums of row j go, and how far from there those of the next row */
  void *scratch;
} cf_strip;

/* Bytes of scratch that rows of n cells need. */
size_t cf_stage_scratch(const cf_split *s);

/* What stage number `number` of the pass does to a strip. */
void cf_stage_run(const cf_pass *p, int number, const cf_strip *t);

/* Whether the stage reads e (or x) of neighbouring rows, so that ghosts must be right. */
bool cf_stage_reads_around(cf_pass_stage stage);

#endif
