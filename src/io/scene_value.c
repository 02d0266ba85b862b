/* SPDX-License-Identifier: MIT
 *
 * Numbers, words, texts and lists of a scene; what has units or variables is in scene_quantity.c. See scene_value.h.
 */
#define _GNU_SOURCE /* realpath */
#include "io/scene_value.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/real.h"

size_t cf_reader_enter(cf_reader *reader, const char *key) {
  const size_t before = reader->length;
  const int n =
      snprintf(reader->path + before, sizeof reader->path - before, "%s%s", before > 0 ? "." : "", key);
  reader->length = CF_MIN(before + (size_t)n, sizeof reader->path - 1);
  return before;
}

void cf_reader_leave(cf_reader *reader, const size_t length) {
  reader->length = length;
  reader->path[length] = '\0';
}

cf_status cf_reader_fail(const cf_reader *reader, const cf_node *node, const char *format, ...) {
  va_list values;
  va_start(values, format);
  const cf_status status =
      cf_config_vfail(reader->config, (cf_about){node->place, reader->path}, format, values);
  va_end(values);
  return status;
}

/* --- numbers ---------------------------------------------------------------------------------- */

cf_status cf_value_expect_scalar(const cf_reader *reader, const cf_param *param, const cf_node *node) {
  const char *wanted = cf_param_type_name(param->type);
  if (node->kind != CF_NODE_SCALAR)
    return cf_reader_fail(reader, node, "%s is a %s, expected: %s", reader->path,
                          node->kind == CF_NODE_LIST ? "list" : "map", wanted);
  if (node->text[0] == '\0' && !node->quoted)
    return cf_reader_fail(reader, node, "%s has no value, expected: %s", reader->path, wanted);
  return CF_OK;
}

static cf_status read_number(cf_reader *reader, const cf_param *param, const cf_node *node, double *value) {
  CF_TRY(cf_value_expect_scalar(reader, param, node));
  CF_TRY(cf_value_quantity(reader, node, param->unit, value));
  return cf_value_in_range(reader, param, node, *value);
}

static cf_status read_integer(cf_reader *reader, const cf_param *param, const cf_node *node, long *value) {
  double number;
  CF_TRY(read_number(reader, param, node, &number));
  if (number != rint(number) || fabs(number) > 9e15)
    return cf_reader_fail(reader, node, "%s = %.80s: must be a whole number", reader->path, node->text);
  *value = (long)number;
  return CF_OK;
}

static bool is_auto(const cf_node *node) {
  return node->kind == CF_NODE_SCALAR && strcmp(node->text, "auto") == 0;
}

static cf_status read_number_or_auto(cf_reader *reader, const cf_param *param, const cf_node *node,
                                     double *value) {
  *value = NAN;
  if (is_auto(node)) return CF_OK;
  CF_TRY(cf_value_expect_scalar(reader, param, node));
  if (cf_param_distance(node->text, "auto") > 0)
    return cf_reader_fail(reader, node, "%s: %.40s is not known: did you mean auto?", reader->path,
                          node->text);
  return read_number(reader, param, node, value);
}

/* A list with as many entries as the row allows. */
static cf_status expect_list(const cf_reader *reader, const cf_param *param, const cf_node *node) {
  const cf_param_range range = cf_param_range_of(param);
  char many[40];
  if (node->kind != CF_NODE_LIST)
    return cf_reader_fail(reader, node, "%s is a %s, expected: %s", reader->path,
                          node->kind == CF_NODE_MAP ? "map" : "single value",
                          cf_param_type_name(param->type));
  if (node->count >= range.count_min && node->count <= range.count_max) return CF_OK;
  snprintf(many, sizeof many, range.count_min == range.count_max ? "%d" : "%d or %d", range.count_min,
           range.count_max);
  return cf_reader_fail(reader, node, "%s has %d %s: must be %s", reader->path, node->count,
                        node->count == 1 ? "entry" : "entries", many);
}

static cf_status read_numbers(cf_reader *reader, const cf_param *param, const cf_node *node,
                              cf_param_numbers *numbers) {
  CF_TRY(expect_list(reader, param, node));
  const cf_node *entry = node->first;
  for (int i = 0; i < node->count; ++i, entry = entry->next)
    CF_TRY(read_number(reader, param, entry, &numbers->value[i]));
  numbers->count = node->count;
  return CF_OK;
}

static cf_status read_integers(cf_reader *reader, const cf_param *param, const cf_node *node,
                               cf_param_integers *integers) {
  CF_TRY(expect_list(reader, param, node));
  const cf_node *entry = node->first;
  for (int i = 0; i < node->count; ++i, entry = entry->next)
    CF_TRY(read_integer(reader, param, entry, &integers->value[i]));
  integers->count = node->count;
  return CF_OK;
}

/* --- words and texts -------------------------------------------------------------------------- */

cf_status cf_value_fail_word(const cf_reader *reader, const cf_node *node, const char *words,
                             const char *word) {
  char each[64], all[256] = "", meant[64];
  size_t n = 0;
  for (int i = 0; cf_param_word_at(words, i, each, sizeof each) && n < sizeof all - 70; ++i)
    n += (size_t)snprintf(all + n, sizeof all - n, "%s%s", i > 0 ? ", " : "", each);
  if (cf_param_word_nearest(words, word, meant, sizeof meant))
    return cf_reader_fail(reader, node, "%s: %.60s is not known: did you mean %s? (there is: %s)",
                          reader->path, word, meant, all);
  return cf_reader_fail(reader, node, "%s: %.60s is not known (there is: %s)", reader->path, word, all);
}

static cf_status read_word(cf_reader *reader, const cf_param *param, const cf_node *node, int *word) {
  CF_TRY(cf_value_expect_scalar(reader, param, node));
  *word = cf_param_word_index(param->range, node->text, strlen(node->text));
  return *word >= 0 ? CF_OK : cf_value_fail_word(reader, node, param->range, node->text);
}

/* One word of a set, out of a longer text. */
static cf_status add_word(cf_reader *reader, const cf_param *param, const cf_node *node, const char *text,
                          unsigned *set) {
  const int word = cf_param_word_index(param->range, text, strlen(text));
  if (word < 0) return cf_value_fail_word(reader, node, param->range, text);
  *set |= 1u << word;
  return CF_OK;
}

/* A list of words, or one text with commas, as defaults are: "[vtkhdf, png]". */
static cf_status read_words(cf_reader *reader, const cf_param *param, const cf_node *node, unsigned *set) {
  *set = 0;
  if (node->kind == CF_NODE_LIST) {
    for (const cf_node *entry = node->first; entry != NULL; entry = entry->next) {
      CF_TRY(cf_value_expect_scalar(reader, param, entry));
      CF_TRY(add_word(reader, param, entry, entry->text, set));
    }
    return CF_OK;
  }
  CF_TRY(cf_value_expect_scalar(reader, param, node));
  for (const char *at = node->text + strspn(node->text, "[, ]"); *at != '\0';) {
    char word[64];
    const size_t n = strcspn(at, "[, ]");
    snprintf(word, sizeof word, "%.*s", (int)CF_MIN(n, sizeof word - 1), at);
    CF_TRY(add_word(reader, param, node, word, set));
    at += n;
    at += strspn(at, "[, ]");
  }
  return CF_OK;
}

static cf_status read_flag(cf_reader *reader, const cf_param *param, const cf_node *node, bool *flag) {
  CF_TRY(cf_value_expect_scalar(reader, param, node));
  *flag = strcmp(node->text, "true") == 0;
  if (*flag || strcmp(node->text, "false") == 0) return CF_OK;
  return cf_reader_fail(reader, node, "%s = %.60s: must be true or false", reader->path, node->text);
}

static cf_status read_text(cf_reader *reader, const cf_param *param, const cf_node *node, const char **text) {
  if (node->kind != CF_NODE_SCALAR) return cf_value_expect_scalar(reader, param, node);
  return cf_config_copy(reader->config, text, node->text, strlen(node->text));
}

/* A name is relative to the scene's folder; what is kept holds wherever the resolved scene is put. */
static cf_status read_path(cf_reader *reader, const cf_param *param, const cf_node *node, const char **path) {
  CF_TRY(cf_value_expect_scalar(reader, param, node));
  if (node->text[0] == '/' || node->text[0] == '\0') return read_text(reader, param, node, path);
  char *folder = realpath(reader->config->folder, NULL);
  if (folder == NULL)
    return cf_reader_fail(reader, node, "%s: the folder %.200s cannot be found", reader->path,
                          reader->config->folder);
  const cf_status status = cf_config_text(reader->config, path, "%s/%s", folder, node->text);
  free(folder);
  return status;
}

static cf_status read_texts(cf_reader *reader, const cf_param *param, const cf_node *node,
                            cf_param_texts *texts) {
  const bool single = node->kind == CF_NODE_SCALAR;
  void *block;
  if (node->kind == CF_NODE_MAP || (single && node->text[0] == '\0'))
    return cf_value_expect_scalar(reader, param, node);
  texts->count = 0;
  CF_TRY(cf_config_new(reader->config, &block, (size_t)(node->count + 1) * sizeof *texts->item));
  texts->item = block;
  for (const cf_node *entry = single ? node : node->first; entry != NULL; entry = single ? NULL : entry->next)
    CF_TRY(read_text(reader, param, entry, &texts->item[texts->count++]));
  return CF_OK;
}

/* --- all types -------------------------------------------------------------------------------- */

cf_status cf_value_read(cf_reader *reader, const cf_param *param, const cf_node *node, void *member) {
  switch (param->type) {
    case CF_PARAM_number:
      return read_number(reader, param, node, member);
    case CF_PARAM_number_or_auto:
      return read_number_or_auto(reader, param, node, member);
    case CF_PARAM_integer:
      return read_integer(reader, param, node, member);
    case CF_PARAM_flag:
      return read_flag(reader, param, node, member);
    case CF_PARAM_word:
      return read_word(reader, param, node, member);
    case CF_PARAM_words:
      return read_words(reader, param, node, member);
    case CF_PARAM_text:
      return read_text(reader, param, node, member);
    case CF_PARAM_path:
      return read_path(reader, param, node, member);
    case CF_PARAM_texts:
      return read_texts(reader, param, node, member);
    case CF_PARAM_numbers_or_auto:
      if (is_auto(node)) return CF_OK;
      return read_numbers(reader, param, node, member);
    case CF_PARAM_numbers:
      return read_numbers(reader, param, node, member);
    case CF_PARAM_integers:
      return read_integers(reader, param, node, member);
    case CF_PARAM_function:
      return cf_value_function(reader, param, node, CF_EXPR_SPACE_TIME, member);
    case CF_PARAM_profile:
      return cf_value_function(reader, param, node, CF_EXPR_SPACE, member);
    case CF_PARAM_functions:
      return cf_value_functions(reader, param, node, CF_EXPR_SPACE_TIME, member);
    case CF_PARAM_profiles:
      return cf_value_functions(reader, param, node, CF_EXPR_SPACE, member);
    case CF_PARAM_walls:
      return cf_value_walls(reader, param, node, member);
    case CF_PARAM_interval:
      return cf_value_interval(reader, param, node, member);
    case CF_PARAM_constants:
      return cf_value_constants(reader, param, node, member);
    default:
      return cf_fail(CF_FAILED, "%s: a record is not a value", reader->path);
  }
}
