/* SPDX-License-Identifier: MIT
 *
 * Opens a scene and matches its tree against the tables: keys that no row has, rows that no key gives,
 * records, lists and maps of records. Single values are read in scene_value.c.
 */
#define _GNU_SOURCE
#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>

#include "base/mem.h"
#include "base/real.h"
#include "io/folder.h"
#include "io/scene_value.h"

enum { NAME_MAX_LENGTH = 63, ENTRIES_MAX = 1000 };

/* --- files ------------------------------------------------------------------------------------ */

static cf_status fail_file(const char *path, const char *why) {
  const size_t length = strlen(path);
  return cf_fail(CF_BAD_SCENE, "%s: error: %s\ntry: cattaneo examples",
                 path + (length > 200 ? length - 200 : 0), why);
}

static cf_status read_stream(cf_config *config, FILE *stream, const char *path) {
  char why[120];
  struct stat about;
  if (fstat(fileno(stream), &about) != 0) return fail_file(path, strerror(errno));
  if (S_ISDIR(about.st_mode)) return fail_file(path, "this is a folder, a scene is a file");
  if (!S_ISREG(about.st_mode)) return fail_file(path, "this is not a file");
  if (about.st_size > CF_SCENE_BYTES) {
    snprintf(why, sizeof why, "the file has %.1f MB, a scene has at most %ld MB",
             (double)about.st_size / 1048576.0, CF_SCENE_BYTES >> 20);
    return fail_file(path, why);
  }
  void *block;
  const size_t room = (size_t)about.st_size;
  CF_TRY(cf_config_new(config, &block, room + 1));
  config->source[0].text = block;
  config->source[0].length = fread(block, 1, room, stream);
  if (ferror(stream)) return fail_file(path, strerror(errno));
  return CF_OK;
}

static cf_status read_file(cf_config *config, const char *path) {
  if (path[0] == '\0')
    return cf_fail(CF_BAD_SCENE, "'': error: the name of the scene is empty\ntry: cattaneo examples");
  FILE *stream = cf_file_stream(path);
  if (stream == NULL) return fail_file(path, errno == ENOENT ? "there is no such file" : strerror(errno));
  const cf_status status = read_stream(config, stream, path);
  fclose(stream);
  return status;
}

/* --- open ------------------------------------------------------------------------------------- */

static cf_status check_text(const cf_config *config, const int source) {
  const cf_config_source *s = &config->source[source];
  const ptrdiff_t bad = cf_text_bad_byte(s->text, s->length);
  if (bad < 0) return CF_OK;
  int line = 1;
  for (ptrdiff_t i = 0; i < bad; ++i) line += s->text[i] == '\n' ? 1 : 0;
  return cf_config_fail(config, (cf_about){{source, 0, 0}, NULL},
                        "this is not UTF-8 text: byte 0x%02X at offset %td, line %d",
                        (unsigned char)s->text[bad], bad, line);
}

static cf_status keep_paths(cf_config *config, const char *path) {
  const char *slash = strrchr(path, '/');
  CF_TRY(cf_config_copy(config, &config->path, path, strlen(path)));
  if (slash == NULL) return cf_config_copy(config, &config->folder, ".", 1);
  return cf_config_copy(config, &config->folder, path, CF_MAX((size_t)(slash - path), 1u));
}

static cf_status keep_sources(cf_config *config, const char *path, const cf_overrides *overrides) {
  void *block;
  config->sources = 1 + overrides->count;
  CF_TRY(cf_config_new(config, &block, (size_t)config->sources * sizeof *config->source));
  config->source = block;
  CF_TRY(keep_paths(config, path));
  config->source[0].name = config->path;
  for (int i = 0; i < overrides->count; ++i) {
    cf_config_source *s = &config->source[i + 1];
    const size_t length = strlen(overrides->set[i]);
    CF_TRY(cf_config_copy(config, &s->text, overrides->set[i], length));
    s->name = "--set";
    s->length = length;
  }
  return CF_OK;
}

static cf_status open_all(cf_config *config, const char *path, const cf_overrides *overrides) {
  CF_TRY(keep_sources(config, path, overrides));
  CF_TRY(read_file(config, path));
  for (int i = 0; i < config->sources; ++i) CF_TRY(check_text(config, i));
  CF_TRY(cf_yaml_parse(config, 0, 0, &config->root));
  config->root->place.length = config->root->kind == CF_NODE_MAP ? 0 : config->root->place.length;
  if (config->root->kind != CF_NODE_MAP)
    return cf_config_fail(config, (cf_about){config->root->place, ""}, "a scene is a map of keys to values");
  for (int i = 1; i < config->sources; ++i) CF_TRY(cf_override_apply(config, i));
  return CF_OK;
}

cf_status cf_config_open(cf_config **config, const cf_param_table *root, const char *path,
                         const cf_overrides *overrides) {
  const cf_overrides none = {0, NULL};
  *config = NULL;
  cf_config *fresh;
  CF_TRY(CF_NEW(&fresh, 1));
  fresh->table = root;
  const cf_status status = open_all(fresh, path, overrides != NULL ? overrides : &none);
  if (status != CF_OK) {
    cf_config_destroy(fresh);
    return status;
  }
  *config = fresh;
  return CF_OK;
}

const char *cf_config_path(const cf_config *config) { return config->path; }
const char *cf_config_folder(const cf_config *config) { return config->folder; }

/* --- records ---------------------------------------------------------------------------------- */

static cf_status read_record(cf_reader *reader, const cf_param_table *table, const cf_node *node,
                             char *record);

/* The default of a list of numbers, "[1e-3, 3e-3]". */
static cf_status read_default_list(cf_reader *reader, const cf_param *param, const cf_node *near,
                                   char *record) {
  cf_node entry[3], list = {.kind = CF_NODE_LIST, .place = near->place, .first = entry};
  char text[128];
  snprintf(text, sizeof text, "%s", cf_param_default(param));
  for (char *at = text + strspn(text, "[, ]"); *at != '\0' && list.count < 3;) {
    const size_t n = strcspn(at, ",]");
    entry[list.count] = (cf_node){.kind = CF_NODE_SCALAR, .place = near->place, .text = at};
    if (list.count > 0) entry[list.count - 1].next = &entry[list.count];
    ++list.count;
    at += n;
    if (*at != '\0') *at++ = '\0';
    at += strspn(at, "[, ]");
  }
  return cf_value_read(reader, param, &list, record + param->offset);
}

/* A row that nothing was written for. */
static cf_status read_default(cf_reader *reader, const cf_param *param, const cf_node *near, char *record) {
  cf_node node = {.kind = CF_NODE_SCALAR, .place = near->place, .text = cf_param_default(param)};
  if (param->table != NULL) {
    const bool single = param->type == CF_PARAM_record || param->type == CF_PARAM_optional;
    node = (cf_node){.kind = CF_NODE_MAP, .place = near->place};
    return single ? read_record(reader, param->table, &node, record + param->offset) : CF_OK;
  }
  if (param->fallback == CF_REQUIRED) return cf_reader_fail(reader, near, "%s is missing", reader->path);
  if (param->type == CF_PARAM_number && node.text == NULL) *(double *)(void *)(record + param->offset) = NAN;
  if (node.text == NULL) return CF_OK;
  if (node.text[0] == '[' && param->type != CF_PARAM_words)
    return read_default_list(reader, param, near, record);
  return cf_value_read(reader, param, &node, record + param->offset);
}

static void set_key(const cf_param_table *table, char *record, const char *key) {
  for (int i = 0; i < table->count; ++i)
    if (table->param[i].type == CF_PARAM_key) memcpy(record + table->param[i].offset, &key, sizeof key);
}

/* The name of an entry of a map: what may stand in a file name and in a table's head. */
static cf_status check_name(cf_reader *reader, const cf_node *entry) {
  static const char letters[] = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ_";
  static const char more[] = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ_0123456789";
  const size_t length = strlen(entry->key);
  if (strspn(entry->key, letters) > 0 && strspn(entry->key, more) == length && length <= NAME_MAX_LENGTH)
    return CF_OK;
  cf_node named = *entry;
  named.place = entry->key_place;
  return cf_reader_fail(reader, &named,
                        "%.80s is not a name: letters, digits and _, a letter first, %d at most", entry->key,
                        NAME_MAX_LENGTH);
}

/* A list or a map of records. */
static cf_status read_items(cf_reader *reader, const cf_param *param, const cf_node *node, char *member) {
  const bool map = param->type == CF_PARAM_map;
  const bool empty = node->kind == CF_NODE_SCALAR && node->text[0] == '\0';
  void *block;
  if (!empty && node->kind != (map ? CF_NODE_MAP : CF_NODE_LIST))
    return cf_reader_fail(reader, node, "%s is a %s, expected: %s", reader->path,
                          node->kind == CF_NODE_SCALAR ? "single value"
                          : map                        ? "list"
                                                       : "map",
                          cf_param_type_name(param->type));
  if (node->count > ENTRIES_MAX)
    return cf_reader_fail(reader, node, "%s has %d entries: at most %d", reader->path, node->count,
                          ENTRIES_MAX);
  CF_TRY(cf_config_new(reader->config, &block, (size_t)node->count * param->table->size));
  cf_param_items_set(member, (cf_param_items){node->count, block});
  const cf_node *entry = node->first;
  for (int i = 0; entry != NULL; ++i, entry = entry->next) {
    char index[16], *record = (char *)block + (size_t)i * param->table->size;
    snprintf(index, sizeof index, "%d", i);
    const size_t length = cf_reader_enter(reader, map ? entry->key : index);
    if (map) CF_TRY(check_name(reader, entry));
    if (map) set_key(param->table, record, entry->key);
    CF_TRY(read_record(reader, param->table, entry, record));
    cf_reader_leave(reader, length);
  }
  return CF_OK;
}

static cf_status read_row(cf_reader *reader, const cf_param *param, const cf_node *parent, char *record) {
  const cf_node *node = cf_node_find(parent, param->name);
  const size_t length = cf_reader_enter(reader, param->name);
  char *member = record + param->offset;
  *(bool *)(void *)(record + param->given) = node != NULL;
  if (node == NULL)
    CF_TRY(read_default(reader, param, parent, record));
  else if (param->type == CF_PARAM_record || param->type == CF_PARAM_optional)
    CF_TRY(read_record(reader, param->table, node, member));
  else if (param->table != NULL)
    CF_TRY(read_items(reader, param, node, member));
  else
    CF_TRY(cf_value_read(reader, param, node, member));
  cf_reader_leave(reader, length);
  return CF_OK;
}

static cf_status fail_unknown(const cf_reader *reader, const cf_param_table *table, const cf_node *entry) {
  char meant[256];
  const cf_about about = {entry->key_place, reader->path};
  const char *near = cf_param_nearest(table, entry->key);
  const char *in = reader->length > 0 ? " in " : "";
  if (near != NULL)
    return cf_config_fail(reader->config, about, "unknown key %.60s%s%s: did you mean %s?", entry->key, in,
                          reader->path, near);
  if (cf_param_nearest_path(reader->config->table, entry->key, meant, sizeof meant))
    return cf_config_fail(reader->config, about, "unknown key %.60s%s%s: did you mean %s?", entry->key, in,
                          reader->path, meant);
  if (entry->key[strspn(entry->key, "0123456789")] == '\0')
    return cf_config_fail(reader->config, about,
                          "unknown key %.60s%s%s: numbers have a point, 0.5, and no comma", entry->key, in,
                          reader->path);
  return cf_config_fail(reader->config, about, "unknown key %.60s%s%s", entry->key, in, reader->path);
}

static cf_status read_record(cf_reader *reader, const cf_param_table *table, const cf_node *node,
                             char *record) {
  const bool empty = node->kind == CF_NODE_SCALAR && node->text[0] == '\0';
  if (node->kind != CF_NODE_MAP && !empty)
    return cf_reader_fail(reader, node, "%s is a %s, expected: map of keys to values", reader->path,
                          node->kind == CF_NODE_LIST ? "list" : "single value");
  for (const cf_node *entry = node->first; entry != NULL; entry = entry->next)
    if (cf_param_find(table, entry->key) == NULL) return fail_unknown(reader, table, entry);
  for (int i = 0; i < table->count; ++i)
    if (table->param[i].type != CF_PARAM_key) CF_TRY(read_row(reader, &table->param[i], node, record));
  return CF_OK;
}

/* `let` names the constants for all other keys, wherever it stands in the file. */
static cf_status read_constants(cf_reader *reader, const cf_param_table *table, const cf_node *node,
                                char *record) {
  const cf_param *let = cf_param_find(table, "let");
  if (let == NULL || let->type != CF_PARAM_constants) return CF_OK;
  return read_row(reader, let, node, record);
}

cf_status cf_config_read(cf_config *config, void *record) {
  cf_reader reader = {.config = config};
  CF_TRY(read_constants(&reader, config->table, config->root, record));
  reader.length = 0;
  reader.path[0] = '\0';
  return read_record(&reader, config->table, config->root, record);
}

cf_status cf_config_fill(cf_config *config, const cf_param_table *table, void *record) {
  cf_reader reader = {.config = config};
  const cf_node near = {.kind = CF_NODE_MAP};
  for (int i = 0; i < table->count; ++i) {
    const cf_param *param = &table->param[i];
    if (param->type != CF_PARAM_key && param->fallback != CF_REQUIRED)
      CF_TRY(read_default(&reader, param, &near, record));
  }
  return CF_OK;
}
