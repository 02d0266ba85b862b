/* SPDX-License-Identifier: MIT
 *
 * What `run` and `resume` share once the session is open.
 */
#ifndef CF_APP_DRIVE_H
#define CF_APP_DRIVE_H

#include "app/tell.h"

/* Options of the session that come from the command line; `teller` gets the progress. */
cf_session_options cf_drive_options(const cf_arguments *a, cf_teller *teller);

/* Runs the session, says how it ended, and puts the folder's name on stdout. `opened` is how opening it went;
 * closes the session. */
cf_status cf_drive(cf_arguments *a, cf_teller *teller, cf_session *s, cf_status opened);

#endif
