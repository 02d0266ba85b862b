/* SPDX-License-Identifier: MIT
 *
 * The hierarchy of levels behind an operator, and one V-cycle over it.
 */
#ifndef CF_SOLVE_MULTIGRID_H
#define CF_SOLVE_MULTIGRID_H

#include "solve/direct.h"
#include "solve/helmholtz.h"
#include "solve/level.h"

#define CF_LEVELS_MAX 40

/* Where diffusion adds less than this to the diagonal, Gauss-Seidel alone is enough. */
#define CF_STIFF_ENOUGH 3.0

struct cf_helmholtz {
  cf_grid grid;
  cf_walls walls;     /* kinds */
  int levels, wanted; /* levels made; asked for by the caller, 0: as needed */
  int depth;          /* levels that the present coefficients use */
  cf_level level[CF_LEVELS_MAX];
  cf_halo outside; /* what a caller's x must hold beyond the walls: the other side, or 0 */
  bool has_held_wall;
  bool singular;                /* alpha = 0 and no held wall */
  double beta;                  /* where it is a number */
  struct cf_box_solver *box;    /* the fast path; NULL until coefficients are numbers */
  bool in_box;                  /* the present coefficients are a case for it */
  struct cf_varied *varied;     /* coefficients that are fields, and regions; NULL until there are any */
  bool is_varied;               /* the present coefficients are a case for it */
  struct cf_box_solver *around; /* numbers in a region: the fast path there, above levels of `varied` */
  bool around_tiles;            /* it was made for tiles */
  bool around_is_set;           /* ... and nothing else has been set since */
  struct cf_window *window;     /* a region that fills a small part of the box; NULL until there is one */
  bool in_window, no_windows;   /* the present coefficients are a case for it; none may be */
  cf_cell r, p, Ap, z;          /* of conjugate gradients on the finest level */
  cf_cell coarse[3];            /* the same on the coarsest */
  int coarse_level;             /* for which `coarse` is shaped; -1: none yet */
  cf_real *scratch;             /* rows for the transfers, one a thread */
  cf_direct direct;             /* the coarsest level where it has few cells */
  double *line;                 /* work of the coarsest level where it is a line */
};

/* z = one V-cycle on A z = r from z = 0. */
void cf_multigrid_cycle(cf_helmholtz *A, cf_cell r, cf_cell z);

/* Sets the vector to zero on the cells of the box. */
void cf_level_clear(const cf_level *l, cf_cell x);

/* omega of Gauss-Seidel: 1 + (share of diffusion in the diagonal)^2 / 5. */
cf_real cf_level_relaxation(const cf_level *l);

#endif
