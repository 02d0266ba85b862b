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

/* The path of the file that runs here, whatever it is called. */
static bool find_self(char path[PATH_MAX]) {
  const ssize_t length = readlink("/proc/self/exe", path, PATH_MAX - 1);
  if (length <= 0) return false;
  path[length] = '\0';
  return true;
}

static void become(const char *path, char **argv) {
  fflush(NULL);
  execv(path, argv);
}

cf_status cf_relaunch_sister(char **argv) {
  static const char name[] = CF_SISTER;
  char path[PATH_MAX];
  if (!find_self(path))
    return cf_fail(CF_FAILED, "the place of this program is not known: run %s itself", name);
  char *last = strrchr(path, '/') + 1;
  if ((size_t)(last - path) + sizeof name > sizeof path)
    return cf_fail(CF_FAILED, "the path of this program is too long: run %s itself", name);
  memcpy(last, name, sizeof name);
  become(path, argv);
  return cf_fail(CF_FAILED, "%.600s cannot be run: %s", path, strerror(errno));
}

void cf_relaunch_politely(char **argv) {
  char path[PATH_MAX];
  if (getenv("OMP_WAIT_POLICY") != NULL || getenv("GOMP_SPINCOUNT") != NULL) return;
  if (find_self(path) && setenv("GOMP_SPINCOUNT", TURNS, 1) == 0) become(path, argv);
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
  FILE *file = cf_file_stream(path.text);
  if (file == NULL) return CF_OK;
  const bool sister = made_by_sister(file);
  fclose(file);
  return sister ? cf_relaunch_sister(argv) : CF_OK;
}
