/* SPDX-License-Identifier: MIT
 *
 * Shapes in space as signed distances: negative inside, 0 on the surface, positive outside, in m. A shape is a
 * value; what it points at (parts, a function, samples) belongs to the caller and must live as long.
 *
 *     sphere      |p - a| - radius                          (a disc in 2D)
 *     box         edges along the axes, centre a, half lengths b (INFINITY where an axis does not matter)
 *     capsule     all points within `radius` of the line from a to b
 *     plane       below the plane through a with outward normal b: (p - a) . b
 *     function    any function of place and time; only its sign is to be trusted as a distance
 *     sampled     values on a regular grid, interpolated linearly; beyond the grid the distance to it is added
 *     union, intersection, complement of other shapes
 *
 * A cf_pose puts a shape elsewhere: it is turned about its pivot, then moved. cf_motion says where a rigid body is
 * at which time, and cf_pose then has its velocities as well.
 *
 * In 2D z is 0 everywhere; cf_shape_sphere and cf_shape_box leave it so.
 */
#ifndef CF_GRID_SHAPE_H
#define CF_GRID_SHAPE_H

#include "base/fn.h"
#include "grid/field.h"
#include "grid/grid.h"

typedef enum cf_shape_kind {
  CF_SHAPE_SPHERE,
  CF_SHAPE_BOX,
  CF_SHAPE_CAPSULE,
  CF_SHAPE_PLANE,
  CF_SHAPE_FUNCTION,
  CF_SHAPE_SAMPLED,
  CF_SHAPE_UNION,
  CF_SHAPE_INTERSECTION,
  CF_SHAPE_COMPLEMENT
} cf_shape_kind;

/* Distances at n[0] n[1] n[2] points, x fastest; point (0, 0, 0) is at `place`, neighbours are h apart. */
typedef struct cf_samples {
  int n[3];
  double place[3], h;
  float *value;
} cf_samples;

void cf_samples_destroy(cf_samples *s); /* a zeroed one is fine */

typedef struct cf_shape {
  cf_shape_kind kind;
  double a[3], b[3], radius; /* see above */
  cf_fn fn;
  const cf_samples *samples;
  const struct cf_shape *part; /* of a union or intersection; the one of a complement */
  int parts;
} cf_shape;

cf_shape cf_shape_sphere(const double center[3], double radius);
cf_shape cf_shape_box(int dim, const double center[3], const double half[3]);
cf_shape cf_shape_capsule(const double a[3], const double b[3], double radius);
cf_shape cf_shape_plane(const double point[3], const double outward[3]); /* `outward` of any length but 0 */
cf_shape cf_shape_function(const cf_fn *fn);
cf_shape cf_shape_sampled(const cf_samples *samples);
cf_shape cf_shape_union(const cf_shape *part, int parts); /* of none: nothing is inside */
cf_shape cf_shape_intersection(const cf_shape *part, int parts);
cf_shape cf_shape_complement(const cf_shape *of);

/* --- where it is ---------------------------------------------------------------------------------------- */

typedef struct cf_pose {
  double turn[3][3], pivot[3], shift[3]; /* place = pivot + shift + turn (place in the shape - pivot) */
  double velocity[3];                    /* of the pivot, m/s */
  double spin[3];                        /* rad/s about the pivot */
} cf_pose;

/* A rigid motion: the pivot is moved by shift(t), and the body turned by angle(t) (rad) about an axis through it. */
typedef struct cf_motion {
  cf_fn shift[3], angle;
  double pivot[3], axis[3]; /* axis of any length; 0: z */
} cf_motion;

/* As it was given. */
cf_pose cf_pose_at_rest(void);

/* At time t. Velocities are differences over t - dt/2 ... t + dt/2. dt > 0. Not for concurrent use on one
 * expression. */
cf_pose cf_motion_at(const cf_motion *m, double t, double dt);

/* The velocity of the body's point that is at `place`. */
void cf_pose_velocity(const cf_pose *p, const double place[3], double u[3]);

/* --- asking --------------------------------------------------------------------------------------------- */

/* pose NULL: at rest. t is for functions. */
double cf_shape_distance(const cf_shape *s, const cf_pose *pose, double t, const double place[3]);

/* out[i] at (x[i], y[i], z[i]). */
void cf_shape_distance_row(const cf_shape *s, const cf_pose *pose, double t, int n, const double *x,
                           const double *y, const double *z, double *out);

/* The outward normal: the gradient of the distance by central differences over `step`, of length 1 (0 where there is
 * none). */
void cf_shape_normal(const cf_shape *s, const cf_pose *pose, double t, const double place[3], double step,
                     double normal[3]);

/* The distance at the centres of cells, ghosts included. CF_NO_MEMORY. */
cf_status cf_shape_sample(const cf_shape *s, const cf_pose *pose, double t, const cf_grid *g,
                          cf_cell distance);

/* The cells whose centres may be inside, low <= (i, j, k) < high, widened by `margin` cells and clipped to the
 * grid: a body that moves costs what it covers. Shapes without bounds (planes, functions, complements) give the
 * whole grid. */
void cf_shape_cells(const cf_shape *s, const cf_pose *pose, const cf_grid *g, int margin, int low[3],
                    int high[3]);

#endif
