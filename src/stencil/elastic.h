/* SPDX-License-Identifier: MIT
 *
 * Elastic laws at a point, eight points side by side: from the deformation gradient F (row by row) and the moduli to
 * the Kirchhoff stress T = P F^T (per initial volume), and what changes of it do. J = det F.
 *
 *     fixed corotated  T = 2 mu (F - R) F^T + lambda (J - 1) J I             (Stomakhin et al. 2012; eq. 32's first part)
 *     neo-Hookean      T = mu (F F^T - I) + lambda ln J I
 *     swelling         T = - chi S I,  S = m_f/(c_0 J) with the water m_f of the point kept      (eq. 32's second)
 *
 * (32) calls T a Cauchy stress; it is used per initial volume, so it is Kirchhoff's.
 *
 * Hardening (Stomakhin et al. 2013): both moduli times exp(xi (1 - J_P)), J_P the plastic part of the volume. (After
 * (32) mu would go with J_E: that is an elastic law with a further stress of its own, and not what it is from.)
 *
 * The change of P = T F^-T with F (Stomakhin et al. 2012, tech. report), for the semi-implicit step:
 *
 *     fixed corotated  dP = 2 mu (dF - dR) + lambda [cof F (cof F : dF) + (J - 1) dcof F]
 *     neo-Hookean      dP = mu dF + lambda F^-T (F^-T : dF) + (lambda ln J - mu) d(F^-T),   F^-T = cof F/J
 *     swelling         dP = - chi S J d(cof F/J^2)
 *
 * dR = R W, W skew: (tr(S) I - S) w = axial vector of R^T dF - dF^T R, S = R^T F.
 */
#ifndef CF_STENCIL_ELASTIC_H
#define CF_STENCIL_ELASTIC_H

#include "base/polar.h"

/* T of the fixed-corotated law, and J. */
CF_SMALL void cf_elastic_corotated(const int dim, const cf_lanes *F, const cf_lanes *mu,
                                   const cf_lanes *lambda, cf_lanes *T, cf_lanes *J) {
  cf_lanes R[9], C[9];
  cf_polar(dim, F, R);
  cf_small_cofactor(dim, F, C, J);
  CF_SMALL_LOOP
  for (int e = 0; e < dim * dim; ++e) R[e] = 2 * *mu * (F[e] - R[e]);
  cf_small_mul_t(dim, R, F, T);
  const cf_lanes pressure = *lambda * (*J - 1) * *J;
  CF_SMALL_LOOP
  for (int a = 0; a < dim; ++a) T[a * dim + a] += pressure;
}

/* J that a logarithm can take: below, the law is that of the bound. */
#define CF_ELASTIC_LEAST_J ((cf_real)1e-3)

CF_SMALL void cf_elastic_log(const cf_lanes *J, cf_lanes *y) {
  cf_lanes x = *J;
  cf_lanes_at_least(CF_ELASTIC_LEAST_J, &x);
  CF_SMALL_LOOP
  for (int l = 0; l < CF_WIDE; ++l) (*y)[l] = (cf_real)log((double)x[l]);
}

CF_SMALL void cf_elastic_neo_hookean(const int dim, const cf_lanes *F, const cf_lanes *mu,
                                     const cf_lanes *lambda, cf_lanes *T, cf_lanes *J) {
  cf_lanes C[9], ln_j;
  cf_small_cofactor(dim, F, C, J);
  cf_elastic_log(J, &ln_j);
  cf_small_mul_t(dim, F, F, T);
  CF_SMALL_LOOP
  for (int e = 0; e < dim * dim; ++e) T[e] = *mu * T[e];
  const cf_lanes pressure = *lambda * ln_j - *mu;
  CF_SMALL_LOOP
  for (int a = 0; a < dim; ++a) T[a * dim + a] += pressure;
}

/* --- changes ----------------------------------------------------------------------------------------------- */

/* What cof F becomes to first order. */
CF_SMALL void cf_elastic_cofactor_change(const int dim, const cf_lanes *F, const cf_lanes *dF, cf_lanes *dC) {
  if (dim == 2) {
    dC[0] = dF[3], dC[1] = -dF[2], dC[2] = -dF[1], dC[3] = dF[0];
    return;
  }
  CF_SMALL_LOOP
  for (int e = 0; e < 9; ++e) {
    const int a = (e / 3 + 1) % 3 * 3, b = (e / 3 + 2) % 3 * 3, c = (e + 1) % 3, d = (e + 2) % 3;
    dC[e] = dF[a + c] * F[b + d] + F[a + c] * dF[b + d] - dF[a + d] * F[b + c] - F[a + d] * dF[b + c];
  }
}

/* dR for a change dF. */
CF_SMALL void cf_elastic_rotation_change(const int dim, const cf_lanes *F, const cf_lanes *R,
                                         const cf_lanes *dF, cf_lanes *dR) {
  cf_lanes S[9], X[9];
  cf_small_t_mul(dim, R, F, S);
  cf_small_t_mul(dim, R, dF, X);
  if (dim == 2) {
    const cf_lanes w = (X[2] - X[1]) / (S[0] + S[3]);
    dR[0] = R[1] * w, dR[1] = -R[0] * w, dR[2] = R[3] * w, dR[3] = -R[2] * w;
    return;
  }
  const cf_lanes a = X[7] - X[5], b = X[2] - X[6], c = X[3] - X[1];
  const cf_lanes xx = S[4] + S[8], yy = S[0] + S[8], zz = S[0] + S[4];
  const cf_lanes xy = -S[1], xz = -S[2], yz = -S[5];
  const cf_lanes m0 = yy * zz - yz * yz, m1 = xz * yz - xy * zz, m2 = xy * yz - xz * yy;
  const cf_lanes per = 1 / (xx * m0 + xy * m1 + xz * m2);
  const cf_lanes u = per * (m0 * a + m1 * b + m2 * c);
  const cf_lanes v = per * (m1 * a + (xx * zz - xz * xz) * b + (xy * xz - xx * yz) * c);
  const cf_lanes w = per * (m2 * a + (xy * xz - xx * yz) * b + (xx * yy - xy * xy) * c);
  CF_SMALL_LOOP
  for (int i = 0; i < 9; i += 3) { /* R times the skew matrix of (u, v, w) */
    dR[i] = R[i + 1] * w - R[i + 2] * v;
    dR[i + 1] = R[i + 2] * u - R[i] * w;
    dR[i + 2] = R[i] * v - R[i + 1] * u;
  }
}

CF_SMALL void cf_elastic_corotated_change(const int dim, const cf_lanes *F, const cf_lanes *mu,
                                          const cf_lanes *lambda, const cf_lanes *dF, cf_lanes *dP) {
  cf_lanes R[9], C[9], dC[9], J, along;
  cf_polar(dim, F, R);
  cf_elastic_rotation_change(dim, F, R, dF, dP);
  cf_small_cofactor(dim, F, C, &J);
  cf_small_dot(dim, C, dF, &along);
  cf_elastic_cofactor_change(dim, F, dF, dC);
  CF_SMALL_LOOP
  for (int e = 0; e < dim * dim; ++e)
    dP[e] = 2 * *mu * (dF[e] - dP[e]) + *lambda * (C[e] * along + (J - 1) * dC[e]);
}

/* P = mu (F - F^-T) + lambda ln J F^-T, F^-T = C/J; d(C/J) = dC/J - C (C : dF)/J^2. */
CF_SMALL void cf_elastic_neo_hookean_change(const int dim, const cf_lanes *F, const cf_lanes *mu,
                                            const cf_lanes *lambda, const cf_lanes *dF, cf_lanes *dP) {
  cf_lanes C[9], dC[9], J, ln_j, along;
  cf_small_cofactor(dim, F, C, &J);
  cf_lanes_at_least(CF_ELASTIC_LEAST_J, &J);
  cf_elastic_log(&J, &ln_j);
  cf_small_dot(dim, C, dF, &along);
  cf_elastic_cofactor_change(dim, F, dF, dC);
  const cf_lanes per = 1 / J, along_ln = along * per, p = *lambda * ln_j - *mu;
  CF_SMALL_LOOP
  for (int e = 0; e < dim * dim; ++e)
    dP[e] = *mu * dF[e] + per * (*lambda * along_ln * C[e] + p * (dC[e] - C[e] * along_ln));
}

/* P = -chi S C/J with S J kept: dP = -chi S J d(C/J^2) = chi S [2 C (C : dF)/J^2 - dC/J]. Added to dP. */
CF_SMALL void cf_elastic_swelling_change(const int dim, const cf_lanes *F, const cf_lanes *chi_s,
                                         const cf_lanes *dF, cf_lanes *dP) {
  cf_lanes C[9], dC[9], J, along;
  cf_small_cofactor(dim, F, C, &J);
  cf_lanes_at_least(CF_ELASTIC_LEAST_J, &J);
  cf_small_dot(dim, C, dF, &along);
  cf_elastic_cofactor_change(dim, F, dF, dC);
  const cf_lanes per = 1 / J, twice = 2 * along * per;
  CF_SMALL_LOOP
  for (int e = 0; e < dim * dim; ++e) dP[e] += *chi_s * per * (twice * C[e] - dC[e]);
}

#endif
