/* SPDX-License-Identifier: MIT
 *
 * A named set of particles ("gel", "tracers"): an id each, and attributes of 1 to 9 components, every component an
 * array of its own, so that kernels run along particles as they run along rows of cells:
 *
 *     cf_particles_create(&set, "gel", 3, room);                     // attribute 0 is `position`, dim components
 *     cf_particles_attribute(set, "velocity", "m/s", 3, CF_CARRIED, &v);
 *     cf_particles_append(set, n, &first);
 *     cf_registry_add_particles(registry, set);                      // once: all of it is state from now on
 *     ...
 *     cf_real *const *u = set->attribute[v].at;                      // u[a][i], 0 <= i < set->count
 *     for (i = 0; i < set->count; ++i) set->key[i] = tile of particle i;
 *     cf_particles_sort(set, threads);                               // by key; equal keys keep their order
 *
 * Attributes are referred to by their number, because arrays move when the set grows or is put into another order:
 * take pointers afresh after that. Arrays start on a page and may be read one vector past `room`.
 *
 * An id is never used twice; the order of particles, their ids and the next id are state.
 */
#ifndef CF_GRID_PARTICLES_H
#define CF_GRID_PARTICLES_H

#include <stdint.h>

#include "base/real.h"
#include "base/status.h"

#define CF_PARTICLE_COMPONENTS 9
#define CF_PARTICLE_ATTRIBUTES 24
#define CF_PARTICLE_POSITION   0 /* the number of that attribute */

/* CARRIED: state, moved along by every reordering. DERIVED: computed from the rest when a frame is written (a stress
 * to look at); not in checkpoints, and left behind when particles change places. */
typedef enum cf_attribute_role { CF_CARRIED, CF_DERIVED } cf_attribute_role;

typedef struct cf_attribute {
  char name[CF_NAME_MAX], unit[CF_NAME_MAX];
  int components;
  cf_attribute_role role;
  cf_real *at[CF_PARTICLE_COMPONENTS];
} cf_attribute;

typedef struct cf_particles {
  char name[CF_NAME_MAX];
  int dim;
  int64_t count, room; /* room: at most INT32_MAX */
  int64_t *id;
  int64_t next_id;
  int attributes;
  cf_attribute attribute[CF_PARTICLE_ATTRIBUTES];

  /* scratch */
  uint32_t *key;  /* one a particle, for cf_particles_sort */
  int32_t *order; /* one a particle, for cf_particles_reorder */
  uint32_t *spare_key;
  int32_t *spare_order;
  cf_real *spare; /* what the next component is gathered into, and then changes places with */
  int64_t *spare_id;
  int32_t *bins;
} cf_particles;

/* An empty set with `position` (m, dim components) and room for `room` particles. CF_BAD_ARGUMENT: a name that is
 * empty or too long, dim; CF_OVER_LIMIT: more than INT32_MAX; CF_NO_MEMORY. */
cf_status cf_particles_create(cf_particles **set, const char *name, int dim, int64_t room);
void cf_particles_destroy(cf_particles *set); /* NULL is fine */

/* One more attribute, zero; *number (NULL is fine) is where it stands. Before anything is appended. */
cf_status cf_particles_attribute(cf_particles *set, const char *name, const char *unit, int components,
                                 cf_attribute_role role, int *number);

/* The number of the attribute of that name, -1 if there is none. */
int cf_particles_find(const cf_particles *set, const char *name);

/* Room for that many; the set is as it was on failure. CF_OVER_LIMIT, CF_NO_MEMORY. */
cf_status cf_particles_reserve(cf_particles *set, int64_t room);

/* n more particles with new ids, all attributes 0; *first (NULL is fine) is the index of the first of them. */
cf_status cf_particles_append(cf_particles *set, int64_t n, int64_t *first);

/* Particle i becomes what particle order[i] was, for i < n <= count; those that `order` does not name are gone. No
 * index may stand there twice. `order` may be set->order. Allocates nothing. */
void cf_particles_reorder(cf_particles *set, const int32_t *order, int64_t n, int threads);

/* Removes the particles i with set->key[i] != 0; the others keep their order. Allocates nothing. */
void cf_particles_remove(cf_particles *set, int threads);

/* Puts the particles into the order of set->key (which comes back sorted), equal keys in the order they had: the same
 * for any number of threads. Allocates nothing. Cost: a pass over the keys for every 11 bits of the largest, and a
 * gather of every component; nothing but one pass where they are in order already. */
void cf_particles_sort(cf_particles *set, int threads);

/* Whether all components of all attributes are finite; if not, the attribute, component and index of the first found
 * (by attribute, then component, then index). */
typedef struct cf_particles_place {
  int attribute, component;
  int64_t index;
} cf_particles_place;
bool cf_particles_finite(const cf_particles *set, int threads, cf_particles_place *where);

#endif
