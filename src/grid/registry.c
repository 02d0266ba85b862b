/* SPDX-License-Identifier: MIT */
#include "grid/registry.h"

#include <stdio.h>
#include <string.h>

#include "base/mem.h"

cf_status cf_registry_init(cf_registry *r, const cf_grid *g) {
  *r = (cf_registry){.grid = g, .room = 64};
  return CF_NEW(&r->entry, r->room);
}

void cf_registry_clear(cf_registry *r) {
  cf_free(r->entry);
  *r = (cf_registry){0};
}

const cf_entry *cf_registry_find(const cf_registry *r, const char *name) {
  for (int e = 0; e < r->count; ++e)
    if (strcmp(r->entry[e].name, name) == 0) return &r->entry[e];
  return NULL;
}

static cf_status grow(cf_registry *r) {
  cf_entry *more;
  CF_TRY(CF_NEW(&more, 2 * r->room));
  memcpy(more, r->entry, (size_t)r->count * sizeof *more);
  cf_free(r->entry);
  r->entry = more;
  r->room *= 2;
  return CF_OK;
}

static cf_status add(cf_registry *r, const char *name, const char *unit, cf_entry entry) {
  if (name[0] == '\0' || strlen(name) >= CF_NAME_MAX)
    return cf_fail(CF_BAD_ARGUMENT, "state named \"%s\": a name has 1 to %d letters", name, CF_NAME_MAX - 1);
  if (cf_registry_find(r, name) != NULL)
    return cf_fail(CF_BAD_ARGUMENT, "two pieces of state are named \"%s\"", name);
  if (r->count == r->room) CF_TRY(grow(r));
  snprintf(entry.name, sizeof entry.name, "%s", name);
  snprintf(entry.unit, sizeof entry.unit, "%s", unit);
  r->entry[r->count++] = entry;
  return CF_OK;
}

cf_status cf_registry_add_cell(cf_registry *r, const char *name, const char *unit, const cf_cell f) {
  return add(r, name, unit, (cf_entry){.kind = CF_KIND_CELL, .cell = f, .components = 1});
}

cf_status cf_registry_add_face(cf_registry *r, const char *name, const char *unit, const cf_face f) {
  return add(r, name, unit, (cf_entry){.kind = CF_KIND_FACE, .face = f, .components = r->grid->box.dim});
}

cf_status cf_registry_add_particles(cf_registry *r, cf_particles *set) {
  return add(r, set->name, "", (cf_entry){.kind = CF_KIND_PARTICLES, .particles = set, .components = 1});
}

cf_status cf_registry_add_numbers(cf_registry *r, const char *name, const char *unit, double *number,
                                  const int count) {
  return add(r, name, unit, (cf_entry){.kind = CF_KIND_NUMBER, .number = number, .components = count});
}

cf_status cf_registry_add_counter(cf_registry *r, const char *name, int64_t *counter) {
  return add(r, name, "", (cf_entry){.kind = CF_KIND_COUNTER, .counter = counter, .components = 1});
}

cf_status cf_registry_add_all(cf_registry *r, const cf_registry *from) {
  for (int e = 0; e < from->count; ++e)
    CF_TRY(add(r, from->entry[e].name, from->entry[e].unit, from->entry[e]));
  return CF_OK;
}
