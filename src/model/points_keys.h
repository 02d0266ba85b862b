/* SPDX-License-Identifier: MIT
 *
 * The keys of `points:` in a scene: where points begin that the flow carries along.
 */
#ifndef CF_MODEL_POINTS_KEYS_H
#define CF_MODEL_POINTS_KEYS_H

#include "base/param.h"

#define CF_POINTS_SHAPE_WORDS(W) W(BOX, box) W(SPHERE, sphere) W(EVERYWHERE, everywhere)
enum { CF_POINTS_BOX, CF_POINTS_SPHERE, CF_POINTS_EVERYWHERE };

#define CF_POINTS_TABLE(P, R)                                                                              \
  P(shape, word, "everywhere", "", CF_WORDS(CF_POINTS_SHAPE_WORDS),                                        \
    "Where they begin: box (center, half), sphere (center, radius), everywhere")                           \
  P(center, numbers, CF_NONE, "m", "2..3 of (-inf, inf)", "Middle of the box or sphere")                   \
  P(half, numbers, CF_NONE, "m", "2..3 of (0, inf)", "Half of the sides of the box")                       \
  P(radius, number, CF_NONE, "m", "(0, inf)", "Radius of the sphere")                                      \
  P(where, profile, "1", "", "",                                                                           \
    "A place within the shape gets its point with this probability, an expression in x, y, z: `y > 0.1`, " \
    "`exp(-x^2)`")                                                                                         \
  P(wall, text, CF_NONE, "", "",                                                                           \
    "x-, x+, y-, y+, z- or z+: points come in with the fluid, `per_cell` a cell of it, through the part "  \
    "of this wall that lies within the shape")                                                             \
  P(count, integer, CF_NONE, "", "[1, 2147483647]", "So many at the time `from`, evenly spread")           \
  P(per_cell, integer, CF_NONE, "", "[1, 65536]", "So many in every cell at the time `from`")              \
  P(rate, number, CF_NONE, "1/s", "(0, inf)", "So many a second, between `from` and `to`")                 \
  P(from, number, "0", "s", "[0, inf)", "When they begin")                                                 \
  P(to, number, CF_NONE, "s", "(0, inf)", "When `rate` or the wall ends; left out: with the run")          \
  P(seed, integer, "1", "", "[0, 4294967295]", "Of the random numbers: another seed, other places")

typedef struct cf_scene_points {
  CF_PARAM_MEMBERS(CF_POINTS_TABLE)
} cf_scene_points;

#endif
