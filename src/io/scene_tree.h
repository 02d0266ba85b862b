/* SPDX-License-Identifier: MIT
 *
 * The tree of a scene: maps, lists and scalars, each with the place it was written at; and the memory that
 * goes with it. Inside io only; the outside sees cf_config (scene.h).
 *
 * A place is a source (0: the file, then one for each override), and bytes in its text. Lines and columns are
 * counted when a message needs them.
 */
#ifndef CF_IO_SCENE_TREE_H
#define CF_IO_SCENE_TREE_H

#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>

#include "base/status.h"
#include "io/expr.h"
#include "io/scene.h"

typedef struct cf_place {
  int source;
  size_t at, length; /* length 0: nothing to underline, only a source */
} cf_place;

typedef enum cf_node_kind { CF_NODE_SCALAR, CF_NODE_MAP, CF_NODE_LIST } cf_node_kind;

typedef struct cf_node {
  cf_node_kind kind;
  const char *key; /* in a map; else NULL */
  cf_place key_place;
  const char *text; /* of a scalar */
  bool quoted;
  cf_place place; /* of a scalar; of a map or list: its first entry, or its key */
  int count;      /* entries */
  struct cf_node *first, *last, *next;
} cf_node;

typedef struct cf_config_source {
  const char *name, *text;
  size_t length;
} cf_config_source;

struct cf_config {
  const char *path, *folder;
  cf_config_source *source;
  int sources;
  int nodes; /* made so far, against CF_SCENE_NODES */
  cf_node *root;
  const cf_param_table *table; /* of the root */
  struct cf_block *blocks;     /* memory that goes with the configuration */
  struct cf_kept *kept;        /* expressions that go with it */
};

/* Memory and expressions that are freed with the configuration. */
cf_status cf_config_copy(cf_config *config, const char **copy, const char *text, size_t length);
cf_status cf_config_keep(cf_config *config, cf_expr *expr); /* takes it over, also when it fails */

cf_status cf_node_create(cf_config *config, cf_node **node, cf_node_kind kind, cf_place place);
void cf_node_add(cf_node *parent, cf_node *child);
cf_node *cf_node_find(const cf_node *map, const char *key);
cf_node *cf_node_at(const cf_node *list, int index);

/* The node at a path with dots, or the nearest above it; `exact` (may be NULL): whether it is the one asked
 * for. */
const cf_node *cf_node_find_path(const cf_node *root, const char *path, bool *exact);

/* A text that could not be shown: not UTF-8, or with control characters. The place of the first bad byte, or
 * -1. */
ptrdiff_t cf_text_bad_byte(const char *text, size_t length);

/* YAML text of `source` (scene_yaml.c). */
cf_status cf_yaml_parse(cf_config *config, int source, size_t from, cf_node **root);

/* Replaces what an override KEY=VALUE names. */
cf_status cf_override_apply(cf_config *config, int source);

/* Where and about which key a message is. */
typedef struct cf_about {
  cf_place place;
  const char *key; /* for "try: cattaneo explain KEY"; NULL: no such line */
} cf_about;

/* CF_BAD_SCENE with the whole message (scene_fail.c). */
cf_status cf_config_fail(const cf_config *config, cf_about about, const char *format, ...) CF_PRINTF(3, 4);
cf_status cf_config_vfail(const cf_config *config, cf_about about, const char *format, va_list values);

#endif
