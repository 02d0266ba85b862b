/* SPDX-License-Identifier: MIT
 *
 * What tables of parameters can answer about themselves: rows by name and by path, the nearest name to a slip
 * of the pen, words, and ranges. See param.h.
 */
#include "base/param.h"

#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/real.h"

cf_param_items cf_param_items_get(const void *member) {
  /* Every list member is an int and a pointer; only the type pointed to differs, and bytes do not care. */
  cf_param_items items;
  memcpy(&items, member, sizeof items);
  return items;
}

void cf_param_items_set(void *member, const cf_param_items items) { memcpy(member, &items, sizeof items); }

const char *cf_param_type_name(const cf_param_type type) {
  static const char *const names[] = {
#define CF_PARAM_TYPE_NAME(type, what) what,
      CF_PARAM_TYPE_LIST(CF_PARAM_TYPE_NAME)
#undef CF_PARAM_TYPE_NAME
  };
  return names[type];
}

const char *cf_param_default(const cf_param *param) {
  return param->fallback == CF_REQUIRED ? NULL : param->fallback;
}

/* --- rows ------------------------------------------------------------------------------------- */

static const cf_param *find(const cf_param_table *table, const char *name, const size_t length) {
  for (int i = 0; i < table->count; ++i) {
    const cf_param *param = &table->param[i];
    if (param->type != CF_PARAM_key && strlen(param->name) == length &&
        memcmp(param->name, name, length) == 0)
      return param;
  }
  return NULL;
}

const cf_param *cf_param_find(const cf_param_table *table, const char *name) {
  return find(table, name, strlen(name));
}

/* Whether entries of a value have places of their own: "domain.cells.1", "let.H", "domain.walls.x-". */
static bool has_parts(const cf_param_type type) {
  switch (type) {
    case CF_PARAM_numbers:
    case CF_PARAM_numbers_or_auto:
    case CF_PARAM_integers:
    case CF_PARAM_words:
    case CF_PARAM_texts:
    case CF_PARAM_functions:
    case CF_PARAM_profiles:
    case CF_PARAM_walls:
    case CF_PARAM_constants:
      return true;
    default:
      return false;
  }
}

/* One part of a path: up to the next dot. */
static size_t part_length(const char *path) { return strcspn(path, "."); }

static const char *part_next(const char *path) {
  path += part_length(path);
  return *path == '.' ? path + 1 : path;
}

const cf_param *cf_param_find_path(const cf_param_table *root, const char *path) {
  const cf_param_table *table = root;
  for (;;) {
    const cf_param *param = find(table, path, part_length(path));
    if (param == NULL) return NULL;
    path = part_next(path);
    if (*path == '\0') return param;
    if (param->table == NULL) return has_parts(param->type) ? param : NULL;
    table = param->table;
    /* The name of an entry, unless the path has left it out. */
    const bool entry = param->type == CF_PARAM_list || param->type == CF_PARAM_map;
    if (entry && find(table, path, part_length(path)) == NULL) {
      path = part_next(path);
      if (*path == '\0') return param;
    }
  }
}

/* --- did you mean ----------------------------------------------------------------------------------------
 */

enum { WORD_MAX = 64 };

static int lower(const char c) { return c >= 'A' && c <= 'Z' ? c - 'A' + 'a' : c; }

/* Optimal string alignment: insertions, deletions, changes and swaps of neighbours cost 1 each. */
static int edits(const char *a, const int na, const char *b, const int nb) {
  int before[WORD_MAX + 1], above[WORD_MAX + 1], row[WORD_MAX + 1];
  for (int j = 0; j <= nb; ++j) before[j] = above[j] = j;
  for (int i = 1; i <= na; ++i) {
    row[0] = i;
    for (int j = 1; j <= nb; ++j) {
      const bool same = lower(a[i - 1]) == lower(b[j - 1]);
      row[j] = CF_MIN(CF_MIN(above[j] + 1, row[j - 1] + 1), above[j - 1] + (same ? 0 : 1));
      const bool swap =
          i > 1 && j > 1 && lower(a[i - 1]) == lower(b[j - 2]) && lower(a[i - 2]) == lower(b[j - 1]);
      if (swap) row[j] = CF_MIN(row[j], before[j - 2] + 1);
    }
    memcpy(before, above, sizeof above);
    memcpy(above, row, sizeof row);
  }
  return above[nb];
}

int cf_param_distance(const char *word, const char *wanted) {
  const size_t na = strlen(word), nb = strlen(wanted);
  if (na == 0 || na > WORD_MAX || nb > WORD_MAX) return -1;
  const int distance = edits(word, (int)na, wanted, (int)nb);
  const int longest = (int)CF_MAX(na, nb);
  if (distance <= (longest + 1) / 3) return distance;
  /* "diff" for "diffusion": the start of a word is meant as the word. */
  const bool start = na >= 3 && na < nb && edits(word, (int)na, wanted, (int)na) == 0;
  return start ? (longest + 1) / 3 + 1 : -1;
}

/* The best so far of a search for what was meant. */
typedef struct cf_nearest {
  const char *name;
  int distance;
} cf_nearest;

static void nearest_try(cf_nearest *best, const char *word, const char *name) {
  const int distance = cf_param_distance(word, name);
  if (distance < 0 || (best->name != NULL && distance >= best->distance)) return;
  *best = (cf_nearest){name, distance};
}

const char *cf_param_nearest(const cf_param_table *table, const char *name) {
  cf_nearest best = {NULL, 0};
  for (int i = 0; i < table->count; ++i)
    if (table->param[i].type != CF_PARAM_key) nearest_try(&best, name, table->param[i].name);
  return best.name;
}

/* A path that grows and shrinks while the tree is walked. */
typedef struct cf_path {
  char text[256];
  size_t length;
} cf_path;

static void path_add(cf_path *path, const char *part) {
  const int n = snprintf(path->text + path->length, sizeof path->text - path->length, "%s%s",
                         path->length > 0 ? "." : "", part);
  path->length = CF_MIN(path->length + (size_t)n, sizeof path->text - 1);
}

static void path_cut(cf_path *path, const size_t length) {
  path->length = length;
  path->text[length] = '\0';
}

/* Follows `path`, mending every part that is nearly right. */
static bool mend(const cf_param_table *table, const char *path, cf_path *mended) {
  for (;;) {
    char part[WORD_MAX + 1];
    snprintf(part, sizeof part, "%.*s", (int)CF_MIN(part_length(path), (size_t)WORD_MAX), path);
    const char *name = find(table, part, strlen(part)) != NULL ? part : cf_param_nearest(table, part);
    if (name == NULL) return false;
    path_add(mended, name);
    const cf_param *param = cf_param_find(table, name);
    path = part_next(path);
    if (*path == '\0') return true;
    if (param->table == NULL) return false;
    table = param->table;
    const bool entry = param->type == CF_PARAM_list || param->type == CF_PARAM_map;
    if (entry && find(table, path, part_length(path)) == NULL && path[part_length(path)] == '.') {
      snprintf(part, sizeof part, "%.*s", (int)CF_MIN(part_length(path), (size_t)WORD_MAX), path);
      path_add(mended, part);
      path = part_next(path);
    }
  }
}

/* Looks for a row called `name` anywhere in the tree. */
static bool search(const cf_param_table *table, const char *name, cf_path *found) {
  for (int i = 0; i < table->count; ++i) {
    const cf_param *param = &table->param[i];
    const size_t length = found->length;
    if (param->type == CF_PARAM_key) continue;
    path_add(found, param->name);
    if (strcmp(param->name, name) == 0) return true;
    if (param->type == CF_PARAM_map) path_add(found, "NAME");
    if (param->type == CF_PARAM_list) path_add(found, "0");
    if (param->table != NULL && search(param->table, name, found)) return true;
    path_cut(found, length);
  }
  return false;
}

bool cf_param_nearest_path(const cf_param_table *root, const char *path, char *nearest, const size_t size) {
  cf_path found = {.length = 0};
  const char *last = strrchr(path, '.');
  const char *name = last != NULL ? last + 1 : path;
  bool good = mend(root, path, &found);
  if (!good) {
    path_cut(&found, 0);
    good = search(root, name, &found);
  }
  snprintf(nearest, size, "%s", good ? found.text : "");
  return good;
}

/* --- words ------------------------------------------------------------------------------------------------
 */

int cf_param_word_index(const char *words, const char *word, const size_t length) {
  for (int i = 0; *words != '\0'; ++i) {
    const size_t n = strcspn(words, "|");
    if (n == length && memcmp(words, word, n) == 0) return i;
    words += n + (words[n] == '|' ? 1 : 0);
  }
  return -1;
}

bool cf_param_word_at(const char *words, int i, char *word, const size_t size) {
  for (; *words != '\0'; --i) {
    const size_t n = strcspn(words, "|");
    if (i == 0) {
      snprintf(word, size, "%.*s", (int)n, words);
      return true;
    }
    words += n + (words[n] == '|' ? 1 : 0);
  }
  return false;
}

bool cf_param_word_nearest(const char *words, const char *word, char *nearest, const size_t size) {
  char each[WORD_MAX + 1];
  int best = -1;
  for (int i = 0; cf_param_word_at(words, i, each, sizeof each); ++i) {
    const int distance = cf_param_distance(word, each);
    if (distance < 0 || (best >= 0 && distance >= best)) continue;
    best = distance;
    snprintf(nearest, size, "%s", each);
  }
  return best >= 0;
}

/* --- ranges -----------------------------------------------------------------------------------------------
 */

cf_param_range cf_param_range_of(const cf_param *param) {
  cf_param_range range = {1, 1, -INFINITY, INFINITY, true, true};
  const char *text = param->range;
  const char *of = strstr(text, " of ");
  char *end;
  if (of != NULL) {
    range.count_min = range.count_max = (int)strtol(text, &end, 10);
    if (end[0] == '.' && end[1] == '.') range.count_max = (int)strtol(end + 2, &end, 10);
    text = of + 4;
  }
  if (*text != '(' && *text != '[') return range;
  range.low_open = *text == '(';
  range.low = strtod(text + 1, &end);
  while (*end == ',' || *end == ' ') ++end;
  range.high = strtod(end, &end);
  range.high_open = *end == ')';
  return range;
}

bool cf_param_range_has(const cf_param_range *range, const double value) {
  const bool above = range->low_open ? value > range->low : value >= range->low;
  const bool below = range->high_open ? value < range->high : value <= range->high;
  return (above || range->low == -INFINITY) && (below || range->high == INFINITY) && !isnan(value);
}

void cf_param_range_sentence(const cf_param_range *range, char *sentence, const size_t size) {
  const bool low = range->low > -INFINITY, high = range->high < INFINITY;
  char from[40] = "", to[40] = "";
  if (low) snprintf(from, sizeof from, "%s %.10g", range->low_open ? ">" : ">=", range->low);
  if (high) snprintf(to, sizeof to, "%s %.10g", range->high_open ? "<" : "<=", range->high);
  snprintf(sentence, size, "%s%s%s", from, low && high ? " and " : "", to);
}
