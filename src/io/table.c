/* SPDX-License-Identifier: MIT */
#define _GNU_SOURCE
#include "io/table.h"

#include <errno.h>
#include <fcntl.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/mem.h"
#include "base/real.h"
#include "io/folder.h"

#define NUMBER_ROOM 26 /* "-1.2345678901234567e-308,": a number and its comma */

struct cf_table {
  cf_path path;
  int columns, file;
  off_t end;   /* of the last whole row */
  char *line;  /* room for a row */
  char *names; /* the first line, with its newline */
};

static cf_status join_names(char **joined, const int columns, const char *const *names) {
  size_t size = 1;
  if (columns < 1) return cf_fail(CF_BAD_ARGUMENT, "a table of %d columns: must have at least one", columns);
  for (int c = 0; c < columns; ++c) {
    if (names[c][0] == '\0' || strpbrk(names[c], ",\"\r\n") != NULL)
      return cf_fail(CF_BAD_ARGUMENT,
                     "a column named \"%s\": must not be empty or have a comma, a quote or a line break",
                     names[c]);
    size += strlen(names[c]) + 1;
  }
  CF_TRY(CF_NEW(joined, size));
  char *at = *joined;
  for (int c = 0; c < columns; ++c) at += sprintf(at, "%s%c", names[c], c + 1 < columns ? ',' : '\n');
  return CF_OK;
}

void cf_table_close(cf_table *t) {
  if (t == NULL) return;
  if (t->file >= 0) close(t->file);
  cf_free(t->line);
  cf_free(t->names);
  cf_free(t);
}

static cf_status make_table(cf_table **t, const char *path, const int columns, const char *const *names) {
  cf_table *fresh;
  CF_TRY(CF_NEW(&fresh, 1));
  fresh->file = -1;
  fresh->columns = columns;
  cf_status s = cf_path_make(&fresh->path, "%s", path);
  if (s == CF_OK) s = join_names(&fresh->names, columns, names);
  if (s == CF_OK) s = CF_NEW(&fresh->line, NUMBER_ROOM * (size_t)columns + 2);
  if (s != CF_OK) {
    cf_table_close(fresh);
    return s;
  }
  *t = fresh;
  return CF_OK;
}

static cf_status cannot_write(const cf_table *t) {
  return cf_fail(CF_CANNOT_WRITE, "%s: cannot be written: %s", t->path.text, strerror(errno));
}

/* One write; what a full disk leaves of it is taken back. */
static cf_status append(cf_table *t, const char *text, const size_t length) {
  ssize_t done;
  do done = write(t->file, text, length);
  while (done < 0 && errno == EINTR);
  if (done == (ssize_t)length) {
    t->end += done;
    return CF_OK;
  }
  if (done >= 0) errno = ENOSPC;
  const cf_status s = cannot_write(t);
  if (ftruncate(t->file, t->end) != 0) return s; /* a half line stays; resume cuts it */
  return s;
}

static cf_status open_table(cf_table *t, const int flags) {
  t->file = open(t->path.text, O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC | flags, 0666);
  return t->file < 0 ? cannot_write(t) : CF_OK;
}

cf_status cf_table_create(cf_table **t, const char *path, const int columns, const char *const *names) {
  cf_table *fresh;
  *t = NULL;
  CF_TRY(make_table(&fresh, path, columns, names));
  cf_status s = open_table(fresh, O_TRUNC);
  if (s == CF_OK) s = append(fresh, fresh->names, strlen(fresh->names));
  if (s != CF_OK) {
    cf_table_close(fresh);
    return s;
  }
  *t = fresh;
  return CF_OK;
}

/* Whether `line` (zero-terminated) is a whole row; its first number is the step. */
static bool is_row(const char *line, const int columns, double *step) {
  for (int c = 0; c < columns; ++c) {
    char *end;
    if (strchr("+-.0123456789in", line[0]) == NULL || line[0] == '\0') return false;
    const double value = strtod(line, &end);
    if (end == line || *end != (c + 1 < columns ? ',' : '\0')) return false;
    if (c == 0) *step = value;
    line = end + 1;
  }
  return true;
}

/* How many bytes of `text` stand: the names, and the rows up to that of step `last`. */
static cf_status find_end(cf_table *t, char *text, const size_t size, const int64_t last, int64_t *found) {
  const size_t head = strlen(t->names);
  if (size < head || memcmp(text, t->names, head) != 0)
    return cf_fail(
        CF_BAD_FILE,
        "%s: has other columns than this run: move it away, and resume begins a new one (expected %.*s, "
        "found %.*s)",
        t->path.text, (int)CF_MIN(head - 1, 200), t->names, (int)CF_MIN(strcspn(text, "\n"), 200), text);
  t->end = (off_t)head;
  for (char *line = text + head; line < text + size;) {
    char *newline = memchr(line, '\n', (size_t)(text + size - line));
    double step = -1;
    if (newline == NULL) break;
    *newline = '\0';
    if (!is_row(line, t->columns, &step) || !(step <= (double)last) || step != floor(step)) break;
    *found = (int64_t)step;
    line = newline + 1;
    t->end = (off_t)(line - text);
  }
  return CF_OK;
}

static cf_status go_on(cf_table *t, const int64_t last, int64_t *found) {
  char *text;
  size_t size;
  if (access(t->path.text, F_OK) != 0) {
    CF_TRY(open_table(t, 0));
    return append(t, t->names, strlen(t->names));
  }
  CF_TRY(cf_file_read(t->path.text, (size_t)1 << 40, &text, &size));
  const cf_status s = find_end(t, text, size, last, found);
  cf_free(text);
  CF_TRY(s);
  CF_TRY(open_table(t, 0));
  return ftruncate(t->file, t->end) == 0 ? CF_OK : cannot_write(t);
}

cf_status cf_table_resume(cf_table **t, const char *path, const int columns, const char *const *names,
                          const int64_t last, int64_t *found) {
  cf_table *fresh;
  int64_t at = -1;
  *t = NULL;
  CF_TRY(make_table(&fresh, path, columns, names));
  const cf_status s = go_on(fresh, last, &at);
  if (found != NULL) *found = at;
  if (s != CF_OK) {
    cf_table_close(fresh);
    return s;
  }
  *t = fresh;
  return CF_OK;
}

cf_status cf_table_row(cf_table *t, const double *values) {
  char *at = t->line;
  for (int c = 0; c < t->columns; ++c)
    at += sprintf(at, "%.17g%c", values[c], c + 1 < t->columns ? ',' : '\n');
  return append(t, t->line, (size_t)(at - t->line));
}

cf_status cf_table_sync(cf_table *t) {
  return fdatasync(t->file) == 0 || errno == EINVAL ? CF_OK : cannot_write(t);
}
