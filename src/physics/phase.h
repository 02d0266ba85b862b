/* SPDX-License-Identifier: MIT
 *
 * A crystal that grows into its own undercooled melt or vapour: the phase eta, 1 in the solid and 0 outside, and
 * the temperature T, both with fluxes that have a memory. With p = grad_* eta = (eta_x, eta_y, Gamma eta_z), the
 * anisotropy A(p) of stencil/anisotropy.h and
 *
 *     X = eps^2 div_* [A^2 p + A |p|^2 dA/dp],     f = eta (1 - eta)(eta - 1/2 + psi),
 *     psi(T) = -(alpha/pi) atan(gamma beta(v) T),
 *
 * section 7 of the paper, in its variational form (Kobayashi 1993) with the latent heat K, reads in two forms:
 *
 *     stable    tau_1 r_t + r = (1 - F) (X + f),             tau_eta eta_t = r + F (X + f)
 *     paper     tau_1 r_t + r = (1 - F) X_1,                 tau_eta eta_t = r + F X_1 + (X - X_1) + f,
 *               X_1 = eps^2 div_* A^2 p                                                          (27, 28)
 *
 * In the paper's form only the flux has a memory, and eliminating it gives tau_1 tau_eta eta_tt + (tau_eta - tau_1 f')
 * eta_t = ...: the damping is negative where tau_1 f' > tau_eta, there every wavelength grows at a rate that no grid
 * bounds, and what grows is the grid's. In the stable form all of the driving force has it; with psi frozen
 *
 *     E = integral of  tau_1 r^2/(2 (1 - F) tau_eta) + eps^2 A^2 |p|^2/2 + g(eta),    g' = -f,
 *
 * never rises, whatever tau_1. F = 1 or tau_1 = 0 is the classical (Allen-Cahn) equation in both.
 *
 *     heat      T_t = K eta_t + F_T D lap T + w + W,    tau_2 w_t + w = (1 - F_T) D lap T
 *
 * r and w are minus the divergences of the paper's fluxes q_eta, q_T, which is all of them that matters as long as
 * tau_1 and tau_2 are numbers. T = 0 is the melting point; the sum of T - K eta changes only through walls and W.
 *
 * eq. 27's beta(v) = 1 - delta (1 - sum v_i^4/|v|^4) is `drive_strength` (v the gradient of eta). In place of the
 * arc tangent stands, for `karma_rappel`, psi = -2 lambda T eta (1 - eta), f four times as large, and tau_eta times
 * A^2: the model of the PFHub benchmark 3 in our eta (Karma, Rappel 1998).
 *
 * Two ways to take a step. Explicit (phase_explicit.c): all fields in one pass a stage, three stages of third order,
 * substeps as its limits ask. Implicit (phase_implicit.c): eta and r by two stages of SDIRK2 with the solver of
 * floor 3; heat is then somebody else's diffusion step with K (eta_new - eta_old)/dt as its source.
 *
 * Gamma is in the phase's operators alone: heat spreads alike in all directions, which eq. 28 with Gamma = 0 would
 * forbid. Orientation turns crystals about z only. tau_1, tau_2, D are one number each.
 */
#ifndef CF_PHYSICS_PHASE_H
#define CF_PHYSICS_PHASE_H

#include "grid/field.h"
#include "grid/grid.h"
#include "grid/wall.h"
#include "solve/helmholtz.h"
#include "stencil/anisotropy.h"

typedef enum cf_phase_form { CF_PHASE_STABLE, CF_PHASE_PAPER } cf_phase_form;

typedef struct cf_phase_params {
  cf_phase_form form;
  bool plain;            /* five-point differences (seven in 3D): the grid shows in the crystal */
  double width;          /* eps, m; the interface is 6.2 eps wide from 10 to 90 % */
  double tau_eta, tau_1; /* s; tau_eta may be 0 where tau_1 is not and F < 1, in the stable form */
  double f_eta;          /* F, 0 ... 1 */
  double alpha, gamma;   /* of psi */
  double drive_strength; /* delta of beta(v); 0: psi does not see the direction */
  bool karma_rappel;
  double coupling; /* lambda of karma_rappel */
  cf_anisotropy_params anisotropy;
  double star;          /* Gamma */
  double latent;        /* K */
  double D, tau_2, f_t; /* of heat: m^2/s, s, 0 ... 1 */
  cf_solve_options solver;
} cf_phase_params;

/* Fields that vary from place to place, all borrowed and read in every step; `at` NULL: there is none. Their first
 * layer of ghosts must be filled. */
typedef struct cf_phase_places {
  cf_cell strength, C, S; /* e, cos(n theta_0), sin(n theta_0) of the anisotropy: all three or none */
  cf_cell mobility;       /* factor on eta_t, 0 ... 1: where 0 nothing grows. Ghosts are not read */
  cf_cell noise;          /* added to psi. Ghosts are not read */
} cf_phase_places;

/* r.at and w.at are there if cf_phase_has_memory, cf_phase_heat_has_memory. The ghosts are scratch. */
typedef struct cf_phase_state {
  cf_cell eta, r, T, w;
} cf_phase_state;

typedef struct cf_phase cf_phase;

bool cf_phase_has_memory(const cf_phase_params *p);
bool cf_phase_heat_has_memory(const cf_phase_params *p);

/* `g` must outlive the object. walls_eta, walls_T: of radiating ones only what value walls have is used.
 * CF_BAD_ARGUMENT, CF_NO_MEMORY. implicit: whether cf_phase_step_implicit will be called. */
typedef struct cf_phase_walls {
  cf_walls eta, T;
} cf_phase_walls;
cf_status cf_phase_create(cf_phase **p, const cf_grid *g, const cf_phase_walls *walls,
                          const cf_phase_params *params, const cf_phase_places *places, bool implicit);
void cf_phase_destroy(cf_phase *p);

/* Numbers that may change from one step to the next (a schedule): those with which memories keep being there or
 * not, form and anisotropy's folds must stay. CF_BAD_ARGUMENT. */
cf_status cf_phase_set(cf_phase *p, const cf_phase_params *params);

/* The longest stable explicit step with the present numbers, s: of the phase, of the heat beside it, and of both with the
 * heat that freezing releases. */
typedef struct cf_phase_limits {
  double phase, heat, both;
  double reaction; /* tau_eta, or what stands for it: the time in which the interface acts, for accuracy */
} cf_phase_limits;
cf_phase_limits cf_phase_limits_of(const cf_phase *p);

/* All four fields from t to t + dt in `substeps` equal steps. `order`: 3, or 1 for forward Euler. W (NULL: none) is
 * dT/dt from elsewhere, constant over the step. heat_in: what came in through the walls of T is added to it, as an
 * integral of T. CF_BAD_ARGUMENT: no substeps. */
typedef struct cf_phase_explicit {
  int order, substeps;
  cf_cell W;
  bool leaks; /* a flow has carried w through the walls: what is left of it no longer adds up to 0 */
} cf_phase_explicit;
cf_status cf_phase_step_explicit(cf_phase *p, double t, double dt, const cf_phase_explicit *how,
                                 const cf_phase_state *y, double *heat_in);

/* eta and r from t to t + dt. The temperature in psi is H + K eta, H = T - K eta extrapolated: h_now is H at t, and
 * h_before H at t - dt_before (dt_before = 0: there was no step). T is not changed. */
typedef struct cf_phase_heat {
  cf_cell h_now, h_before;
  double dt_before;
} cf_phase_heat;
cf_status cf_phase_step_implicit(cf_phase *p, double t, double dt, const cf_phase_heat *heat, cf_cell eta,
                                 cf_cell r, cf_solve_report *report);

/* --- measures --------------------------------------------------------------------------------------------- */

/* E above with the present T; integrals of eta and of T - K eta. */
double cf_phase_energy(cf_phase *p, const cf_phase_state *y);
double cf_phase_solid(const cf_phase *p, cf_cell eta);
double cf_phase_heat_content(const cf_phase *p, const cf_phase_state *y);

/* The largest distance from `from` at which eta passes 1/2, interpolated between neighbouring cells; and where.
 * 0 where there is no solid. axis: 0..2 for the reach along +axis instead (from's other coordinates do not
 * matter), or -1. */
double cf_phase_tip(const cf_phase *p, cf_cell eta, const double from[3], int axis, double where[3]);

#endif
