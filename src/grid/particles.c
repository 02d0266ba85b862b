/* SPDX-License-Identifier: MIT
 *
 * A reordering takes one spare array: a component is gathered into it, and then array and spare change places.
 * (Putting particles in order of a key: particles_sort.c.)
 */
#include "grid/particles.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "base/mem.h"
#include "grid/particles_part.h"
#include "grid/sweep.h"

/* --- memory ----------------------------------------------------------------------------------------------- */

/* One vector may be read past the end. */
static size_t bytes_of(const int64_t room, const size_t element) {
  return ((size_t)room + (size_t)CF_LANES) * element;
}

/* Every array of a set, in one order: what grows, and what is freed. `carried` ones keep their values. */
typedef struct array {
  void **at;
  size_t element;
  bool carried;
} array;

#define ARRAYS_MOST (CF_PARTICLE_ATTRIBUTES * CF_PARTICLE_COMPONENTS + 7)

static int list_arrays(cf_particles *s, array *list) {
  int n = 0;
  list[n++] = (array){(void **)&s->id, sizeof *s->id, true};
  list[n++] = (array){(void **)&s->spare_id, sizeof *s->id, false};
  list[n++] = (array){(void **)&s->spare, sizeof *s->spare, false};
  list[n++] = (array){(void **)&s->key, sizeof *s->key, true};
  list[n++] = (array){(void **)&s->spare_key, sizeof *s->key, false};
  list[n++] = (array){(void **)&s->order, sizeof *s->order, false};
  list[n++] = (array){(void **)&s->spare_order, sizeof *s->order, false};
  for (int a = 0; a < s->attributes; ++a)
    for (int c = 0; c < s->attribute[a].components; ++c)
      list[n++] = (array){(void **)&s->attribute[a].at[c], sizeof(cf_real), true};
  return n;
}

static cf_status check_room(const cf_particles *s, const int64_t room) {
  if (room <= INT32_MAX) return CF_OK;
  return cf_fail(CF_OVER_LIMIT, "%" PRId64 " particles in \"%s\": a set holds at most %d", room, s->name,
                 INT32_MAX);
}

/* All new arrays are there before any old one goes. */
static cf_status change_room(cf_particles *s, const int64_t room) {
  array list[ARRAYS_MOST];
  void *fresh[ARRAYS_MOST];
  const int n = list_arrays(s, list);
  for (int i = 0; i < n; ++i) {
    const cf_status status = cf_pages_reserve(&fresh[i], bytes_of(room, list[i].element), true);
    if (status == CF_OK) continue;
    while (--i >= 0) cf_pages_release(fresh[i], bytes_of(room, list[i].element));
    return status;
  }
  for (int i = 0; i < n; ++i) {
    if (list[i].carried && s->count > 0) memcpy(fresh[i], *list[i].at, (size_t)s->count * list[i].element);
    cf_pages_release(*list[i].at, bytes_of(s->room, list[i].element));
    *list[i].at = fresh[i];
  }
  s->room = room;
  return CF_OK;
}

cf_status cf_particles_reserve(cf_particles *s, const int64_t room) {
  CF_TRY(check_room(s, room));
  return room <= s->room ? CF_OK : change_room(s, room);
}

/* --- a set ------------------------------------------------------------------------------------------------ */

static cf_status check_name(const char *what, const char *name) {
  const size_t length = strlen(name);
  if (length > 0 && length < CF_NAME_MAX && strpbrk(name, "./ \t\r\n") == NULL) return CF_OK;
  return cf_fail(CF_BAD_ARGUMENT, "%s named \"%s\": a name has 1 to %d letters, without dot, slash or blank",
                 what, name, CF_NAME_MAX - 1);
}

static cf_status fill(cf_particles *s, const int64_t room) {
  CF_TRY(CF_NEW(&s->bins, CF_SORT_BINS * CF_SORT_CHUNKS));
  CF_TRY(change_room(s, CF_MAX(room, 1)));
  return cf_particles_attribute(s, "position", "m", s->dim, CF_CARRIED, NULL);
}

cf_status cf_particles_create(cf_particles **set, const char *name, const int dim, const int64_t room) {
  cf_particles *s;
  *set = NULL;
  CF_TRY(check_name("particles", name));
  if (dim != 2 && dim != 3)
    return cf_fail(CF_BAD_ARGUMENT, "particles in %d dimensions: only 2 and 3 exist", dim);
  CF_TRY(CF_NEW(&s, 1));
  snprintf(s->name, sizeof s->name, "%s", name);
  s->dim = dim;
  cf_status status = check_room(s, room);
  if (status == CF_OK) status = fill(s, room);
  if (status != CF_OK) {
    cf_particles_destroy(s);
    return status;
  }
  *set = s;
  return CF_OK;
}

void cf_particles_destroy(cf_particles *s) {
  if (s == NULL) return;
  array list[ARRAYS_MOST];
  const int n = list_arrays(s, list);
  for (int i = 0; i < n; ++i) cf_pages_release(*list[i].at, bytes_of(s->room, list[i].element));
  cf_free(s->bins);
  cf_free(s);
}

int cf_particles_find(const cf_particles *s, const char *name) {
  for (int a = 0; a < s->attributes; ++a)
    if (strcmp(s->attribute[a].name, name) == 0) return a;
  return -1;
}

static cf_status check_attribute(const cf_particles *s, const char *name, const int components) {
  CF_TRY(check_name("an attribute", name));
  if (components < 1 || components > CF_PARTICLE_COMPONENTS)
    return cf_fail(CF_BAD_ARGUMENT, "attribute %s of %s: %d components: 1 to %d are possible", name, s->name,
                   components, CF_PARTICLE_COMPONENTS);
  if (cf_particles_find(s, name) >= 0 || strcmp(name, "id") == 0 || strcmp(name, "next_id") == 0)
    return cf_fail(CF_BAD_ARGUMENT, "two attributes of %s are named \"%s\"", s->name, name);
  if (s->attributes == CF_PARTICLE_ATTRIBUTES)
    return cf_fail(CF_OVER_LIMIT, "attribute %s of %s: there are %d already", name, s->name, s->attributes);
  return CF_OK;
}

cf_status cf_particles_attribute(cf_particles *s, const char *name, const char *unit, const int components,
                                 const cf_attribute_role role, int *number) {
  CF_TRY(check_attribute(s, name, components));
  cf_attribute *a = &s->attribute[s->attributes];
  *a = (cf_attribute){.components = components, .role = role};
  snprintf(a->name, sizeof a->name, "%s", name);
  snprintf(a->unit, sizeof a->unit, "%s", unit);
  for (int c = 0; c < components; ++c) {
    void *pages;
    const cf_status status = cf_pages_reserve(&pages, bytes_of(s->room, sizeof(cf_real)), true);
    if (status != CF_OK) {
      while (--c >= 0) cf_pages_release(a->at[c], bytes_of(s->room, sizeof(cf_real)));
      return status;
    }
    a->at[c] = pages;
  }
  if (number != NULL) *number = s->attributes;
  ++s->attributes;
  return CF_OK;
}

cf_status cf_particles_append(cf_particles *s, const int64_t n, int64_t *first) {
  const int64_t count = s->count + n;
  if (n < 0) return cf_fail(CF_BAD_ARGUMENT, "%" PRId64 " more particles in \"%s\"", n, s->name);
  CF_TRY(check_room(s, count));
  if (count > s->room) CF_TRY(change_room(s, CF_MIN(CF_MAX(count, s->room + s->room / 2), INT32_MAX)));
  for (int64_t i = s->count; i < count; ++i) s->id[i] = s->next_id++;
  for (int a = 0; a < s->attributes; ++a)
    for (int c = 0; c < s->attribute[a].components; ++c)
      memset(s->attribute[a].at[c] + s->count, 0, (size_t)n * sizeof(cf_real));
  if (first != NULL) *first = s->count;
  s->count = count;
  return CF_OK;
}

/* --- another order ---------------------------------------------------------------------------------------- */

CF_CLONES static void gather(const int64_t n, const int32_t *order, const cf_real *from, cf_real *to) {
  for (int64_t i = 0; i < n; ++i) to[i] = from[order[i]];
}

static void gather_component(cf_particles *s, cf_real **component, const int32_t *order, const int64_t n,
                             const int threads) {
  const cf_real *from = *component;
#pragma omp parallel for schedule(static) num_threads(threads)
  for (int64_t chunk = 0; chunk < CF_PARTICLE_CHUNKS(n); ++chunk) {
    const int64_t at = chunk * CF_PARTICLE_CHUNK;
    gather(CF_MIN(n - at, CF_PARTICLE_CHUNK), order + at, from, s->spare + at);
  }
  cf_real *old = *component;
  *component = s->spare;
  s->spare = old;
}

void cf_particles_reorder(cf_particles *s, const int32_t *order, const int64_t n, const int threads) {
  const int team = n < CF_SERIAL_CELLS ? 1 : threads;
#pragma omp parallel for schedule(static) num_threads(team)
  for (int64_t i = 0; i < n; ++i) s->spare_id[i] = s->id[order[i]];
  int64_t *old = s->id;
  s->id = s->spare_id;
  s->spare_id = old;
  for (int a = 0; a < s->attributes; ++a)
    for (int c = 0; c < s->attribute[a].components; ++c)
      if (s->attribute[a].role == CF_CARRIED) gather_component(s, &s->attribute[a].at[c], order, n, team);
  s->count = n;
}

void cf_particles_remove(cf_particles *s, const int threads) {
  int64_t kept = 0;
  for (int64_t i = 0; i < s->count; ++i)
    if (s->key[i] == 0) s->order[kept++] = (int32_t)i;
  if (kept == s->count) return;
  cf_particles_reorder(s, s->order, kept, threads);
  memset(s->key, 0, (size_t)kept * sizeof *s->key);
}

/* --- finiteness ------------------------------------------------------------------------------------------- */

/* x - x is 0 for finite x and NaN for all others. */
CF_CLONES static bool is_finite(const int64_t n, const cf_real *x) {
  cf_real lane[CF_SUM_LANES] = {0};
  int64_t i = 0;
  for (; i + CF_SUM_LANES <= n; i += CF_SUM_LANES) CF_ROW_LOOP
  for (int l = 0; l < CF_SUM_LANES; ++l) lane[l] += x[i + l] - x[i + l];
  for (; i < n; ++i) lane[0] += x[i] - x[i];
  for (int l = 1; l < CF_SUM_LANES; ++l) lane[0] += lane[l];
  return lane[0] == 0;
}

static bool component_is_finite(const cf_real *x, const int64_t n, const int threads, int64_t *where) {
  int bad = 0;
#pragma omp parallel for schedule(static) num_threads(n < CF_SERIAL_CELLS ? 1 : threads) reduction(| : bad)
  for (int64_t chunk = 0; chunk < CF_PARTICLE_CHUNKS(n); ++chunk) {
    const int64_t at = chunk * CF_PARTICLE_CHUNK;
    bad |= !is_finite(CF_MIN(n - at, CF_PARTICLE_CHUNK), x + at);
  }
  for (*where = 0; bad && *where < n && isfinite(x[*where]);) ++*where;
  return !bad;
}

bool cf_particles_finite(const cf_particles *s, const int threads, cf_particles_place *where) {
  for (int a = 0; a < s->attributes; ++a)
    for (int c = 0; c < s->attribute[a].components; ++c) {
      int64_t index;
      if (s->attribute[a].role != CF_CARRIED ||
          component_is_finite(s->attribute[a].at[c], s->count, threads, &index))
        continue;
      *where = (cf_particles_place){a, c, index};
      return false;
    }
  return true;
}
