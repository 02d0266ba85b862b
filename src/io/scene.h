/* SPDX-License-Identifier: MIT
 *
 * Scene files, whatever is in them: YAML into the structs of a root table (base/param.h), and back.
 *
 * A scene is read in three passes. The text becomes a tree of maps, lists and scalars, each with its place
 * (scene_yaml.c). Overrides (KEY=VALUE from a command line) replace parts of the tree (scene_tree.c). The
 * tree is matched against the tables and fills the structs (scene_read.c), with the defaults for what is left
 * out.
 *
 * All scalars are text until a row says what they are: no yes/no or 1e-3 traps. An error names the place,
 * shows the line and suggests:
 *
 *     ink.yaml:18:6: error: diffusion.k has unit m/s, expected m^2/s
 *       k: 1e-3 m/s
 *          ^~~~~~~~
 *     try: cattaneo explain diffusion.k
 *
 * Limits, so that no file can exhaust the machine: CF_SCENE_BYTES, CF_SCENE_NODES, CF_SCENE_DEPTH.
 */
#ifndef CF_IO_SCENE_H
#define CF_IO_SCENE_H

#include <stdbool.h>
#include <stddef.h>

#include "base/param.h"
#include "base/status.h"

#define CF_SCENE_BYTES (4L << 20)
#define CF_SCENE_NODES 100000
#define CF_SCENE_DEPTH 32

/* What stays of a file: its tree with the places, and the memory of everything the structs point to. */
typedef struct cf_config cf_config;

/* KEY=VALUE, as given after --set; VALUE is YAML. */
typedef struct cf_overrides {
  int count;
  const char *const *set;
} cf_overrides;

/* Reads the file at `path`, and the overrides, into a tree; nothing is matched yet. CF_BAD_SCENE for a file
 * that is not there, is not text, is not YAML, or is not a map. On failure nothing is left behind. */
cf_status cf_config_open(cf_config **config, const cf_param_table *root, const char *path,
                         const cf_overrides *overrides);

/* Matches the tree against the root table and fills `record`, a zeroed struct of that table. A root row `let`
 * of type constants is read first and names the constants for all other keys. CF_BAD_SCENE for what does not
 * match. */
cf_status cf_config_read(cf_config *config, void *record);

/* Frees the tree and everything the structs point to; NULL is fine. */
void cf_config_destroy(cf_config *config);

const char *cf_config_path(const cf_config *config); /* as it was given */
const char *cf_config_folder(
    const cf_config *config); /* what paths in the scene are relative to; "." at least */

/* CF_BAD_SCENE with a sentence at the place of `key` ("diffusion.k", "sources.0.rate", "domain.cells.1"), or
 * of the nearest enclosing key that was written down. The message names the key only if the sentence does. */
cf_status cf_config_fail_at(const cf_config *config, const char *key, const char *format, ...)
    CF_PRINTF(3, 4);

/* Whether the file or an override has `key`; and the text written for it, NULL if it is no single value. */
bool cf_config_has(const cf_config *config, const char *key);
const char *cf_config_scalar(const cf_config *config, const char *key);

/* Fills a record with the defaults of its table, as if it stood empty in the file (rows that are required
 * stay zero). */
cf_status cf_config_fill(cf_config *config, const cf_param_table *table, void *record);

/* Zeroed memory, and text, that live as long as the configuration. */
cf_status cf_config_new(cf_config *config, void **block, size_t bytes);
cf_status cf_config_text(cf_config *config, const char **text, const char *format, ...) CF_PRINTF(3, 4);

/* The struct as YAML, with every default filled in, such that reading it again gives the same struct: numbers
 * with 17 digits, expressions as given. Keys of the root that `writes` says no to are left out (NULL: none). The
 * text is the caller's: cf_free. */
cf_status cf_config_write(const cf_param_table *root, const void *record,
                          bool (*writes)(const void *record, const char *key), char **text);

/* What the tables say about `key`, or about all keys if it is NULL. The text is the caller's: cf_free.
 * CF_BAD_USAGE: there is no such key (and which one might have been meant). */
cf_status cf_config_explain(const cf_param_table *root, const char *key, char **text);

#endif
