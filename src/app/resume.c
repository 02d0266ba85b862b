/* SPDX-License-Identifier: MIT
 *
 * cattaneo resume DIR
 */
#include "app/command.h"
#include "app/drive.h"
#include "app/relaunch.h"
#include "app/stop.h"

cf_status cf_resume_command(cf_arguments *a) {
  CF_TRY(cf_relaunch_as_run(a->argv, a->operand[0]));
  cf_relaunch_politely(a->argv);
  cf_teller teller = cf_teller_begin(a->progress);
  const cf_session_options o = cf_drive_options(a, &teller);
  cf_session *s = NULL;
  cf_stop_watch();
  const cf_status opened = cf_session_resume(&s, a->operand[0], &o);
  return cf_drive(a, &teller, s, opened);
}
