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

static cf_status read_count(cf_hdf5 *h, const cf_entry *e, int64_t *count) {
  cf_path path;
  cf_array found;
  CF_TRY(cf_path_make(&path, "/state/%s/id", e->name));
  CF_TRY(cf_hdf5_shape(h, path.text, &found));
  *count = found.n[0];
  return CF_OK;
}

static void shape_text(const cf_array *a, char *text, const size_t size) {
  size_t used = 0;
  for (int d = 0; d < a->rank; ++d)
    used += (size_t)snprintf(text + used, size - used, "%s%" PRId64, d > 0 ? " x " : "", a->n[d]);
}

/* What a double array is called when cf_real is double too. */
static cf_element element_in_file(const cf_element e) {
  return e == CF_ELEMENT_NUMBER && sizeof(cf_real) == 8 ? CF_ELEMENT_REAL : e;
}

static cf_status fit_array(cf_hdf5 *h, const char *path, const cf_array *wanted) {
  cf_array found;
  CF_TRY(cf_hdf5_shape(h, path, &found));
  bool same = found.rank == wanted->rank && found.element == element_in_file(wanted->element);
  for (int d = 0; d < wanted->rank; ++d) same = same && found.n[d] == wanted->n[d];
  if (same) return CF_OK;
  char a[96], b[96];
  shape_text(wanted, a, sizeof a);
  shape_text(&found, b, sizeof b);
  return cf_fail(CF_BAD_FILE, "%s: %s has another shape: expected %s, found %s", h->draft.path.text, path, a,
                 b);
}

static cf_status visit_attribute(void *context, cf_hdf5 *h, const char *name) {
  const cf_particles *set = context;
  if (strcmp(name, "id") == 0 || strcmp(name, "next_id") == 0 || cf_particles_find(set, name) >= 0)
    return CF_OK;
  return cf_fail(CF_BAD_FILE, "%s: has \"%s.%s\", which this scene does not know", h->draft.path.text,
                 set->name, name);
}

/* Of particles the file says how many there are. */
static cf_status fit_parts(cf_hdf5 *h, const cf_registry *r, const cf_entry *e) {
  const bool particles = e->kind == CF_KIND_PARTICLES;
  int64_t count = 0;
  cf_part part;
  cf_path path;
  if (particles) CF_TRY(read_count(h, e, &count));
  for (int i = 0; cf_part_of(r, e, i, &part); ++i) {
    if (part.derived) continue;
    CF_TRY(cf_path_make(&path, "/state/%s", part.name));
    if (particles && i != CF_PART_NEXT_ID) part.array.n[0] = count;
    CF_TRY(fit_array(h, path.text, &part.array));
  }
  CF_TRY(cf_path_make(&path, "/state/%s", e->name));
  return particles ? cf_hdf5_each(h, path.text, visit_attribute, e->particles) : CF_OK;
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
  return fit_parts(h, r, e);
}

static cf_status visit_known(void *context, cf_hdf5 *h, const char *name) {
  if (cf_registry_find(context, name) != NULL) return CF_OK;
  return cf_fail(CF_BAD_FILE, "%s: has \"%s\", which this scene does not know", h->draft.path.text, name);
}

static cf_status fit(cf_hdf5 *h, const cf_registry *r) {
  CF_TRY(fit_facts(h, r));
  for (int e = 0; e < r->count; ++e) CF_TRY(fit_entry(h, r, &r->entry[e]));
  return cf_hdf5_each(h, "/state", visit_known, (void *)(uintptr_t)r);
}

/* --- into the registry ---------------------------------------------------------------------------------- */

/* Room is there for all sets before any is changed. */
static cf_status make_room(cf_hdf5 *h, const cf_registry *r) {
  int64_t count;
  for (int pass = 0; pass < 2; ++pass)
    for (int i = 0; i < r->count; ++i) {
      const cf_entry *e = &r->entry[i];
      if (e->kind != CF_KIND_PARTICLES) continue;
      CF_TRY(read_count(h, e, &count));
      if (pass == 0)
        CF_TRY(cf_particles_reserve(e->particles, count));
      else
        e->particles->count = count;
    }
  return CF_OK;
}

static cf_status take_over(cf_hdf5 *h, const cf_registry *r) {
  cf_part part;
  cf_path path;
  CF_TRY(fit(h, r));
  CF_TRY(make_room(h, r));
  for (int e = 0; e < r->count; ++e)
    for (int i = 0; cf_part_of(r, &r->entry[e], i, &part); ++i) {
      if (part.derived) continue;
      CF_TRY(cf_path_make(&path, "/state/%s", part.name));
      CF_TRY(cf_hdf5_read_part(h, path.text, &part));
    }
  return CF_OK;
}

cf_status cf_checkpoint_read(const char *path, const cf_registry *r) {
  cf_hdf5 h;
  CF_TRY(cf_head_check(path));
  CF_TRY(cf_hdf5_open(&h, path));
  return cf_hdf5_close(&h, take_over(&h, r));
}
