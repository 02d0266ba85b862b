/* SPDX-License-Identifier: MIT
 *
 * The front filter: takes the ringing out of steep fronts that a central scheme leaves behind, and lets smooth
 * fields be. Along each axis
 *
 *   f_i += nu (J_{i+1/2} - J_{i-1/2}),   J = f^R - f^L,
 *
 * J being the jump at a face between the straight lines fitted to the two cells with slopes limited by MC. Where
 * the field is smooth J is of third order. All axes act on the same old values. The sum is kept; with
 * nu <= 1/(2 dim) no new extrema appear. J = 0 on walls that are not periodic.
 *
 * It is a heuristic without a time in it: on well resolved waves its own error may exceed the scheme's.
 */
#ifndef CF_STENCIL_FRONT_H
#define CF_STENCIL_FRONT_H

#include "base/walls.h"
#include "grid/field.h"
#include "grid/grid.h"
#include "grid/region.h"

/* nu = weight min(1/dim, courant)/2 for waves that move `courant` = c dt/h cells a step. Weight 1 goes with
 * SDIRK2, 1/2 with leapfrog. */
double cf_front_strength(int dim, double courant, double weight);

/* Filters a cell field once; `work` is scratch, two layers of ghosts of phi are written. With a region (NULL: none) J = 0
 * on faces that are not between two cells inside. */
void cf_front_cell(const cf_grid *g, const cf_walls *walls, const cf_region *region, double nu, cf_cell phi,
                   cf_cell work);

/* Filters every component of a face field. q.n on insulated walls stays as it is and q is taken as odd there. */
void cf_front_face(const cf_grid *g, const cf_walls *walls, double nu, cf_face q, cf_cell work);

#endif
