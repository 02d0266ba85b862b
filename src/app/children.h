/* SPDX-License-Identifier: MIT
 *
 * Runs in processes of their own: this program, started again for each, some at a time. A child dies with its
 * parent. Ctrl-C stops them all with a checkpoint.
 */
#ifndef CF_APP_CHILDREN_H
#define CF_APP_CHILDREN_H

#include <stdbool.h>
#include <stdio.h>

#include "base/status.h"

typedef struct cf_child {
  char **argv;  /* of the program, argv[0] included; NULL at its end */
  int code;     /* exit code (that of a stopped run, if SIGTERM ended it); 128 + another signal; -1 before */
  long process; /* while it runs */
  FILE *said;   /* what it says on stderr; shown if it fails */
} cf_child;

typedef struct cf_children {
  int count, jobs;
  cf_child *child;
  void (*ended)(void *context, int child); /* called for each as it ends */
  void *context;
} cf_children;

/* Runs them all, in their order, `jobs` at a time. CF_STOPPED: interrupted; those that were running have ended
 * with a checkpoint, or not at all. CF_FAILED: a process cannot be made. */
cf_status cf_children_run(cf_children *c);

#endif
