/* SPDX-License-Identifier: MIT
 *
 * The message of a scene error:
 *
 *     ink.yaml:18:6: error: diffusion.k has unit m/s, expected m^2/s
 *       k: 1e-3 m/s
 *          ^~~~~~~~
 *     try: cattaneo explain diffusion.k
 *
 * Columns are counted in characters from 1. A long line is shown in part, around the place. An error in an
 * override has `--set` for file, line and column, and shows the override as it was written.
 */
#include <stdio.h>
#include <string.h>

#include "base/real.h"
#include "io/scene_tree.h"

enum { LINE_SHOWN = 100, UNDERLINE_MAX = 60, PATH_SHOWN = 200, SENTENCE_SHOWN = 420 };

/* A line of a source and what is to be underlined in it, in bytes from its start. */
typedef struct cf_line {
  const char *text;
  size_t length, from, to;
  int number; /* from 1 */
} cf_line;

static bool continues(const char c) { return ((unsigned char)c & 0xC0u) == 0x80u; }

static int characters(const char *text, const size_t length) {
  int n = 0;
  for (size_t i = 0; i < length; ++i) n += continues(text[i]) ? 0 : 1;
  return n;
}

static cf_line line_of(const cf_config_source *source, const cf_place place) {
  size_t at = CF_MIN(place.at, source->length);
  /* An error at the end of the file belongs to the last line that has something on it. */
  while (at > 0 && at == source->length && strchr(" \n\r", source->text[at - 1]) != NULL &&
         strspn(source->text + at, " \n\r") == source->length - at) {
    do --at;
    while (at > 0 && strchr(" \n\r", source->text[at - 1]) != NULL);
    break;
  }
  cf_line line = {.text = source->text, .number = 1};
  for (size_t i = 0; i < at; ++i)
    if (source->text[i] == '\n') {
      line.text = source->text + i + 1;
      ++line.number;
    }
  line.length = strcspn(line.text, "\n\r");
  line.from = CF_MIN((size_t)(source->text + at - line.text), line.length);
  line.to = CF_MIN(line.from + CF_MAX(place.length, 1u), CF_MAX(line.length, line.from + 1));
  return line;
}

/* Cuts a long line down to a window that holds the place. */
static void clip(cf_line *line) {
  if (line->length <= LINE_SHOWN) return;
  size_t start = line->from > LINE_SHOWN / 2 ? line->from - LINE_SHOWN / 2 : 0;
  while (start > 0 && continues(line->text[start])) --start;
  line->text += start;
  line->from -= start;
  line->to -= start;
  line->length = CF_MIN(line->length - start, (size_t)LINE_SHOWN);
  while (line->length > 0 && continues(line->text[line->length])) --line->length;
  line->to = CF_MAX(CF_MIN(line->to, line->length), line->from + 1);
}

/* "  k: 1e-3 m/s\n     ^~~~~~~~\n": blanks under the line keep its tabs. */
static void draw(const cf_line *line, const char *before, char *drawn, const size_t size) {
  char blanks[LINE_SHOWN + 8], marks[UNDERLINE_MAX + 2];
  size_t n = 0;
  for (size_t i = 0; i < line->from && n < sizeof blanks - 1; ++i)
    if (!continues(line->text[i])) blanks[n++] = line->text[i] == '\t' ? '\t' : ' ';
  blanks[n] = '\0';
  const size_t to = CF_MIN(line->to, line->length);
  const int wide = to > line->from ? characters(line->text + line->from, to - line->from) : 1;
  const size_t length = (size_t)CF_MIN(CF_MAX(wide, 1), UNDERLINE_MAX);
  memset(marks, '~', length);
  marks[0] = '^';
  marks[length] = '\0';
  snprintf(drawn, size, "\n%s%.*s\n%*s%s%s", before, (int)line->length, line->text, (int)strlen(before), "",
           blanks, marks);
}

cf_status cf_config_vfail(const cf_config *config, const cf_about about, const char *format, va_list values) {
  char sentence[SENTENCE_SHOWN + 1], drawn[2 * LINE_SHOWN + UNDERLINE_MAX + 220], where[PATH_SHOWN + 40],
      more[120] = "";
  const cf_config_source *source = &config->source[about.place.source];
  const size_t name = strlen(source->name);
  const char *shown = source->name + (name > PATH_SHOWN ? name - PATH_SHOWN : 0);
  vsnprintf(sentence, sizeof sentence, format, values);
  cf_line line = line_of(source, about.place);
  const int column = characters(line.text, line.from) + 1;
  snprintf(where, sizeof where, "%s", shown);
  drawn[0] = '\0';
  if (about.place.length > 0) {
    if (about.place.source == 0) snprintf(where, sizeof where, "%s:%d:%d", shown, line.number, column);
    clip(&line);
    draw(&line, about.place.source == 0 ? "" : "--set ", drawn, sizeof drawn);
  }
  if (about.key != NULL)
    snprintf(more, sizeof more, "\ntry: cattaneo explain%s%.80s", about.key[0] != '\0' ? " " : "", about.key);
  return cf_fail(CF_BAD_SCENE, "%s: error: %s%s%s", where, sentence, drawn, more);
}

cf_status cf_config_fail(const cf_config *config, const cf_about about, const char *format, ...) {
  va_list values;
  va_start(values, format);
  const cf_status status = cf_config_vfail(config, about, format, values);
  va_end(values);
  return status;
}

/* The longest start of `key` that is a row of the tables: "domain.cells" of "domain.cells.1". */
static const char *explained(const cf_config *config, const char *key, char *buffer, const size_t size) {
  snprintf(buffer, size, "%s", key);
  for (;;) {
    const cf_param *param = cf_param_find_path(config->table, buffer);
    char *dot = strrchr(buffer, '.');
    if (param != NULL && (param->table != NULL || dot == NULL || strcmp(dot + 1, param->name) == 0))
      return buffer;
    if (dot == NULL) return NULL;
    *dot = '\0';
  }
}

cf_status cf_config_fail_at(const cf_config *config, const char *key, const char *format, ...) {
  char buffer[256];
  const cf_node *node = cf_node_find_path(config->root, key, NULL);
  cf_about about = {{0, 0, 0}, explained(config, key, buffer, sizeof buffer)};
  if (node != NULL && node != config->root) about.place = node->place;
  va_list values;
  va_start(values, format);
  const cf_status status = cf_config_vfail(config, about, format, values);
  va_end(values);
  return status;
}

bool cf_config_has(const cf_config *config, const char *key) {
  bool exact;
  cf_node_find_path(config->root, key, &exact);
  return exact;
}

const char *cf_config_scalar(const cf_config *config, const char *key) {
  bool exact;
  const cf_node *node = cf_node_find_path(config->root, key, &exact);
  return exact && node->kind == CF_NODE_SCALAR ? node->text : NULL;
}
