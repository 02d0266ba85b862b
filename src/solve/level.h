/* SPDX-License-Identifier: MIT
 *
 * The one operator of the project, on one level of a multigrid hierarchy:
 *
 *     (A x)_p = alpha x_p + sum over axes a of  lo_a (x_p - x_{p-a}) + hi_a (x_p - x_{p+a}),
 *
 * which is (alpha - div beta grad) x on cells for numbers alpha and beta, point-scaled (fields and regions: varied.h).
 * lo_a and hi_a are tables along axis a alone:
 * 1/(width of the cell * distance to the neighbour). They hold the walls as well, so no kernel asks where it
 * is: 0 on an insulated wall, 1/(w * w/2) on a held one (the ghost behind it stays 0; values of a wall are
 * part of the right side), and the distance around the seam on a periodic axis. One cell does not go around: it is no neighbour of its own.
 *
 * Coarse cells are pairs of fine cells per axis. Where the count is odd the last cell stays alone, or makes a triple where it
 * is narrower than the others (transfer.h), so every extent coarsens down to 1 and a wall never moves. Triples on level after level
 * would cost as many cycles again. Hence widths vary (in the last cell of an axis), and the
 * operator is self-adjoint in the inner product weighted with the cells' volumes.
 */
#ifndef CF_SOLVE_LEVEL_H
#define CF_SOLVE_LEVEL_H

#include <stdbool.h>

#include "base/walls.h"
#include "grid/field.h"
#include "grid/halo.h"

/* What an axis is made of, in units of the finest cell. Tables have n entries. */
typedef struct cf_axis {
  int n;
  bool periodic, held[2]; /* periodic: and of more than one cell */
  double *width;
  cf_real *lo, *hi;  /* see above, multiplied by beta */
  double *lo1, *hi1; /* the same without beta */
} cf_axis;

/* How the cells of an axis sit in those of the next coarser level. */
typedef struct cf_pairing {
  bool coarsened;     /* false: cell i is coarse cell i */
  int *parent;        /* of fine cell i */
  int *other;         /* the second coarse cell that fine cell i is interpolated from; -1 or n_c: a ghost */
  cf_real *weight[2]; /* of parent and other in linear interpolation */
  cf_real *share;     /* width of fine cell i over width of its parent: restriction's weights sum to 1 */
} cf_pairing;

typedef struct cf_level {
  cf_box box;
  int threads;
  cf_axis axis[3];
  cf_pairing pairing[3]; /* to the next coarser level, if there is one */
  cf_halo wrap;          /* fills the ghosts of periodic axes, leaves the others 0 */
  bool has_seam;         /* any axis periodic */

  double alpha;

  cf_cell x, b, r; /* correction, right side, residual: coarse levels own x and b, every level r */
  double *rows;    /* partial sums, 2 a row */
} cf_level;

/* r = b - A x. x's periodic ghosts are filled first. */
void cf_level_residual(const cf_level *l, cf_cell x, cf_cell b, cf_cell r);

/* y = A x. */
void cf_level_apply(const cf_level *l, cf_cell x, cf_cell y);

/* One red-black sweep of over-relaxed Gauss-Seidel on A x = b. */
void cf_level_smooth(const cf_level *l, cf_cell b, cf_real omega, cf_cell x);

/* The diagonal's part that diffusion adds in the middle of the box, over alpha: how much there is to smooth.
 * Infinite for alpha = 0. */
double cf_level_stiffness(const cf_level *l);

/* sum x y and sum x, weighted by cell volumes in units of the finest; ordered. */
double cf_level_dot(const cf_level *l, cf_cell x, cf_cell y);
double cf_level_sum(const cf_level *l, cf_cell x);

#endif
