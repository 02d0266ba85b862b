/* SPDX-License-Identifier: MIT
 *
 * The keys of `phase:` in a scene.
 */
#ifndef CF_MODEL_PHASE_KEYS_H
#define CF_MODEL_PHASE_KEYS_H

#include "base/param.h"

#define CF_PHASE_FORM_WORDS(W)    W(STABLE, stable) W(PAPER, paper)
#define CF_PHASE_STENCIL_WORDS(W) W(ISOTROPIC, isotropic) W(FIVE_POINT, five_point)
#define CF_PHASE_SCHEME_WORDS(W)  W(AUTO, auto) W(EXPLICIT, explicit) W(IMPLICIT, implicit) W(EULER, euler)
#define CF_PHASE_DRIVING_WORDS(W) W(KOBAYASHI, kobayashi) W(KARMA_RAPPEL, karma_rappel)
#define CF_PHASE_LAW_WORDS(W)     W(FOLD, fold) W(CUBIC, cubic) W(DRIVING, driving) W(NONE, none)
#define CF_PHASE_POLE_WORDS(W)    W(FADE, fade) W(PRINTED, printed)
#define CF_PHASE_CARRY_WORDS(W)   W(BOTH, both) W(HEAT, heat)
#define CF_PHASE_SEED_WORDS(W)    W(BALL, ball) W(DISC, disc) W(BOX, box) W(LINE, line)

enum { CF_SCENE_PHASE_STABLE, CF_SCENE_PHASE_PAPER };
enum { CF_SCENE_PHASE_ISOTROPIC, CF_SCENE_PHASE_FIVE_POINT };
enum { CF_SCENE_PHASE_AUTO, CF_SCENE_PHASE_EXPLICIT, CF_SCENE_PHASE_IMPLICIT, CF_SCENE_PHASE_EULER };
enum { CF_SCENE_PHASE_KOBAYASHI, CF_SCENE_PHASE_KARMA_RAPPEL };
enum { CF_SCENE_PHASE_FOLD, CF_SCENE_PHASE_CUBIC, CF_SCENE_PHASE_DRIVING, CF_SCENE_PHASE_NONE };
enum { CF_SCENE_PHASE_FADE, CF_SCENE_PHASE_PRINTED };
enum { CF_SCENE_PHASE_BOTH, CF_SCENE_PHASE_HEAT };
enum { CF_SCENE_SEED_BALL, CF_SCENE_SEED_DISC, CF_SCENE_SEED_BOX, CF_SCENE_SEED_LINE };

#define CF_PHASE_ANISOTROPY_TABLE(P, R)                                                                      \
  P(law, word, "fold", "", CF_WORDS(CF_PHASE_LAW_WORDS),                                                     \
    "fold: the energy of the surface, A = 1 + strength cos(folds theta) in the plane, and polar_strength "   \
    "cos(polar_folds phi) from the axis z; cubic: A = 1 + strength (4 sum n_i^4 - 3); driving: the driving " \
    "force, beta(v) = 1 - strength (1 - sum v_i^4/|v|^4) of eq. 27; none")                                   \
  P(folds, integer, "6", "", "[0, 14]", "omega of eq. 28, an even number: 6 for snow, 4 for metals")         \
  P(strength, profile, "0.02", "", "[0, 1)",                                                                 \
    "eps_p of eq. 28, delta of eq. 27; an expression in x, y, z. Facets are sharp, and the equation is no "  \
    "longer well-posed, from 1/(folds^2 - 1) on")                                                            \
  P(angle, profile, "0", "degree", "",                                                                       \
    "How far the crystal is turned in the plane; an expression in x, y, z")                                  \
  P(polar_folds, integer, "0", "", "[0, 6]", "zeta of eq. 28: 0, 2, 4 or 6")                                 \
  P(polar_strength, number, "0", "", "(-1, 1)",                                                              \
    "eps_a of eq. 28; with polar_folds: 2, above 0 needles along z, below 0 plates across it")               \
  P(pole, word, "fade", "", CF_WORDS(CF_PHASE_POLE_WORDS),                                                   \
    "In 3D, the plane's harmonic near the axis: fade (as sin^2 phi, so that the flux is bounded) or as "     \
    "printed in eq. 28")

#define CF_PHASE_SEED_TABLE(P, R)                                                                       \
  P(shape, word, "ball", "", CF_WORDS(CF_PHASE_SEED_WORDS),                                             \
    "ball or disc (a ball; in 3D, with half_height, a flat cylinder), box, line (from center to end)")  \
  P(center, numbers, CF_NONE, "m", "2..3 of (-inf, inf)", "Its middle; left out: that of the domain")   \
  P(radius, number, CF_NONE, "m", "(0, inf)", "Of the ball, disc or line; left out: 2 cells")           \
  P(half, numbers, CF_NONE, "m", "2..3 of (0, inf)", "Half of the sides of a box")                      \
  P(half_height, number, CF_NONE, "m", "(0, inf)", "Of a disc in 3D")                                   \
  P(end, numbers, CF_NONE, "m", "2..3 of (-inf, inf)", "The other end of a line")                       \
  P(angle, number, CF_NONE, "degree", "",                                                               \
    "How far this crystal is turned in the plane; left out: as anisotropy.angle. Crystals with angles " \
    "of their own keep them as they grow")

#define CF_PHASE_MAP_TABLE(P, R)                                                                             \
  P(file, path, CF_NONE, "", "",                                                                             \
    "A picture (.png) or an array (.npy; rows of y, in 3D planes of z or one plane for all) that fills the " \
    "box")                                                                                                   \
  P(range, numbers, "[0, 1]", "", "2 of (-inf, inf)",                                                        \
    "What black and white of a picture stand for, in the "                                                   \
    "unit of the key it replaces")

#define CF_PHASE_MAPS_TABLE(P, R)                                                              \
  R(record, mask, cf_scene_phase_map, "In place of phase.mask")                                \
  R(record, distance, cf_scene_phase_map, "In place of phase.distance")                        \
  R(record, angle, cf_scene_phase_map, "In place of phase.anisotropy.angle; not interpolated") \
  R(record, strength, cf_scene_phase_map, "In place of phase.anisotropy.strength")

#define CF_PHASE_NOISE_TABLE(P, R)                                                                         \
  P(amplitude, number, "0", "", "[0, inf)", "Added to psi: a number between -amplitude/2 and amplitude/2") \
  P(period, number, CF_NONE, "s", "(0, inf)", "How long each lasts; left out: 5 tau_eta")                  \
  P(symmetric, integer, "0", "", "[0, 24]",                                                                \
    "The noise has the symmetry of so many folds and of mirrors about the first seed; 0: it has none")     \
  P(seed, integer, "1", "", "[0, 1073741824]", "Another number gives other noise")

#define CF_PHASE_WINDOW_TABLE(P, R)                                                                         \
  P(follow, text, "", "", "",                                                                               \
    "The tip along this axis, x+, y+ or z+; left out: the box stands still. Walls and sources go with it, " \
    "what is an expression of x, y, z in `phase` or `velocity` does not")                                   \
  P(at, number, "0.6", "", "(0, 1)",                                                                        \
    "The box moves on by whole cells so that the tip stays within this part of its length")

#define CF_PHASE_TABLE(P, R)                                                                                 \
  P(form, word, "stable", "", CF_WORDS(CF_PHASE_FORM_WORDS),                                                 \
    "stable: all of the driving force has the memory tau_1, and energy never rises; paper: the flux alone "  \
    "has it, eqs 27 and 28, which amplifies the grid where tau_1 is above about 3 tau_eta")                  \
  P(scheme, word, "auto", "", CF_WORDS(CF_PHASE_SCHEME_WORDS),                                               \
    "explicit: substeps of three stages; implicit: two stages around the solver, for fine grids and large "  \
    "steps; euler: substeps of first order; auto: explicit where that costs less")                           \
  P(stencil, word, "isotropic", "", CF_WORDS(CF_PHASE_STENCIL_WORDS),                                        \
    "Differences of the phase across a face. isotropic: with those of the neighbouring faces, so that the "  \
    "error of the Laplacian is alike in all directions; five_point (seven in 3D): its own cells' alone, as " \
    "other programs do, for comparisons")                                                                    \
  P(width, number, "0.01", "m", "(0, inf)",                                                                  \
    "Width eps of the interface (delta of eq. 28): 6.2 of it lie between 10 % and 90 %; cells of up to 3 "   \
    "of it are common, 2 are better")                                                                        \
  P(tau_eta, function, "3e-4", "s", "[0, inf)",                                                              \
    "Time scale of the interface; a number or an expression in t")                                           \
  P(tau_1, function, "0", "s", "[0, inf)",                                                                   \
    "Relaxation time of the phase's flux; a number or an expression in t")                                   \
  P(f_eta, number, "0", "", "[0, 1]", "The share F_eta without memory: 0 is Cattaneo's law, 1 Fourier's")    \
  P(driving, word, "kobayashi", "", CF_WORDS(CF_PHASE_DRIVING_WORDS),                                        \
    "kobayashi: psi = -(alpha/pi) atan(gamma T); karma_rappel: psi = -2 coupling T eta (1 - eta), the "      \
    "driving force four times as large and tau_eta times A^2")                                               \
  P(alpha, function, "0.9", "", "(0, 1)", "alpha of eqs 27 and 28; a number or an expression in t")          \
  P(gamma, function, "10", "1/K", "[0, inf)", "gamma of eqs 27 and 28; a number or an expression in t")      \
  P(coupling, number, "1", "1/K", "[0, inf)", "lambda of karma_rappel")                                      \
  P(latent, number, "1.8", "K", "[0, inf)",                                                                  \
    "Latent heat K: how much warmer what has frozen would be; T is 0 at the melting point, -1 far off")      \
  P(star, number, "1", "", "[0, inf)", "Gamma of eq. 28: how readily the phase spreads along z")             \
  R(record, anisotropy, cf_scene_phase_anisotropy, "Which ways the crystal grows")                           \
  R(list, seeds, cf_scene_phase_seed, "What is solid at first; left out: one ball in the middle")            \
  P(mask, profile, CF_NONE, "", "",                                                                          \
    "Where it may grow: 1 yes, 0 no, between them slower; an expression in x, y, z")                         \
  P(distance, profile, CF_NONE, "m", "", "In place of mask: a signed distance, below 0 where it may grow")   \
  R(record, maps, cf_scene_phase_maps, "Pictures and arrays in place of expressions in x, y, z")             \
  R(record, noise, cf_scene_phase_noise, "What makes side branches")                                         \
  R(record, window, cf_scene_phase_window, "A box that follows the tip")                                     \
  P(carried, word, "both", "", CF_WORDS(CF_PHASE_CARRY_WORDS),                                               \
    "What `velocity` carries: both phase and heat (the crystal drifts along), or heat alone past a crystal " \
    "that stands")                                                                                           \
  P(thickening, number, "1e-3", "m^2/s", "[0, inf)",                                                         \
    "For the field thickness of flakes in 2D: their height is sqrt(2 thickening age)")

typedef struct cf_scene_phase_anisotropy {
  CF_PARAM_MEMBERS(CF_PHASE_ANISOTROPY_TABLE)
} cf_scene_phase_anisotropy;
typedef struct cf_scene_phase_seed {
  CF_PARAM_MEMBERS(CF_PHASE_SEED_TABLE)
} cf_scene_phase_seed;
typedef struct cf_scene_phase_map {
  CF_PARAM_MEMBERS(CF_PHASE_MAP_TABLE)
} cf_scene_phase_map;
typedef struct cf_scene_phase_maps {
  CF_PARAM_MEMBERS(CF_PHASE_MAPS_TABLE)
} cf_scene_phase_maps;
typedef struct cf_scene_phase_noise {
  CF_PARAM_MEMBERS(CF_PHASE_NOISE_TABLE)
} cf_scene_phase_noise;
typedef struct cf_scene_phase_window {
  CF_PARAM_MEMBERS(CF_PHASE_WINDOW_TABLE)
} cf_scene_phase_window;
typedef struct cf_scene_phase {
  CF_PARAM_MEMBERS(CF_PHASE_TABLE)
} cf_scene_phase;

#endif
