/* SPDX-License-Identifier: MIT
 *
 * How the energy of a crystal's surface depends on where it faces. With p = grad_* eta the energy density is
 * A(p)^2 |p|^2 / 2, A homogeneous of degree 0, and its derivative the flux
 *
 *     J = A^2 p + A |p|^2 dA/dp,       homogeneous of degree 1, odd in p.
 *
 * (Eq. 28 of the paper in its variational form; Kobayashi 1993.) Two laws:
 *
 *     fold    A = 1 + e W cos(n (theta - theta_0)) + e_a cos(m phi),     theta = atan2(p_y, p_x) in the plane,
 *                                                                        phi = atan2(rho, p_z) from the axis
 *     cubic   A = 1 + e (4 sum n_i^4 - 3),   turned by theta_0 in the plane;  in 2D it is fold with n = 4
 *
 * rho^2 = p_x^2 + p_y^2. The paper's law has W = 1: near the axis, where theta turns fast, J then has no bound.
 * W = rho^2/|p|^2, the default, lets the plane's harmonic fade towards the axis; in 2D both are the same.
 *
 * No trigonometric calls: with z = ((p_x^2 - p_y^2) + 2 i p_x p_y)/rho^2, cos and sin of n theta are the parts of
 * z^(n/2), n even (a law with odd n would not be even in p, and the energy would tell a crystal from its hole), and
 * cos(m phi), sin(m phi)/sin(2 phi) are polynomials in cos(2 phi). theta_0 comes as C = cos(n theta_0),
 * S = sin(n theta_0). At p = 0, where there is no direction, rho^2 + 1e-20 keeps J = 0.
 *
 * Convex, hence well-posed without regularisation, as long as A + A'' > 0; in the plane e < 1/(n^2 - 1).
 */
#ifndef CF_STENCIL_ANISOTROPY_H
#define CF_STENCIL_ANISOTROPY_H

#include <stdbool.h>

#include "base/real.h"
#include "base/status.h"

/* The power n/2 of the laws that have kernels of their own; others share one. */
typedef enum cf_facets {
  CF_FACETS_NONE,
  CF_FACETS_FOUR,
  CF_FACETS_SIX,
  CF_FACETS_ANY,
  CF_FACETS_CUBIC,
  CF_FACETS_COUNT
} cf_facets;

#define CF_FOLDS_MAX 14

/* The numbers of a law, made by cf_anisotropy_init. */
typedef struct cf_anisotropy {
  cf_facets facets;
  int n;               /* folds in the plane; 4 for cubic */
  double strength;     /* e */
  double C, S;         /* of theta_0 */
  cf_real folds;       /* n again */
  cf_real bit[3];      /* whether n/2 has the powers 1, 2, 4 */
  cf_real fades;       /* 1: W = rho^2/|p|^2; 0: W = 1 */
  cf_real polar;       /* e_a m */
  cf_real cosine[4];   /* e_a cos(m phi) as a polynomial in cos(2 phi) */
  cf_real quotient[3]; /* sin(m phi)/sin(2 phi) likewise */
} cf_anisotropy;

typedef struct cf_anisotropy_params {
  bool cubic;
  int n;                  /* even, 0 ... CF_FOLDS_MAX; 0: isotropic in the plane */
  double strength, angle; /* e; theta_0, rad */
  int polar_n;            /* m: 0, 2, 4 or 6 */
  double polar_strength;  /* e_a */
  bool printed;           /* W = 1 */
} cf_anisotropy_params;

/* CF_BAD_ARGUMENT: folds that are odd or too many. */
cf_status cf_anisotropy_init(cf_anisotropy *a, const cf_anisotropy_params *p);

/* The least and largest of A, and the largest eigenvalue of the second derivative of A^2 |p|^2/2, which is what
 * limits explicit steps; and the least: below 0 the law is not convex. `strength`: in place of the law's own. */
typedef struct cf_anisotropy_bounds {
  double a_min, a_max, stiff_min, stiff_max;
} cf_anisotropy_bounds;
cf_anisotropy_bounds cf_anisotropy_range(const cf_anisotropy *a, int dim, double strength);

/* --- pointwise -------------------------------------------------------------------------------------------- */

typedef struct cf_vec {
  cf_real x, y, z;
} cf_vec;

/* Where the law's direction and strength are at this place. */
typedef struct cf_facing {
  cf_real e, C, S;
} cf_facing;

#define CF_POINTWISE static inline __attribute__((always_inline))

/* c + i s = (u + i w)^(n/2). */
CF_POINTWISE void cf_anisotropy_power(const int facets, const cf_anisotropy *a, const cf_real u,
                                      const cf_real w, cf_real *c, cf_real *s) {
  const cf_real u2 = u * u - w * w, w2 = 2 * (u * w);
  if (facets == CF_FACETS_FOUR || facets == CF_FACETS_CUBIC) {
    *c = u2;
    *s = w2;
  } else if (facets == CF_FACETS_SIX) {
    *c = u * (u * u - 3 * (w * w));
    *s = w * (3 * (u * u) - w * w);
  } else {
    const cf_real u4 = u2 * u2 - w2 * w2, w4 = 2 * (u2 * w2);
    const cf_real b1 = a->bit[0], b2 = a->bit[1], b4 = a->bit[2];
    const cf_real x1 = b1 * u + (1 - b1), y1 = b1 * w, x2 = b2 * u2 + (1 - b2), y2 = b2 * w2;
    const cf_real x4 = b4 * u4 + (1 - b4), y4 = b4 * w4, x = x1 * x2 - y1 * y2, y = x1 * y2 + y1 * x2;
    *c = x * x4 - y * y4;
    *s = x * y4 + y * x4;
  }
}

/* A, and B = |p|^2 dA/dp. */
CF_POINTWISE cf_real cf_anisotropy_at(const int dim, const int facets, const cf_anisotropy *a,
                                      const cf_facing f, const cf_vec p, cf_vec *B) {
  if (facets == CF_FACETS_NONE) {
    *B = (cf_vec){0, 0, 0};
    return 1;
  }
  const cf_real xx = p.x * p.x, yy = p.y * p.y, rho2 = (xx + yy) + (cf_real)1e-20, per_rho2 = 1 / rho2;
  cf_real c, s;
  cf_anisotropy_power(facets, a, (xx - yy) * per_rho2, 2 * (p.x * p.y) * per_rho2, &c, &s);
  const cf_real cosine = c * f.C + s * f.S, sine = s * f.C - c * f.S;
  if (dim == 2) {
    const cf_real turn = a->folds * f.e * sine;
    *B = (cf_vec){turn * p.y, -(turn * p.x), 0};
    return 1 + f.e * cosine;
  }
  const cf_real zz = p.z * p.z, size2 = rho2 + zz, per_size2 = 1 / size2;
  if (facets == CF_FACETS_CUBIC) {
    const cf_real k = rho2 * per_size2, axis = zz * per_size2, e4 = 4 * f.e;
    const cf_real Q = k * k * (3 + cosine) / 4 + axis * axis;
    *B = (cf_vec){e4 * (k * (p.x * (3 + cosine) + sine * p.y) - 4 * Q * p.x),
                  e4 * (k * (p.y * (3 + cosine) - sine * p.x) - 4 * Q * p.y), e4 * (4 * axis - 4 * Q) * p.z};
    return 1 + f.e * (4 * Q - 3);
  }
  const cf_real c2 = (zz - rho2) * per_size2, fades = a->fades, fixed = 1 - fades;
  const cf_real W = fades * (rho2 * per_size2) + fixed, G = fades + fixed * (size2 * per_rho2);
  const cf_real polar = a->cosine[0] + c2 * (a->cosine[1] + c2 * (a->cosine[2] + c2 * a->cosine[3]));
  const cf_real quotient = a->quotient[0] + c2 * (a->quotient[1] + c2 * a->quotient[2]);
  const cf_real turn = a->folds * f.e * G * sine;
  const cf_real tilt = 2 * per_size2 * (fades * f.e * cosine - a->polar * quotient);
  *B = (cf_vec){turn * p.y + tilt * zz * p.x, tilt * zz * p.y - turn * p.x, -(tilt * rho2 * p.z)};
  return 1 + f.e * W * cosine + polar;
}

/* main A^2 p + rest A |p|^2 dA/dp: J for 1, 1; one of its parts for 1, 0 and 0, 1. */
CF_POINTWISE cf_vec cf_anisotropy_flux(const int dim, const int facets, const cf_anisotropy *a,
                                       const cf_facing f, const cf_vec p, const cf_real main,
                                       const cf_real rest) {
  cf_vec B;
  if (facets == CF_FACETS_NONE) return (cf_vec){main * p.x, main * p.y, main * p.z};
  const cf_real A = cf_anisotropy_at(dim, facets, a, f, p, &B), AA = main * (A * A), AB = rest * A;
  return (cf_vec){AA * p.x + AB * B.x, AA * p.y + AB * B.y, AA * p.z + AB * B.z};
}

#endif
