/* SPDX-License-Identifier: MIT
 *
 * Bodies that scenes take from files, as signed distances (grid/shape.h): closed surfaces, and distances themselves.
 */
#ifndef CF_MODEL_SURFACE_H
#define CF_MODEL_SURFACE_H

#include "base/param.h"
#include "grid/shape.h"

/* Where a surface goes: its middle to `center`, scaled to `half` along each axis; of no entries: as in the file. */
typedef struct cf_surface_place {
  const cf_param_numbers *center, *half;
} cf_surface_place;

/* Reads a closed surface (.ply, .obj) and samples its distance h apart, `margin` samples more on every side; low and
 * high enclose the surface. CF_BAD_FILE; CF_BAD_ARGUMENT: not closed; CF_OVER_LIMIT, CF_NO_MEMORY. *samples is the
 * caller's: cf_samples_destroy. */
cf_status cf_surface_read(const char *path, const cf_surface_place *place, double h, int margin,
                          cf_samples *samples, double low[3], double high[3]);

/* Reads distances (.npy) of `dim` axes that lie h apart, the first at `origin`. CF_BAD_FILE, CF_NO_MEMORY. */
cf_status cf_surface_read_distances(const char *path, int dim, double h, const double origin[3],
                                    cf_samples *samples);

#endif
