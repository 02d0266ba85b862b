/* SPDX-License-Identifier: MIT
 *
 * What the files of physics/phase.h share.
 *
 *   phase.c            creation, limits
 *   phase_flux.c       X: fluxes on faces and their divergence, row by row
 *   phase_react.c      psi and f, and the two laws that move eta and T in a row
 *   phase_explicit.c   stages of Runge-Kutta in one pass over all fields
 *   phase_implicit.c   SDIRK2
 *   phase_measure.c    energy, tip, sums
 */
#ifndef CF_PHYSICS_PHASE_PART_H
#define CF_PHYSICS_PHASE_PART_H

#include "grid/sweep.h"
#include "physics/phase.h"

/* Cells from <= i < to of a row. */
typedef struct cf_span {
  int from, to;
} cf_span;

/* Rows and planes of one thread. */
typedef struct cf_phase_rows {
  cf_real *x;         /* fluxes on the low faces of a row in x, and its high wall */
  cf_real *low, *y;   /* on the low and the high faces in y */
  cf_real *plane, *z; /* on the low faces of a plane in z; on the high faces of a row */
  cf_real *div;       /* X */
  cf_real *react, *rate, *beta, *A2;
  cf_span busy; /* of the row that is visited: outside it X and f are 0 */
} cf_phase_rows;

struct cf_phase {
  const cf_grid *grid;
  cf_phase_params p;
  cf_phase_places places;
  cf_anisotropy law;
  cf_anisotropy_bounds bounds;
  double drive_C, drive_S; /* cos and sin of 4 theta_0, for beta(v) */
  double strength_max;     /* of places.strength; -1: there is none */
  cf_wall_values eta_walls, T_walls;
  bool has_r, has_w;
  int threads; /* for which there are rows */
  cf_phase_rows *rows;
  cf_real *room;           /* the memory of the rows */
  cf_phase_state stage[2]; /* of Runge-Kutta */
  cf_helmholtz *A;         /* of implicit steps, and their fields */
  cf_cell x, b, alpha, X;
  cf_face beta;
  double beta_is;          /* which number beta stands for */
  double *sums;            /* 3 a row of the box */
  cf_span *filled;         /* where eta is not 0, per row of the box */
  cf_span *next_filled;    /* the same of what a stage makes */
  const cf_real *known_of; /* the eta that `filled` is right for within a step; NULL: none */
};

/* --- the divergence --------------------------------------------------------------------------------------- */

/* Visits row r of the box, which begins at cell `start`, with (this part of) X of it in rows->div. */
typedef void cf_phase_visit(const cf_phase *p, cf_phase_rows *rows, ptrdiff_t start, ptrdiff_t r,
                            void *context);
typedef enum cf_phase_part { CF_PHASE_X, CF_PHASE_X_1, CF_PHASE_X_2 } cf_phase_part; /* X_2 = X - X_1 */
void cf_phase_each_row(const cf_phase *p, cf_phase_part part, cf_cell eta, cf_phase_visit *visit,
                       void *context);

/* Looks where in each row eta is not 0. Then X and f are 0 outside the busy part of row (j, k): what has something in it
 * or next to it. With a wall that is held at something the whole row is busy. */
void cf_phase_find_filled(const cf_phase *p, cf_cell eta);
void cf_phase_note_filled(const cf_phase *p, ptrdiff_t r, const cf_real *row); /* row r of what is next */
cf_span cf_phase_busy(const cf_phase *p, int j, int k);

/* --- rows ------------------------------------------------------------------------------------------------- */

/* y += weight x. */
void cf_phase_add_row(int n, cf_real weight, const cf_real *x, cf_real *y);

/* react[i] = f. With `lean` T is H, the temperature in psi H + K eta, and lean[i] the slope min(df/deta, 0) of f
 * with that taken along, for implicit steps. */
typedef struct cf_phase_react {
  const cf_real *eta, *T, *noise, *beta; /* rows; noise and beta may be NULL */
  cf_real *react, *lean;
  cf_real gamma, alpha_pi, latent, coupling;
  bool karma;
} cf_phase_react;
void cf_phase_react_row(int n, const cf_phase_react *f);

/* beta(v) of eq. 27, and A^2, from central differences at n cells from `start` on. */
void cf_phase_beta_row(const cf_phase *p, int n, const cf_real *eta, ptrdiff_t start, cf_real *beta);
void cf_phase_A2_row(const cf_phase *p, int n, const cf_real *eta, ptrdiff_t start, cf_real *A2);

/* What f needs beside eta and T, made ready for n cells from `start` on. */
cf_phase_react cf_phase_react_of(const cf_phase *p, const cf_phase_rows *rows, int n, const cf_real *eta,
                                 ptrdiff_t start);

/* One layer of ghosts, corners included. */
void cf_phase_ghosts(const cf_phase *p, cf_cell eta);

#endif
