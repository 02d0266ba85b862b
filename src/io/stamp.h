/* SPDX-License-Identifier: MIT
 *
 * What every output file says about where it comes from, besides the program's version. Never the time of
 * day, the machine or the user: the same run gives the same bytes.
 */
#ifndef CF_IO_STAMP_H
#define CF_IO_STAMP_H

#include <stdint.h>

typedef struct cf_stamp {
  const char *title; /* of the scene, UTF-8; NULL: none */
  const char *scene; /* the resolved scene as text, kept in checkpoints; NULL: none */
  double time;       /* simulated, s */
  int64_t step;
} cf_stamp;

#endif
