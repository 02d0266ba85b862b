/* SPDX-License-Identifier: MIT
 *
 * Cattaneo-Fourier diffusion of one scalar in a medium at rest: cf_diffuse_* and the ledger of cattaneo.h, with
 * the equations and schemes. (What moves is physics/advect.h's.) Nothing more is known outside diffuse.c.
 */
#ifndef CF_PHYSICS_DIFFUSE_H
#define CF_PHYSICS_DIFFUSE_H

#include "base/fn.h"
#include "base/walls.h"
#include "grid/field.h"
#include "grid/grid.h"
#include "solve/helmholtz.h"

#endif
