/* SPDX-License-Identifier: MIT
 *
 * cattaneo check SCENE.yaml
 */
#include "session/check.h"

#include "app/command.h"
#include "base/mem.h"

cf_status cf_check_command(cf_arguments *a) {
  cf_scene *scene = NULL;
  char *text = NULL;
  CF_TRY(cf_scene_read(&scene, a->operand[0], a->sets, a->set));
  const cf_status status = cf_check_text(scene, &text);
  if (status == CF_OK) fputs(text, stdout);
  cf_free(text);
  cf_scene_destroy(scene);
  return status;
}
