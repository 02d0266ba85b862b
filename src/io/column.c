/* SPDX-License-Identifier: MIT */
#include "io/column.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "io/folder.h"

#define BYTES_MOST ((size_t)1 << 32)

/* Which cell of the first line holds the name; -1: none. */
static int find(const char *line, const size_t length, const char *name) {
  const size_t wanted = strlen(name);
  int column = 0;
  for (const char *at = line; at <= line + length; ++column) {
    const size_t cell = strcspn(at, ",\n");
    if (cell == wanted && strncmp(at, name, cell) == 0) return column;
    at += cell + 1;
  }
  return -1;
}

static double cell_of(const char *line, int column) {
  for (; column > 0; --column) {
    line += strcspn(line, ",\n");
    if (*line != ',') return (double)NAN;
    ++line;
  }
  char *end;
  const double value = strtod(line, &end);
  return end == line || (*end != ',' && *end != '\n') ? (double)NAN : value;
}

static cf_status read_text(const char *path, const char *text, const char *name, int64_t *count,
                           double **values) {
  const size_t head = strcspn(text, "\n");
  const int column = find(text, head, name);
  if (column < 0)
    return cf_fail(CF_BAD_FILE, "%s: has no column \"%s\"; it has: %.*s", path, name,
                   (int)(head < 600 ? head : 600), text);
  int64_t lines = 0;
  for (const char *at = text; (at = strchr(at, '\n')) != NULL; ++at) ++lines;
  CF_TRY(CF_NEW(values, lines > 1 ? lines : 1));
  const char *line = strchr(text, '\n');
  for (*count = 0; line != NULL && strchr(line + 1, '\n') != NULL; line = strchr(line + 1, '\n'))
    (*values)[(*count)++] = cell_of(line + 1, column);
  return CF_OK;
}

cf_status cf_column_read(const char *path, const char *name, int64_t *count, double **values) {
  char *text;
  size_t size;
  *values = NULL;
  *count = 0;
  CF_TRY(cf_file_read(path, BYTES_MOST, &text, &size));
  const cf_status s = read_text(path, text, name, count, values);
  cf_free(text);
  return s;
}
