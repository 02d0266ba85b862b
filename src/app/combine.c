/* SPDX-License-Identifier: MIT */
#include "app/combine.h"

#include <ctype.h>
#include <stdbool.h>
#include <stdio.h>
#include <string.h>

#include "base/mem.h"
#include "base/real.h"

/* The end of the value that starts at `at`: a comma outside of brackets and quotes, or the end of the text. */
static const char *value_end(const char *at) {
  int depth = 0;
  char quote = '\0';
  for (; *at != '\0'; ++at) {
    if (quote != '\0') {
      if (*at == quote) quote = '\0';
    } else if (*at == '"' || *at == '\'') {
      quote = *at;
    } else if (strchr("([{", *at) != NULL) {
      ++depth;
    } else if (strchr(")]}", *at) != NULL) {
      --depth;
    } else if (*at == ',' && depth <= 0) {
      break;
    }
  }
  return at;
}

static const char *trimmed(char *from, char *end) {
  while (*from == ' ') ++from;
  while (end > from && end[-1] == ' ') --end;
  *end = '\0';
  return from;
}

/* Takes "KEY=A,B,C", which is cut into pieces. */
static cf_status read_axis(cf_grid_axis *axis, char *text) {
  char *at = strchr(text, '=');
  axis->key = trimmed(text, at++);
  int count = 1;
  for (const char *end = value_end(at); *end != '\0'; end = value_end(end + 1)) ++count;
  CF_TRY(CF_NEW(&axis->value, count));
  for (bool last = false; !last;) {
    char *end = at + (value_end(at) - at);
    last = *end == '\0';
    const char *value = trimmed(at, end);
    if (*value == '\0') return cf_fail(CF_BAD_USAGE, "--grid %s: a value is empty", axis->key);
    for (int i = 0; i < axis->count; ++i)
      if (strcmp(axis->value[i], value) == 0)
        return cf_fail(CF_BAD_USAGE, "--grid %s: %s is there twice", axis->key, value);
    axis->value[axis->count++] = value;
    at = end + 1;
  }
  return CF_OK;
}

static const char *last_part(const char *key) {
  const char *dot = strrchr(key, '.');
  return dot != NULL && dot[1] != '\0' ? dot + 1 : key;
}

static cf_status label_axes(cf_combinations *c) {
  for (int i = 0; i < c->axes; ++i) {
    c->axis[i].label = last_part(c->axis[i].key);
    for (int j = 0; j < c->axes; ++j) {
      if (j == i) continue;
      if (strcmp(c->axis[i].key, c->axis[j].key) == 0)
        return cf_fail(CF_BAD_USAGE, "--grid %s: is there twice", c->axis[i].key);
      if (strcmp(last_part(c->axis[i].key), last_part(c->axis[j].key)) == 0)
        c->axis[i].label = c->axis[i].key;
    }
  }
  return CF_OK;
}

/* --- names ------------------------------------------------------------------------------------------------ */

/* The name of a scene file without folder and ending. */
static int scene_name(const char *path, const char **name) {
  const char *slash = strrchr(path, '/');
  *name = slash != NULL ? slash + 1 : path;
  const char *dot = strrchr(*name, '.');
  return (int)(dot != NULL && dot != *name ? dot - *name : (long)strlen(*name));
}

/* Letters, digits and a few marks; a name must need no quotes in a shell. */
static void make_plain(char *name) {
  for (; *name != '\0'; ++name)
    if (!isalnum((unsigned char)*name) && strchr("=.+-_", *name) == NULL) *name = '_';
}

static cf_status name_run(const cf_combinations *c, const char *scene, cf_combination *run) {
  size_t n = 0, m = 0;
  if (scene != NULL) {
    const char *start;
    const int length = scene_name(scene, &start);
    n += (size_t)snprintf(run->name, sizeof run->name, "%.*s", length, start);
    m += (size_t)snprintf(run->caption, sizeof run->caption, "%.*s", length, start);
  }
  for (int i = 0; i < c->axes && n < sizeof run->name; ++i) {
    n += (size_t)snprintf(run->name + n, sizeof run->name - n, "%s%s=%s", n > 0 ? "-" : "", c->axis[i].label,
                          run->value[i]);
    if (m < sizeof run->caption)
      m += (size_t)snprintf(run->caption + m, sizeof run->caption - m, "%s%s = %s", m > 0 ? ", " : "",
                            c->axis[i].label, run->value[i]);
  }
  if (n >= sizeof run->name)
    return cf_fail(CF_BAD_USAGE, "--grid: %.60s... makes too long a name for a folder", run->name);
  make_plain(run->name);
  return CF_OK;
}

static cf_status check_names(const cf_combinations *c) {
  for (int i = 0; i < c->count; ++i)
    for (int j = 0; j < i; ++j)
      if (strcmp(c->item[i].name, c->item[j].name) == 0)
        return cf_fail(CF_BAD_USAGE, "two of the runs would be called %s", c->item[i].name);
  return CF_OK;
}

/* --- combinations ------------------------------------------------------------------------------------------ */

static cf_status fill_run(const cf_combinations *c, char *const *scene, const int scenes, const int number) {
  cf_combination *run = &c->item[number];
  int rest = number;
  for (int i = c->axes - 1; i >= 0; --i) {
    const cf_grid_axis *axis = &c->axis[i];
    run->value[i] = axis->value[rest % axis->count];
    rest /= axis->count;
    const size_t size = strlen(axis->key) + strlen(run->value[i]) + 2;
    CF_TRY(CF_NEW(&run->set[i], size));
    snprintf(run->set[i], size, "%s=%s", axis->key, run->value[i]);
  }
  run->scene = rest;
  return name_run(c, scenes > 1 ? scene[rest] : NULL, run);
}

/* One text that holds all the grids, for the pieces to point to. */
static cf_status copy_grids(cf_combinations *c, const int grids, const char *const *grid) {
  size_t bytes = 1;
  for (int i = 0; i < grids; ++i) bytes += strlen(grid[i]) + 1;
  CF_TRY(CF_NEW(&c->texts, bytes));
  char *at = c->texts;
  for (int i = 0; i < grids; ++i) {
    const size_t length = strlen(grid[i]) + 1;
    memcpy(at, grid[i], length);
    ++c->axes;
    CF_TRY(read_axis(&c->axis[i], at));
    at += length;
  }
  return label_axes(c);
}

static cf_status make(cf_combinations *c, const int scenes, char *const *scene, const int grids,
                      const char *const *grid) {
  if (grids > CF_GRIDS_MAX) return cf_fail(CF_BAD_USAGE, "%d times --grid: at most %d", grids, CF_GRIDS_MAX);
  CF_TRY(copy_grids(c, grids, grid));
  double count = scenes;
  for (int i = 0; i < c->axes; ++i) count *= c->axis[i].count;
  if (count > CF_COMBINATIONS_MAX)
    return cf_fail(CF_BAD_USAGE, "%.0f runs: at most %d", count, CF_COMBINATIONS_MAX);
  CF_TRY(CF_NEW(&c->item, (int)count));
  c->count = (int)count;
  for (int i = 0; i < c->count; ++i) CF_TRY(fill_run(c, scene, scenes, i));
  return check_names(c);
}

cf_status cf_combinations_make(cf_combinations *c, const int scenes, char *const *scene, const int grids,
                               const char *const *grid) {
  *c = (cf_combinations){.axes = 0};
  const cf_status status = make(c, scenes, scene, grids, grid);
  if (status != CF_OK) cf_combinations_clear(c);
  return status;
}

void cf_combinations_clear(cf_combinations *c) {
  for (int i = 0; c->item != NULL && i < c->count; ++i)
    for (int a = 0; a < c->axes; ++a) cf_free(c->item[i].set[a]);
  for (int a = 0; a < c->axes; ++a) cf_free(c->axis[a].value);
  cf_free(c->item);
  cf_free(c->texts);
  *c = (cf_combinations){.axes = 0};
}
