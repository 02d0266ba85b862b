/* SPDX-License-Identifier: MIT
 *
 * Elastic bodies as material points (section 8 of the paper; Jiang et al. 2016): particles carry mass, velocity,
 * deformation and water; every step the grid is a scratchpad for the equation of motion
 *
 *     m_i v_i = sum_p w_ip m_p [v_p + C_p (x_i - x_p)],     f_i = -sum_p V_p T_p (4/h^2) w_ip (x_i - x_p)
 *     v_i <- v_i + dt (f_i/m_i + g), collisions             (33), with g as the acceleration it is
 *     C_p = (4/h^2) sum_i w_ip v_i (x_i - x_p)^T,  F_p <- (I + dt C_p) F_p,  x_p <- x_p + dt sum_i w_ip v_i
 *
 * with T Kirchhoff's stress (stencil/elastic.h) and the gradient of the moving-least-squares method (Hu et al. 2018): f
 * is then the exact derivative of the elastic energy under this very update of F, and f_i/m_i stays bounded where
 * a node has hardly any mass. APIC (Jiang et al. 2015) carries C_p along; FLIP the share `flip` of eq. 36 instead.
 *
 * The paper advects on the grid as well (31): a Lagrangian step has no such term, and here nothing has it.
 *
 * Water on particles: m_f and A = V0 J s (s = div q_C), capacity c = c_0 J, saturation S = m_f/c. Neither m_f nor A
 * changes as J does, so swelling neither makes nor takes water. The nodes get sum w c, sum w m_f, sum w A; whoever
 * solves for saturation (physics/poro.h) leaves changes over C there, and what particles take of them closes to
 * round-off because the weights are the same. Inertia does not follow the water: m_p is constant, so that momentum
 * and angular momentum are kept to round-off.
 *
 *     cf_mpm_scatter(m, dt);  cf_mpm_move_nodes(m, t, dt, &report);  [water on m->nodes]  cf_mpm_gather(m, dt);
 *
 * Does not do: contact between bodies other than through the shared grid (which sticks them together), fracture:
 * cf_mpm_split keeps stretched bodies from coming apart where only the grid cannot see that they are whole.
 */
#ifndef CF_PHYSICS_MPM_H
#define CF_PHYSICS_MPM_H

#include "grid/shape.h"
#include "solve/helmholtz.h"
#include "stencil/nodes.h"

typedef enum cf_mpm_law { CF_MPM_COROTATED, CF_MPM_NEO_HOOKEAN } cf_mpm_law;

typedef struct cf_mpm_material {
  cf_mpm_law law;
  double mu, lambda;           /* Pa */
  double hardening;            /* xi; 0: none */
  double stretch, compression; /* stretches are kept in [1 - compression, 1 + stretch]; INFINITY: elastic */
  double swelling;             /* chi, Pa */
  double density;              /* inertia per initial volume, kg/m^3 */
  double water;                /* c_0 per initial volume: mass of water at S = 1, J = 1 */
  double k, f_t;               /* of the water in it, for cf_mpm_mix */
} cf_mpm_material;

/* sticky: moves with the obstacle; slip: along it; separate: along it or away. Friction (Coulomb's) acts with the last
 * two. */
typedef enum cf_mpm_contact { CF_MPM_STICKY, CF_MPM_SLIP, CF_MPM_SEPARATE } cf_mpm_contact;

typedef struct cf_mpm_obstacle {
  const cf_shape *shape;
  const cf_motion *motion; /* NULL: at rest */
  cf_mpm_contact contact;
  double friction;
} cf_mpm_obstacle;

#define CF_MPM_OBSTACLES_MAX 64

typedef struct cf_mpm_params {
  int materials, obstacles;
  const cf_mpm_material *material;
  const cf_mpm_obstacle *obstacle;
  double gravity[3];
  double flip;         /* share of FLIP in velocities, 0 ... 1; < 0: APIC */
  double implicitness; /* beta of (35), 0 ... 1; 0: symplectic Euler */
  double damping;      /* velocities decay at this rate, 1/s */
  bool mixture;        /* materials differ in k or F_T, and cf_mpm_mix will be called */
  cf_solve_options solver;
} cf_mpm_params;

/* The numbers of the particles' attributes. */
typedef struct cf_mpm_attributes {
  int position, velocity, affine, deformation, volume, side, material, plastic, water, memory;
} cf_mpm_attributes;

typedef struct cf_mpm {
  const cf_grid *grid; /* the lattice */
  cf_particles *set;
  cf_mpm_params p;
  cf_mpm_attributes at;
  cf_nodes *nodes;
  bool plastic;                         /* some material is */
  cf_lanes *force, *old;                /* FLIP: sums of forces, changes of velocity */
  cf_lanes *mixture;                    /* see cf_mpm_mix; NULL: none */
  cf_lanes *residual, *along, *applied; /* semi-implicit: vectors on nodes */
  cf_lanes *normal;                     /* ... and what of a node obstacles hold */
  cf_real *rest[2];                     /* the filter: (1 - P) z of every particle */
  double returned; /* water that the latest gather gave back to held cells (see physics/poro.h) */
} cf_mpm;

/* Adds the attributes to an empty set. `material`: index of the material; `plastic`: J_P; `side`: of the piece of the
 * undeformed body that a particle stands for, along the axes; 0: it is never split. */
cf_status cf_mpm_attributes_add(cf_particles *set, cf_mpm_attributes *at);

/* For the particles that `set` has now, or later up to its room; params' tables must outlive it, as lattice and set.
 * CF_BAD_ARGUMENT, CF_OVER_LIMIT, CF_NO_MEMORY. */
cf_status cf_mpm_create(cf_mpm **m, const cf_grid *lattice, cf_particles *set, const cf_mpm_attributes *at,
                        const cf_mpm_params *p);
void cf_mpm_destroy(cf_mpm *m);

void cf_mpm_scatter(cf_mpm *m, double dt);
/* Momenta to velocities, (33) and (35). CF_NOT_FINITE. */
cf_status cf_mpm_move_nodes(cf_mpm *m, double t, double dt, cf_solve_report *report);
void cf_mpm_gather(cf_mpm *m, double dt);

/* Cuts in two what is longer than `most` cells, as long as the set has room: mpm_split.c. Returns how many times. */
int64_t cf_mpm_split(cf_mpm *m, double most);

/* The largest speed (over axes), m/s, and the largest h/(dt of the explicit limit): a step must have
 * dt <= 0.5 h/waves, and should have dt <= h/speed times a Courant number. */
typedef struct cf_mpm_limits {
  double speed, waves;
} cf_mpm_limits;
cf_mpm_limits cf_mpm_limits_of(const cf_mpm *m);

/* After cf_mpm_scatter: m->mixture has the sums over particles of w c, w c k, w c k F_T, in the layout of nodes->at. */
void cf_mpm_mix(cf_mpm *m);

/* Takes out of m_f and A what the grid cannot see: z -= (1 - P) eta (1 - P) z for z = m_f/c and A/c, where
 * (P z)_p = sum_i w_ip (sum_q w_iq c_q z_q)/C_i and eta is one number a material. Keeps sum c z; the spectrum of P is in
 * [0, 1]. Uses the nodes. */
void cf_mpm_filter(cf_mpm *m, const double *eta);

/* Sums over the particles, in a fixed order. angular: about the origin (z in 2D). */
typedef struct cf_mpm_sums {
  double mass, volume, water, capacity, memory, momentum[3], angular[3], kinetic, center[3];
  double saturation_min, saturation_max, jacobian_min, jacobian_max;
} cf_mpm_sums;
cf_mpm_sums cf_mpm_sums_of(const cf_mpm *m);

/* S, J and T of every particle into arrays of its own (one a component), any of them NULL. */
void cf_mpm_derive(const cf_mpm *m, cf_real *saturation, cf_real *jacobian, cf_real *const *stress);

#endif
