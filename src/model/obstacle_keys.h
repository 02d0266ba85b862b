/* SPDX-License-Identifier: MIT
 *
 * The keys of `obstacles:` in a scene.
 */
#ifndef CF_MODEL_OBSTACLE_KEYS_H
#define CF_MODEL_OBSTACLE_KEYS_H

#include "base/param.h"

#define CF_OBSTACLE_SHAPE_WORDS(W) \
  W(BOX, box)                      \
  W(SPHERE, sphere) W(BALL, ball) W(CAPSULE, capsule) W(PLANE, plane) W(EXPRESSION, expression) W(FILE, file)
#define CF_OBSTACLE_KIND_WORDS(W)    W(WALL, wall) W(HELD, held)
#define CF_OBSTACLE_CONTACT_WORDS(W) W(STICKY, sticky) W(SLIP, slip) W(SEPARATE, separate)

enum {
  CF_OBSTACLE_BOX,
  CF_OBSTACLE_SPHERE,
  CF_OBSTACLE_BALL,
  CF_OBSTACLE_CAPSULE,
  CF_OBSTACLE_PLANE,
  CF_OBSTACLE_EXPRESSION,
  CF_OBSTACLE_FILE
};
enum { CF_OBSTACLE_WALL, CF_OBSTACLE_HELD };
enum { CF_OBSTACLE_STICKY, CF_OBSTACLE_SLIP, CF_OBSTACLE_SEPARATE };

#define CF_OBSTACLE_STOP_TABLE(P, R)                                          \
  P(time, number, CF_REQUIRED, "s", "(-inf, inf)", "When it is there")        \
  P(place, numbers, CF_NONE, "m", "2..3 of (-inf, inf)",                      \
    "Where its pivot is then; left out at all stops: where the shape has it") \
  P(turn, number, "0", "degree", "(-inf, inf)", "How far it has been turned about `axis` by then")

#define CF_OBSTACLE_FIELD_TABLE(P, R)                                                                 \
  P(name, key, CF_NONE, "", "", "The scalar")                                                         \
  P(kind, word, CF_NONE, "", CF_WORDS(CF_OBSTACLE_KIND_WORDS), "For this scalar; with `value`: held") \
  P(value, function, CF_NONE, "", "", "Held: what this scalar is on the surface, an expression in x, y, z, t")

#define CF_OBSTACLE_TABLE(P, R)                                                                              \
  P(shape, word, "box", "", CF_WORDS(CF_OBSTACLE_SHAPE_WORDS),                                               \
    "box (center, half), sphere or ball (center, radius), capsule (center, end, radius: round, from center " \
    "to end), plane (center, normal: solid on the other side), expression (distance), file (file)")          \
  P(center, numbers, CF_NONE, "m", "2..3 of (-inf, inf)",                                                    \
    "Middle; a point of the plane; one end of the capsule; where the middle of a surface from a file goes")  \
  P(half, numbers, CF_NONE, "m", "2..3 of (0, inf)",                                                         \
    "Half of the sides of the box; what a surface from a file is scaled to")                                 \
  P(radius, number, CF_NONE, "m", "(0, inf)", "Of the sphere, of the capsule")                               \
  P(end, numbers, CF_NONE, "m", "2..3 of (-inf, inf)", "The other end of the capsule")                       \
  P(normal, numbers, CF_NONE, "", "2..3 of (-inf, inf)",                                                     \
    "Of the plane, out of the solid; left out: along the last axis")                                         \
  P(distance, function, CF_NONE, "m", "",                                                                    \
    "Of the expression: negative inside, positive outside, in x, y, z, t; only the sign matters, but for "   \
    "snow that comes to lie")                                                                                \
  P(file, path, CF_NONE, "", "",                                                                             \
    "A closed surface in a PLY or OBJ file (in 2D its section at z = 0), or signed distances in a NPY "      \
    "file, "                                                                                                 \
    "in m, negative inside, an array [z, y, x] or [y, x]; relative to the scene")                            \
  P(spacing, number, CF_NONE, "m", "(0, inf)", "Between the values of a NPY file; left out: the domain's")   \
  P(origin, numbers, CF_NONE, "m", "2..3 of (-inf, inf)",                                                    \
    "Place of its first value; left out: the middle of the domain's first cell")                             \
  P(outside, flag, "false", "", "", "true: solid is everywhere but there (a vessel)")                        \
  P(turn, number, "0", "degree", "(-inf, inf)", "It stands turned by this about `axis` through its pivot")   \
  P(axis, numbers, "[0, 0, 1]", "", "3 of (-inf, inf)", "What it is turned about")                           \
  P(pivot, numbers, CF_NONE, "m", "2..3 of (-inf, inf)",                                                     \
    "The point that it is turned about, and that `path` moves; left out: center, or the middle of the file") \
  P(motion, functions, CF_NONE, "m", "", "How far it has been moved by time t, an expression in t an axis")  \
  P(rotation, function, CF_NONE, "rad", "", "How far it has been turned about `axis`, an expression in t")   \
  R(list, path, cf_scene_obstacle_stop,                                                                      \
    "In place of motion and rotation: stops in order of time; smooth in between, at rest before and after")  \
  P(kind, word, "wall", "", CF_WORDS(CF_OBSTACLE_KIND_WORDS),                                                \
    "What scalars meet: wall (nothing passes), held (they are `value` on the surface)")                      \
  P(value, function, CF_NONE, "", "", "Held: what scalars are on the surface, an expression in x, y, z, t")  \
  R(map, fields, cf_scene_obstacle_field, "Scalars for which kind or value differ, by name")                 \
  P(contact, word, "separate", "", CF_WORDS(CF_OBSTACLE_CONTACT_WORDS),                                      \
    "What bodies of model gel do there. sticky: held; slip: along the surface only; separate: may leave "    \
    "it. "                                                                                                   \
    "A viscous fluid is held where it is sticky, and slips elsewhere")                                       \
  P(friction, number, "0", "", "[0, inf)",                                                                   \
    "Coulomb's coefficient for bodies of model gel, with slip and separate")

typedef struct cf_scene_obstacle_stop {
  CF_PARAM_MEMBERS(CF_OBSTACLE_STOP_TABLE)
} cf_scene_obstacle_stop;
typedef struct cf_scene_obstacle_field {
  CF_PARAM_MEMBERS(CF_OBSTACLE_FIELD_TABLE)
} cf_scene_obstacle_field;
typedef struct cf_scene_obstacle {
  CF_PARAM_MEMBERS(CF_OBSTACLE_TABLE)
} cf_scene_obstacle;

#endif
