/* SPDX-License-Identifier: MIT
 *
 * An atlas of snow crystals: pictures that model `phase` makes of grown flakes, with a JSON file that says what they
 * measure. The pictures of a flake have the same size, their first row is the top (largest y), x runs to the right.
 *
 *     rgba     16 bits each: colour, and as straight alpha how much of the pixel is ice
 *     height   16-bit grey: half of the thickness, value/65535 height_scale
 *     normal   16-bit RGB: n = 2 c/65535 - 1, z towards the viewer
 *
 * JSON is YAML, so it is read, and its errors are told, like a scene.
 */
#ifndef CF_MODEL_ATLAS_H
#define CF_MODEL_ATLAS_H

#include "base/param.h"
#include "base/status.h"

#define CF_ATLAS_FLAKE_TABLE(P, R)                                                                        \
  P(name, text, "", "", "", "What the flake is called")                                                   \
  P(rgba, text, CF_REQUIRED, "", "", "The picture of its colour and cover, beside the atlas")             \
  P(height, text, CF_REQUIRED, "", "", "The picture of its thickness")                                    \
  P(normal, text, CF_REQUIRED, "", "", "The picture of its normals")                                      \
  P(pixels, integers, CF_REQUIRED, "", "2 of [1, 32768]", "Width and height of the pictures")             \
  P(metres_per_pixel, number, CF_REQUIRED, "", "(0, inf)", "Width of a pixel, m")                         \
  P(center, numbers, CF_REQUIRED, "", "2 of (-inf, inf)",                                                 \
    "Centre of mass, in pixels from the middle of the upper left one")                                    \
  P(radius, number, CF_REQUIRED, "", "(0, inf)", "Of the farthest ice from the centre, m")                \
  P(area, number, CF_REQUIRED, "", "(0, inf)", "Of the silhouette, m^2")                                  \
  P(mean_thickness, number, CF_REQUIRED, "", "(0, inf)", "Over the silhouette, m")                        \
  P(height_scale, number, CF_REQUIRED, "", "(0, inf)", "What white means in the picture of thickness, m") \
  P(mass, number, CF_REQUIRED, "", "(0, inf)", "kg")                                                      \
  P(symmetry, integer, "6", "", "[0, 1000]", "Number of its arms; 0: none in particular")

#define CF_ATLAS_TABLE(P, R)                                                        \
  P(cattaneo_atlas, integer, CF_REQUIRED, "", "[1, 1]", "Version of the format: 1") \
  R(list, flakes, cf_atlas_flake, "The flakes")

typedef struct cf_atlas_flake {
  CF_PARAM_MEMBERS(CF_ATLAS_FLAKE_TABLE)
} cf_atlas_flake;

typedef struct cf_atlas {
  CF_PARAM_MEMBERS(CF_ATLAS_TABLE)
  struct cf_config *config; /* the memory of all texts */
} cf_atlas;

/* What the picture of the thickness says of a flake, in units of its diameter D = 2 radius. */
typedef struct cf_atlas_shape {
  double inertia; /* about its normal through the centre of mass, over m D^2 */
  double
      offset[2]; /* of the middle of the silhouette from the centre of mass, x to the right, y up, over D */
} cf_atlas_shape;

/* Reads the index at `path`; the pictures are not opened. CF_BAD_SCENE with place and line for what is wrong, or if
 * there is no flake in it. */
cf_status cf_atlas_read(cf_atlas **atlas, const char *path);
void cf_atlas_destroy(cf_atlas *atlas); /* NULL is fine */

/* From the picture of flake `i`. CF_BAD_FILE: it cannot be read, is not of the size that the atlas says, or is black. */
cf_status cf_atlas_measure(const cf_atlas *atlas, int i, cf_atlas_shape *shape);

/* The folder that its pictures are in: "." at least. */
const char *cf_atlas_folder(const cf_atlas *atlas);

#endif
