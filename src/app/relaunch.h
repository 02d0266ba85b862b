/* SPDX-License-Identifier: MIT
 *
 * Starting this program again in its own place, because something must be settled before main: which of the
 * two precisions it is, and how its threads wait for each other.
 */
#ifndef CF_APP_RELAUNCH_H
#define CF_APP_RELAUNCH_H

#include "base/status.h"

/* Becomes the program of the other precision, which stands beside this one, with the same arguments. Returns only on
 * failure. */
cf_status cf_relaunch_sister(char **argv);

/* As above if the run in `folder` was made by the other program, which alone can read its checkpoints; CF_OK if
 * it was not, or if there is no telling. */
cf_status cf_relaunch_as_run(char **argv, const char *folder);

/* Threads of OpenMP wait for each other in a busy loop. Where other programs want the processors too that takes
 * several times as long as it saves, so this program (the same file, under
 * whatever name) has them sleep soon, unless the environment says how they
 * wait (OMP_WAIT_POLICY, GOMP_SPINCOUNT). Goes on as it is if it cannot start again. */
void cf_relaunch_politely(char **argv);

#endif
