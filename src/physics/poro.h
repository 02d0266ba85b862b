/* SPDX-License-Identifier: MIT
 *
 * Water in porous bodies on the nodes of a particles' grid: one C-F step of the saturation S with everything
 * extensive (sums over particles, nothing divided by a porosity):
 *
 *     C_i = sum w c_p, m_i = sum w m_f, A_i = sum w A,   (L S)_i = sum over faces kappa_f (S_j - S_i)
 *     (C - beta L) S~ = m - tau d/(tau + d) A,            beta = d (d + F_T tau)/(tau + d)                     (34)
 *     A <- [tau A - d (1 - F_T) L S~]/(tau + d),          m <- m - d (A - F_T L S~)
 *
 * one stage of length d; two of them (SDIRK2) are a step. kappa_f = k (C_i + C_j)/(2 h^2): the share of the face that
 * is filled. L is symmetric and faces to cells without a body are closed, so sum m changes by what is held or added
 * and by nothing else, whatever the solver's tolerance.
 *
 * Where water is held (a bath around the body, wet cells): at a surface the distance z(theta) is had from the fill, as
 * if the surface were plane; cells with z < 0.1 (in h) take the held value, and the faces between a held cell j and
 * a free one i conduct k c h^(d-2)/clip(z_i/(z_i - z_j), 0.1, 1.5), c the water per volume: the value stands on the
 * surface, not in the cell (Gibou et al. 2002). Only cells within two of the outside are ever held, so a body that is
 * pulled thin does not become bath.
 *
 * Bodies may differ in k and F_T. Cells then have k and k F_T as means over the water that fits in, faces the harmonic
 * means of both: what conducts at once and what conducts in the end are each as two bodies one behind the other are.
 * Memory belongs to the part of L that is not F_T's, L - L_F, whose sum is 0 as well, so water is kept:
 *
 *     A <- [tau A - d (L - L_F) S~]/(tau + d),            m <- m - d (A - L_F S~)
 *
 * The solve is the library's one solver on the cells that are free. Does not do: tau that differs between bodies. A is the
 * divergence of a flux, and sums to 0 for as long as all of it decays alike.
 */
#ifndef CF_PHYSICS_PORO_H
#define CF_PHYSICS_PORO_H

#include "grid/region.h"
#include "solve/helmholtz.h"
#include "stencil/nodes.h"

/* Where and how water comes and goes. */
typedef enum cf_poro_kind {
  CF_PORO_BATH, /* S = value on the body's surface, where that is inside the shape */
  CF_PORO_HELD, /* S = value in all cells of the body inside the shape */
  CF_PORO_RATE  /* value is added inside the shape: kg/(s m^3) of the body */
} cf_poro_kind;

typedef struct cf_poro_source {
  cf_poro_kind kind;
  const cf_shape *shape; /* NULL: everywhere */
  cf_fn value;           /* of time (and place) */
  double from, to;       /* s */
  double amount;         /* kg: gone when it has given that much; INFINITY: never */
  double *given;         /* what it gave so far; the caller's, for it is state */
} cf_poro_source;

#define CF_PORO_SOURCES_MAX 32

typedef struct cf_poro_params {
  double k, tau, f_t;
  const cf_lanes
      *mixture; /* k and F_T vary: sums over particles of w c, w c k, w c k F_T, laid out as nodes->at are */
  bool two_stages; /* SDIRK2; one: backward Euler, as the paper */
  bool dense;      /* visits every cell of the lattice: the same bits, to compare with */
  cf_solve_options solver;
  int sources;
  const cf_poro_source *source;
} cf_poro_params;

typedef struct cf_poro {
  const cf_grid *grid; /* the lattice */
  cf_poro_params p;
  cf_tiles *tiles;
  cf_region *region;
  cf_helmholtz *solver;
  cf_cell C, m, A, fill, S, b, alpha, value, m0, A0; /* value: where held */
  cf_face beta;                                      /* kappa times `scale`; 0 to held cells */
  cf_cell k, k_now;                                  /* with a mixture: k, k F_T, */
  cf_face kappa, kappa_now;                          /* kappa and its part of L_F */
  double slow, fast;                                 /* of the stage: beta = slow kappa + fast kappa_F */
  double scale;                                      /* without a mixture beta over kappa, times h^2 */
  unsigned char *kind, *wet;                         /* of a cell: see poro_part.h, poro_cells.c */
  double *rows;                                      /* partial sums, one a row of cells */
} cf_poro;

/* `lattice` and the sources must outlive it. CF_BAD_ARGUMENT, CF_NO_MEMORY. */
cf_status cf_poro_create(cf_poro **w, const cf_grid *lattice, const cf_poro_params *p);
void cf_poro_destroy(cf_poro *w);

/* One step on nodes that hold sums (stencil/nodes.h); they then hold changes over C. *gained: how much the nodes
 * gained, kg (what particles near held cells do not take goes off again: cf_mpm.returned). CF_NOT_FINITE. */
cf_status cf_poro_step(cf_poro *w, cf_nodes *nodes, double t, double dt, double *gained,
                       cf_solve_report *report);

/* The weight of cf_mpm_filter's projection after a time: 1 - exp(-rate t) with the rate at which a wave as long as two
 * cells really decays (K = 4/h^2) where these are k and F_T; 0 where k is 0. */
double cf_poro_filter_rate(double k, double tau, double f_t, double h);

/* The distance in h from a plane surface of a body that fills the share theta of a node's spline; in [-1.5, 1.5]. */
double cf_poro_distance(double theta);

#endif
