/* SPDX-License-Identifier: MIT
 *
 * Writing frames of fields. (Particles and surfaces: frame_poly.c. Reading: frame_read.c.)
 */
#include "io/frame.h"

#include <inttypes.h>
#include <stdio.h>
#include <string.h>

#include "base/version.h"
#include "io/frame_part.h"
#include "io/series.h"

/* --- parts of a file --------------------------------------------------------------------------------------
 */

static cf_status write_stamp(cf_hdf5 *h, const cf_frame_job *j) {
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
cf_status cf_frame_root(cf_hdf5 *h, const cf_frame_job *j, const char *type) {
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

static cf_status write_parts(cf_hdf5 *h, const cf_frame_job *j, const cf_entry *e, const char *group) {
  cf_path path;
  cf_part part;
  for (int i = 0; cf_part_of(j->r, e, i, &part); ++i) {
    CF_TRY(cf_path_make(&path, "%s/%s", group, part.name));
    CF_TRY(cf_hdf5_write_part(h, path.text, &part, j->plan->compression, NULL));
  }
  return CF_OK;
}

/* As vectors for the eye, and as they are. */
static cf_status write_face(cf_hdf5 *h, const cf_frame_job *j, const cf_entry *e) {
  const cf_slabs means = cf_slabs_of_vectors(&j->r->grid->box, &e->face);
  cf_path path;
  CF_TRY(cf_path_make(&path, "/VTKHDF/CellData/%s", e->name));
  CF_TRY(cf_hdf5_write_slabs(h, path.text, &means, j->plan->compression, NULL));
  CF_TRY(cf_hdf5_set_text(h, path.text, "unit", e->unit));
  if (!cf_hdf5_has(h, "/faces")) CF_TRY(cf_hdf5_group(h, "/faces"));
  CF_TRY(cf_path_make(&path, "/faces/%s", e->name));
  CF_TRY(cf_hdf5_group(h, path.text));
  return write_parts(h, j, e, "/faces");
}

static cf_status write_entry(cf_hdf5 *h, const cf_frame_job *j, const cf_entry *e) {
  cf_path path;
  if (e->kind == CF_KIND_CELL) return write_parts(h, j, e, "/VTKHDF/CellData");
  if (e->kind == CF_KIND_FACE) return write_face(h, j, e);
  CF_TRY(cf_path_make(&path, "/VTKHDF/FieldData/%s", e->name));
  if (cf_hdf5_has(h, path.text)) return CF_OK; /* an entry of the name Time */
  return write_parts(h, j, e, "/VTKHDF/FieldData");
}

static bool is_field(const cf_frame_job *j, const cf_entry *e) {
  return e->kind != CF_KIND_PARTICLES && cf_choice_has(&j->plan->choice, e);
}

/* --- fields_000012.vtkhdf --------------------------------------------------------------------------------
 */

static cf_status fill_fields(cf_hdf5 *h, const cf_frame_job *j, const void *nothing) {
  (void)nothing;
  CF_TRY(cf_frame_root(h, j, "ImageData"));
  CF_TRY(write_shape(h, j->r->grid));
  CF_TRY(cf_hdf5_group(h, "/VTKHDF/CellData"));
  for (int e = 0; e < j->r->count; ++e)
    if (is_field(j, &j->r->entry[e])) CF_TRY(write_entry(h, j, &j->r->entry[e]));
  return CF_OK;
}

/* --- files ------------------------------------------------------------------------------------------------
 */

cf_status cf_frame_file(const char *folder, const cf_frame_job *j, const char *word, const cf_frame_fill fill,
                        const void *what) {
  cf_path path;
  cf_hdf5 h;
  CF_TRY(cf_path_make(&path, "%s/%s_%06" PRId64 ".vtkhdf", folder, word, j->frame));
  CF_TRY(cf_hdf5_create(&h, path.text, 0));
  CF_TRY(cf_hdf5_close(&h, fill(&h, j, what)));
  CF_TRY(cf_draft_keep(&h.draft));
  return cf_series_add(folder, word, j->frame, j->stamp->time);
}

/* A name is a name in the file. */
static cf_status check_names(const cf_registry *r) {
  for (int e = 0; e < r->count; ++e)
    if (strchr(r->entry[e].name, '/') != NULL)
      return cf_fail(CF_BAD_ARGUMENT, "a field named \"%s\": a slash cannot stand in a name",
                     r->entry[e].name);
  return CF_OK;
}

cf_status cf_frame_write(const char *folder, const int64_t frame, const cf_registry *r,
                         const cf_frame_plan *plan, const cf_stamp *stamp) {
  const cf_frame_job j = {r, plan, stamp, frame};
  bool fields = false;
  CF_TRY(check_names(r));
  CF_TRY(cf_choice_check(&plan->choice, r));
  for (int e = 0; e < r->count; ++e) fields = fields || is_field(&j, &r->entry[e]);
  if (fields) CF_TRY(cf_frame_file(folder, &j, "fields", fill_fields, NULL));
  for (int e = 0; e < r->count; ++e)
    if (r->entry[e].kind == CF_KIND_PARTICLES && cf_choice_has(&plan->choice, &r->entry[e]))
      CF_TRY(cf_frame_particles(folder, &j, &r->entry[e]));
  return CF_OK;
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
