/* SPDX-License-Identifier: MIT
 *
 * YAML text into the tree of a scene, by libfyaml. The library parses; everything that a user sees is ours:
 * places are bytes in the source, aliases are copied with the same limits as everything else (so a file of
 * aliases of aliases stops at CF_SCENE_NODES, and one that holds itself at CF_SCENE_DEPTH), keys are single
 * values and stand once. One document a file. Tags are not used.
 */
#include <libfyaml.h>
#include <string.h>

#include "base/real.h"
#include "io/scene_tree.h"

enum { KEYS_MAX = 1000 };

/* A conversion under way. */
typedef struct cf_yaml {
  cf_config *config;
  int source;
  size_t from; /* where the text given to the library starts in the source */
} cf_yaml;

static cf_status fail(const cf_yaml *yaml, const cf_place place, const char *sentence) {
  return cf_config_fail(yaml->config, (cf_about){place, NULL}, "%s", sentence);
}

/* --- places ----------------------------------------------------------------------------------- */

static cf_place token_place(const cf_yaml *yaml, struct fy_token *token, const enum fy_node_style style) {
  const struct fy_mark *start = fy_token_start_mark(token), *end = fy_token_end_mark(token);
  cf_place place = {yaml->source, yaml->from, 1};
  if (start == NULL || end == NULL) return place;
  const size_t from = yaml->from + start->input_pos, to = yaml->from + end->input_pos;
  place.at = from;
  place.length = to > from ? to - from : 1;
  const bool quoted = style == FYNS_SINGLE_QUOTED || style == FYNS_DOUBLE_QUOTED;
  if (quoted && place.at > 0) { /* the marks are inside the quotes */
    place.at -= 1;
    place.length = to - from + 2;
  }
  if (style == FYNS_ALIAS && place.at > 0) {
    place.at -= 1;
    place.length += 1;
  }
  return place;
}

/* The byte at a line and column (both from 1, columns in characters) of what the library was given. */
static cf_place mark_place(const cf_yaml *yaml, const int line, const int column) {
  const cf_config_source *s = &yaml->config->source[yaml->source];
  size_t at = yaml->from;
  for (int l = 1; l < line && at < s->length; ++at)
    if (s->text[at] == '\n') ++l;
  for (int c = 1; c < column && at < s->length && s->text[at] != '\n'; ++c) do
      ++at;
    while (at < s->length && ((unsigned char)s->text[at] & 0xC0u) == 0x80u);
  return (cf_place){yaml->source, at, 1};
}

/* --- nodes ------------------------------------------------------------------------------------ */

static cf_status convert(const cf_yaml *yaml, struct fy_node *from, cf_place near, int depth, cf_node **node);

static cf_status convert_scalar(const cf_yaml *yaml, struct fy_node *from, const cf_place near,
                                cf_node **node) {
  size_t length = 0;
  const char *text = fy_node_get_scalar(from, &length);
  struct fy_token *token = fy_node_get_scalar_token(from);
  const enum fy_node_style style = fy_node_get_style(from);
  const cf_place place = token != NULL ? token_place(yaml, token, style) : near;
  if (text == NULL) length = 0;
  if (length > 0 && cf_text_bad_byte(text, length) >= 0)
    return fail(yaml, place, "the text has a control character in it");
  CF_TRY(cf_node_create(yaml->config, node, CF_NODE_SCALAR, place));
  (*node)->quoted = style != FYNS_PLAIN;
  return cf_config_copy(yaml->config, &(*node)->text, text != NULL ? text : "", length);
}

static cf_status convert_list(const cf_yaml *yaml, struct fy_node *from, const cf_place near, const int depth,
                              cf_node **node) {
  void *iterator = NULL;
  CF_TRY(cf_node_create(yaml->config, node, CF_NODE_LIST, near));
  for (struct fy_node *item; (item = fy_node_sequence_iterate(from, &iterator)) != NULL;) {
    cf_node *child;
    CF_TRY(convert(yaml, item, near, depth + 1, &child));
    if ((*node)->count == 0) (*node)->place = child->place;
    cf_node_add(*node, child);
  }
  return CF_OK;
}

/* The first scalar in a node is where it starts. */
static cf_place first_place(const cf_yaml *yaml, struct fy_node *node, const cf_place near) {
  for (int depth = 0; depth < CF_SCENE_DEPTH && node != NULL; ++depth) {
    struct fy_token *token = fy_node_is_scalar(node) ? fy_node_get_scalar_token(node) : NULL;
    if (token != NULL) return token_place(yaml, token, fy_node_get_style(node));
    if (fy_node_is_sequence(node))
      node = fy_node_sequence_get_by_index(node, 0);
    else if (fy_node_is_mapping(node) && fy_node_mapping_get_by_index(node, 0) != NULL)
      node = fy_node_pair_key(fy_node_mapping_get_by_index(node, 0));
    else
      break;
  }
  return near;
}

static cf_status convert_pair(const cf_yaml *yaml, struct fy_node_pair *pair, const cf_place near,
                              const int depth, cf_node *map) {
  struct fy_node *name = fy_node_pair_key(pair), *value = fy_node_pair_value(pair);
  cf_node *key, *child;
  if (name == NULL || fy_node_get_type(name) != FYNT_SCALAR || fy_node_is_alias(name))
    return fail(yaml, first_place(yaml, name, near), "a key is a single word here");
  CF_TRY(convert_scalar(yaml, name, near, &key));
  if (key->text[0] == '\0') return fail(yaml, key->place, "a key is missing before the colon");
  if (cf_node_find(map, key->text) != NULL)
    return cf_config_fail(yaml->config, (cf_about){key->place, NULL},
                          "the key %.80s stands here for the second time", key->text);
  if (map->count >= KEYS_MAX) return fail(yaml, key->place, "too many keys in one map");
  if (value != NULL)
    CF_TRY(convert(yaml, value, key->place, depth + 1, &child));
  else
    CF_TRY(cf_node_create(yaml->config, &child, CF_NODE_SCALAR, key->place));
  if (child->kind == CF_NODE_SCALAR && child->text == NULL) child->text = "";
  child->key = key->text;
  child->key_place = key->place;
  if (child->kind == CF_NODE_MAP) child->place = key->place;
  cf_node_add(map, child);
  return CF_OK;
}

static cf_status convert_map(const cf_yaml *yaml, struct fy_node *from, const cf_place near, const int depth,
                             cf_node **node) {
  void *iterator = NULL;
  CF_TRY(cf_node_create(yaml->config, node, CF_NODE_MAP, near));
  for (struct fy_node_pair *pair; (pair = fy_node_mapping_iterate(from, &iterator)) != NULL;) {
    CF_TRY(convert_pair(yaml, pair, near, depth, *node));
    if ((*node)->count == 1) (*node)->place = (*node)->first->key_place;
  }
  return CF_OK;
}

static cf_status convert(const cf_yaml *yaml, struct fy_node *from, const cf_place near, const int depth,
                         cf_node **node) {
  if (depth > CF_SCENE_DEPTH) return fail(yaml, near, "maps and lists are nested too deep");
  if (fy_node_is_alias(from)) {
    const cf_place place = token_place(yaml, fy_node_get_scalar_token(from), FYNS_ALIAS);
    struct fy_node *meant = fy_node_resolve_alias(from);
    if (meant == NULL) return fail(yaml, place, "nothing has this anchor");
    return convert(yaml, meant, place, depth + 1, node);
  }
  switch (fy_node_get_type(from)) {
    case FYNT_SEQUENCE:
      return convert_list(yaml, from, near, depth, node);
    case FYNT_MAPPING:
      return convert_map(yaml, from, near, depth, node);
    default:
      return convert_scalar(yaml, from, near, node);
  }
}

/* --- documents -------------------------------------------------------------------------------- */

/* Messages of the library that say little, and what we say. */
static const char *plainer(const char *message) {
  static const char *const table[][2] = {
      {"invalid multiline plain key",
       "this line and the next do not fit together: is the indentation right?"},
      {"invalid nested block mapping", "a second colon in the line: put the text in quotes"},
      {"wrongly indented flow", "a bracket before this is not closed"},
      {"wrongly indented double-quoted", "the quote that opens here is not closed"},
      {"wrongly indented single-quoted", "the quote that opens here is not closed"},
      {"without a closing bracket", "a bracket is not closed"},
      {"without a closing brace", "a brace is not closed"},
      {"without closing quote", "the quote that opens here is not closed"},
      {"plain scalar cannot start with", "a text that starts with this sign must be in quotes"},
      {"invalid tab used as indentation", "a tab cannot indent: use blanks"},
  };
  for (size_t i = 0; i < sizeof table / sizeof table[0]; ++i)
    if (strstr(message, table[i][0]) != NULL) return table[i][1];
  return message;
}

/* The first error that the library has collected. */
static cf_status syntax_error(const cf_yaml *yaml, struct fy_diag *diag) {
  void *iterator = NULL;
  const struct fy_diag_error *error = fy_diag_errors_iterate(diag, &iterator);
  if (error == NULL) return fail(yaml, (cf_place){yaml->source, yaml->from, 1}, "this is not YAML");
  return cf_config_fail(yaml->config, (cf_about){mark_place(yaml, error->line, error->column), NULL},
                        "%.200s", plainer(error->msg));
}

static cf_status convert_documents(const cf_yaml *yaml, struct fy_parser *parser, struct fy_diag *diag,
                                   cf_node **root) {
  struct fy_document *document = fy_parse_load_document(parser);
  const cf_place start = {yaml->source, yaml->from, 1};
  if (document == NULL && fy_diag_got_error(diag)) return syntax_error(yaml, diag);
  if (document == NULL || fy_document_root(document) == NULL) {
    fy_parse_document_destroy(parser, document);
    return fail(yaml, (cf_place){yaml->source, yaml->from, 0},
                "there is nothing in it: a scene starts with `cattaneo: 1`");
  }
  cf_status status = convert(yaml, fy_document_root(document), start, 0, root);
  fy_parse_document_destroy(parser, document);
  if (status != CF_OK) return status;
  document = fy_parse_load_document(parser);
  if (document == NULL) return fy_diag_got_error(diag) ? syntax_error(yaml, diag) : CF_OK;
  cf_node *second;
  status = fail(yaml, start, "a scene is one YAML document, here is a second one");
  if (fy_document_root(document) != NULL &&
      convert(yaml, fy_document_root(document), start, 0, &second) == CF_OK)
    status = fail(yaml, second->place, "a scene is one YAML document, here starts a second one");
  fy_parse_document_destroy(parser, document);
  return status;
}

cf_status cf_yaml_parse(cf_config *config, const int source, const size_t from, cf_node **root) {
  const cf_yaml yaml = {config, source, from};
  struct fy_diag_cfg diag_cfg;
  fy_diag_cfg_default(&diag_cfg);
  diag_cfg.fp = NULL;
  struct fy_diag *diag = fy_diag_create(&diag_cfg);
  if (diag == NULL) return cf_fail(CF_NO_MEMORY, "no memory to read %s", config->path);
  fy_diag_set_collect_errors(diag, true);
  const struct fy_parse_cfg cfg = {
      .flags = FYPCF_QUIET | FYPCF_COLLECT_DIAG | FYPCF_ALLOW_DUPLICATE_KEYS | FYPCF_JSON_NONE, .diag = diag};
  struct fy_parser *parser = fy_parser_create(&cfg);
  cf_status status = cf_fail(CF_NO_MEMORY, "no memory to read %s", config->path);
  if (parser != NULL && fy_parser_set_string(parser, config->source[source].text + from,
                                             config->source[source].length - from) == 0)
    status = convert_documents(&yaml, parser, diag, root);
  if (parser != NULL) fy_parser_destroy(parser);
  fy_diag_destroy(diag);
  return status;
}
