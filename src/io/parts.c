/* SPDX-License-Identifier: MIT */
#include "io/parts.h"

#include <stdio.h>
#include <string.h>

const char *cf_kind_name(const cf_kind kind) {
  static const char *const names[] = {"cell", "face", "particles", "number", "counter"};
  return names[kind];
}

static void stream(cf_part *p, const cf_slabs slabs) {
  p->streamed = true;
  p->slabs = slabs;
  p->array = cf_slabs_array(&slabs);
}

static void hold(cf_part *p, const cf_element element, const int64_t n, void *values) {
  p->array = (cf_array){element, 1, {n}};
  p->values = values;
}

static void name_part(cf_part *p, const char *own) {
  snprintf(p->name, sizeof p->name, "%s/%s", p->entry->name, own);
}

const char *cf_part_own(const cf_part *p) {
  const char *slash = strrchr(p->name, '/');
  return slash == NULL ? p->name : slash + 1;
}

static bool particle_part(const cf_entry *e, const int i, cf_part *p) {
  cf_particles *set = e->particles;
  p->unit = "";
  p->attribute = i - 2;
  if (i == 0) {
    name_part(p, "id");
    hold(p, CF_ELEMENT_INTEGER, set->count, set->id);
  } else if (i == CF_PART_NEXT_ID) {
    name_part(p, "next_id");
    hold(p, CF_ELEMENT_INTEGER, 1, &set->next_id);
  } else if (p->attribute < set->attributes) {
    const cf_attribute *a = &set->attribute[p->attribute];
    name_part(p, a->name);
    stream(p, cf_slabs_of_attribute(set, p->attribute));
    p->unit = a->unit;
    p->derived = a->role == CF_DERIVED;
  }
  return p->attribute < set->attributes;
}

bool cf_part_of(const cf_registry *r, const cf_entry *e, const int i, cf_part *p) {
  const cf_box *b = &r->grid->box;
  *p = (cf_part){.entry = e, .unit = e->unit, .attribute = -1};
  snprintf(p->name, sizeof p->name, "%s", e->name);
  switch (e->kind) {
    case CF_KIND_CELL:
      stream(p, cf_slabs_of_cell(b, e->cell));
      return i == 0;
    case CF_KIND_FACE:
      if (i >= b->dim) return false;
      name_part(p, (const char *const[]){"x", "y", "z"}[i]);
      stream(p, cf_slabs_of_face(b, &e->face, i));
      return true;
    case CF_KIND_PARTICLES:
      return particle_part(e, i, p);
    case CF_KIND_NUMBER:
      hold(p, CF_ELEMENT_NUMBER, e->components, e->number);
      return i == 0;
    case CF_KIND_COUNTER:
      hold(p, CF_ELEMENT_INTEGER, 1, e->counter);
      return i == 0;
  }
  return false;
}

/* --- what a frame shows ------------------------------------------------------------------------------- */

static bool names_attribute(const char *name, const char *set, const char *attribute) {
  const size_t length = strlen(set);
  return strncmp(name, set, length) == 0 && name[length] == '.' && strcmp(name + length + 1, attribute) == 0;
}

bool cf_choice_has_part(const cf_choice *c, const cf_part *p) {
  if (c->names == NULL) return true;
  for (int i = 0; i < c->count; ++i)
    if (strcmp(c->names[i], p->entry->name) == 0 ||
        names_attribute(c->names[i], p->entry->name, cf_part_own(p)))
      return true;
  return false;
}

static bool names_entry(const char *name, const cf_entry *e) {
  if (strcmp(name, e->name) == 0) return true;
  if (e->kind != CF_KIND_PARTICLES) return false;
  for (int a = 0; a < e->particles->attributes; ++a)
    if (names_attribute(name, e->name, e->particles->attribute[a].name)) return true;
  return names_attribute(name, e->name, "id");
}

bool cf_choice_has(const cf_choice *c, const cf_entry *e) {
  if (c->names == NULL) return true;
  for (int i = 0; i < c->count; ++i)
    if (names_entry(c->names[i], e)) return true;
  return false;
}

void cf_choice_list(const cf_registry *r, char *text, const size_t size) {
  size_t used = 0;
  text[0] = '\0';
  for (int e = 0; e < r->count && used < size; ++e) {
    const cf_entry *entry = &r->entry[e];
    if (entry->kind == CF_KIND_NUMBER || entry->kind == CF_KIND_COUNTER) continue;
    used += (size_t)snprintf(text + used, size - used, "%s%s", used > 0 ? ", " : "", entry->name);
    if (entry->kind != CF_KIND_PARTICLES) continue;
    for (int a = 0; a < entry->particles->attributes && used < size; ++a)
      used += (size_t)snprintf(text + used, size - used, ", %s.%s", entry->name,
                               entry->particles->attribute[a].name);
  }
}

cf_status cf_choice_check(const cf_choice *c, const cf_registry *r) {
  for (int i = 0; c->names != NULL && i < c->count; ++i) {
    bool known = false;
    char list[512];
    for (int e = 0; e < r->count; ++e) known = known || names_entry(c->names[i], &r->entry[e]);
    if (known) continue;
    cf_choice_list(r, list, sizeof list);
    return cf_fail(CF_BAD_ARGUMENT, "there is no field \"%s\"; there are %s", c->names[i], list);
  }
  return CF_OK;
}

void cf_particles_word(const cf_registry *r, const cf_particles *set, char *word, const size_t size) {
  int e = 0;
  while (r->entry[e].kind != CF_KIND_PARTICLES) ++e;
  const bool first = r->entry[e].particles == set;
  snprintf(word, size, "particles%s%s", first ? "" : "_", first ? "" : set->name);
}
