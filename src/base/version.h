/* SPDX-License-Identifier: MIT
 *
 * Which program this is: what --version prints and what every output file carries, so that a result can be
 * traced to the source it came from. (cf_version is in cattaneo.h.) The build passes CF_VERSION and
 * CF_GIT_HASH; without them the version is that of version.c and the hash is "unknown".
 */
#ifndef CF_BASE_VERSION_H
#define CF_BASE_VERSION_H

#include "cattaneo.h"

/* The commit, "1a2b3c4d" or "unknown". */
const char *cf_git_hash(void);

/* Compiler and precision: "gcc 12.2.0, double". */
const char *cf_build(void);

#endif
