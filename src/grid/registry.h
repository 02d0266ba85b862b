/* SPDX-License-Identifier: MIT
 *
 * Everything that is state, listed once. Output, checkpoints, resume, previews and `info` walk this list;
 * what is not in it is not state and will not survive a stop.
 *
 * An entry points at memory that somebody else owns and that must outlive the registry. A set of particles is one
 * entry: its order, ids and carried attributes (grid/particles.h) are state, and their number may change.
 */
#ifndef CF_GRID_REGISTRY_H
#define CF_GRID_REGISTRY_H

#include <stdint.h>

#include "grid/field.h"
#include "grid/grid.h"
#include "grid/particles.h"

typedef enum cf_kind {
  CF_KIND_CELL,
  CF_KIND_FACE,
  CF_KIND_PARTICLES,
  CF_KIND_NUMBER,
  CF_KIND_COUNTER
} cf_kind;

typedef struct cf_entry {
  char name[CF_NAME_MAX];
  char unit[CF_NAME_MAX]; /* "" where unknown or dimensionless */
  cf_kind kind;
  cf_cell cell;            /* CF_KIND_CELL */
  cf_face face;            /* CF_KIND_FACE */
  cf_particles *particles; /* CF_KIND_PARTICLES */
  double *number;          /* CF_KIND_NUMBER */
  int components;          /* CF_KIND_NUMBER: how many numbers; CF_KIND_FACE: dim; else 1 */
  int64_t *counter;        /* CF_KIND_COUNTER: steps, noise counters */
} cf_entry;

typedef struct cf_registry {
  const cf_grid *grid;
  int count, room;
  cf_entry *entry;
} cf_registry;

cf_status cf_registry_init(cf_registry *r, const cf_grid *g);
void cf_registry_clear(cf_registry *r); /* frees the list, not the state */

/* Each adds one entry. CF_BAD_ARGUMENT: the name is taken, empty or too long. */
cf_status cf_registry_add_cell(cf_registry *r, const char *name, const char *unit, cf_cell f);
cf_status cf_registry_add_face(cf_registry *r, const char *name, const char *unit, cf_face f);
cf_status cf_registry_add_particles(cf_registry *r, cf_particles *set);
cf_status cf_registry_add_numbers(cf_registry *r, const char *name, const char *unit, double *number,
                                  int count);
cf_status cf_registry_add_counter(cf_registry *r, const char *name, int64_t *counter);

/* All of `from`, for a list that shows more than state: the memory is shared. */
cf_status cf_registry_add_all(cf_registry *r, const cf_registry *from);

/* NULL where there is none of that name. */
const cf_entry *cf_registry_find(const cf_registry *r, const char *name);

#endif
