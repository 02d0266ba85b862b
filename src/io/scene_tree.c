/* SPDX-License-Identifier: MIT
 *
 * The tree of a scene, its memory, look-up by path, and overrides. See scene_tree.h.
 *
 * Overrides: KEY is a path with dots ("diffusion.k", "sources.0.rate", "fields.phi.initial"); maps on the way
 * are made where they are missing, entries of lists must be there. A VALUE that starts with [ { " or ' is
 * YAML, any other is the plain text of a scalar, so `--set title=Cone: H_c = 2` needs no second quotes.
 */
#include "io/scene_tree.h"

#include <limits.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "base/real.h"

struct cf_block {
  struct cf_block *next;
  _Alignas(CF_ALIGN) char bytes[];
};

struct cf_kept {
  struct cf_kept *next;
  cf_expr *expr;
};

/* --- memory ----------------------------------------------------------------------------------- */

cf_status cf_config_new(cf_config *config, void **block, const size_t bytes) {
  struct cf_block *fresh;
  *block = NULL;
  if (bytes > SIZE_MAX / 2) return cf_fail(CF_NO_MEMORY, "%zu bytes: more than can be addressed", bytes);
  CF_TRY(cf_new_array((void **)&fresh, 1, sizeof *fresh + bytes));
  fresh->next = config->blocks;
  config->blocks = fresh;
  *block = fresh->bytes;
  return CF_OK;
}

cf_status cf_config_copy(cf_config *config, const char **copy, const char *text, const size_t length) {
  void *block;
  CF_TRY(cf_config_new(config, &block, length + 1));
  memcpy(block, text, length);
  *copy = block;
  return CF_OK;
}

cf_status cf_config_text(cf_config *config, const char **text, const char *format, ...) {
  char buffer[1024];
  va_list values;
  va_start(values, format);
  vsnprintf(buffer, sizeof buffer, format, values);
  va_end(values);
  return cf_config_copy(config, text, buffer, strlen(buffer));
}

cf_status cf_config_keep(cf_config *config, cf_expr *expr) {
  void *block;
  const cf_status status = cf_config_new(config, &block, sizeof(struct cf_kept));
  if (status != CF_OK) {
    cf_expr_destroy(expr);
    return status;
  }
  struct cf_kept *kept = block;
  *kept = (struct cf_kept){config->kept, expr};
  config->kept = kept;
  return CF_OK;
}

void cf_config_destroy(cf_config *config) {
  if (config == NULL) return;
  for (struct cf_kept *kept = config->kept; kept != NULL; kept = kept->next) cf_expr_destroy(kept->expr);
  for (struct cf_block *block = config->blocks, *next; block != NULL; block = next) {
    next = block->next;
    cf_free(block);
  }
  cf_free(config);
}

/* --- nodes ------------------------------------------------------------------------------------ */

cf_status cf_node_create(cf_config *config, cf_node **node, const cf_node_kind kind, const cf_place place) {
  void *block;
  if (++config->nodes > CF_SCENE_NODES)
    return cf_config_fail(config, (cf_about){place, NULL}, "the scene has more than %d parts",
                          CF_SCENE_NODES);
  CF_TRY(cf_config_new(config, &block, sizeof **node));
  *node = block;
  **node = (cf_node){.kind = kind, .place = place};
  return CF_OK;
}

void cf_node_add(cf_node *parent, cf_node *child) {
  child->next = NULL;
  if (parent->last != NULL)
    parent->last->next = child;
  else
    parent->first = child;
  parent->last = child;
  ++parent->count;
}

static cf_node *find(const cf_node *map, const char *key, const size_t length) {
  if (map->kind != CF_NODE_MAP) return NULL;
  for (cf_node *child = map->first; child != NULL; child = child->next)
    if (strlen(child->key) == length && memcmp(child->key, key, length) == 0) return child;
  return NULL;
}

cf_node *cf_node_find(const cf_node *map, const char *key) { return find(map, key, strlen(key)); }

cf_node *cf_node_at(const cf_node *list, int index) {
  cf_node *child = list->first;
  while (child != NULL && index-- > 0) child = child->next;
  return child;
}

/* The entry that one part of a path names; NULL: there is none. */
static cf_node *step(const cf_node *node, const char *part, const size_t length) {
  if (node->kind == CF_NODE_MAP) return find(node, part, length);
  if (node->kind != CF_NODE_LIST || length == 0 || length > 6) return NULL;
  int index = 0;
  for (size_t i = 0; i < length; ++i) {
    if (part[i] < '0' || part[i] > '9') return NULL;
    index = 10 * index + (part[i] - '0');
  }
  return cf_node_at(node, index);
}

const cf_node *cf_node_find_path(const cf_node *root, const char *path, bool *exact) {
  const cf_node *node = root;
  bool all = root != NULL;
  while (node != NULL && *path != '\0') {
    const size_t length = strcspn(path, ".");
    const cf_node *child = step(node, path, length);
    if (child == NULL) {
      all = false;
      break;
    }
    node = child;
    path += length + (path[length] == '.' ? 1 : 0);
  }
  if (exact != NULL) *exact = all;
  return node;
}

/* --- overrides -------------------------------------------------------------------------------- */

static void replace_child(cf_node *parent, const cf_node *old, cf_node *fresh) {
  fresh->next = old->next;
  if (parent->first == old) parent->first = fresh;
  for (cf_node *child = parent->first; child != NULL; child = child->next)
    if (child->next == old) child->next = fresh;
  if (parent->last == old) parent->last = fresh;
}

static cf_status value_node(cf_config *config, const int source, const size_t from, cf_node **node) {
  const cf_config_source *s = &config->source[source];
  const char *value = s->text + from;
  if (*value != '\0' && strchr("[{\"'", *value) != NULL) return cf_yaml_parse(config, source, from, node);
  size_t length = s->length - from;
  while (length > 0 && value[length - 1] == ' ') --length;
  CF_TRY(cf_node_create(config, node, CF_NODE_SCALAR, (cf_place){source, from, length > 0 ? length : 1}));
  return cf_config_copy(config, &(*node)->text, value, length);
}

/* The entry of `parent` named by a part of the key; a map gets a new one where it has none. */
static cf_status entry(cf_config *config, cf_node *parent, const cf_place part, cf_node **child) {
  const cf_config_source *s = &config->source[part.source];
  const char *name = s->text + part.at;
  const cf_about about = {part, NULL};
  if (parent->kind == CF_NODE_SCALAR && parent->text[0] == '\0') parent->kind = CF_NODE_MAP;
  if (parent->kind == CF_NODE_SCALAR)
    return cf_config_fail(config, about, "%.*s is a single value, it has no %.*s",
                          (int)CF_MIN(part.at > 0 ? part.at - 1 : 0, 80u), s->text,
                          (int)CF_MIN(part.length, 60u), name);
  *child = step(parent, name, part.length);
  if (*child != NULL) return CF_OK;
  if (parent->kind == CF_NODE_LIST)
    return cf_config_fail(config, about, "the list has no entry %.*s: it has %d, counted from 0",
                          (int)CF_MIN(part.length, 60u), name, parent->count);
  CF_TRY(cf_node_create(config, child, CF_NODE_MAP, part));
  CF_TRY(cf_config_copy(config, &(*child)->key, name, part.length));
  (*child)->key_place = part;
  cf_node_add(parent, *child);
  return CF_OK;
}

static cf_status set_value(cf_config *config, const int source, const size_t equals) {
  const char *text = config->source[source].text;
  cf_node *parent = config->root, *child = NULL;
  for (size_t at = 0; at < equals;) {
    const size_t length = CF_MIN(strcspn(text + at, "."), equals - at);
    if (child != NULL) parent = child;
    CF_TRY(entry(config, parent, (cf_place){source, at, CF_MAX(length, 1u)}, &child));
    at += length + 1;
  }
  cf_node *fresh;
  CF_TRY(value_node(config, source, equals + 1, &fresh));
  fresh->key = child->key;
  fresh->key_place = (cf_place){source, 0, equals};
  if (fresh->place.length == 0) fresh->place = fresh->key_place;
  replace_child(parent, child, fresh);
  return CF_OK;
}

/* Where the '=' of KEY=VALUE is; 0 if there is no such form, or a part of the key is empty. */
static size_t key_length(const char *text) {
  const size_t equals = strcspn(text, "=");
  if (text[equals] == '\0' || equals == 0 || text[0] == '.' || text[equals - 1] == '.') return 0;
  for (size_t i = 1; i < equals; ++i)
    if (text[i] == '.' && text[i - 1] == '.') return 0;
  return equals;
}

cf_status cf_override_apply(cf_config *config, const int source) {
  const cf_config_source *s = &config->source[source];
  const cf_place whole = {source, 0, CF_MAX(s->length, 1u)};
  const size_t equals = key_length(s->text);
  if (equals == 0)
    return cf_config_fail(config, (cf_about){whole, NULL},
                          "an override is written KEY=VALUE, as in diffusion.tau=2");
  return set_value(config, source, equals);
}

/* --- text ------------------------------------------------------------------------------------- */

/* Length of the UTF-8 character at the start of `text`, 0 if it is none. */
static size_t character_length(const unsigned char *text, const size_t left) {
  const unsigned char c = text[0];
  if (c < 0x80) return (c >= 0x20 && c != 0x7F) || c == '\t' || c == '\n' || c == '\r' ? 1 : 0;
  const size_t n = c >= 0xC2 && c < 0xE0 ? 2 : c >= 0xE0 && c < 0xF0 ? 3 : c >= 0xF0 && c < 0xF5 ? 4 : 0;
  if (n == 0 || n > left) return 0;
  for (size_t i = 1; i < n; ++i)
    if ((text[i] & 0xC0u) != 0x80u) return 0;
  if ((c == 0xE0 && text[1] < 0xA0) || (c == 0xED && text[1] > 0x9F)) return 0; /* overlong; surrogates */
  if ((c == 0xF0 && text[1] < 0x90) || (c == 0xF4 && text[1] > 0x8F)) return 0; /* overlong; past the last */
  if (c == 0xC2 && text[1] < 0xA0) return 0;                                    /* control characters */
  return n;
}

ptrdiff_t cf_text_bad_byte(const char *text, const size_t length) {
  for (size_t i = 0, n; i < length; i += n) {
    n = character_length((const unsigned char *)text + i, length - i);
    if (n == 0) return (ptrdiff_t)i;
  }
  return -1;
}
