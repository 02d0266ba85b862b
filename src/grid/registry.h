/* SPDX-License-Identifier: MIT
 *
 * Everything that is state, listed once. Output, checkpoints, resume, previews and `info` walk this list;
 * what is not in it is not state and will not survive a stop.
 *
 * An entry points at memory that somebody else owns and that must outlive the registry. Particle arrays may
 * move when they grow, so their entry holds the address of the owner's pointer and of its count.
 */
#ifndef CF_GRID_REGISTRY_H
#define CF_GRID_REGISTRY_H

#include <stdint.h>

#include "grid/field.h"
#include "grid/grid.h"

typedef enum cf_kind {
  CF_KIND_CELL,
  CF_KIND_FACE,
  CF_KIND_PARTICLE,
  CF_KIND_NUMBER,
  CF_KIND_COUNTER
} cf_kind;

typedef struct cf_entry {
  char name[CF_NAME_MAX];
  char unit[CF_NAME_MAX]; /* "" where unknown or dimensionless */
  cf_kind kind;
  cf_cell cell;         /* CF_KIND_CELL */
  cf_face face;         /* CF_KIND_FACE */
  cf_real **particles;  /* CF_KIND_PARTICLE: the owner's array, components of a particle side by side */
  const int64_t *count; /* CF_KIND_PARTICLE: how many there are */
  int components;       /* CF_KIND_PARTICLE: 1 or dim; CF_KIND_NUMBER: how many numbers */
  double *number;       /* CF_KIND_NUMBER */
  int64_t *counter;     /* CF_KIND_COUNTER: steps, noise counters */
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
cf_status cf_registry_add_particles(cf_registry *r, const cf_entry *particles);
cf_status cf_registry_add_numbers(cf_registry *r, const char *name, const char *unit, double *number,
                                  int count);
cf_status cf_registry_add_counter(cf_registry *r, const char *name, int64_t *counter);

/* NULL where there is none of that name. */
const cf_entry *cf_registry_find(const cf_registry *r, const char *name);

#endif
