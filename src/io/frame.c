/* SPDX-License-Identifier: MIT
 *
 * Writing frames. (Reading: frame_read.c.)
 */
#include "io/frame.h"

#include <inttypes.h>
#include <stdio.h>
#include <string.h>

#include "base/mem.h"
#include "base/version.h"
#include "io/hdf5.h"
#include "io/series.h"

/* --- which entries ----------------------------------------------------------------------------------------
 */

/* The set that a particle entry SET.ATTRIBUTE belongs to. */
static void set_of(const cf_entry *e, char word[CF_NAME_MAX]) {
  const size_t length = strcspn(e->name, ".");
  if (e->name[length] == '\0')
    snprintf(word, CF_NAME_MAX, "particles");
  else
    snprintf(word, CF_NAME_MAX, "%.*s", (int)length, e->name);
}

static const char *attribute_of(const cf_entry *e) {
  const char *dot = strchr(e->name, '.');
  return dot == NULL ? e->name : dot + 1;
}

static bool is_named(const cf_entry *e, const char *name) {
  char word[CF_NAME_MAX];
  if (strcmp(e->name, name) == 0) return true;
  if (e->kind != CF_KIND_PARTICLE) return false;
  set_of(e, word);
  return strcmp(word, name) == 0;
}

static bool is_chosen(const cf_frame_plan *plan, const cf_entry *e) {
  if (plan->names == NULL) return true;
  for (int i = 0; i < plan->count; ++i)
    if (is_named(e, plan->names[i])) return true;
  return false;
}

static void list_names(const cf_registry *r, char *list, const size_t size) {
  list[0] = '\0';
  for (int e = 0; e < r->count; ++e) {
    const size_t length = strlen(list);
    snprintf(list + length, size - length, "%s%s", e > 0 ? ", " : "", r->entry[e].name);
  }
}

static cf_status check_names(const cf_registry *r, const cf_frame_plan *plan) {
  for (int e = 0; e < r->count; ++e)
    if (strchr(r->entry[e].name, '/') != NULL)
      return cf_fail(CF_BAD_ARGUMENT, "a field named \"%s\": a slash cannot stand in a name",
                     r->entry[e].name);
  for (int i = 0; plan->names != NULL && i < plan->count; ++i) {
    bool known = false;
    for (int e = 0; e < r->count; ++e) known = known || is_named(&r->entry[e], plan->names[i]);
    char list[512];
    if (known) continue;
    list_names(r, list, sizeof list);
    return cf_fail(CF_BAD_ARGUMENT, "there is no field \"%s\" to write; there are: %s", plan->names[i], list);
  }
  return CF_OK;
}

/* --- parts of a file --------------------------------------------------------------------------------------
 */

typedef struct job {
  const cf_registry *r;
  const cf_frame_plan *plan;
  const cf_stamp *stamp;
  int64_t frame;
} job;

static cf_status write_stamp(cf_hdf5 *h, const job *j) {
  const int64_t dim = j->r->grid->box.dim;
  CF_TRY(cf_hdf5_set_text(h, "/", "title", j->stamp->title == NULL ? "" : j->stamp->title));
  CF_TRY(cf_hdf5_set_text(h, "/", "program", "Cattaneo"));
  CF_TRY(cf_hdf5_set_text(h, "/", "version", cf_version()));
  CF_TRY(cf_hdf5_set_text(h, "/", "git", cf_git_hash()));
  CF_TRY(cf_hdf5_set_text(h, "/", "precision", CF_PRECISION));
  CF_TRY(cf_hdf5_set_numbers(h, "/", "time", 1, &j->stamp->time));
  CF_TRY(cf_hdf5_set_integers(h, "/", "step", 1, &j->stamp->step));
  CF_TRY(cf_hdf5_set_integers(h, "/", "frame", 1, &j->frame));
  return cf_hdf5_set_integers(h, "/", "dim", 1, &dim);
}

/* The group /VTKHDF, and the time where VTK's readers look for it. */
static cf_status write_root(cf_hdf5 *h, const job *j, const char *type) {
  const int64_t version[2] = {1, 0};
  const cf_array one = {CF_ELEMENT_NUMBER, 1, {1}};
  CF_TRY(write_stamp(h, j));
  CF_TRY(cf_hdf5_group(h, "/VTKHDF"));
  CF_TRY(cf_hdf5_set_integers(h, "/VTKHDF", "Version", 2, version));
  CF_TRY(cf_hdf5_set_text(h, "/VTKHDF", "Type", type));
  CF_TRY(cf_hdf5_group(h, "/VTKHDF/FieldData"));
  return cf_hdf5_write(h, "/VTKHDF/FieldData/Time", &one, &j->stamp->time, NULL);
}

static cf_status write_shape(cf_hdf5 *h, const cf_grid *g) {
  const cf_box *b = &g->box;
  const int64_t extent[6] = {0, b->n[0], 0, b->n[1], 0, b->n[2]}; /* of points */
  const double origin[3] = {g->origin[0], g->origin[1], b->dim == 3 ? g->origin[2] : 0};
  const double spacing[3] = {g->h, g->h, g->h};
  const double direction[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};
  CF_TRY(cf_hdf5_set_integers(h, "/VTKHDF", "WholeExtent", 6, extent));
  CF_TRY(cf_hdf5_set_numbers(h, "/VTKHDF", "Origin", 3, origin));
  CF_TRY(cf_hdf5_set_numbers(h, "/VTKHDF", "Spacing", 3, spacing));
  return cf_hdf5_set_numbers(h, "/VTKHDF", "Direction", 9, direction);
}

static cf_status write_field(cf_hdf5 *h, const char *path, const cf_slabs *s, const job *j,
                             const char *unit) {
  CF_TRY(cf_hdf5_write_slabs(h, path, s, j->plan->compression, NULL));
  return cf_hdf5_set_text(h, path, "unit", unit);
}

static cf_status write_cell(cf_hdf5 *h, const job *j, const cf_entry *e) {
  const cf_slabs s = cf_slabs_of_cell(&j->r->grid->box, e->cell);
  cf_path path;
  CF_TRY(cf_path_make(&path, "/VTKHDF/CellData/%s", e->name));
  return write_field(h, path.text, &s, j, e->unit);
}

/* As vectors for the eye, and as they are. */
static cf_status write_face(cf_hdf5 *h, const job *j, const cf_entry *e) {
  const cf_box *b = &j->r->grid->box;
  cf_slabs s = cf_slabs_of_vectors(b, &e->face);
  cf_path path;
  CF_TRY(cf_path_make(&path, "/VTKHDF/CellData/%s", e->name));
  CF_TRY(write_field(h, path.text, &s, j, e->unit));
  if (!cf_hdf5_has(h, "/faces")) CF_TRY(cf_hdf5_group(h, "/faces"));
  CF_TRY(cf_path_make(&path, "/faces/%s", e->name));
  CF_TRY(cf_hdf5_group(h, path.text));
  for (int a = 0; a < b->dim; ++a) {
    s = cf_slabs_of_face(b, &e->face, a);
    CF_TRY(cf_path_make(&path, "/faces/%s/%c", e->name, "xyz"[a]));
    CF_TRY(write_field(h, path.text, &s, j, e->unit));
  }
  return CF_OK;
}

static cf_status write_number(cf_hdf5 *h, const cf_entry *e) {
  const bool counter = e->kind == CF_KIND_COUNTER;
  const cf_array a = {counter ? CF_ELEMENT_INTEGER : CF_ELEMENT_NUMBER, 1, {e->components}};
  cf_path path;
  CF_TRY(cf_path_make(&path, "/VTKHDF/FieldData/%s", e->name));
  if (cf_hdf5_has(h, path.text)) return CF_OK; /* an entry of the name Time */
  CF_TRY(cf_hdf5_write(h, path.text, &a, counter ? (const void *)e->counter : e->number, NULL));
  return cf_hdf5_set_text(h, path.text, "unit", e->unit);
}

static cf_status write_entry(cf_hdf5 *h, const job *j, const cf_entry *e) {
  if (e->kind == CF_KIND_CELL) return write_cell(h, j, e);
  if (e->kind == CF_KIND_FACE) return write_face(h, j, e);
  return e->kind == CF_KIND_PARTICLE ? CF_OK : write_number(h, e);
}

/* --- fields_000012.vtkhdf --------------------------------------------------------------------------------
 */

static cf_status fill_fields(cf_hdf5 *h, const job *j) {
  CF_TRY(write_root(h, j, "ImageData"));
  CF_TRY(write_shape(h, j->r->grid));
  CF_TRY(cf_hdf5_group(h, "/VTKHDF/CellData"));
  for (int e = 0; e < j->r->count; ++e)
    if (is_chosen(j->plan, &j->r->entry[e])) CF_TRY(write_entry(h, j, &j->r->entry[e]));
  return CF_OK;
}

/* --- particles_000012.vtkhdf ---------------------------------------------------------------------------- */

/* A group of cells of one kind: none, or one cell of all the points. */
static cf_status write_cells(cf_hdf5 *h, const char *group, const int64_t points) {
  const int64_t cells = points > 0 ? 1 : 0, offsets[2] = {0, points};
  const cf_array one = {CF_ELEMENT_INTEGER, 1, {1}}, ends = {CF_ELEMENT_INTEGER, 1, {cells + 1}},
                 all = {CF_ELEMENT_INTEGER, 1, {points}};
  int64_t *index;
  cf_path path;
  CF_TRY(cf_path_make(&path, "/VTKHDF/%s", group));
  CF_TRY(cf_hdf5_group(h, path.text));
  CF_TRY(cf_path_make(&path, "/VTKHDF/%s/NumberOfCells", group));
  CF_TRY(cf_hdf5_write(h, path.text, &one, &cells, NULL));
  CF_TRY(cf_path_make(&path, "/VTKHDF/%s/NumberOfConnectivityIds", group));
  CF_TRY(cf_hdf5_write(h, path.text, &one, &points, NULL));
  CF_TRY(cf_path_make(&path, "/VTKHDF/%s/Offsets", group));
  CF_TRY(cf_hdf5_write(h, path.text, &ends, offsets, NULL));
  CF_TRY(cf_path_make(&path, "/VTKHDF/%s/Connectivity", group));
  CF_TRY(CF_NEW(&index, points));
  for (int64_t i = 0; i < points; ++i) index[i] = i;
  const cf_status s = cf_hdf5_write(h, path.text, &all, index, NULL);
  cf_free(index);
  return s;
}

/* Places and vectors have three components in VTK: z = 0 in 2D. */
static cf_status write_particles(cf_hdf5 *h, const char *path, const cf_entry *e, const int components) {
  const int64_t n = *e->count;
  const cf_array a = {CF_ELEMENT_REAL, components > 1 ? 2 : 1, {n, components}};
  cf_real *padded = NULL;
  if (components != e->components) {
    CF_TRY(CF_NEW(&padded, n * components));
    for (int64_t i = 0; i < n; ++i)
      for (int c = 0; c < e->components; ++c)
        padded[i * components + c] = (*e->particles)[i * e->components + c];
  }
  cf_status s = cf_hdf5_write(h, path, &a, padded != NULL ? padded : *e->particles, NULL);
  if (s == CF_OK) s = cf_hdf5_set_text(h, path, "unit", e->unit);
  cf_free(padded);
  return s;
}

static const cf_entry *find_places(const cf_registry *r, const char *word) {
  for (int e = 0; e < r->count; ++e) {
    char set[CF_NAME_MAX];
    if (r->entry[e].kind != CF_KIND_PARTICLE) continue;
    set_of(&r->entry[e], set);
    if (strcmp(set, word) == 0 && strcmp(attribute_of(&r->entry[e]), "position") == 0) return &r->entry[e];
  }
  return NULL;
}

static cf_status fill_particles(cf_hdf5 *h, const job *j, const char *word) {
  static const char *const groups[] = {"Vertices", "Lines", "Polygons", "Strips"};
  const cf_array one = {CF_ELEMENT_INTEGER, 1, {1}};
  const cf_entry *places = find_places(j->r, word);
  if (places == NULL || places->components != j->r->grid->box.dim)
    return cf_fail(CF_BAD_ARGUMENT,
                   "the particles \"%s\" have no places: %s.position must be registered, %d numbers each",
                   word, word, j->r->grid->box.dim);
  CF_TRY(write_root(h, j, "PolyData"));
  CF_TRY(cf_hdf5_write(h, "/VTKHDF/NumberOfPoints", &one, places->count, NULL));
  CF_TRY(write_particles(h, "/VTKHDF/Points", places, 3));
  for (int g = 0; g < 4; ++g) CF_TRY(write_cells(h, groups[g], g == 0 ? *places->count : 0));
  CF_TRY(cf_hdf5_group(h, "/VTKHDF/PointData"));
  for (int i = 0; i < j->r->count; ++i) {
    const cf_entry *e = &j->r->entry[i];
    char set[CF_NAME_MAX];
    cf_path path;
    if (e->kind != CF_KIND_PARTICLE || e == places || !is_chosen(j->plan, e)) continue;
    set_of(e, set);
    if (strcmp(set, word) != 0) continue;
    CF_TRY(cf_path_make(&path, "/VTKHDF/PointData/%s", attribute_of(e)));
    CF_TRY(write_particles(h, path.text, e, e->components == 2 ? 3 : e->components));
  }
  return CF_OK;
}

/* --- files ------------------------------------------------------------------------------------------------
 */

static cf_status write_file(const char *folder, const job *j, const char *word, const bool particles) {
  cf_path path;
  cf_hdf5 h;
  CF_TRY(cf_path_make(&path, "%s/%s_%06" PRId64 ".vtkhdf", folder, word, j->frame));
  CF_TRY(cf_hdf5_create(&h, path.text, 0));
  CF_TRY(cf_hdf5_close(&h, particles ? fill_particles(&h, j, word) : fill_fields(&h, j)));
  CF_TRY(cf_draft_keep(&h.draft));
  return cf_series_add(folder, word, j->frame, j->stamp->time);
}

/* One file for each set, at the first of its entries. */
static cf_status write_sets(const char *folder, const job *j) {
  for (int e = 0; e < j->r->count; ++e) {
    char word[CF_NAME_MAX], earlier[CF_NAME_MAX];
    bool chosen = false, done = false;
    if (j->r->entry[e].kind != CF_KIND_PARTICLE) continue;
    set_of(&j->r->entry[e], word);
    for (int i = 0; i < j->r->count; ++i) {
      if (j->r->entry[i].kind != CF_KIND_PARTICLE) continue;
      set_of(&j->r->entry[i], earlier);
      if (strcmp(earlier, word) != 0) continue;
      chosen = chosen || is_chosen(j->plan, &j->r->entry[i]);
      done = done || i < e;
    }
    if (chosen && !done) CF_TRY(write_file(folder, j, word, true));
  }
  return CF_OK;
}

cf_status cf_frame_write(const char *folder, const int64_t frame, const cf_registry *r,
                         const cf_frame_plan *plan, const cf_stamp *stamp) {
  const job j = {r, plan, stamp, frame};
  bool fields = false;
  CF_TRY(check_names(r, plan));
  for (int e = 0; e < r->count; ++e)
    fields = fields || (r->entry[e].kind != CF_KIND_PARTICLE && is_chosen(plan, &r->entry[e]));
  if (fields) CF_TRY(write_file(folder, &j, "fields", false));
  return write_sets(folder, &j);
}

typedef struct cut {
  const char *folder;
  int64_t last;
  cf_status status;
} cut;

static void visit_series(void *context, const char *name) {
  cut *c = context;
  char word[CF_NAME_MAX];
  const char *dot = strchr(name, '.');
  if (c->status != CF_OK || dot == NULL || strcmp(dot, ".vtkhdf.series") != 0) return;
  if ((size_t)(dot - name) >= sizeof word) return;
  snprintf(word, sizeof word, "%.*s", (int)(dot - name), name);
  c->status = cf_series_cut(c->folder, word, c->last);
}

cf_status cf_frame_cut(const char *folder, const int64_t last) {
  cut c = {folder, last, CF_OK};
  CF_TRY(cf_folder_each(folder, visit_series, &c));
  CF_TRY(c.status);
  return cf_folder_cut_frames(folder, last);
}
