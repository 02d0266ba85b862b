/* SPDX-License-Identifier: MIT
 *
 * Ctrl-C and its kin: a first INT, TERM or HUP asks for an end after the present step, a second one of the same
 * kind ends the program at once. A closed pipe is no reason to lose a run.
 */
#ifndef CF_APP_STOP_H
#define CF_APP_STOP_H

#include <stdbool.h>

/* Watches from now on. A signal that the caller of the program ignores (nohup) stays ignored. */
void cf_stop_watch(void);

bool cf_stop_asked(void);

#endif
