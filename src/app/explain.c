/* SPDX-License-Identifier: MIT
 *
 * cattaneo explain [KEY]
 */
#include "app/command.h"
#include "base/mem.h"
#include "model/scene.h"

cf_status cf_explain_command(cf_arguments *a) {
  char *text = NULL;
  CF_TRY(cf_scene_explain(a->operands > 0 ? a->operand[0] : NULL, &text));
  fputs(text, stdout);
  cf_free(text);
  return CF_OK;
}
