/* SPDX-License-Identifier: MIT
 *
 * cattaneo info FILE|DIR
 */
#include "io/info.h"

#include "app/command.h"
#include "base/mem.h"

cf_status cf_info_command(cf_arguments *a) {
  char *text = NULL;
  CF_TRY(cf_info_text(a->operand[0], &text));
  fputs(text, stdout);
  cf_free(text);
  return CF_OK;
}
