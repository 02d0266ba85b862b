/* SPDX-License-Identifier: MIT
 *
 * The keys of `snowfall:` in a scene.
 */
#ifndef CF_MODEL_SNOWFALL_KEYS_H
#define CF_MODEL_SNOWFALL_KEYS_H

#include "base/param.h"

#define CF_SNOWFALL_TABLE(P, R)                                                                              \
  P(atlas, path, CF_NONE, "", "",                                                                            \
    "The atlas of flakes, an atlas.json that a run of model phase has written; relative to the scene")       \
  P(flakes, integer, "5000", "", "[1, 10000000]",                                                            \
    "How many are in the air; for each that lands another comes in at the top")                              \
  P(radius, numbers, "[1e-3, 3e-3]", "m", "2 of (0, 1)",                                                     \
    "Smallest and largest radius of a flake; a flake of the atlas is scaled in all directions")              \
  P(slope, number, "0", "1/m", "[0, inf)",                                                                   \
    "How their number falls off with the radius r, as exp(-slope r) (Gunn, Marshall 1958); 0: evenly")       \
  P(gravity, number, "9.81", "m/s^2", "(0, inf)", "Downwards, along -z")                                     \
  P(air_density, number, "1.29", "kg/m^3", "(0, inf)", "Density of the air")                                 \
  P(viscosity, number, "1.72e-5", "kg/m/s", "(0, inf)", "Viscosity of the air")                              \
  P(wind, numbers, "[0, 0, 0]", "m/s", "3 of (-inf, inf)", "Mean wind, far above the ground")                \
  P(gust_strength, number, "0", "m/s", "[0, inf)",                                                           \
    "Root mean square of one component of the gusts, a random wind that is free of divergence")              \
  P(gust_length, number, CF_NONE, "m", "(0, inf)",                                                           \
    "Size of the largest gusts, and the height from which the ground is not felt; left out: a third of the " \
    "box's height")                                                                                          \
  P(flutter, number, "1", "", "[0, inf)", "How strongly vortices rock the flakes; 1 is as measured")         \
  P(imperfection, number, "0.01", "", "[0, 0.2]",                                                            \
    "How far a flake's centre of pressure is off its middle, in diameters: it glides and spirals")           \
  P(snow_density, number, "60", "kg/m^3", "(0, inf)", "Of snow that lies")                                   \
  P(repose, number, "40", "degree", "(0, 90)", "The steepest slope on which it stays")                       \
  P(stands_for, number, "1", "", "(0, inf)",                                                                 \
    "The layer grows as if each flake that lands were so many: hours of snow in a short scene")              \
  P(seed, integer, "1", "", "[0, 1073741824]", "Another one gives other flakes and gusts")

typedef struct cf_scene_snowfall {
  CF_PARAM_MEMBERS(CF_SNOWFALL_TABLE)
} cf_scene_snowfall;

#endif
