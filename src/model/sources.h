/* SPDX-License-Identifier: MIT
 *
 * The scene's `sources:` list as what acts on one scalar and its flux: rates, held values and point sources.
 *
 * A cell takes the fraction of a source that lies inside the shape: exact for a box, by 8 points an axis for
 * a sphere's surface. A point source is shared by the 2^dim cells around it with linear weights, so that its
 * sum and its centre of mass are exact.
 */
#ifndef CF_MODEL_SOURCES_H
#define CF_MODEL_SOURCES_H

#include "grid/field.h"
#include "grid/grid.h"
#include "model/obstacles.h"
#include "model/scene.h"
#include "physics/diffuse.h"

typedef struct cf_sources cf_sources;

/* What acts on scene field `scalar` (an index in scene->fields) and on the flux named `flux`. *acts is ready
 * for cf_diffuse_create and alive as long as `s`; it is all NULL where nothing acts. */
cf_status cf_sources_create(cf_sources **s, const cf_scene *scene, const cf_grid *g, int scalar,
                            const char *flux, cf_source *acts);
void cf_sources_destroy(cf_sources *s); /* NULL is fine */

/* The scalar has a region whose held cells have values of the time: *acts of cf_sources_create is told. */
void cf_sources_add_held(cf_sources *s, const cf_obstacles *o, cf_source *acts);

/* Sets the held faces of the flux to their values at time t. */
void cf_sources_hold_flux(const cf_sources *s, double t, cf_face q);

#endif
