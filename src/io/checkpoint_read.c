/* SPDX-License-Identifier: MIT
 *
 * Reading checkpoints: first every byte (checkpoint_head.c), then whether all fits the registry, and only
 * then the values go where they belong.
 */
#include <inttypes.h>
#include <stdio.h>
#include <string.h>

#include "base/mem.h"
#include "io/checkpoint.h"
#include "io/checkpoint_head.h"

#define SCENE_BYTES ((int64_t)64 << 20)

const char *cf_kind_name(const cf_kind kind) {
  static const char *const names[] = {"cell", "face", "particle", "number", "counter"};
  return names[kind];
}

/* --- facts
 * -------------------------------------------------------------------------------------------------- */

static cf_status read_facts(cf_hdf5 *h, cf_checkpoint_facts *f) {
  int64_t dim, cells[3];
  CF_TRY(cf_hdf5_get_text(h, "/", "title", f->title, sizeof f->title));
  CF_TRY(cf_hdf5_get_text(h, "/", "version", f->version, sizeof f->version));
  CF_TRY(cf_hdf5_get_text(h, "/", "precision", f->precision, sizeof f->precision));
  CF_TRY(cf_hdf5_get_numbers(h, "/", "time", 1, &f->time));
  CF_TRY(cf_hdf5_get_integers(h, "/", "step", 1, &f->step));
  CF_TRY(cf_hdf5_get_integers(h, "/", "dim", 1, &dim));
  CF_TRY(cf_hdf5_get_integers(h, "/", "cells", 3, cells));
  CF_TRY(cf_hdf5_get_numbers(h, "/", "spacing", 1, &f->h));
  CF_TRY(cf_hdf5_get_numbers(h, "/", "origin", 3, f->origin));
  f->dim = (int)dim;
  for (int a = 0; a < 3; ++a) f->n[a] = (int)cells[a];
  return CF_OK;
}

static cf_status read_scene(cf_hdf5 *h, char **scene) {
  cf_array a;
  CF_TRY(cf_hdf5_shape(h, "/scene", &a));
  if (a.rank != 1 || a.element != CF_ELEMENT_BYTE || a.n[0] > SCENE_BYTES)
    return cf_fail(CF_BAD_FILE, "%s: the scene in it is not a text", h->draft.path.text);
  CF_TRY(CF_NEW(scene, (size_t)a.n[0] + 1));
  return cf_hdf5_read(h, "/scene", &a, *scene);
}

cf_status cf_checkpoint_describe(const char *path, cf_checkpoint_facts *facts, char **scene) {
  cf_hdf5 h;
  memset(facts, 0, sizeof *facts);
  if (scene != NULL) *scene = NULL;
  CF_TRY(cf_head_check(path));
  CF_TRY(cf_hdf5_open(&h, path));
  cf_status s = read_facts(&h, facts);
  if (s == CF_OK && scene != NULL) s = read_scene(&h, scene);
  s = cf_hdf5_close(&h, s);
  if (s != CF_OK && scene != NULL) {
    cf_free(*scene);
    *scene = NULL;
  }
  return s;
}

cf_status cf_checkpoint_check(const char *path) {
  cf_checkpoint_facts facts;
  return cf_checkpoint_describe(path, &facts, NULL);
}

/* --- does it fit
 * -------------------------------------------------------------------------------------------- */

static cf_status fit_facts(cf_hdf5 *h, const cf_registry *r) {
  const cf_box *b = &r->grid->box;
  const char *path = h->draft.path.text;
  cf_checkpoint_facts f;
  CF_TRY(read_facts(h, &f));
  if (strcmp(f.precision, CF_PRECISION) != 0)
    return cf_fail(CF_BAD_FILE,
                   "%s: was written in %s precision, this program computes in %s: go on with --precision %s",
                   path, f.precision, CF_PRECISION, f.precision);
  if (f.dim != b->dim)
    return cf_fail(CF_BAD_FILE, "%s: has another domain: expected %dD, found %dD", path, b->dim, f.dim);
  if (f.n[0] != b->n[0] || f.n[1] != b->n[1] || f.n[2] != b->n[2])
    return cf_fail(CF_BAD_FILE, "%s: has another domain: expected %d x %d x %d cells, found %d x %d x %d",
                   path, b->n[0], b->n[1], b->n[2], f.n[0], f.n[1], f.n[2]);
  if (f.h != r->grid->h)
    return cf_fail(CF_BAD_FILE, "%s: has another spacing: expected %.17g m, found %.17g m", path, r->grid->h,
                   f.h);
  return CF_OK;
}

static cf_status fit_array(cf_hdf5 *h, const char *path, const cf_array *wanted) {
  cf_array found;
  CF_TRY(cf_hdf5_shape(h, path, &found));
  bool same = found.rank == wanted->rank && found.element == wanted->element;
  for (int d = 0; d < wanted->rank; ++d) same = same && (found.n[d] == wanted->n[d] || wanted->n[d] < 0);
  if (same) return CF_OK;
  return cf_fail(CF_BAD_FILE,
                 "%s: %s has another shape: expected %" PRId64 " x %" PRId64 " x %" PRId64 ", found %" PRId64
                 " x %" PRId64 " x %" PRId64,
                 h->draft.path.text, path, wanted->n[0], wanted->n[1], wanted->n[2], found.n[0], found.n[1],
                 found.n[2]);
}

/* What a double array is called when cf_real is double too. */
static cf_element number_element(void) { return sizeof(cf_real) == 8 ? CF_ELEMENT_REAL : CF_ELEMENT_NUMBER; }

static cf_array array_of(const cf_registry *r, const cf_entry *e, const int axis) {
  const cf_box *b = &r->grid->box;
  if (e->kind == CF_KIND_NUMBER) return (cf_array){number_element(), 1, {e->components}};
  if (e->kind == CF_KIND_COUNTER) return (cf_array){CF_ELEMENT_INTEGER, 1, {e->components}};
  if (e->kind == CF_KIND_PARTICLE) return (cf_array){CF_ELEMENT_REAL, 2, {-1, e->components}};
  const cf_slabs s = axis < 0 ? cf_slabs_of_cell(b, e->cell) : cf_slabs_of_face(b, &e->face, axis);
  cf_array a = cf_slabs_array(&s);
  a.n[3] = 0;
  return a;
}

static cf_status fit_entry(cf_hdf5 *h, const cf_registry *r, const cf_entry *e) {
  cf_path path;
  char kind[16];
  CF_TRY(cf_path_make(&path, "/state/%s", e->name));
  if (!cf_hdf5_has(h, path.text))
    return cf_fail(CF_BAD_FILE, "%s: has no \"%s\" (%s), which this scene needs", h->draft.path.text, e->name,
                   cf_kind_name(e->kind));
  CF_TRY(cf_hdf5_get_text(h, path.text, "kind", kind, sizeof kind));
  if (strcmp(kind, cf_kind_name(e->kind)) != 0)
    return cf_fail(CF_BAD_FILE, "%s: \"%s\" is of another kind: expected %s, found %s", h->draft.path.text,
                   e->name, cf_kind_name(e->kind), kind);
  if (e->kind != CF_KIND_FACE) {
    const cf_array wanted = array_of(r, e, -1);
    return fit_array(h, path.text, &wanted);
  }
  for (int a = 0; a < r->grid->box.dim; ++a) {
    const cf_array wanted = array_of(r, e, a);
    CF_TRY(cf_path_make(&path, "/state/%s/%c", e->name, "xyz"[a]));
    CF_TRY(fit_array(h, path.text, &wanted));
  }
  return CF_OK;
}

static cf_status visit_known(void *context, cf_hdf5 *h, const char *name) {
  if (cf_registry_find(context, name) != NULL) return CF_OK;
  return cf_fail(CF_BAD_FILE, "%s: has \"%s\", which this scene does not know", h->draft.path.text, name);
}

static cf_status count_particles(cf_hdf5 *h, const cf_entry *e, int64_t *count) {
  cf_path path;
  cf_array found;
  CF_TRY(cf_path_make(&path, "/state/%s", e->name));
  CF_TRY(cf_hdf5_shape(h, path.text, &found));
  *count = found.n[0];
  return CF_OK;
}

/* Entries that share a count must agree on it; without `room` it must be the present one. */
static cf_status fit_particles(cf_hdf5 *h, const cf_registry *r, const bool has_room) {
  for (int i = 0; i < r->count; ++i) {
    const cf_entry *e = &r->entry[i];
    int64_t count, other;
    if (e->kind != CF_KIND_PARTICLE) continue;
    CF_TRY(count_particles(h, e, &count));
    if (!has_room && count != *e->count)
      return cf_fail(CF_BAD_FILE, "%s: %s has %" PRId64 " particles, expected %" PRId64, h->draft.path.text,
                     e->name, count, *e->count);
    for (int o = 0; o < i; ++o) {
      if (r->entry[o].kind != CF_KIND_PARTICLE || r->entry[o].count != e->count) continue;
      CF_TRY(count_particles(h, &r->entry[o], &other));
      if (other != count)
        return cf_fail(CF_BAD_FILE, "%s: %s has %" PRId64 " particles, but %s has %" PRId64,
                       h->draft.path.text, e->name, count, r->entry[o].name, other);
    }
  }
  return CF_OK;
}

static cf_status fit(cf_hdf5 *h, const cf_registry *r, const bool has_room) {
  CF_TRY(fit_facts(h, r));
  for (int e = 0; e < r->count; ++e) CF_TRY(fit_entry(h, r, &r->entry[e]));
  CF_TRY(cf_hdf5_each(h, "/state", visit_known, (void *)(uintptr_t)r));
  return fit_particles(h, r, has_room);
}

/* --- into the registry ---------------------------------------------------------------------------------- */

static cf_status make_room(cf_hdf5 *h, const cf_registry *r, const cf_checkpoint_room *room) {
  for (int i = 0; i < r->count; ++i) {
    const cf_entry *e = &r->entry[i];
    int64_t count;
    if (e->kind != CF_KIND_PARTICLE) continue;
    CF_TRY(count_particles(h, e, &count));
    if (count != *e->count) CF_TRY(room->make(room->context, e, count));
    if (count != *e->count)
      return cf_fail(CF_FAILED, "%s: no room was made for the %" PRId64 " particles of %s",
                     h->draft.path.text, count, e->name);
  }
  return CF_OK;
}

static cf_status read_fields(cf_hdf5 *h, const cf_registry *r, const cf_entry *e) {
  const cf_box *b = &r->grid->box;
  cf_path path;
  if (e->kind == CF_KIND_CELL) {
    const cf_slabs s = cf_slabs_of_cell(b, e->cell);
    CF_TRY(cf_path_make(&path, "/state/%s", e->name));
    return cf_hdf5_read_slabs(h, path.text, &s);
  }
  for (int a = 0; a < b->dim; ++a) {
    const cf_slabs s = cf_slabs_of_face(b, &e->face, a);
    CF_TRY(cf_path_make(&path, "/state/%s/%c", e->name, "xyz"[a]));
    CF_TRY(cf_hdf5_read_slabs(h, path.text, &s));
  }
  return CF_OK;
}

static cf_status read_entry(cf_hdf5 *h, const cf_registry *r, const cf_entry *e) {
  if (e->kind == CF_KIND_CELL || e->kind == CF_KIND_FACE) return read_fields(h, r, e);
  cf_array a = array_of(r, e, -1);
  cf_path path;
  CF_TRY(cf_path_make(&path, "/state/%s", e->name));
  if (e->kind == CF_KIND_COUNTER) return cf_hdf5_read(h, path.text, &a, e->counter);
  if (e->kind == CF_KIND_NUMBER) return cf_hdf5_read(h, path.text, &a, e->number);
  a.n[0] = *e->count;
  return cf_hdf5_read(h, path.text, &a, *e->particles);
}

static cf_status take_over(cf_hdf5 *h, const cf_registry *r, const cf_checkpoint_room *room) {
  CF_TRY(fit(h, r, room != NULL));
  if (room != NULL) CF_TRY(make_room(h, r, room));
  for (int e = 0; e < r->count; ++e) CF_TRY(read_entry(h, r, &r->entry[e]));
  return CF_OK;
}

cf_status cf_checkpoint_read(const char *path, const cf_registry *r, const cf_checkpoint_room *room) {
  cf_hdf5 h;
  CF_TRY(cf_head_check(path));
  CF_TRY(cf_hdf5_open(&h, path));
  return cf_hdf5_close(&h, take_over(&h, r, room));
}
