/* SPDX-License-Identifier: MIT
 *
 * The registry as files have it: every entry is one or more arrays with names, and whatever writes, reads or describes
 * state walks these parts.
 *
 *   phi                                    a cell field
 *   q/x, q/y, q/z                          a face field, high faces included
 *   gel/id, gel/next_id, gel/position ...  a set of particles: (N), (1), and (N, components) or (N) an attribute
 *   ledger, step                           numbers, a counter
 */
#ifndef CF_IO_PARTS_H
#define CF_IO_PARTS_H

#include "grid/registry.h"
#include "io/slabs.h"

typedef struct cf_part {
  const cf_entry *entry;
  char name[2 * CF_NAME_MAX]; /* ENTRY or ENTRY/PART */
  const char *unit;
  bool derived;   /* not state: in frames only */
  bool streamed;  /* in slabs; else the array is in one piece at `values` */
  cf_slabs slabs; /* streamed */
  cf_array array; /* shape and elements, either way */
  void *values;   /* not streamed */
  int attribute;  /* of particles; -1: none */
} cf_part;

/* Where the next id stands among the parts of particles. */
#define CF_PART_NEXT_ID 1

/* PART, or ENTRY where that is all. */
const char *cf_part_own(const cf_part *p);

/* Part number `i` of an entry, counted from 0; false past the last. */
bool cf_part_of(const cf_registry *r, const cf_entry *e, int i, cf_part *p);

/* "cell", "face", "particles", "number", "counter". */
const char *cf_kind_name(cf_kind kind);

/* --- what a frame shows ------------------------------------------------------------------------------- */

/* Names of entries; of particles SET, or SET.ATTRIBUTE. `names` NULL: everything. */
typedef struct cf_choice {
  int count;
  const char *const *names;
} cf_choice;

bool cf_choice_has(const cf_choice *c, const cf_entry *e); /* any part of it */
bool cf_choice_has_part(const cf_choice *c, const cf_part *p);

/* CF_BAD_ARGUMENT: a name that the registry does not have; the sentence lists those there are. */
cf_status cf_choice_check(const cf_choice *c, const cf_registry *r);

/* "phi, q, gel, gel.position": what could be chosen, besides numbers and counters. */
void cf_choice_list(const cf_registry *r, char *text, size_t size);

/* The word in the names of a set's files: particles_000012.vtkhdf for the first set of a run, particles_SET for others. */
void cf_particles_word(const cf_registry *r, const cf_particles *set, char *word, size_t size);

#endif
