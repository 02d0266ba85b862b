/* SPDX-License-Identifier: MIT */
#include "base/version.h"

#include "base/real.h"

#ifndef CF_VERSION
#define CF_VERSION "0.1.0"
#endif
#ifndef CF_GIT_HASH
#define CF_GIT_HASH "unknown"
#endif

#if defined(__clang__)
#define CF_COMPILER "clang " __clang_version__
#elif defined(__GNUC__)
#define CF_COMPILER "gcc " __VERSION__
#else
#define CF_COMPILER "unknown compiler"
#endif

const char *cf_version(void) { return CF_VERSION; }

const char *cf_git_hash(void) { return CF_GIT_HASH; }

const char *cf_build(void) { return CF_COMPILER ", " CF_PRECISION; }
