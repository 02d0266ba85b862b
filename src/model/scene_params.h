/* SPDX-License-Identifier: MIT
 *
 * Diffusion in words that people think in. With D = k/C, U the speed of the wind and L a thickness:
 *
 *     front_speed     c = sqrt((1 - F) D/tau)
 *     reach           R = 2 ln 20 c tau                 where 5 % of a front in one dimension is left
 *     blur            b = sqrt(F D tau)                 what Fourier's share does to a front; 1/b is the wave
 *                                                       number of the fastest wave
 *     cone_angle      alpha = asin(c/U)                 half-angle behind a source in the wind
 *     visible_length  L_c = 2 tau U (1 - c^2/U^2)       over which the cone is straight
 *     arrival         t_a = L/c                         first sign on the far side of a slab
 *     saturation      t_s = 4 ln(160/pi^2) L^2/(pi^2 D) until a slab, wetted from one side, is 95 % full (without
 *                                                       ringing: tau < L^2/(pi^2 D))
 *
 * The long-time diffusivity is D, whatever tau and F.
 */
#ifndef CF_MODEL_SCENE_PARAMS_H
#define CF_MODEL_SCENE_PARAMS_H

#include "model/scene.h"

/* Any two of (k or saturation), tau, (front_speed, cone_angle or arrival), reach, visible_length, with f_t or blur
 * or neither (F = f_t of the struct), become k, tau and f_t; the others are no longer given. Keys that say more
 * than is needed must agree to 1e-6. `path` is that of the struct in the scene. CF_BAD_SCENE names the keys that
 * contradict each other, or what is missing. */
cf_status cf_scene_resolve_params(cf_scene *scene, const char *path, cf_scene_diffusion *d);

typedef struct cf_scene_measures {
  double front_speed, reach, blur; /* m/s, m, m; speed and reach are 0 or infinite where there is no front */
  double cone_angle, visible_length; /* degrees, m; NaN without a cone */
  double arrival, saturation;        /* s */
  bool rings;                        /* a slab of that thickness fills with overshoots */
} cf_scene_measures;

/* Of D = k/C, in m^2/s; wind and thickness may be 0. */
cf_scene_measures cf_scene_measure(double D, double tau, double f_t, double wind, double thickness);

/* A line "front_speed = 0.25 m/s, reach = ..." of all of them that mean something. */
void cf_scene_measures_text(const cf_scene_measures *m, double thickness, char *text, size_t size);

#endif
