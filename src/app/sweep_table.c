/* SPDX-License-Identifier: MIT */
#include "app/sweep_table.h"

#include <stdio.h>
#include <string.h>

#include "base/mem.h"
#include "io/folder.h"
#include "io/scene_text.h"

enum { LINE = 16384 };

/* The first and the last whole line of a file; false: it has no two of them. */
static bool ends_of(const char *path, char *first, char *last) {
  FILE *f = cf_file_stream(path);
  int lines = 0;
  if (f == NULL) return false;
  char line[LINE];
  while (fgets(line, sizeof line, f) != NULL) {
    const size_t length = strcspn(line, "\n");
    if (line[length] != '\n') break; /* cut short, or too long to be one of ours */
    line[length] = '\0';
    memcpy(lines++ == 0 ? first : last, line, length + 1);
  }
  fclose(f);
  return lines >= 2;
}

static bool metrics_of(const cf_path *folder, char *names, char *values) {
  cf_path path;
  return cf_path_make(&path, "%s/metrics.csv", folder->text) == CF_OK && ends_of(path.text, names, values);
}

/* The i-th entry of a line, its length in *length; NULL: it has not so many. */
static const char *entry_of(const char *line, int i, size_t *length) {
  for (; i > 0; --i) {
    line += strcspn(line, ",");
    if (*line == '\0') return NULL;
    ++line;
  }
  *length = strcspn(line, ",");
  return line;
}

/* The value under the column `name` (of `length` bytes). */
static const char *value_of(const char *names, const char *values, const char *name, const size_t length,
                            size_t *found) {
  size_t n;
  const char *at;
  for (int i = 0; (at = entry_of(names, i, &n)) != NULL; ++i)
    if (n == length && memcmp(at, name, n) == 0) return entry_of(values, i, found);
  return NULL;
}

/* As CSV has it: in quotes where it must be. */
static void add_entry(cf_writing *out, const char *text) {
  if (text[strcspn(text, ",\"\n")] == '\0') {
    cf_writing_add(out, "%s", text);
    return;
  }
  cf_writing_add(out, "\"");
  for (; *text != '\0'; ++text) cf_writing_add(out, *text == '"' ? "\"\"" : "%c", *text);
  cf_writing_add(out, "\"");
}

static void add_metrics(cf_writing *out, const char *columns, const cf_path *folder) {
  char names[LINE], values[LINE];
  const bool has = metrics_of(folder, names, values);
  size_t length, n;
  const char *name;
  for (int i = 0; (name = entry_of(columns, i, &length)) != NULL; ++i) {
    const char *value = has ? value_of(names, values, name, length, &n) : NULL;
    cf_writing_add(out, ",");
    if (value != NULL) cf_writing_add(out, "%.*s", (int)n, value);
  }
}

cf_status cf_sweep_table_write(const cf_combinations *runs, const cf_path *folder, const cf_child *child,
                               const char *file) {
  cf_writing out = {0};
  char columns[LINE] = "", values[LINE];
  for (int i = 0; i < runs->count && columns[0] == '\0'; ++i)
    if (!metrics_of(&folder[i], columns, values)) columns[0] = '\0';
  cf_writing_add(&out, "run");
  for (int a = 0; a < runs->axes; ++a) {
    cf_writing_add(&out, ",");
    add_entry(&out, runs->axis[a].key);
  }
  cf_writing_add(&out, ",exit_code%s%s\n", columns[0] != '\0' ? "," : "", columns);
  for (int i = 0; i < runs->count; ++i) {
    add_entry(&out, runs->item[i].name);
    for (int a = 0; a < runs->axes; ++a) {
      cf_writing_add(&out, ",");
      add_entry(&out, runs->item[i].value[a]);
    }
    cf_writing_add(&out, ",");
    if (child[i].code >= 0) cf_writing_add(&out, "%d", child[i].code);
    if (columns[0] != '\0') add_metrics(&out, columns, &folder[i]);
    cf_writing_add(&out, "\n");
  }
  char *text;
  CF_TRY(cf_writing_end(&out, &text));
  const cf_status status = cf_file_write(file, text, strlen(text));
  cf_free(text);
  return status;
}
