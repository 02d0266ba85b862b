/* SPDX-License-Identifier: MIT
 *
 * cattaneo run SCENE.yaml
 */
#include "app/command.h"
#include "app/drive.h"
#include "app/relaunch.h"
#include "app/stop.h"

cf_status cf_run_command(cf_arguments *a) {
  if (a->other) return cf_relaunch_sister(a->argv);
  cf_relaunch_politely(a->argv);
  cf_teller teller = cf_teller_begin(a->progress);
  const cf_session_options o = cf_drive_options(a, &teller);
  cf_session *s = NULL;
  cf_stop_watch();
  const cf_status opened = cf_session_start(&s, a->operand[0], a->sets, a->set, &o);
  return cf_drive(a, &teller, s, opened);
}
