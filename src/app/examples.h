/* SPDX-License-Identifier: MIT
 *
 * The scenes of examples/, in the program, and the files that they name. The lists are made at build time
 * (cmake/embed.cmake).
 */
#ifndef CF_APP_EXAMPLES_H
#define CF_APP_EXAMPLES_H

#include <stddef.h>

typedef struct cf_example {
  const char *name, *title;
  const unsigned char *scene; /* the file, byte for byte */
  size_t size;
} cf_example;

typedef struct cf_example_file {
  const char *example, *path; /* the path from the scene, example/name */
  const unsigned char *bytes;
  size_t size;
} cf_example_file;

/* Both end with a row without a name. */
extern const cf_example cf_examples[];
extern const cf_example_file cf_example_files[];

#endif
