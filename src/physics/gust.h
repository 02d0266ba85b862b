/* SPDX-License-Identifier: MIT
 *
 * A wind with gusts: a mean wind and a random velocity that is free of divergence, still on the ground, periodic
 * sideways, and a function of place, time and seed alone (kinematic simulation: Fung, Hunt, Malik, Perkins 1992; its
 * ground by a ramp on the vector potential: Bridson, Houriham, Nordenstam 2007):
 *
 *     u = U r(z) + curl [r(z) psi],      psi = sum_m a_m cos(k_m . (x - U t) + omega_m t + theta_m)
 *
 * with |k_m| spread evenly in its logarithm from 2 pi/length to CF_GUST_RANGE times that, directions all over the
 * sphere, a_m across k_m, and |k_m x a_m|^2 ~ k^(-2/3), Kolmogorov's spectrum E(k) ~ k^(-5/3); omega_m is the rate at
 * which an eddy of that size turns over. r(z) rises from 0 on the ground to 1 at the height of `length`, as
 * zeta^2 (3 - 2 zeta), so u is 0 on the ground.
 *
 * It knows nothing of what stands in its way: the wind blows through obstacles.
 */
#ifndef CF_PHYSICS_GUST_H
#define CF_PHYSICS_GUST_H

#include <stdint.h>

#define CF_GUST_MODES 24
#define CF_GUST_RANGE 12.0

typedef struct cf_gust_params {
  double wind[3];   /* mean, far above the ground, m/s */
  double strength;  /* root mean square of one component of the random part there, m/s */
  double length;    /* of the largest gusts, m */
  double ground;    /* z of the ground, m */
  double period[2]; /* of the random part in x and y, m */
  uint64_t seed;
} cf_gust_params;

typedef struct cf_gust {
  cf_gust_params p;
  double k[CF_GUST_MODES][3], a[CF_GUST_MODES][3], rate[CF_GUST_MODES], phase[CF_GUST_MODES];
} cf_gust;

/* Draws the modes. length and period > 0. */
void cf_gust_create(cf_gust *g, const cf_gust_params *p);

/* u at a place and time, m/s. */
void cf_gust_at(const cf_gust *g, const double place[3], double t, double u[3]);

#endif
