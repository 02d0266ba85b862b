/* SPDX-License-Identifier: MIT
 *
 * Particles of a frame (io/frame.h writes them), read back in single precision, for pictures.
 */
#ifndef CF_IO_POINTS_H
#define CF_IO_POINTS_H

#include <stdint.h>

#include "base/status.h"
#include "io/folder.h"

typedef struct cf_points {
  cf_path path;
  double time;
  int64_t count;
  float (*place)[3]; /* m */
} cf_points;

/* The places. CF_BAD_FILE, CF_NO_MEMORY. */
cf_status cf_points_read(cf_points *p, const char *path);
void cf_points_clear(cf_points *p); /* a zeroed one is fine */

/* An attribute, `components` numbers a particle; the caller's: cf_free. With 1 of an attribute that has more: their
 * length as a vector. CF_BAD_FILE: there is none of that name (the sentence lists those there are), or it has fewer. */
cf_status cf_points_attribute(const cf_points *p, const char *name, int components, float **values);

#endif
