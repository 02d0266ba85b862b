/* SPDX-License-Identifier: MIT
 *
 * How many substeps the explicit schemes of physics/diffuse.h need.
 *
 * The exponential leapfrog, q <- E q - (1 - E)(1 - F) k grad phi with E = exp(-dt/tau), then phi <- phi - dt div q,
 * has on a mode with div grad = -s^2 a step matrix of determinant E and trace 1 + E - (1 - E)(1 - F) dt D s^2,
 * D = k/C. It is stable where |trace| <= 1 + determinant, and with s^2 <= 4 dim/h^2 that is
 *
 *     2 dim ((1 - F) D/h^2) dt tanh(dt/(2 tau)) <= 1,
 *
 * between the limit of waves, c dt sqrt(dim) <= h, and Fourier's, 2 dim D dt <= h^2. Only axes along which
 * something can flow count in dim. What is asked for here is 0.9.
 *
 * The staggered WENO5 scheme was found stable to c dt/h = 0.65 in 2D and 0.55 in 3D; 0.5 and 0.4 are asked for,
 * and dt <= tau/4, so that its splitting of waves and relaxation stays accurate.
 */
#ifndef CF_STENCIL_EXPLICIT_H
#define CF_STENCIL_EXPLICIT_H

#include <math.h>

#define CF_EXPLICIT_MARGIN 0.9

/* The left side of the condition. `D` is the part that has a memory, (1 - F) k/C at its largest. */
static inline double cf_explicit_load(const int axes, const double D, const double tau, const double h,
                                      const double dt) {
  const double much = tau > 0 ? tanh(dt / (2 * tau)) : 1;
  return D > 0 ? 2 * axes * D / (h * h) * dt * much : 0;
}

/* Substeps of equal length in a step of dt: at least 1. The smaller of what waves and what Fourier's law would
 * need, which is never too few (tanh x <= min(x, 1)). */
static inline double cf_explicit_substeps(const int axes, const double D, const double tau, const double h,
                                          const double dt) {
  if (cf_explicit_load(axes, D, tau, h, dt) <= CF_EXPLICIT_MARGIN) return 1;
  const double fourier = 2 * axes * D / (h * h) * dt / CF_EXPLICIT_MARGIN;
  const double wave = tau > 0 ? dt / h * sqrt(axes * D / (tau * CF_EXPLICIT_MARGIN)) : (double)INFINITY;
  return ceil(fmin(fourier, wave));
}

/* The same for the WENO5 scheme; `c` is the wave speed. */
static inline double cf_explicit_wave_substeps(const int axes, const double c, const double tau,
                                               const double h, const double dt) {
  const double courant = axes == 3 ? 0.4 : 0.5;
  return fmax(1, ceil(fmax(c * dt / (courant * h), 4 * dt / tau) * (1 - 1e-12)));
}

#endif
