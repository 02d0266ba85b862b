/* SPDX-License-Identifier: MIT
 *
 * The keys of `flow:` in a scene.
 */
#ifndef CF_MODEL_FLOW_KEYS_H
#define CF_MODEL_FLOW_KEYS_H

#include "base/param.h"

#define CF_FLOW_WALL_WORDS(W) W(CLOSED, closed) W(OPEN, open)
#define CF_SLIP_WORDS(W)      W(ON, on) W(OFF, off)
#define CF_INLET_WORDS(W)     W(BOX, box) W(SPHERE, sphere) W(EVERYWHERE, everywhere)

enum { CF_SCENE_FLOW_WALL_CLOSED, CF_SCENE_FLOW_WALL_OPEN };
enum { CF_SCENE_SLIP_ON, CF_SCENE_SLIP_OFF };
enum { CF_SCENE_INLET_BOX, CF_SCENE_INLET_SPHERE, CF_SCENE_INLET_EVERYWHERE };

#define CF_FLOW_WALL_TABLE(P, R)                                                                           \
  P(side, text, CF_REQUIRED, "", "", "Which wall: x-, x+, y-, y+, z-, z+")                                 \
  P(kind, word, CF_NONE, "", CF_WORDS(CF_FLOW_WALL_WORDS),                                                 \
    "closed: nothing passes (but through inlets, or with `velocity`); open: the fluid comes and goes, at " \
    "pressure 0; left out: open where domain.walls is open, else closed")                                  \
  P(slip, word, "on", "", CF_WORDS(CF_SLIP_WORDS),                                                         \
    "off: the fluid sticks to the wall (felt with viscosity)")                                             \
  P(velocity, functions, CF_NONE, "m/s", "",                                                               \
    "Of the fluid on a closed wall, an expression in x, y, z, t an axis: a wall that moves along itself, " \
    "fluid that comes in or goes out through it")

#define CF_FLOW_INLET_TABLE(P, R)                                                                           \
  P(wall, text, CF_REQUIRED, "", "", "The closed wall that it is in: x-, x+, y-, y+, z-, z+")               \
  P(shape, word, "everywhere", "", CF_WORDS(CF_INLET_WORDS),                                                \
    "Its outline on the wall: box (center, half), sphere (center, radius: a round hole), everywhere")       \
  P(center, numbers, CF_NONE, "m", "2..3 of (-inf, inf)", "Its middle; across the wall it does not matter") \
  P(half, numbers, CF_NONE, "m", "2..3 of (0, inf)", "Half of the sides of the box")                        \
  P(radius, number, CF_NONE, "m", "(0, inf)", "Radius of the sphere")                                       \
  P(speed, function, CF_REQUIRED, "m/s", "",                                                                \
    "Of the fluid that comes in there, an expression in x, y, z, t; below 0 it goes out")

#define CF_FLOW_TABLE(P, R)                                                                              \
  P(gravity, numbers, CF_NONE, "m/s^2", "2..3 of (-inf, inf)",                                           \
    "What lighter fluid rises against; left out: 9.81 m/s^2 along -y")                                   \
  P(buoyancy, constants, CF_NONE, "", "",                                                                \
    "For each scalar that matters, the share of its weight that one unit of it takes off the fluid: "    \
    "{smoke: 0.5, ink: -0.02}; the acceleration is -buoyancy phi gravity")                               \
  P(force, functions, CF_NONE, "m/s^2", "",                                                              \
    "A further acceleration, an expression in x, y, z, t an axis, evaluated at the faces")               \
  P(viscosity, number, "0", "m^2/s", "[0, inf)", "Kinematic viscosity nu")                               \
  P(confinement, number, "0", "", "[0, inf)",                                                            \
    "Vorticity confinement: how strongly whirls of a few cells are spun up against the smearing of the " \
    "grid; 0.1 to 0.5 is common, 0 leaves the equations as they are")                                    \
  P(advection, word, CF_NONE, "", "ppm|linear|weno5|cubic|",                                             \
    "How the velocity carries itself; left out: as advection.scheme")                                    \
  R(list, walls, cf_scene_flow_wall,                                                                     \
    "What the walls do to the velocity, those that differ from domain.walls")                            \
  R(list, inlets, cf_scene_flow_inlet, "Holes in closed walls through which fluid comes; later ones add up")

typedef struct cf_scene_flow_wall {
  CF_PARAM_MEMBERS(CF_FLOW_WALL_TABLE)
} cf_scene_flow_wall;
typedef struct cf_scene_flow_inlet {
  CF_PARAM_MEMBERS(CF_FLOW_INLET_TABLE)
} cf_scene_flow_inlet;
typedef struct cf_scene_flow {
  CF_PARAM_MEMBERS(CF_FLOW_TABLE)
} cf_scene_flow;

#endif
