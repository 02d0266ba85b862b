/* SPDX-License-Identifier: MIT
 *
 * Small square matrices, 2x2 and 3x3, row by row in an array of dim*dim, eight of them side by side (base/lanes.h):
 * products, determinants, and
 *
 *     F = R S,  R the rotation nearest to F (det R = 1, also where det F < 0), S symmetric,
 *
 * without a singular value decomposition. In 3D, R maximises tr(R^T F); with lambda the largest eigenvalue of
 * Davenport's 4x4 matrix (lambda = s1 + s2 +- s3 in singular values), Markley (J. Astronaut. Sci. 41, 1993) gives
 *
 *     lambda^4 - 2|F|^2 lambda^2 - 8 det F lambda + |F|^4 - 4|cof F|^2 = 0          (Newton, from above)
 *     R = [(kappa + |F|^2) F + lambda cof F - F F^T F]/(kappa lambda - det F),   kappa = (lambda^2 - |F|^2)/2
 *
 * and one Newton-Schulz step R <- R (3 - R^T R)/2 takes the last digits. No branch depends on the values. Where
 * s2 +- s3 = 0 the nearest rotation is not unique, and what comes is finite, no more.
 *
 * With `dim` a literal the loops unroll. Singular values: cf_symmetric_eigen of S.
 */
#ifndef CF_BASE_POLAR_H
#define CF_BASE_POLAR_H

#include "base/lanes.h"

/* C = A B; C is none of the others. */
CF_SMALL void cf_small_mul(const int dim, const cf_lanes *A, const cf_lanes *B, cf_lanes *C) {
  CF_SMALL_LOOP
  for (int e = 0; e < dim * dim; ++e) {
    C[e] = A[e / dim * dim] * B[e % dim];
    CF_SMALL_LOOP
    for (int k = 1; k < dim; ++k) C[e] += A[e / dim * dim + k] * B[k * dim + e % dim];
  }
}

/* C = A B^T. */
CF_SMALL void cf_small_mul_t(const int dim, const cf_lanes *A, const cf_lanes *B, cf_lanes *C) {
  CF_SMALL_LOOP
  for (int e = 0; e < dim * dim; ++e) {
    C[e] = A[e / dim * dim] * B[e % dim * dim];
    CF_SMALL_LOOP
    for (int k = 1; k < dim; ++k) C[e] += A[e / dim * dim + k] * B[e % dim * dim + k];
  }
}

/* C = A^T B. */
CF_SMALL void cf_small_t_mul(const int dim, const cf_lanes *A, const cf_lanes *B, cf_lanes *C) {
  CF_SMALL_LOOP
  for (int e = 0; e < dim * dim; ++e) {
    C[e] = A[e / dim] * B[e % dim];
    CF_SMALL_LOOP
    for (int k = 1; k < dim; ++k) C[e] += A[k * dim + e / dim] * B[k * dim + e % dim];
  }
}

/* The sum of A_ij B_ij. */
CF_SMALL void cf_small_dot(const int dim, const cf_lanes *A, const cf_lanes *B, cf_lanes *sum) {
  *sum = A[0] * B[0];
  CF_SMALL_LOOP
  for (int e = 1; e < dim * dim; ++e) *sum += A[e] * B[e];
}

/* The cofactors C, det F F^-T, and the determinant. */
CF_SMALL void cf_small_cofactor(const int dim, const cf_lanes *F, cf_lanes *C, cf_lanes *det) {
  if (dim == 2) {
    C[0] = F[3], C[1] = -F[2], C[2] = -F[1], C[3] = F[0];
    *det = F[0] * F[3] - F[1] * F[2];
    return;
  }
  CF_SMALL_LOOP
  for (int e = 0; e < 9; ++e) {
    const int a = (e / 3 + 1) % 3 * 3, b = (e / 3 + 2) % 3 * 3, c = (e + 1) % 3, d = (e + 2) % 3;
    C[e] = F[a + c] * F[b + d] - F[a + d] * F[b + c];
  }
  *det = F[0] * C[0] + F[1] * C[1] + F[2] * C[2];
}

/* Newton's steps for lambda from sqrt(3)|F| >= lambda: enough for stretches of 1 to 10 side by side. */
#define CF_POLAR_STEPS 9

CF_SMALL void cf_polar_3d(const cf_lanes *F, cf_lanes *R) {
  cf_lanes per, B[9], C[9], G[9], X[9], det, last, lambda;
  cf_small_dot(3, F, F, &per);
  per += (cf_real)1e-30;
  cf_lanes_sqrt(&per);
  per = 1 / per;
  CF_SMALL_LOOP
  for (int i = 0; i < 9; ++i) B[i] = F[i] * per; /* |B| = 1 from here on */
  cf_small_cofactor(3, B, C, &det);
  cf_small_dot(3, C, C, &last);
  last = 1 - 4 * last;
  cf_lanes_fill((cf_real)1.7320508075688772, &lambda);
  for (int n = 0; n < CF_POLAR_STEPS; ++n) {
    const cf_lanes l2 = lambda * lambda;
    const cf_lanes p = (l2 - 2) * l2 - 8 * det * lambda + last;
    lambda -= p / (4 * (l2 - 1) * lambda - 8 * det + (cf_real)1e-20); /* from above the slope is >= 0 */
  }
  const cf_lanes kappa = (lambda * lambda - 1) / 2, zeta = 1 / (kappa * lambda - det + (cf_real)1e-20);
  cf_small_mul_t(3, B, B, G);
  cf_small_mul(3, G, B, X);
  CF_SMALL_LOOP
  for (int i = 0; i < 9; ++i) B[i] = ((kappa + 1) * B[i] + lambda * C[i] - X[i]) * zeta;
  cf_small_t_mul(3, B, B, G);
  cf_small_mul(3, B, G, X);
  CF_SMALL_LOOP
  for (int i = 0; i < 9; ++i) R[i] = (3 * B[i] - X[i]) / 2;
}

/* R = [c -s; s c] along (F_11 + F_22, F_21 - F_12). */
CF_SMALL void cf_polar_2d(const cf_lanes *F, cf_lanes *R) {
  const cf_lanes c = F[0] + F[3], s = F[2] - F[1];
  cf_lanes r = c * c + s * s + (cf_real)1e-30;
  cf_lanes_sqrt(&r);
  R[0] = c / r, R[1] = -s / r, R[2] = s / r, R[3] = c / r;
}

/* The nearest rotations. R may not be F. */
CF_SMALL void cf_polar(const int dim, const cf_lanes *F, cf_lanes *R) {
  if (dim == 3)
    cf_polar_3d(F, R);
  else
    cf_polar_2d(F, R);
}

/* S = V diag(e) V^T for one symmetric S, by Jacobi rotations; V a rotation, e in no particular order. */
void cf_symmetric_eigen(int dim, const double *S, double *V, double *e);

#endif
