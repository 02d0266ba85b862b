/* SPDX-License-Identifier: MIT
 *
 * The program: finds the command, reads its options, runs it, and says what went wrong. Results go to stdout,
 * everything else to stderr; exit codes are those of base/status.h.
 */
#include <fcntl.h>
#include <signal.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "app/command.h"
#include "app/tell.h"
#include "base/version.h"

static int usage_failure(const char *command) {
  cf_tell_failure(CF_BAD_USAGE);
  fprintf(stderr, "try: " CF_PROGRAM " help%s%s\n", command != NULL ? " " : "",
          command != NULL ? command : "");
  return cf_status_exit_code(CF_BAD_USAGE);
}

static cf_status check_operands(const cf_command *c, const cf_arguments *a) {
  if (a->operands < c->least) return cf_fail(CF_BAD_USAGE, "%s: %s is missing", c->name, c->operands);
  if (a->operands > c->most)
    return cf_fail(CF_BAD_USAGE, "%s: %.256s is one operand too many: it takes %s", c->name,
                   a->operand[c->most], c->operands);
  return CF_OK;
}

/* A result that did not reach its place (a full disk) is a failure. */
static cf_status close_results(void) {
  const bool failed = ferror(stdout) != 0;
  if (fflush(stdout) != 0 || failed)
    return cf_fail(CF_CANNOT_WRITE, "the output could not be written: is the disk full that it goes to?");
  return CF_OK;
}

/* The exit code; says why the program failed, unless that has been told. */
static int finish(cf_status status, const bool told) {
  if (status == CF_OK) status = close_results();
  if (status != CF_OK && !told) cf_tell_failure(status);
  return cf_status_exit_code(status);
}

static int command_main(const cf_command *c, const int argc, char **argv) {
  cf_arguments a;
  cf_status status = cf_arguments_read(&a, argc - 1, argv + 1, c->options);
  if (status != CF_OK) return status == CF_BAD_USAGE ? usage_failure(c->name) : finish(status, false);
  a.argv = argv;
  if (a.help) {
    cf_help_command_page(stdout, c);
  } else {
    status = check_operands(c, &a);
    if (status != CF_OK) {
      cf_arguments_clear(&a);
      return usage_failure(c->name);
    }
    status = c->run(&a);
  }
  const bool told = a.told;
  cf_arguments_clear(&a);
  return finish(status, told);
}

/* A stream that whoever started the program has closed would lend its number to the next file that is opened, and what is
 * meant for a terminal would be written there. A limit on the size of files is told like a full disk. */
static void settle(void) {
  int file;
  do file = open("/dev/null", O_RDONLY);
  while (file >= 0 && file <= STDERR_FILENO);
  if (file > STDERR_FILENO) close(file);
  signal(SIGXFSZ, SIG_IGN);
}

int main(const int argc, char **argv) {
  settle();
  if (argc < 2) {
    cf_help_overview(stderr);
    return cf_status_exit_code(CF_BAD_USAGE);
  }
  const char *word = argv[1];
  const cf_command *c = cf_command_find(word);
  if (c != NULL) return command_main(c, argc, argv);
  cf_status status = CF_OK;
  if (strcmp(word, "--version") == 0 || strcmp(word, "-V") == 0)
    printf(CF_PROGRAM " %s (%s; %s)\n", cf_version(), cf_git_hash(), cf_build());
  else if (strcmp(word, "--help") == 0 || strcmp(word, "-h") == 0)
    cf_help_overview(stdout);
  else if (word[0] == '-' && word[1] != '\0')
    status = cf_fail(CF_BAD_USAGE,
                     "there is no option %.64s before a command: those are --version and --help", word);
  else
    status = cf_command_unknown(word);
  return status != CF_OK ? usage_failure(NULL) : finish(CF_OK, false);
}
