/* SPDX-License-Identifier: MIT
 *
 * Cattaneo-Fourier diffusion of one scalar in a medium at rest (what moves is src/physics/advect.h's):
 *
 *     C phi_t + div q = C W,     q = q_C - F_T k grad phi,                                            (1, 6, 7)
 *     tau (q_C)_t + q_C + (1 - F_T) k grad phi = tau B.                                                    (8)
 *
 * phi in cells, q_C on faces. One implicit stage of length d serves every scheme: with m = tau/(tau + d), what
 * is left of a flux after d,
 *
 *     beta = d (1 - m + F_T m) k,     (C - div beta grad) phi~ = C phi* - d m div q* + d C W               (17)
 *     q    = m q* - (1 - m)(1 - F_T) k grad phi~                                                           (18)
 *     phi  = phi* - (d/C) div(q - F_T k grad phi~) + d W
 *
 * and the last line (in place of phi = phi~) keeps sum C phi to round-off whatever the solver's tolerance.
 * tau = 0, F_T = 0 or 1 and k = 0 are ordinary values.
 *
 *   CF_DIFFUSE_PAPER   eqs 11-18 as printed: one stage of backward Euler, W taken at the old time, phi = phi~.
 *   CF_DIFFUSE_SDIRK2  two stages of g dt, g = 1 - 1/sqrt(2), the second from -sqrt(2) y + (1 + sqrt(2)) Y1
 *                      (Alexander 1977): second order, L-stable, no history. The default.
 *
 * k lives on faces: the harmonic mean of its cells, the cell's own on a held wall.
 * Not done here: advection, the front filter, explicit schemes.
 */
#ifndef CF_PHYSICS_DIFFUSE_H
#define CF_PHYSICS_DIFFUSE_H

#include "base/fn.h"
#include "base/walls.h"
#include "grid/field.h"
#include "grid/grid.h"
#include "solve/helmholtz.h"

typedef enum cf_diffuse_scheme { CF_DIFFUSE_PAPER, CF_DIFFUSE_SDIRK2 } cf_diffuse_scheme;

/* What acts on the scalar; a NULL function does not act. Each writes every cell (face) of its fields at time t. */
typedef struct cf_source {
  cf_status (*rate)(void *context, double t, cf_cell W);      /* d phi/dt */
  cf_status (*flux_rate)(void *context, double t, cf_face B); /* d q/dt */
  /* Cells held at `value` with weight `fraction` in [0, 1] (0: free, 1: held). */
  cf_status (*hold)(void *context, double t, cf_cell fraction, cf_cell value);
  void *context;
} cf_source;

typedef struct cf_diffuse_params {
  cf_fn k;        /* m^2/s (times C's unit); constant or of x, y, z; >= 0 */
  cf_fn capacity; /* C > 0 */
  double tau;     /* s, >= 0; INFINITY is a value too */
  double f_t;     /* 0 ... 1 */
  cf_diffuse_scheme scheme;
  cf_solve_options solver;
  int levels; /* of multigrid; 0: as needed */
} cf_diffuse_params;

/* Where the scalar's sum came from and went, in absolute amounts (integral of C phi). With `first` what was there
 * at the start, first + entered - left is what must be inside: the ledger. State. */
typedef struct cf_ledger {
  double first, entered, left;
} cf_ledger;

typedef struct cf_diffuse cf_diffuse;

/* `g` must outlive the object. CF_BAD_ARGUMENT: a parameter out of range, or k < 0, C <= 0 somewhere. */
cf_status cf_diffuse_create(cf_diffuse **d, const cf_grid *g, const cf_walls *walls,
                            const cf_diffuse_params *p, const cf_source *source);
void cf_diffuse_destroy(cf_diffuse *d); /* NULL is fine */

/* phi and q from t to t + dt. The ghosts of both are scratch. report->iterations is summed over the solves,
 * ->residual the largest. CF_NOT_FINITE as cf_helmholtz_solve. */
cf_status cf_diffuse_step(cf_diffuse *d, double t, double dt, cf_cell phi, cf_face q, cf_ledger *ledger,
                          cf_solve_report *report);

/* Integral of C phi over the box, J. */
double cf_diffuse_content(const cf_diffuse *d, cf_cell phi);

/* (inside - first - entered + left) / (|first| + entered + left), 0 if all are 0. */
double cf_ledger_error(const cf_ledger *l, double inside);

/* Adds an amount to `entered`, or to `left` where it is negative. */
void cf_ledger_add(cf_ledger *l, double amount);

/* The largest k of the box, and the largest wave speed sqrt((1 - F_T) k/(C tau)); 0 where tau = 0. */
double cf_diffuse_k_max(const cf_diffuse *d);
double cf_diffuse_speed_max(const cf_diffuse *d);

#endif
