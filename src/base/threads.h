/* SPDX-License-Identifier: MIT
 *
 * Whether the threads of a run can be had. OpenMP ends the program where the system refuses it a thread, so they are
 * asked for here first.
 */
#ifndef CF_BASE_THREADS_H
#define CF_BASE_THREADS_H

#include "base/status.h"

/* Starts a team of that many threads, which OpenMP keeps for later. CF_OVER_LIMIT: the system does not give them. */
cf_status cf_threads_start(int threads);

#endif
