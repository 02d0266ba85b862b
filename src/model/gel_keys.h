/* SPDX-License-Identifier: MIT
 *
 * The keys of `gel:` in a scene.
 */
#ifndef CF_MODEL_GEL_KEYS_H
#define CF_MODEL_GEL_KEYS_H

#include "base/param.h"

#define CF_GEL_BODY_WORDS(W)     W(BOX, box) W(BALL, ball) W(SLAB, slab) W(IMAGE, image) W(MESH, mesh)
#define CF_GEL_LAW_WORDS(W)      W(COROTATED, corotated) W(NEO_HOOKEAN, neo_hookean)
#define CF_GEL_CONTACT_WORDS(W)  W(STICKY, sticky) W(SLIP, slip) W(SEPARATE, separate)
#define CF_GEL_WALL_WORDS(W)     CF_GEL_CONTACT_WORDS(W) W(NONE, none)
#define CF_GEL_WATER_WORDS(W)    W(BATH, bath) W(HELD, held) W(RATE, rate)
#define CF_GEL_PLACE_WORDS(W)    W(BOX, box) W(BALL, ball) W(PLANE, plane) W(EVERYWHERE, everywhere)
#define CF_GEL_TRANSFER_WORDS(W) W(APIC, apic) W(FLIP, flip)

enum { CF_GEL_BODY_BOX, CF_GEL_BODY_BALL, CF_GEL_BODY_SLAB, CF_GEL_BODY_IMAGE, CF_GEL_BODY_MESH };
enum { CF_GEL_LAW_COROTATED, CF_GEL_LAW_NEO_HOOKEAN };
enum { CF_GEL_WALL_NONE = 3 }; /* before it the contacts, in the order of cf_mpm_contact */
enum { CF_GEL_WATER_BATH, CF_GEL_WATER_HELD, CF_GEL_WATER_RATE };
enum { CF_GEL_PLACE_BOX, CF_GEL_PLACE_BALL, CF_GEL_PLACE_PLANE, CF_GEL_PLACE_EVERYWHERE };
enum { CF_GEL_TRANSFER_APIC, CF_GEL_TRANSFER_FLIP };

#define CF_GEL_BODY_TABLE(P, R)                                                                              \
  P(shape, word, "box", "", CF_WORDS(CF_GEL_BODY_WORDS),                                                     \
    "box (center, half), ball (center, radius), slab (center, half of its two long sides, thickness along "  \
    "the "                                                                                                   \
    "last axis), image (file, center, half: what is darker than the middle grey; in 3D with thickness), "    \
    "mesh "                                                                                                  \
    "(a closed surface in a PLY or OBJ file, as it is or to center and half)")                               \
  P(center, numbers, CF_NONE, "m", "2..3 of (-inf, inf)", "Middle of the body")                              \
  P(half, numbers, CF_NONE, "m", "1..3 of (0, inf)", "Half of its sides")                                    \
  P(radius, number, CF_NONE, "m", "(0, inf)", "Of a ball")                                                   \
  P(thickness, number, CF_NONE, "m", "(0, inf)", "Of a slab, or of an image in 3D")                          \
  P(file, path, CF_NONE, "", "", "Image or mesh, relative to the scene")                                     \
  P(turn, number, "0", "degree", "(-inf, inf)",                                                              \
    "The body is turned by this about `axis` through its middle")                                            \
  P(axis, numbers, "[0, 0, 1]", "", "3 of (-inf, inf)", "What it is turned about")                           \
  P(velocity, numbers, CF_NONE, "m/s", "2..3 of (-inf, inf)", "At time 0; left out: at rest")                \
  P(spin, number, "0", "rad/s", "(-inf, inf)", "Rotation at time 0 about `axis` through its middle")         \
  P(saturation, profile, "0", "", "", "Water at time 0: S, an expression in x, y, z")                        \
  P(young, number, "40", "Pa", "(0, inf)", "Young's modulus E of the dry body")                              \
  P(poisson, number, "0.4", "", "[0, 0.5)", "Poisson's ratio nu")                                            \
  P(law, word, "corotated", "", CF_WORDS(CF_GEL_LAW_WORDS), "Elastic law: fixed corotated or neo-Hookean")   \
  P(swelling, number, "10", "Pa", "[0, inf)", "chi of eq. 32: the swelling stress is chi S")                 \
  P(hardening, number, "0", "", "[0, inf)",                                                                  \
    "xi: the moduli grow as exp(xi (1 - J_P)) where the body was pressed")                                   \
  P(compression, number, CF_NONE, "", "(0, 1)",                                                              \
    "Plastic: what is pressed by more than this share stays pressed")                                        \
  P(stretch, number, CF_NONE, "", "(0, inf)", "Plastic: what is stretched by more than this share stays so") \
  P(solid_density, number, "10", "kg/m^3", "(0, inf)", "Of the body's solid part")                           \
  P(fluid_density, number, "1", "kg/m^3", "(0, inf)", "rho_f, of the water")                                 \
  P(porosity, number, "0.7", "", "[0, 1)", "phi_p: the share of the body's volume that water can fill")      \
  P(k, number, CF_NONE, "m^2/s", "[0, inf)",                                                                 \
    "Of this body; left out: diffusion.k. tau is that of all bodies")                                        \
  P(f_t, number, CF_NONE, "", "[0, 1]", "F_T of this body; left out: diffusion.f_t")                         \
  P(inertia_saturation, number, "0", "", "[0, inf)",                                                         \
    "Inertia and weight are those of the body with its pores filled to this share: a mass that does not "    \
    "follow "                                                                                                \
    "the water keeps momentum exact")

#define CF_GEL_WATER_TABLE(P, R)                                                                           \
  P(kind, word, "bath", "", CF_WORDS(CF_GEL_WATER_WORDS),                                                  \
    "bath: the body's surface has the saturation `value`; held: all of the body inside the place has it; " \
    "rate: "                                                                                               \
    "`value` is added, kg a second and m^3 of the body")                                                   \
  P(shape, word, "everywhere", "", CF_WORDS(CF_GEL_PLACE_WORDS),                                           \
    "Where: box (center, half), ball (center, radius), plane (center, normal: below it), everywhere")      \
  P(center, numbers, CF_NONE, "m", "2..3 of (-inf, inf)", "Middle; a point of the plane")                  \
  P(half, numbers, CF_NONE, "m", "2..3 of (0, inf)", "Half of the sides of the box")                       \
  P(radius, number, CF_NONE, "m", "(0, inf)", "Of the ball")                                               \
  P(outside, flag, "false", "", "", "true: everywhere but there")                                          \
  P(normal, numbers, CF_NONE, "", "2..3 of (-inf, inf)", "Of the plane, away from the water")              \
  P(value, function, "1", "", "",                                                                          \
    "Saturation, or rate; an expression in t. Below that of the body it dries")                            \
  P(from, number, "0", "s", "(-inf, inf)", "When it begins")                                               \
  P(to, number, CF_NONE, "s", "(-inf, inf)", "When it ends; left out: never")                              \
  P(amount, number, CF_NONE, "kg", "(0, inf)", "A drop: gone when it has given that much; left out: never")

#define CF_GEL_TABLE(P, R)                                                                                   \
  R(list, bodies, cf_scene_gel_body, "The bodies, each with its material")                                   \
  R(list, water, cf_scene_gel_water, "Where water is; the first in the list that covers a cell has it")      \
  P(walls, word, "separate", "", CF_WORDS(CF_GEL_WALL_WORDS),                                                \
    "How bodies meet the walls of the domain; none: there are no walls and the domain only says how large "  \
    "a "                                                                                                     \
    "cell is")                                                                                               \
  P(gravity, numbers, CF_NONE, "m/s^2", "2..3 of (-inf, inf)", "Acceleration; left out: none")               \
  P(particles, integer, "2", "", "[1, 64]", "Particles a cell along each axis")                              \
  P(jitter, number, "0", "", "[0, 1]",                                                                       \
    "Random displacement of particles at time 0, in halves of their spacing")                                \
  P(split, number, "1", "", "[0, inf)",                                                                      \
    "A particle whose piece of the body has been stretched over more cells than this becomes two, lest the " \
    "body come apart where grid and particles do not meet any more; there is room for four times the "       \
    "particles of time 0. 0: never")                                                                         \
  P(transfer, word, "apic", "", CF_WORDS(CF_GEL_TRANSFER_WORDS),                                             \
    "How velocities come back from the grid: apic (keeps angular momentum) or flip (eq. 36)")                \
  P(flip, number, "0.95", "", "[0, 1]", "With transfer: flip, its share; the rest is PIC")                   \
  P(implicitness, number, "0", "", "[0, 1]",                                                                 \
    "beta of eq. 35: 0 explicit, 1 implicit, whose steps are not bound by the speed of sound")               \
  P(damping, number, "0", "1/s", "[0, inf)", "Velocities decay at this rate: what water around would do")    \
  P(surface, number, "0.5", "", "(0, 1)",                                                                    \
    "The surface that is drawn is where the grid is filled to this share")                                   \
  P(seed, integer, "1", "", "[0, 1073741824]", "Of the jitter")

typedef struct cf_scene_gel_body {
  CF_PARAM_MEMBERS(CF_GEL_BODY_TABLE)
} cf_scene_gel_body;
typedef struct cf_scene_gel_water {
  CF_PARAM_MEMBERS(CF_GEL_WATER_TABLE)
} cf_scene_gel_water;
typedef struct cf_scene_gel {
  CF_PARAM_MEMBERS(CF_GEL_TABLE)
} cf_scene_gel;

#endif
