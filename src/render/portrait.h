/* SPDX-License-Identifier: MIT
 *
 * A crystal that grew in the plane as a flake: maps of 16 bits of what covers, how high it is and where it faces, and
 * what it measures. They are for an atlas of snow (model/atlas.h).
 *
 * The crystal has no size of its own. Its radius r, from the centre of mass to the farthest point of eta = 1/2, becomes R
 * metres, and all three axes are scaled by s = R/r, the thickness d(x, y) too:
 *
 *     height   s d/2 above the plane, and as much below it
 *     normal   (-dh/dx, -dh/dy, 1) over its length, h the height
 *     area     integral of eta;   volume   integral of s d;   mass = 917 kg/m^3 volume
 *
 * The pictures are squares around the centre of mass, a little wider than the crystal; a pixel is the mean of what is in
 * it. What reaches out of the grid is cut off. Several crystals in a field are one flake.
 */
#ifndef CF_RENDER_PORTRAIT_H
#define CF_RENDER_PORTRAIT_H

#include <stdbool.h>
#include <stdint.h>

#include "grid/field.h"
#include "grid/grid.h"

typedef struct cf_portrait {
  int pixels;       /* width and height of the maps, rows from the top */
  uint16_t *rgba;   /* ice white, bluer where it is thin; cover = eta, not multiplied by it */
  uint16_t *height; /* 65535 is height_scale */
  uint16_t *normal; /* n = 2 c/65535 - 1: x right, y up, z to the viewer */
  double metres_per_pixel, center[2];
  double radius, area, mean_thickness, height_scale, mass;
  bool cut; /* the crystal touches the border of the grid */
} cf_portrait;

/* From eta and the thickness (in the unit of the grid) on a grid in 2D. CF_BAD_ARGUMENT, with a sentence made to follow
 * the name of a run: there is no crystal, or no thickness, or it is a few cells wide. CF_NO_MEMORY. */
cf_status cf_portrait_create(cf_portrait *p, const cf_grid *g, cf_cell eta, cf_cell thickness, int pixels,
                             double radius);
void cf_portrait_destroy(cf_portrait *p); /* a zeroed one is fine */

#endif
