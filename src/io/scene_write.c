/* SPDX-License-Identifier: MIT
 *
 * Structs of a root table as YAML, every default filled in. Read again they are the same: numbers have as
 * many digits as it takes (17 at most), expressions stand as they were given, texts are in double quotes with
 * escapes. Left out: what has no default and was not given, and optional records that were not given.
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "io/scene.h"
#include "io/scene_text.h"

static void add_indent(cf_writing *out, const int depth) {
  for (int i = 0; i < depth; ++i) cf_writing_add_bytes(out, "  ", 2);
}

static void add_number(cf_writing *out, const double value) {
  char text[32];
  for (int digits = 15; digits <= 17; ++digits) {
    snprintf(text, sizeof text, "%.*g", digits, value);
    if (strtod(text, NULL) == value) break;
  }
  cf_writing_add_bytes(out, text, strlen(text));
}

static void add_text(cf_writing *out, const char *text) {
  cf_writing_add_bytes(out, "\"", 1);
  for (; *text != '\0'; ++text) {
    const char c = *text;
    if (c == '"' || c == '\\')
      cf_writing_add(out, "\\%c", c);
    else if (c == '\n')
      cf_writing_add_bytes(out, "\\n", 2);
    else if (c == '\t')
      cf_writing_add_bytes(out, "\\t", 2);
    else if (c == '\r')
      cf_writing_add_bytes(out, "\\r", 2);
    else
      cf_writing_add_bytes(out, &c, 1);
  }
  cf_writing_add_bytes(out, "\"", 1);
}

/* --- values ----------------------------------------------------------------------------------- */

/* As given; a function that was made and not read has a number only. */
static void add_function(cf_writing *out, const cf_function *function) {
  if (function->text != NULL)
    add_text(out, function->text);
  else
    add_number(out, function->fn.value);
}

static void add_functions(cf_writing *out, const cf_param_functions *functions) {
  if (functions->count == 1) {
    add_function(out, &functions->axis[0]);
    return;
  }
  for (int a = 0; a < functions->count; ++a) {
    cf_writing_add(out, a > 0 ? ", " : "[");
    add_function(out, &functions->axis[a]);
  }
  cf_writing_add(out, "]");
}

static void add_numbers(cf_writing *out, const cf_param_numbers *numbers) {
  cf_writing_add(out, "[");
  for (int i = 0; i < numbers->count; ++i) {
    if (i > 0) cf_writing_add(out, ", ");
    add_number(out, numbers->value[i]);
  }
  cf_writing_add(out, "]");
}

static void add_integers(cf_writing *out, const cf_param_integers *integers) {
  for (int i = 0; i < integers->count; ++i)
    cf_writing_add(out, "%s%ld", i > 0 ? ", " : "[", integers->value[i]);
  cf_writing_add(out, integers->count > 0 ? "]" : "[]");
}

static void add_words(cf_writing *out, const char *words, const unsigned set) {
  char word[64];
  const char *separator = "[";
  for (int i = 0; cf_param_word_at(words, i, word, sizeof word); ++i) {
    if ((set & 1u << i) == 0) continue;
    cf_writing_add(out, "%s%s", separator, word);
    separator = ", ";
  }
  cf_writing_add(out, set != 0 ? "]" : "[]");
}

static void add_word(cf_writing *out, const char *words, const int index) {
  char word[64] = "";
  cf_param_word_at(words, index, word, sizeof word);
  cf_writing_add(out, "%s", word);
}

static void add_texts(cf_writing *out, const cf_param_texts *texts) {
  for (int i = 0; i < texts->count; ++i) {
    cf_writing_add(out, i > 0 ? ", " : "[");
    add_text(out, texts->item[i]);
  }
  cf_writing_add(out, texts->count > 0 ? "]" : "[]");
}

static void add_walls(cf_writing *out, const cf_param_walls *walls) {
  static const char *const kinds[] = {
#define CF_WALL_WORD(upper, lower) #lower,
      CF_WALL_LIST(CF_WALL_WORD)
#undef CF_WALL_WORD
  };
  const char *separator = "{";
  for (int side = 0; side < 6; ++side) {
    const int axis = side / 2, high = side % 2;
    if (!walls->given[axis][high]) continue;
    cf_writing_add(out, "%s%c%c: ", separator, "xyz"[axis], "-+"[high]);
    separator = ", ";
    const char *kind = kinds[walls->walls.kind[axis][high]];
    if (walls->text[axis][high] == NULL) {
      cf_writing_add(out, "%s", kind);
      continue;
    }
    cf_writing_add(out, "{%s: ", kind);
    add_text(out, walls->text[axis][high]);
    cf_writing_add(out, "}");
  }
  cf_writing_add(out, separator[0] == '{' ? "insulated" : "}");
}

static void add_interval(cf_writing *out, const cf_interval *interval) {
  if (interval->every > 0.0) add_number(out, interval->every);
  cf_writing_add(out, interval->every <= 0.0 ? "never" : interval->in_steps ? " steps" : " s");
}

static void add_constants(cf_writing *out, const cf_param_constants *constants) {
  for (int i = 0; i < constants->count; ++i) {
    cf_writing_add(out, "%s%s: ", i > 0 ? ", " : "{", constants->name[i]);
    add_text(out, constants->text[i]);
  }
  cf_writing_add(out, constants->count > 0 ? "}" : "{}");
}

static void add_value(cf_writing *out, const cf_param *param, const void *member) {
  switch (param->type) {
    case CF_PARAM_number_or_auto:
    case CF_PARAM_number:
      if (isnan(*(const double *)member))
        cf_writing_add(out, "auto");
      else
        add_number(out, *(const double *)member);
      break;
    case CF_PARAM_integer:
      cf_writing_add(out, "%ld", *(const long *)member);
      break;
    case CF_PARAM_flag:
      cf_writing_add(out, *(const bool *)member ? "true" : "false");
      break;
    case CF_PARAM_word:
      add_word(out, param->range, *(const int *)member);
      break;
    case CF_PARAM_words:
      add_words(out, param->range, *(const unsigned *)member);
      break;
    case CF_PARAM_text:
    case CF_PARAM_path:
      add_text(out, *(const char *const *)member);
      break;
    case CF_PARAM_texts:
      add_texts(out, member);
      break;
    case CF_PARAM_numbers_or_auto:
      if (((const cf_param_numbers *)member)->count == 0)
        cf_writing_add(out, "auto");
      else
        add_numbers(out, member);
      break;
    case CF_PARAM_numbers:
      add_numbers(out, member);
      break;
    case CF_PARAM_integers:
      add_integers(out, member);
      break;
    case CF_PARAM_function:
    case CF_PARAM_profile:
      add_function(out, member);
      break;
    case CF_PARAM_functions:
    case CF_PARAM_profiles:
      add_functions(out, member);
      break;
    case CF_PARAM_walls:
      add_walls(out, member);
      break;
    case CF_PARAM_interval:
      add_interval(out, member);
      break;
    case CF_PARAM_constants:
      add_constants(out, member);
      break;
    default:
      break;
  }
}

/* --- records ---------------------------------------------------------------------------------- */

/* What is left out of a record, and how its first key is indented. */
typedef enum cf_record_style { CF_RECORD_WHOLE, CF_RECORD_ENTRY, CF_RECORD_GIVEN } cf_record_style;

static void add_record(cf_writing *out, const cf_param_table *table, const char *record, int depth,
                       cf_record_style style);

/* A map writes the name of each entry on a line of its own, a list puts a dash before the first key. */
static void add_items(cf_writing *out, const cf_param *param, const char *member, const int depth) {
  const cf_param_items items = cf_param_items_get(member);
  if (items.count == 0) {
    cf_writing_add(out, param->type == CF_PARAM_map ? " {}\n" : " []\n");
    return;
  }
  cf_writing_add(out, "\n");
  for (int i = 0; i < items.count; ++i) {
    const char *record = (const char *)items.item + (size_t)i * param->table->size;
    add_indent(out, depth + 1);
    if (param->type == CF_PARAM_map) {
      for (int r = 0; r < param->table->count; ++r)
        if (param->table->param[r].type == CF_PARAM_key)
          cf_writing_add(out, "%s:\n",
                         *(const char *const *)(const void *)(record + param->table->param[r].offset));
      add_record(out, param->table, record, depth + 2, CF_RECORD_WHOLE);
    } else {
      cf_writing_add(out, "- ");
      add_record(out, param->table, record, depth + 2, CF_RECORD_ENTRY);
    }
  }
}

/* What was not given and has no default is not there; of an optional record, which goes before another one,
 * only what was given is. */
static bool is_there(const cf_param *param, const char *record, const cf_record_style style) {
  if (param->type == CF_PARAM_key) return false;
  const bool can_miss = param->table != NULL ? param->type == CF_PARAM_optional : param->fallback == CF_NONE;
  const bool given = *(const bool *)(const void *)(record + param->given);
  return given || (!can_miss && style != CF_RECORD_GIVEN);
}

static void add_row(cf_writing *out, const cf_param *param, const char *member, const int depth) {
  if (param->type == CF_PARAM_list || param->type == CF_PARAM_map) {
    add_items(out, param, member, depth);
  } else if (param->table != NULL) {
    const bool optional = param->type == CF_PARAM_optional;
    cf_writing_add(out, "\n");
    add_record(out, param->table, member, depth + 1, optional ? CF_RECORD_GIVEN : CF_RECORD_WHOLE);
  } else {
    cf_writing_add(out, " ");
    add_value(out, param, member);
    cf_writing_add(out, "\n");
  }
}

static void add_record(cf_writing *out, const cf_param_table *table, const char *record, const int depth,
                       const cf_record_style style) {
  bool indent = style != CF_RECORD_ENTRY;
  for (int i = 0; i < table->count; ++i) {
    const cf_param *param = &table->param[i];
    if (!is_there(param, record, style)) continue;
    if (indent) add_indent(out, depth);
    indent = true;
    cf_writing_add(out, "%s:", param->name);
    add_row(out, param, record + param->offset, depth);
  }
}

cf_status cf_config_write(const cf_param_table *root, const void *record,
                          bool (*writes)(const void *record, const char *key), char **text) {
  cf_writing out = {.text = NULL};
  const char *bytes = record;
  for (int i = 0; i < root->count; ++i) {
    const cf_param *param = &root->param[i];
    if (!is_there(param, bytes, CF_RECORD_WHOLE) || (writes != NULL && !writes(record, param->name)))
      continue;
    cf_writing_add(&out, "%s:", param->name);
    add_row(&out, param, bytes + param->offset, 0);
  }
  return cf_writing_end(&out, text);
}
