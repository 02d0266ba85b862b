/* SPDX-License-Identifier: MIT
 *
 * Folders of a test: made fresh, compared byte by byte.
 */
#ifndef CF_TESTS_FOLDERS_H
#define CF_TESTS_FOLDERS_H

#include <dirent.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "base/real.h"
#include "testing.h"

/* An empty folder below the build, the same for every run of the test. */
static inline const char *folder_fresh(const char *name) {
  static char path[8][512];
  static int next;
  char *p = path[next++ % 8], command[1200];
  /* One for each precision: both tests may run at once. */
  snprintf(p, 512, "%s/scratch/%s/%s", CF_BINARY_DIR, CF_PRECISION, name);
  snprintf(command, sizeof command, "rm -rf '%s' && mkdir -p '%s'", p, p);
  assert_int_equal(system(command), 0);
  return p;
}

static inline void file_write(const char *folder, const char *name, const char *text) {
  char path[2048];
  snprintf(path, sizeof path, "%s/%s", folder, name);
  FILE *f = fopen(path, "w");
  assert_non_null(f);
  fputs(text, f);
  fclose(f);
}

static inline long file_size(const char *folder, const char *name) {
  char path[2048];
  struct stat s;
  snprintf(path, sizeof path, "%s/%s", folder, name);
  return stat(path, &s) == 0 ? (long)s.st_size : -1;
}

static inline int files_equal(const char *a, const char *b, const char *name) {
  char path[2][2048];
  snprintf(path[0], sizeof path[0], "%s/%s", a, name);
  snprintf(path[1], sizeof path[1], "%s/%s", b, name);
  FILE *f = fopen(path[0], "rb"), *g = fopen(path[1], "rb");
  int same = f != NULL && g != NULL, x = 0;
  while (same && x != EOF) {
    x = fgetc(f);
    same = x == fgetc(g);
  }
  if (f != NULL) fclose(f);
  if (g != NULL) fclose(g);
  return same;
}

/* Every file of `a` whose name starts with one of the words stands in `b` with the same bytes; returns how many. */
static inline int folders_compare(const char *a, const char *b, const char *const *words) {
  int count = 0;
  DIR *d = opendir(a);
  assert_non_null(d);
  for (struct dirent *e = readdir(d); e != NULL; e = readdir(d))
    for (int w = 0; words[w] != NULL; ++w)
      if (strncmp(e->d_name, words[w], strlen(words[w])) == 0) {
        if (!files_equal(a, b, e->d_name)) fail_msg("%s differs between %s and %s", e->d_name, a, b);
        ++count;
      }
  closedir(d);
  return count;
}

#endif
