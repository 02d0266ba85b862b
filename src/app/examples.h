/* SPDX-License-Identifier: MIT
 *
 * The scenes of examples/, in the program. The list is made at build time (cmake/embed.cmake).
 */
#ifndef CF_APP_EXAMPLES_H
#define CF_APP_EXAMPLES_H

#include <stddef.h>

typedef struct cf_example {
  const char *name, *title;
  const unsigned char *scene; /* the file, byte for byte */
  size_t size;
} cf_example;

/* Ends with a row without a name. */
extern const cf_example cf_examples[];

#endif
