/* SPDX-License-Identifier: MIT */
#include "base/polar.h"

#include <string.h>

#define SWEEPS 8

/* Turns the plane (p, q) so that S[p][q] becomes 0. */
static void rotate(const int dim, const int p, const int q, double *S, double *V) {
  const double off = S[p * dim + q];
  if (off == 0) return;
  const double theta = (S[q * dim + q] - S[p * dim + p]) / (2 * off);
  const double t = copysign(1, theta) / (fabs(theta) + sqrt(theta * theta + 1));
  const double c = 1 / sqrt(t * t + 1), s = t * c;
  for (int k = 0; k < dim; ++k) { /* S G */
    const double a = S[k * dim + p], b = S[k * dim + q];
    S[k * dim + p] = c * a - s * b, S[k * dim + q] = s * a + c * b;
  }
  for (int k = 0; k < dim; ++k) { /* G^T S */
    const double a = S[p * dim + k], b = S[q * dim + k];
    S[p * dim + k] = c * a - s * b, S[q * dim + k] = s * a + c * b;
  }
  for (int k = 0; k < dim; ++k) {
    const double a = V[k * dim + p], b = V[k * dim + q];
    V[k * dim + p] = c * a - s * b, V[k * dim + q] = s * a + c * b;
  }
}

void cf_symmetric_eigen(const int dim, const double *S, double *V, double *e) {
  double s[9];
  memcpy(s, S, sizeof *s * (size_t)(dim * dim));
  for (int i = 0; i < dim * dim; ++i) V[i] = i % (dim + 1) == 0;
  for (int sweep = 0; sweep < SWEEPS; ++sweep)
    for (int p = 0; p < dim; ++p)
      for (int q = p + 1; q < dim; ++q) rotate(dim, p, q, s, V);
  for (int i = 0; i < dim; ++i) e[i] = s[i * dim + i];
}
