/* SPDX-License-Identifier: MIT
 *
 * The values of a scene that have a grammar of their own: walls, intervals, and the constants under `let`.
 *
 *   walls      insulated, or {x-: open, x+: {value: sin(t)}, ...}: one word for all, or a map of sides
 *   interval   100 steps, 10 min, never
 *   constants  {H: 2, c: 1/H, L: 3 cm}: in order, each may use those before it
 */
#include <math.h>
#include <string.h>

#include "base/mem.h"
#include "io/scene_value.h"

/* --- walls ------------------------------------------------------------------------------------ */

#define CF_WALL_WORD(upper, lower) #lower "|"
static const char wall_words[] = CF_WALL_LIST(CF_WALL_WORD);
#undef CF_WALL_WORD
static const char side_words[] = "x-|x+|y-|y+|z-|z+";

static cf_status wall_word(const cf_reader *reader, const cf_node *node, cf_wall *kind) {
  const int word = cf_param_word_index(wall_words, node->text, strlen(node->text));
  if (word < 0) return cf_value_fail_word(reader, node, wall_words, node->text);
  if (word == CF_WALL_VALUE)
    return cf_reader_fail(reader, node, "%s: a value is written {value: EXPRESSION}", reader->path);
  *kind = (cf_wall)word;
  return CF_OK;
}

/* {value: EXPRESSION} or {radiate: EXPRESSION}: what is held, or what lies outside. */
static cf_status wall_map(cf_reader *reader, const cf_param *param, const cf_node *node, cf_wall *kind,
                          cf_function *function) {
  const cf_node *entry = node->first;
  if (node->kind != CF_NODE_MAP || node->count != 1)
    return cf_reader_fail(reader, node, "%s: a wall is a word or {value: EXPRESSION}", reader->path);
  if (strcmp(entry->key, "value") == 0)
    *kind = CF_WALL_VALUE;
  else if (strcmp(entry->key, "radiate") == 0)
    *kind = CF_WALL_RADIATE;
  else
    return cf_config_fail(reader->config, (cf_about){entry->key_place, reader->path},
                          "%s: unknown key %.60s: did you mean value?", reader->path, entry->key);
  return cf_value_function(reader, param, entry, CF_EXPR_SPACE_TIME, function);
}

static cf_status wall_side(cf_reader *reader, const cf_param *param, const cf_node *node, const int side,
                           cf_param_walls *walls) {
  const int axis = side / 2, high = side % 2;
  cf_function outside = {cf_fn_constant(0.0), NULL};
  cf_wall kind = CF_WALL_INSULATED;
  if (node->kind == CF_NODE_SCALAR)
    CF_TRY(wall_word(reader, node, &kind));
  else
    CF_TRY(wall_map(reader, param, node, &kind, &outside));
  walls->walls.kind[axis][high] = kind;
  walls->walls.value[axis][high] = outside.fn;
  walls->text[axis][high] = outside.text;
  walls->given[axis][high] = true;
  return CF_OK;
}

/* Whether a map is that of one wall for all sides, {value: 1}, and not one of sides. */
static bool is_one_wall(const cf_node *node) {
  return node->kind == CF_NODE_MAP && node->count == 1 &&
         (strcmp(node->first->key, "value") == 0 || strcmp(node->first->key, "radiate") == 0);
}

cf_status cf_value_walls(cf_reader *reader, const cf_param *param, const cf_node *node,
                         cf_param_walls *walls) {
  *walls = (cf_param_walls){.text = {{NULL}}};
  if (node->kind != CF_NODE_MAP || is_one_wall(node)) {
    for (int side = 0; side < 6; ++side) CF_TRY(wall_side(reader, param, node, side, walls));
    return CF_OK;
  }
  for (const cf_node *entry = node->first; entry != NULL; entry = entry->next) {
    const int side = cf_param_word_index(side_words, entry->key, strlen(entry->key));
    cf_node named = *entry;
    named.place = entry->key_place;
    if (side < 0) return cf_value_fail_word(reader, &named, side_words, entry->key);
    const size_t length = cf_reader_enter(reader, entry->key);
    CF_TRY(wall_side(reader, param, entry, side, walls));
    cf_reader_leave(reader, length);
  }
  return CF_OK;
}

/* --- intervals -------------------------------------------------------------------------------- */

/* "100 steps": the number before the word; false if the text does not end so. */
static bool ends_in_steps(const char *text, size_t *number) {
  size_t length = strlen(text);
  if (length >= 4 && strcmp(text + length - 4, "step") == 0)
    length -= 4;
  else if (length >= 5 && strcmp(text + length - 5, "steps") == 0)
    length -= 5;
  else
    return false;
  while (length > 0 && text[length - 1] == ' ') --length;
  *number = length;
  return true;
}

static cf_status interval_in_steps(cf_reader *reader, const cf_node *node, const size_t length,
                                   cf_interval *interval) {
  cf_node number = *node;
  CF_TRY(cf_config_copy(reader->config, &number.text, node->text, length));
  CF_TRY(cf_value_quantity(reader, &number, "", &interval->every));
  interval->in_steps = true;
  if (interval->every == rint(interval->every) && interval->every >= 1.0 && interval->every <= 9e15)
    return CF_OK;
  return cf_reader_fail(reader, node, "%s = %.60s: must be a whole number of steps, 1 at least", reader->path,
                        node->text);
}

cf_status cf_value_interval(cf_reader *reader, const cf_param *param, const cf_node *node,
                            cf_interval *interval) {
  size_t length;
  double plain;
  CF_TRY(cf_value_expect_scalar(reader, param, node));
  *interval = (cf_interval){0.0, false};
  if (strcmp(node->text, "never") == 0) return CF_OK;
  if (ends_in_steps(node->text, &length)) return interval_in_steps(reader, node, length, interval);
  if (cf_param_distance(node->text, "never") > 0)
    return cf_reader_fail(reader, node, "%s: %.40s is not known: did you mean never?", reader->path,
                          node->text);
  const cf_status status = cf_value_quantity(reader, node, "", &plain);
  if (status == CF_NO_MEMORY) return status;
  if (status == CF_OK)
    return cf_reader_fail(reader, node, "%s = %.60s: of what? write N steps, or a time such as 10 min",
                          reader->path, node->text);
  CF_TRY(cf_value_quantity(reader, node, "s", &interval->every));
  if (interval->every > 0.0) return CF_OK;
  return cf_reader_fail(reader, node, "%s = %.60s: must be > 0", reader->path, node->text);
}

/* --- constants -------------------------------------------------------------------------------- */

static cf_status constants_room(cf_config *config, const int count, cf_param_constants *constants) {
  void *name, *text, *value;
  const size_t n = (size_t)count;
  CF_TRY(cf_config_new(config, &name, n * sizeof(const char *)));
  CF_TRY(cf_config_new(config, &text, n * sizeof(const char *)));
  CF_TRY(cf_config_new(config, &value, n * sizeof(double)));
  *constants = (cf_param_constants){0, name, text, value};
  return CF_OK;
}

cf_status cf_value_constants(cf_reader *reader, const cf_param *param, const cf_node *node,
                             cf_param_constants *constants) {
  const bool empty = node->kind == CF_NODE_SCALAR && node->text[0] == '\0';
  if (node->kind != CF_NODE_MAP && !empty) return cf_value_expect_scalar(reader, param, node);
  CF_TRY(constants_room(reader->config, node->count, constants));
  for (const cf_node *entry = node->first; entry != NULL; entry = entry->next) {
    const size_t length = cf_reader_enter(reader, entry->key);
    cf_node named = *entry;
    named.place = entry->key_place;
    const cf_status status = cf_expr_name_check(entry->key);
    if (status != CF_OK) return cf_reader_fail(reader, &named, "%s: %s", reader->path, cf_status_sentence());
    CF_TRY(cf_value_expect_scalar(reader, param, entry));
    const int i = constants->count;
    CF_TRY(cf_value_quantity(reader, entry, NULL, &constants->value[i])); /* any unit; kept in SI */
    CF_TRY(cf_config_copy(reader->config, &constants->name[i], entry->key, strlen(entry->key)));
    CF_TRY(cf_config_copy(reader->config, &constants->text[i], entry->text, strlen(entry->text)));
    constants->count = i + 1;
    reader->constants = (cf_expr_constants){constants->count, constants->name, constants->value};
    cf_reader_leave(reader, length);
  }
  return CF_OK;
}
