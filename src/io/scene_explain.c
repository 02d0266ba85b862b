/* SPDX-License-Identifier: MIT
 *
 * The page on a key, made from its row:
 *
 *     diffusion.k
 *       Diffusivity k of eqs 7 to 10; an expression in x, y, z
 *       type     number or expression in x, y, z
 *       unit     m^2/s
 *       range    >= 0
 *       default  0
 *
 * A record shows its own line and the pages of all keys in it.
 */
#include <stdio.h>
#include <string.h>

#include "io/scene.h"
#include "io/scene_text.h"

enum { WIDTH = 92 };

/* Words of a sentence, broken at WIDTH. */
static void add_wrapped(cf_writing *out, const char *text) {
  int column = 0;
  while (*text != '\0') {
    const int n = (int)strcspn(text, " ");
    if (column > 0 && column + 1 + n > WIDTH) {
      cf_writing_add(out, "\n");
      column = 0;
    }
    cf_writing_add(out, "%s%.*s", column == 0 ? "  " : " ", n, text);
    column += n + (column == 0 ? 2 : 1);
    text += n;
    text += strspn(text, " ");
  }
  cf_writing_add(out, "\n");
}

static void add_words(cf_writing *out, const char *words) {
  char word[64];
  for (int i = 0; cf_param_word_at(words, i, word, sizeof word); ++i)
    cf_writing_add(out, "%s%s", i > 0 ? ", " : "  words    ", word);
  cf_writing_add(out, "\n");
}

static void add_range(cf_writing *out, const cf_param *param) {
  char sentence[80];
  const cf_param_range range = cf_param_range_of(param);
  if (param->type == CF_PARAM_word || param->type == CF_PARAM_words) {
    add_words(out, param->range);
    return;
  }
  cf_param_range_sentence(&range, sentence, sizeof sentence);
  if (range.count_max > 1 && range.count_min < range.count_max)
    cf_writing_add(out, "  entries  %d or %d\n", range.count_min, range.count_max);
  else if (range.count_max > 1)
    cf_writing_add(out, "  entries  %d\n", range.count_max);
  if (sentence[0] != '\0') cf_writing_add(out, "  range    %s\n", sentence);
}

static void add_default(cf_writing *out, const cf_param *param) {
  if (param->fallback == CF_REQUIRED)
    cf_writing_add(out, "  default  none: must be given\n");
  else if (param->fallback == CF_NONE)
    cf_writing_add(out, "  default  none: may be left out\n");
  else
    cf_writing_add(out, "  default  %s\n", param->fallback[0] != '\0' ? param->fallback : "empty");
}

static void add_page(cf_writing *out, const cf_param *param, const char *path) {
  cf_writing_add(out, "%s\n", path);
  add_wrapped(out, param->doc);
  cf_writing_add(out, "  type     %s\n", cf_param_type_name(param->type));
  if (param->unit[0] != '\0') cf_writing_add(out, "  unit     %s\n", param->unit);
  add_range(out, param);
  if (param->table == NULL) add_default(out, param);
}

/* Keys of an entry stand under a name or a number. */
static void add_entry(const cf_param *param, char *path, const size_t size) {
  const size_t length = strlen(path);
  if (param->type == CF_PARAM_map) snprintf(path + length, size - length, ".NAME");
  if (param->type == CF_PARAM_list) snprintf(path + length, size - length, ".0");
}

static void add_pages(cf_writing *out, const cf_param_table *table, const char *path) {
  for (int i = 0; i < table->count; ++i) {
    const cf_param *param = &table->param[i];
    char inner[256];
    if (param->type == CF_PARAM_key) continue;
    snprintf(inner, sizeof inner, "%s%s%s", path, path[0] != '\0' ? "." : "", param->name);
    if (out->length > 0) cf_writing_add(out, "\n");
    add_page(out, param, inner);
    if (param->table == NULL) continue;
    add_entry(param, inner, sizeof inner);
    add_pages(out, param->table, inner);
  }
}

cf_status cf_config_explain(const cf_param_table *root, const char *key, char **text) {
  cf_writing out = {.text = NULL};
  char meant[256];
  *text = NULL;
  if (key == NULL) {
    add_pages(&out, root, "");
    return cf_writing_end(&out, text);
  }
  const cf_param *param = cf_param_find_path(root, key);
  if (param == NULL && cf_param_nearest_path(root, key, meant, sizeof meant))
    return cf_fail(CF_BAD_USAGE, "there is no key %.100s: did you mean %s?", key, meant);
  if (param == NULL)
    return cf_fail(CF_BAD_USAGE, "there is no key %.100s (cattaneo explain lists all keys)", key);
  add_page(&out, param, key);
  snprintf(meant, sizeof meant, "%s", key);
  const size_t length = strlen(meant), name = strlen(param->name);
  if (length >= name && strcmp(meant + length - name, param->name) == 0)
    add_entry(param, meant, sizeof meant);
  if (param->table != NULL) add_pages(&out, param->table, meant);
  return cf_writing_end(&out, text);
}
