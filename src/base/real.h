/* SPDX-License-Identifier: MIT
 *
 * What goes with cf_real (cattaneo.h), the precision of the state. Sums, norms, time and parameters are
 * double in both builds.
 */
#ifndef CF_BASE_REAL_H
#define CF_BASE_REAL_H

#include <float.h>

#include "cattaneo.h"

#ifdef CF_SINGLE
#define CF_REAL_EPSILON FLT_EPSILON
#define CF_PRECISION    "single"
#else
#define CF_REAL_EPSILON DBL_EPSILON
#define CF_PRECISION    "double"
#endif

#define CF_MIN(a, b) ((a) < (b) ? (a) : (b))
#define CF_MAX(a, b) ((a) > (b) ? (a) : (b))

/* An alignment that suits every vector width in use (512 bits), in bytes and in cf_real. */
#define CF_ALIGN 64
#define CF_LANES ((int)(CF_ALIGN / sizeof(cf_real)))

#endif
