/* SPDX-License-Identifier: MIT
 *
 * cattaneo help [COMMAND], --help, and the manual page: three ways to print the same tables.
 */
#include <stdarg.h>
#include <string.h>

#include "app/command.h"
#include "base/version.h"

enum { WIDTH = 80, COLUMN = 24 };

static const char purpose[] =
    "Cattaneo-Fourier diffusion: heat and matter that spread at a finite speed. A scene file says what "
    "happens; "
    "the program runs it and writes pictures and data.";

static const struct {
  int code;
  const char *meaning;
} exit_codes[] = {
    {0, "done"},
    {1, "failure: a file, a disk"},
    {2, "the command line or the scene has an error"},
    {3, "the solver did not converge (with solver.on_stall: stop)"},
    {4, "a value stopped being finite"},
    {5, "a limit of memory or of the machine was reached"},
    {130, "interrupted, with a checkpoint to resume from"},
};
enum { EXIT_CODES = sizeof exit_codes / sizeof exit_codes[0] };

/* --- plain text ------------------------------------------------------------------------------------------- */

/* Words of `text` up to its end or a newline, in lines that start with `indent` blanks; the first stands at
 * `column` already. */
static void print_wrapped(FILE *out, const char *text, const int indent, int column) {
  while (*text != '\0' && *text != '\n') {
    const size_t length = strcspn(text, " \n");
    if (column > indent && column + (int)length + 1 > WIDTH) {
      fprintf(out, "\n%*s", indent, "");
      column = indent;
    }
    column += fprintf(out, "%s%.*s", column > indent ? " " : "", (int)length, text);
    text += length;
    while (*text == ' ') ++text;
  }
  putc('\n', out);
}

/* "  name   what it means", the meaning in a column. */
static void print_row(FILE *out, const char *name, const char *meaning) {
  const int written = fprintf(out, "  %s", name);
  if (written + 2 > COLUMN)
    fprintf(out, "\n%*s", COLUMN, "");
  else
    fprintf(out, "%*s", COLUMN - written, "");
  print_wrapped(out, meaning, COLUMN, COLUMN);
}

static void option_text(const cf_option *o, char *text, const size_t size) {
  const char *value = o->value != NULL ? o->value : "";
  const char *blank = o->value != NULL ? " " : "";
  if (o->letter != 0)
    snprintf(text, size, "-%c, --%s%s%s", o->letter, o->name, blank, value);
  else
    snprintf(text, size, "--%s%s%s", o->name, blank, value);
}

void cf_help_overview(FILE *out) {
  char name[64];
  fprintf(out, CF_PROGRAM " %s\n\n", cf_version());
  print_wrapped(out, purpose, 0, 0);
  fputs("\nusage: " CF_PROGRAM " COMMAND ...\n\n", out);
  for (const cf_command *c = cf_commands; c->name != NULL; ++c) {
    snprintf(name, sizeof name, "%s %s", c->name, c->operands);
    print_row(out, name, c->summary);
  }
  print_row(out, "--version", "which program this is");
  print_row(out, "--help", "this page");
  fputs("\nexit codes:\n", out);
  for (int i = 0; i < EXIT_CODES; ++i) {
    snprintf(name, sizeof name, "%d", exit_codes[i].code);
    fprintf(out, "  %-5s", name);
    print_wrapped(out, exit_codes[i].meaning, 7, 7);
  }
  putc('\n', out);
  print_wrapped(out,
                "`" CF_PROGRAM " help COMMAND` says what a command takes, `" CF_PROGRAM
                " examples` lists scenes to start from.",
                0, 0);
}

void cf_help_command_page(FILE *out, const cf_command *c) {
  char name[64];
  fprintf(out, "usage: " CF_PROGRAM " %s %s%s\n\n", c->name, c->operands,
          c->options != 0 ? " [OPTIONS]" : "");
  print_wrapped(out, c->summary, 0, 0);
  for (const char *text = c->text; *text != '\0';) {
    putc('\n', out);
    if (*text == ' ')
      fprintf(out, "%.*s\n", (int)strcspn(text, "\n"), text);
    else
      print_wrapped(out, text, 0, 0);
    text += strcspn(text, "\n");
    if (*text == '\n') ++text;
  }
  putc('\n', out);
  for (int i = 0; i < CF_OPTIONS; ++i) {
    if ((c->options >> i & 1) == 0) continue;
    option_text(&cf_option_table[i], name, sizeof name);
    print_row(out, name, cf_option_table[i].doc);
  }
}

/* --- the manual page -------------------------------------------------------------------------------------- */

/* Text up to a newline, with what roff would take for its own guarded. */
static void print_roff(FILE *out, const char *text) {
  if (*text == '.' || *text == '\'') fputs("\\&", out);
  for (; *text != '\0' && *text != '\n'; ++text) {
    if (*text == '\\')
      fputs("\\e", out);
    else if (*text == '-')
      fputs("\\-", out);
    else
      putc(*text, out);
  }
  putc('\n', out);
}

static void print_roff_paragraphs(FILE *out, const char *text) {
  while (*text != '\0') {
    const bool example = *text == ' ';
    fputs(example ? ".IP\n.nf\n" : ".PP\n", out);
    while (*text == ' ') ++text;
    print_roff(out, text);
    if (example) fputs(".fi\n", out);
    text += strcspn(text, "\n");
    if (*text == '\n') ++text;
  }
}

static void print_roff_row(FILE *out, const char *name, const char *meaning) {
  fputs(".TP\n.B ", out);
  print_roff(out, name);
  print_roff(out, meaning);
}

static void print_roff_command(FILE *out, const cf_command *c) {
  char name[64];
  fprintf(out, ".SS %s %s\n", c->name, c->operands);
  print_roff(out, c->summary);
  print_roff_paragraphs(out, c->text);
  for (int i = 0; i < CF_OPTIONS; ++i) {
    if ((c->options >> i & 1) == 0 || i == CF_OPTION_HELP) continue;
    option_text(&cf_option_table[i], name, sizeof name);
    print_roff_row(out, name, cf_option_table[i].doc);
  }
}

void cf_help_manual(FILE *out) {
  char code[16];
  fprintf(out, ".\\\" SPDX-License-Identifier: MIT\n.TH CATTANEO 1 \"\" \"cattaneo %s\"\n", cf_version());
  fputs(".SH NAME\ncattaneo, cattaneof \\- Cattaneo\\-Fourier diffusion in double and in single precision\n",
        out);
  fputs(".SH SYNOPSIS\n.B cattaneo\n.I COMMAND\n[OPTIONS] ...\n.SH DESCRIPTION\n", out);
  print_roff(out, purpose);
  fputs(".SH COMMANDS\n", out);
  for (const cf_command *c = cf_commands; c->name != NULL; ++c) print_roff_command(out, c);
  fputs(".SH EXIT STATUS\n", out);
  for (int i = 0; i < EXIT_CODES; ++i) {
    snprintf(code, sizeof code, "%d", exit_codes[i].code);
    print_roff_row(out, code, exit_codes[i].meaning);
  }
}

cf_status cf_help_command(cf_arguments *a) {
  if (a->manual) {
    cf_help_manual(stdout);
  } else if (a->operands == 0) {
    cf_help_overview(stdout);
  } else {
    const cf_command *c = cf_command_find(a->operand[0]);
    if (c == NULL) return cf_command_unknown(a->operand[0]);
    cf_help_command_page(stdout, c);
  }
  return CF_OK;
}
