/* SPDX-License-Identifier: MIT */
#define _GNU_SOURCE
#include "app/relaunch.h"

#include <errno.h>
#include <limits.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "app/command.h"
#include "io/folder.h"

/* Turns of the waiting loop before a thread sleeps: some microseconds. */
#define TURNS "1000"

static cf_status become(const char *name, char **argv) {
  char path[PATH_MAX];
  const ssize_t length = readlink("/proc/self/exe", path, sizeof path - 1);
  if (length <= 0) return cf_fail(CF_FAILED, "the place of this program is not known: run %s itself", name);
  path[length] = '\0';
  char *last = strrchr(path, '/') + 1;
  if ((size_t)(last - path) + strlen(name) + 1 > sizeof path)
    return cf_fail(CF_FAILED, "the path of this program is too long: run %s itself", name);
  memcpy(last, name, strlen(name) + 1);
  fflush(NULL);
  execv(path, argv);
  return cf_fail(CF_FAILED, "%.600s cannot be run: %s", path, strerror(errno));
}

cf_status cf_relaunch_sister(char **argv) { return become(CF_SISTER, argv); }

void cf_relaunch_politely(char **argv) {
  if (getenv("OMP_WAIT_POLICY") != NULL || getenv("GOMP_SPINCOUNT") != NULL) return;
  if (setenv("GOMP_SPINCOUNT", TURNS, 1) == 0) (void)become(CF_PROGRAM, argv);
}

/* run.yaml starts with lines of comment; one of them ends with compiler and precision: ", single". */
static bool made_by_sister(FILE *file) {
  const char *sign = sizeof(cf_real) == sizeof(float) ? ", double\n" : ", single\n";
  const size_t length = strlen(sign);
  char line[512];
  while (fgets(line, sizeof line, file) != NULL && line[0] == '#') {
    const size_t n = strlen(line);
    if (n >= length && strcmp(line + n - length, sign) == 0) return true;
  }
  return false;
}

cf_status cf_relaunch_as_run(char **argv, const char *folder) {
  cf_path path;
  if (cf_path_make(&path, "%s/run.yaml", folder) != CF_OK) return CF_OK; /* opening it will say why */
  FILE *file = fopen(path.text, "r");
  if (file == NULL) return CF_OK;
  const bool sister = made_by_sister(file);
  fclose(file);
  return sister ? cf_relaunch_sister(argv) : CF_OK;
}
