/* SPDX-License-Identifier: MIT */
#include "stencil/anisotropy.h"

#include <math.h>
#include <string.h>

#include "base/status.h"

/* cos(q x) and sin(q x)/sin(x) as polynomials in cos(x), q = 1, 2, 3. */
static const double cosine_of[4][4] = {{0, 0, 0, 0}, {0, 1, 0, 0}, {-1, 0, 2, 0}, {0, -3, 0, 4}};
static const double quotient_of[4][3] = {{0, 0, 0}, {1, 0, 0}, {0, 2, 0}, {-1, 0, 4}};

static cf_facets facets_of(const cf_anisotropy_params *p, const int n) {
  if (p->cubic) return CF_FACETS_CUBIC;
  if (n == 0) return p->polar_n > 0 ? CF_FACETS_ANY : CF_FACETS_NONE;
  return n == 4 ? CF_FACETS_FOUR : n == 6 ? CF_FACETS_SIX : CF_FACETS_ANY;
}

cf_status cf_anisotropy_init(cf_anisotropy *a, const cf_anisotropy_params *p) {
  const int n = p->cubic ? 4 : p->n, q = p->polar_n / 2;
  if (n < 0 || n > CF_FOLDS_MAX || n % 2 != 0)
    return cf_fail(CF_BAD_ARGUMENT,
                   "%d folds: must be even, 0 to %d (the energy of a surface is the same for both its sides)",
                   n, CF_FOLDS_MAX);
  if (p->polar_n < 0 || p->polar_n > 6 || p->polar_n % 2 != 0)
    return cf_fail(CF_BAD_ARGUMENT, "%d folds from the axis: must be 0, 2, 4 or 6", p->polar_n);
  memset(a, 0, sizeof *a);
  a->facets = facets_of(p, n);
  a->n = n;
  a->strength = n > 0 ? p->strength : 0;
  a->C = cos(n * p->angle);
  a->S = sin(n * p->angle);
  a->folds = (cf_real)n;
  for (int i = 0; i < 3; ++i) a->bit[i] = (cf_real)(n / 2 >> i & 1);
  a->fades = p->printed ? 0 : 1;
  a->polar = (cf_real)(p->polar_strength * p->polar_n);
  for (int i = 0; i < 4; ++i) a->cosine[i] = (cf_real)(p->polar_strength * cosine_of[q][i]);
  for (int i = 0; i < 3; ++i) a->quotient[i] = (cf_real)quotient_of[q][i];
  return CF_OK;
}

/* --- bounds ----------------------------------------------------------------------------------------------- */

static double A_at(const cf_anisotropy *a, const int dim, const cf_facing f, const cf_vec p) {
  cf_vec B;
  return (double)(dim == 2 ? cf_anisotropy_at(2, (int)a->facets, a, f, p, &B)
                           : cf_anisotropy_at(3, (int)a->facets, a, f, p, &B));
}

static cf_vec J_at(const cf_anisotropy *a, const int dim, const cf_facing f, const cf_vec p) {
  return dim == 2 ? cf_anisotropy_flux(2, (int)a->facets, a, f, p, 1, 1)
                  : cf_anisotropy_flux(3, (int)a->facets, a, f, p, 1, 1);
}

/* dJ/dp in the direction p, symmetric, by central differences. */
static void curvature(const cf_anisotropy *a, const int dim, const cf_facing f, const double p[3],
                      double H[3][3]) {
  const double d = 2e-3;
  for (int j = 0; j < dim; ++j) {
    double low[3] = {p[0], p[1], p[2]}, high[3] = {p[0], p[1], p[2]};
    low[j] -= d;
    high[j] += d;
    const cf_vec l = J_at(a, dim, f, (cf_vec){(cf_real)low[0], (cf_real)low[1], (cf_real)low[2]});
    const cf_vec h = J_at(a, dim, f, (cf_vec){(cf_real)high[0], (cf_real)high[1], (cf_real)high[2]});
    const double column[3] = {(double)(h.x - l.x), (double)(h.y - l.y), (double)(h.z - l.z)};
    for (int i = 0; i < dim; ++i) H[i][j] = column[i] / (2 * d);
  }
  for (int i = 0; i < dim; ++i)
    for (int j = 0; j < i; ++j) H[i][j] = H[j][i] = (H[i][j] + H[j][i]) / 2;
}

/* Least and largest eigenvalue of the symmetric H. */
static void eigenvalues(const int dim, double H[3][3], double *least, double *largest) {
  if (dim == 2) {
    const double mean = (H[0][0] + H[1][1]) / 2, r = hypot((H[0][0] - H[1][1]) / 2, H[0][1]);
    *least = mean - r;
    *largest = mean + r;
    return;
  }
  const double off = H[0][1] * H[0][1] + H[0][2] * H[0][2] + H[1][2] * H[1][2];
  const double mean = (H[0][0] + H[1][1] + H[2][2]) / 3;
  const double x = H[0][0] - mean, y = H[1][1] - mean, z = H[2][2] - mean;
  const double r = sqrt((x * x + y * y + z * z + 2 * off) / 6);
  const double det = x * (y * z - H[1][2] * H[1][2]) - H[0][1] * (H[0][1] * z - H[1][2] * H[0][2]) +
                     H[0][2] * (H[0][1] * H[1][2] - y * H[0][2]);
  const double c = r > 0 ? fmax(-1, fmin(1, det / (2 * r * r * r))) : 1, angle = acos(c) / 3;
  *largest = mean + 2 * r * cos(angle);
  *least = mean + 2 * r * cos(angle + 2 * acos(-1) / 3);
}

cf_anisotropy_bounds cf_anisotropy_range(const cf_anisotropy *a, const int dim, const double strength) {
  const cf_facing f = {(cf_real)strength, 1, 0};
  const double pi = acos(-1);
  const int around = 8 * CF_MAX(a->n, 2), up = dim == 3 ? 48 : 0;
  cf_anisotropy_bounds b = {INFINITY, -INFINITY, INFINITY, -INFINITY};
  for (int j = 0; j <= up; ++j)
    for (int i = 0; i <= around; ++i) {
      const double theta = 2 * pi * i / around, phi = dim == 3 ? pi / 2 * j / up : pi / 2;
      const double p[3] = {sin(phi) * cos(theta), sin(phi) * sin(theta), dim == 3 ? cos(phi) : 0};
      double H[3][3] = {{0}}, least, largest;
      const double A = A_at(a, dim, f, (cf_vec){(cf_real)p[0], (cf_real)p[1], (cf_real)p[2]});
      curvature(a, dim, f, p, H);
      eigenvalues(dim, H, &least, &largest);
      b.a_min = fmin(b.a_min, A);
      b.a_max = fmax(b.a_max, A);
      b.stiff_min = fmin(b.stiff_min, least);
      b.stiff_max = fmax(b.stiff_max, largest);
    }
  return b;
}
