/* SPDX-License-Identifier: MIT
 *
 * What a moving medium carries along: cf_advect_* of cattaneo.h, with the equations and what each scheme
 * promises. Nothing more is known outside advect.c.
 */
#ifndef CF_PHYSICS_ADVECT_H
#define CF_PHYSICS_ADVECT_H

#include "base/walls.h"
#include "grid/field.h"
#include "grid/grid.h"

#endif
