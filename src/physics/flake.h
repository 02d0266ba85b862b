/* SPDX-License-Identifier: MIT
 *
 * A snow crystal in the air: a thin plate of mass m, diameter D and silhouette A, with normal n, falling through a
 * wind w. With the relative velocity u = v - w, split into u_n along n and u_t across it,
 *
 *     m dv/dt = m g - K |u| (u_n + r u_t)                    a plate slides more easily edge on: r < 1
 *     I dO/dt + O x I O = T_pressure + T_damping + T_shed    (body axes, O the spin)
 *
 *     K           m g / v_t^2: falling flat it reaches its terminal speed v_t, which follows from its Best number
 *                 (Heymsfield, Westbrook 2010, area ratio A_r = A/(pi D^2/4)):
 *                     X = 8 m g rho/(pi eta^2 sqrt(A_r)),  Re = 16 (sqrt(1 + sqrt(X)/(16 sqrt(.35))) - 1)^2,
 *                     v_t = eta Re/(rho D)
 *     r           skin friction on both faces over pressure drag, 2.66/sqrt(Re)/1.1, at most Stokes' 2/3
 *     T_pressure  the pressure acts ahead of the middle, by CENTRE D u_t/|u|, which turns the plate flat; and at the
 *                 crystal's own centre of pressure, off its middle by `offset` (no crystal is perfect): it glides and
 *                 spirals
 *     T_damping   what the turning adds to the normal velocity at distance from the middle: 2 K |u| (D^2/16) O_t;
 *                 about n a tenth of that
 *     T_shed      above Re = 100 vortices leave the edge at Strouhal number .13 and rock the plate (Willmarth, Hawk,
 *                 Harvey 1964): flutter; of size SHED m g D, growing to its full size at Re = 300
 *
 * Drag is implicit in v with |u| taken from before (so v_t is exact for any step), the gyroscopic part is an exact
 * turn, the rest explicit: order 1 in substeps, of which a step takes as many as the fastest of these rates asks for.
 *
 * Not here: collisions of flakes with each other, the air they drag along, melting.
 */
#ifndef CF_PHYSICS_FLAKE_H
#define CF_PHYSICS_FLAKE_H

#include <stdint.h>

typedef struct cf_air {
  double gravity;   /* m/s^2 */
  double density;   /* kg/m^3 */
  double viscosity; /* eta, kg/(m s) */
  double flutter;   /* multiplies T_shed; 1 is as measured */
} cf_air;

/* What a crystal is. */
typedef struct cf_flake {
  double mass, diameter, area; /* kg, m, m^2 */
  double inertia[2];           /* about a line in its plane, and about the normal: kg m^2 */
  double offset[2];            /* of its centre of pressure, along body x and y, m */
  double terminal_speed;       /* m/s, falling flat */
  double reynolds, glide;      /* at that speed; r above */
  double shed_phase;           /* of its vortices at time 0, in turns, 0 ... 1 */
} cf_flake;

/* Where it is and how it moves. */
typedef struct cf_flake_state {
  double x[3], v[3]; /* m, m/s */
  double turn[4];    /* unit quaternion w x y z, from body to world; the normal is body z */
  double spin[3];    /* rad/s, body axes */
} cf_flake_state;

/* Fills in terminal_speed, reynolds and glide from mass, diameter and area (all > 0). */
void cf_flake_settle_speed(cf_flake *f, const cf_air *air);

/* From t to t + dt in the wind w, which stays the same meanwhile. */
void cf_flake_step(const cf_flake *f, const cf_air *air, double t, double dt, const double w[3],
                   cf_flake_state *s);

/* The normal, or what any vector of the body is in the world. */
void cf_flake_turn(const double turn[4], const double body[3], double world[3]);

#endif
