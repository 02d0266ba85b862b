/* SPDX-License-Identifier: MIT
 *
 * Reads the reference tables in tests/reference: comment lines with #, one header line, then numbers (an empty
 * or non-numeric entry is NaN; text columns are compared with cf_table_is).
 */
#ifndef CF_TESTS_REFERENCE_H
#define CF_TESTS_REFERENCE_H

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define TABLE_COLUMNS 24

typedef struct table {
  int rows, columns;
  char name[TABLE_COLUMNS][48];
  char (*text)[TABLE_COLUMNS][32];
} table;

static inline int table_split(char *line, char out[][48], const size_t width) {
  int n = 0;
  line[strcspn(line, "\r\n")] = '\0';
  for (char *at = line; at != NULL && n < TABLE_COLUMNS; ++n) {
    char *comma = strchr(at, ',');
    if (comma != NULL) *comma = '\0';
    snprintf(out[n], width, "%.*s", (int)width - 1, at);
    at = comma != NULL ? comma + 1 : NULL;
  }
  return n;
}

static inline table table_read(const char *name) {
  char path[512], line[4096];
  table t = {0};
  snprintf(path, sizeof path, "%s/tests/reference/%s", CF_SOURCE_DIR, name);
  FILE *f = fopen(path, "r");
  if (f == NULL) {
    fprintf(stderr, "no reference table %s\n", path);
    exit(1);
  }
  int room = 0;
  while (fgets(line, sizeof line, f) != NULL) {
    if (line[0] == '#') continue;
    char entry[TABLE_COLUMNS][48] = {{0}};
    const int n = table_split(line, entry, 48);
    if (t.columns == 0) {
      t.columns = n;
      memcpy(t.name, entry, sizeof entry);
      continue;
    }
    if (t.rows == room) {
      room = room == 0 ? 256 : 2 * room;
      t.text = realloc(t.text, (size_t)room * sizeof *t.text);
      if (t.text == NULL) exit(1);
    }
    for (int c = 0; c < TABLE_COLUMNS; ++c) snprintf(t.text[t.rows][c], 32, "%.31s", entry[c]);
    ++t.rows;
  }
  fclose(f);
  return t;
}

static inline int table_column(const table *t, const char *name) {
  for (int c = 0; c < t->columns; ++c)
    if (strcmp(t->name[c], name) == 0) return c;
  fprintf(stderr, "no column %s\n", name);
  exit(1);
}

static inline double table_at(const table *t, const int row, const char *name) {
  const char *text = t->text[row][table_column(t, name)];
  char *end;
  const double v = strtod(text, &end);
  return end == text ? NAN : v;
}

static inline int table_is(const table *t, const int row, const char *name, const char *word) {
  return strcmp(t->text[row][table_column(t, name)], word) == 0;
}

static inline void table_free(table *t) {
  free(t->text);
  t->text = NULL;
}

#endif
