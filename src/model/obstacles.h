/* SPDX-License-Identifier: MIT
 *
 * The scene's `obstacles:` list on a grid: which obstacle a cell is in, where each stands and how it moves. Every model
 * that meets obstacles reads them here.
 *
 *     cf_obstacles o = {0};
 *     cf_obstacles_create(&o, scene, grid);              // shapes and files; o.count may be 0
 *     cf_obstacles_place(&o, t + dt, dt);                // at the end of a step, if o.changes
 *     cf_obstacles_region(&o, CF_OBSTACLES_SOLID, r);    // every cell of an obstacle a wall: what a fluid meets
 *     cf_obstacles_region(&o, field, r);                 // walls and held cells of one scalar, at their values then
 *     cf_obstacles_push(&o, u);                          // u on faces of those cells: the obstacle's own velocity
 *     cf_obstacles_destroy(&o);
 *
 * A cell belongs to the obstacle that its centre is in; of several to the last in the list, and to one that moves
 * before one that stands.
 */
#ifndef CF_MODEL_OBSTACLES_H
#define CF_MODEL_OBSTACLES_H

#include <stdint.h>

#include "grid/region.h"
#include "grid/shape.h"
#include "model/model.h"

/* The shift along an axis (0..2) or the angle (3) of an obstacle over time, as what a cf_fn points to. */
typedef struct cf_obstacle_track {
  const struct cf_obstacle *of;
  int which;
} cf_obstacle_track;

typedef struct cf_obstacle {
  const cf_scene_obstacle *keys;
  int dim;
  cf_shape shape, inner; /* as the scene means it; what it is outside of, where `outside` is said */
  cf_samples samples;    /* of a file */
  cf_motion motion;
  cf_obstacle_track track[4];
  bool posed;   /* does not stand as the shape was given: use the motion */
  bool moves;   /* its pose depends on time */
  bool changes; /* its pose or its shape does */
  cf_pose pose; /* of the latest cf_obstacles_place */
} cf_obstacle;

typedef struct cf_obstacles {
  const cf_scene *scene;
  const cf_grid *grid;
  int count;
  cf_obstacle *item;
  bool changes; /* some obstacle does */
  bool placed;
  double time, dt;       /* of the latest cf_obstacles_place: state */
  uint16_t *owner;       /* at cell (0, 0, 0), laid out as a cell field: 0 free, else number + 1 */
  uint16_t *owner_still; /* of obstacles that stand; NULL: all do, or none */
  const cf_fn **held;    /* [field count + number]: what it holds the field at; NULL: it is a wall for it */
  ptrdiff_t solid;       /* cells in obstacles */
} cf_obstacles;

#define CF_OBSTACLES_SOLID (-1) /* in place of a field: everything is a wall */
#define CF_OBSTACLES_MAX   65535

/* Shapes, files and motions of a scene; places them at time 0. CF_BAD_SCENE: a file that is none; CF_NO_MEMORY. After
 * any failure cf_obstacles_destroy cleans up. */
cf_status cf_obstacles_create(cf_obstacles *o, const cf_scene *scene, const cf_grid *g);
void cf_obstacles_destroy(cf_obstacles *o); /* a zeroed one is fine */

/* Where everything is at time t; velocities are means over dt around it. Costs nothing where nothing changes. Not for
 * concurrent use. Only says CF_OK. */
cf_status cf_obstacles_place(cf_obstacles *o, double t, double dt);

/* Velocities alone, as means over dt around time t: cells stay with whom they are. */
void cf_obstacles_pace(cf_obstacles *o, double t, double dt);

/* The time of the latest place is state: adds it, and places everything anew after it was read back. Does nothing where
 * nothing changes. */
cf_status cf_obstacles_register(cf_obstacles *o, cf_registry *r);
cf_status cf_obstacles_restored(cf_obstacles *o);

/* Kinds of all cells for the scalar scene->fields.item[field], or CF_OBSTACLES_SOLID, and the values of held ones at the
 * time placed. */
cf_status cf_obstacles_region(const cf_obstacles *o, int field, cf_region *r);

/* The values of the scalar's held cells at another time, where the obstacles stand as placed; other cells stay. */
void cf_obstacles_values(const cf_obstacles *o, int field, double t, cf_cell value);

/* Whether some obstacle holds the scalar, and whether its value depends on time. */
bool cf_obstacles_holds(const cf_obstacles *o, int field);
bool cf_obstacles_value_in_time(const cf_obstacles *o, int field);

/* Sets u on every face of every cell in an obstacle: the obstacle's velocity at the middle of the face, 0 where it
 * stands. Faces between two obstacles have that of the cell above. Walls of the box are faces like others. */
void cf_obstacles_push(const cf_obstacles *o, cf_face u);

/* Across a periodic axis the first face is the last one: the obstacle's, if either cell beside it is in one. */
void cf_obstacles_join(const cf_obstacles *o, int axis, cf_face u);

/* 1 in cells of obstacles, 0 in others; at their surface about the share of the cell that is inside, above 1/2 where its
 * middle is. */
void cf_obstacles_show(const cf_obstacles *o, cf_cell solid);

/* The fastest that a point of an obstacle moves within the box, as placed, m/s. */
double cf_obstacles_speed(const cf_obstacles *o);

/* The least distance to any obstacle, as placed; negative inside. INFINITY without obstacles. For concurrent use. */
double cf_obstacles_distance(const cf_obstacles *o, const double place[3]);

/* The outward normal of what is nearest, of length 1 (0 where there is none). */
void cf_obstacles_normal(const cf_obstacles *o, const double place[3], double step, double normal[3]);

static inline bool cf_obstacles_has(const cf_obstacles *o, const ptrdiff_t p) {
  return o->count > 0 && o->owner[p] != 0;
}

/* --- of a scene, before there is a grid (obstacles_scene.c) ------------------------------------------------ */

/* Checks the list; CF_BAD_SCENE at the key. */
cf_status cf_obstacles_resolve(cf_scene *scene);

/* Whether some obstacle of the scene moves, or has a shape that depends on time. */
bool cf_obstacles_change(const cf_scene *scene);

/* Bytes that obstacles need at most, with the regions of the scalars. */
double cf_obstacles_memory(const cf_scene *scene);

/* What `check` says: cells that are walls and held, at time 0. */
cf_status cf_obstacles_check(const cf_scene *scene, const cf_page *page);

#endif
