/* SPDX-License-Identifier: MIT
 *
 * Points that go with the flow and do nothing to it,
 *
 *     x' = u(x, t),
 *
 * by Kutta's three stages (third order in a steady flow, and as good as its velocities are in one that changes):
 *
 *     k_1 = u(x, t),  k_2 = u(x + dt/2 k_1, t + dt/2),  k_3 = u(x + dt (2 k_2 - k_1), t + dt)
 *     x <- x + dt/6 (k_1 + 4 k_2 + k_3)
 *
 * Between the faces a component is a quadratic spline along its own axis and linear across it:
 *
 *     u_a(x) = sum over faces i of u_a,i B_2(x_a - i) prod over e != a of B_1(x_e - i_e - 1/2)      (in cells)
 *
 * The derivative of B_2 is a difference of two B_1, so div u(x) = sum over cells of (div u)_cell prod of B_1: where the
 * cells have no divergence, no place between them has any, and points that fill the fluid evenly go on doing so. Values
 * given by the grid are not quite met (they are smoothed by h^2/8 u_aa): the error is of second order, as the grid's own.
 * With ghosts that go on linearly (cf_courant_ghosts) the normal velocity on a closed wall is met.
 */
#ifndef CF_PHYSICS_DRIFT_H
#define CF_PHYSICS_DRIFT_H

#include <stdbool.h>

#include "grid/field.h"
#include "grid/grid.h"
#include "grid/particles.h"

typedef struct cf_drift {
  const cf_grid *grid;
  cf_face u[3];    /* at the beginning, in the middle and at the end of the step, with cf_courant_ghosts */
  bool wraps[3];   /* axes that are periodic */
  bool open[3][2]; /* walls that points leave through; at others they stop */
} cf_drift;

/* Moves the points from number `first` on by dt; those that are out afterwards have key 1, all others 0. */
void cf_drift_move(const cf_drift *d, double dt, cf_particles *set, int64_t first);

/* The same for points that are where they are at times of their own, attribute `born`: from then to `until`, with the
 * velocity at the end of the step. */
void cf_drift_move_born(const cf_drift *d, double until, int born, cf_particles *set, int64_t first);

/* The velocity at the end of the step, where the points are, into attribute `to`. */
void cf_drift_velocity(const cf_drift *d, cf_particles *set, int to);

/* Puts points into the order of blocks of 8 x 4 x 4 cells: neighbours in the flow are neighbours in memory. */
void cf_drift_sort(const cf_grid *g, cf_particles *set);

#endif
