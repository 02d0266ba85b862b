/* SPDX-License-Identifier: MIT */
#include "io/series.h"

#include <inttypes.h>
#include <stdbool.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "base/mem.h"
#include "io/folder.h"

#define NAME_ROOM    128
#define LINE_ROOM    (2 * NAME_ROOM)
#define SERIES_BYTES ((size_t)1 << 30)

static const char head[] = "{\n  \"file-series-version\": \"1.0\",\n  \"files\": [\n";
static const char foot[] = "\n  ]\n}\n";

static int write_line(char *line, const char *word, const int64_t frame, const double time) {
  return snprintf(line, LINE_ROOM, "    {\"name\": \"%s_%06" PRId64 ".vtkhdf\", \"time\": %.17g}", word,
                  frame, time);
}

/* A line of ours; anything else is passed over. */
static bool read_line(const char *line, const char *word, int64_t *frame, double *time) {
  char name[NAME_ROOM + 32];
  const size_t length = strlen(word);
  if (sscanf(line, " {\"name\": \"%159[^\"]\", \"time\": %lf", name, time) != 2) return false;
  return strncmp(name, word, length) == 0 && sscanf(name + length, "_%" SCNd64 ".vtkhdf", frame) == 1;
}

/* Copies the lines of frames up to `last` behind the head; returns the end. */
static char *keep_lines(char *out, const char *old, const char *word, const int64_t last) {
  bool first = true;
  memcpy(out, head, sizeof head - 1);
  out += sizeof head - 1;
  for (const char *line = old; line != NULL && *line != '\0';) {
    int64_t frame;
    double time;
    if (read_line(line, word, &frame, &time) && frame <= last) {
      if (!first) out += sprintf(out, ",\n");
      out += write_line(out, word, frame, time);
      first = false;
    }
    line = strchr(line, '\n');
    if (line != NULL) ++line;
  }
  return out;
}

/* Writes the series with the lines up to `last`, and one more if `extra` is not NULL. */
static cf_status rewrite(const char *folder, const char *word, const int64_t last, const char *extra) {
  cf_path path;
  char *old = NULL, *fresh;
  size_t size = 0, lines = 2;
  if (strlen(word) >= NAME_ROOM) return cf_fail(CF_BAD_ARGUMENT, "the name %s is too long for a file", word);
  CF_TRY(cf_path_make(&path, "%s/%s.vtkhdf.series", folder, word));
  if (access(path.text, F_OK) == 0) CF_TRY(cf_file_read(path.text, SERIES_BYTES, &old, &size));
  for (size_t i = 0; i < size; ++i) lines += old[i] == '\n';
  cf_status s = CF_NEW(&fresh, sizeof head + lines * LINE_ROOM + sizeof foot);
  if (s == CF_OK) {
    char *end = keep_lines(fresh, old, word, last);
    const bool none = (size_t)(end - fresh) == sizeof head - 1;
    if (extra != NULL) end += sprintf(end, "%s%s", none ? "" : ",\n", extra);
    end += sprintf(end, "%s", foot);
    s = cf_file_write(path.text, fresh, (size_t)(end - fresh));
    cf_free(fresh);
  }
  cf_free(old);
  return s;
}

cf_status cf_series_add(const char *folder, const char *word, const int64_t frame, const double time) {
  char line[LINE_ROOM];
  write_line(line, word, frame, time);
  return rewrite(folder, word, frame - 1, line);
}

cf_status cf_series_cut(const char *folder, const char *word, const int64_t last) {
  cf_path path;
  CF_TRY(cf_path_make(&path, "%s/%s.vtkhdf.series", folder, word));
  return access(path.text, F_OK) == 0 ? rewrite(folder, word, last, NULL) : CF_OK;
}
