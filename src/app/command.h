/* SPDX-License-Identifier: MIT
 *
 * The commands of the program, one file each, and the table from which main, --help, `help COMMAND` and the
 * manual page come.
 */
#ifndef CF_APP_COMMAND_H
#define CF_APP_COMMAND_H

#include <stdio.h>

#include "app/options.h"
#include "base/real.h"

#ifdef CF_SINGLE
#define CF_PROGRAM "cattaneof"
#define CF_SISTER  "cattaneo"
#else
#define CF_PROGRAM "cattaneo"
#define CF_SISTER  "cattaneof"
#endif

typedef struct cf_command {
  const char *name;
  const char *operands; /* as a line of help shows them: "SCENE.yaml", "[KEY]" */
  int least, most;      /* operands */
  unsigned options;     /* bits 1 << CF_OPTION_... */
  const char *summary;  /* a line */
  const char *text;     /* paragraphs; a line that starts with two blanks is an example */
  cf_status (*run)(cf_arguments *a);
} cf_command;

/* Ends with a row without a name. */
extern const cf_command cf_commands[];

/* NULL: there is none. */
const cf_command *cf_command_find(const char *name);

cf_status cf_run_command(cf_arguments *a);
cf_status cf_resume_command(cf_arguments *a);
cf_status cf_check_command(cf_arguments *a);
cf_status cf_explain_command(cf_arguments *a);
cf_status cf_examples_command(cf_arguments *a);
cf_status cf_info_command(cf_arguments *a);
cf_status cf_sweep_command(cf_arguments *a);
cf_status cf_sheet_command(cf_arguments *a);
cf_status cf_bench_command(cf_arguments *a);
cf_status cf_render_command(cf_arguments *a);
cf_status cf_movie_command(cf_arguments *a);
cf_status cf_atlas_command(cf_arguments *a);
cf_status cf_help_command(cf_arguments *a);

/* CF_BAD_USAGE, with the command that may have been meant. */
cf_status cf_command_unknown(const char *name);

/* --- pages (app/help.c) ------------------------------------------------------------------------------- */

void cf_help_overview(FILE *out);
void cf_help_command_page(FILE *out, const cf_command *c);
void cf_help_manual(FILE *out);

#endif
