/* SPDX-License-Identifier: MIT
 *
 * How a cycle of eight half sweeps on the finest level is set, by alpha's share in the diagonal (0: Poisson's equation): omega of
 * its half sweeps less 1, and by what share alpha and beta of the coarse levels differ from their own. Found by minimizing what
 * three cycles leave of noise, and of smooth waves, in a box without walls, where Fourier's analysis (couplings of the eight waves
 * that coincide on the coarse level; four in 2D) tells it in no time. Coarse levels that differ a little make up for what
 * averaging does to alpha and for what over-relaxation does to smooth waves; the rates are a fifth of those without.
 * The fourth half sweep is not over-relaxed: RESTRICT_RED (stages.h) asks for that.
 */
#ifndef CF_SOLVE_SETTING_H
#define CF_SOLVE_SETTING_H

/* Half sweeps of a cycle, as many before the coarse correction as after it. */
#define CF_BOX_HALF_SWEEPS 8

typedef struct cf_setting {
  double share, over[CF_BOX_HALF_SWEEPS], alpha, beta;
} cf_setting;

/* stiffness: 4 sigma in 2D, 6 sigma in 3D; infinite without alpha. */
cf_setting cf_setting_for(int dim, double stiffness);

#endif
