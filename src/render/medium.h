/* SPDX-License-Identifier: MIT
 *
 * Ink or smoke: a density d on a grid that takes from light of colour c the part (absorb_c + scatter_c) d per metre and
 * hands on the scattered part of what the lights send there,
 *
 *     dL/ds = -(absorb + scatter) d L + scatter d sum over lights of p(angle) T E
 *
 * with Henyey and Greenstein's p and the light E T that comes through the medium to the place. T is found for the whole
 * grid at once, layer by layer away from the light (short characteristics): what a cell sees of a light is what the
 * point upstream, on the layer before, sees, faded over the way between. That is of the first order and softens shadows
 * by about a cell. Light scattered more than once is made up for by two further orders with less and less depth
 * (Wrenninge, Kulla, Lundqvist 2013).
 *
 * Rays march with steps of at most a cell through what is not empty, in midpoints: exact where d is uniform.
 */
#ifndef CF_RENDER_MEDIUM_H
#define CF_RENDER_MEDIUM_H

#include "grid/grid.h"
#include "render/camera.h"
#include "render/light.h"

#define CF_MEDIUM_LIGHTS (CF_LIGHTS + 1)

typedef struct cf_medium {
  int n[3];
  float low[3], h;        /* lower corner of the box, width of a cell, m */
  float *density;         /* n[0] a row, x first */
  cf_vec absorb, scatter; /* per metre and unit of density */
  float forward;          /* g of Henyey and Greenstein: -1 back, 0 all ways, 1 forward */
  /* worked out */
  int bricks[3];
  float *most;                    /* of a brick and what interpolation reaches from it */
  int coarse, m[3], lights;       /* cells for the light, `coarse` times as wide */
  float *depth[CF_MEDIUM_LIGHTS]; /* integral of d towards the sky straight above, and towards each light */
  cf_vec *sent;                   /* what a cell sends to the eye for each unit that it scatters */
} cf_medium;

/* d = max(0, (f - zero) scale) for the field f. `fine`: grids of few cells are refined by a cubic first, so that the
 * cells are not seen. CF_NO_MEMORY. */
cf_status cf_medium_create(cf_medium *m, const cf_grid *g, const cf_real *f, double zero, double scale,
                           bool fine);
void cf_medium_destroy(cf_medium *m); /* a zeroed one is fine */

/* Works out how far the lights, and the sky from straight above, come, and what of it is sent to the eye. Needed
 * where `scatter` is not 0. */
cf_status cf_medium_illuminate(cf_medium *m, int lights, const cf_light *light, cf_vec sky, cf_vec eye,
                               int threads);

/* Adds to *light what the stretch near..far of the ray sends, and takes from *through what it holds back.
 * offset: 0 to 1, where in a step the midpoints lie (0.5 for none). */
void cf_medium_march(const cf_medium *m, const cf_ray *r, float near, float far, float offset, cf_vec *light,
                     cf_vec *through);

/* The part of light l that comes through to a place. */
cf_vec cf_medium_shade(const cf_medium *m, int l, cf_vec at);

#endif
