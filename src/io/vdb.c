/* SPDX-License-Identifier: MIT */
#include "io/vdb.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "base/mem.h"
#include "base/version.h"
#include "io/folder.h"

#ifdef CF_WITH_OPENVDB
bool cf_vdb_built(void) { return true; }
#else
bool cf_vdb_built(void) { return false; }

bool cf_vdb_shim_write(const cf_vdb_file *file, char *why, const size_t size) {
  (void)file;
  snprintf(why, size, "this program was built without OpenVDB");
  return false;
}

bool cf_vdb_shim_look(const char *path, const cf_vdb_viewer *viewer, char *why, const size_t size) {
  (void)path;
  (void)viewer;
  snprintf(why, size, "this program was built without OpenVDB");
  return false;
}
#endif

cf_status cf_vdb_look(const char *path, const cf_vdb_viewer *viewer) {
  char why[256];
  if (cf_vdb_shim_look(path, viewer, why, sizeof why)) return CF_OK;
  return cf_fail(CF_BAD_FILE, "%s: cannot be read as a volume: %s", path, why);
}

/* --- fields as rows of voxels ----------------------------------------------------------------------------- */

/* The values of a component, and how many voxels have one; beyond them they are 0. */
typedef struct source {
  const cf_box *box;
  const cf_real *at[3];
  int n[3][3];
} source;

static void read_row(const void *context, const int component, const int j, const int k, float *values) {
  const source *s = context;
  const int *n = s->n[component];
  const bool there = s->at[component] != NULL && j < n[1] && k < n[2];
  const cf_real *row = there ? s->at[component] + cf_box_at(s->box, 0, j, k) : NULL;
  const int length = s->box->n[0] + 1;
  for (int i = 0; i < length; ++i) values[i] = there && i < n[0] ? (float)row[i] : 0;
}

static double largest(const source *s, const int components) {
  double most = 0;
  for (int c = 0; c < components; ++c)
    for (int k = 0; s->at[c] != NULL && k < s->n[c][2]; ++k)
      for (int j = 0; j < s->n[c][1]; ++j) {
        const cf_real *row = s->at[c] + cf_box_at(s->box, 0, j, k);
        for (int i = 0; i < s->n[c][0]; ++i) most = fmax(most, fabs((double)row[i]));
      }
  return most;
}

static source source_of(const cf_box *b, const cf_entry *e) {
  source s = {.box = b};
  const bool faces = e->kind == CF_KIND_FACE;
  for (int c = 0; c < (faces ? b->dim : 1); ++c) {
    s.at[c] = faces ? e->face.at[c] : e->cell.at;
    for (int a = 0; a < 3; ++a) s.n[c][a] = cf_box_extent(b, a, faces ? c : -1);
  }
  return s;
}

/* --- names ------------------------------------------------------------------------------------------------ */

static bool is_written(const cf_vdb_plan *plan, const cf_entry *e) {
  return (e->kind == CF_KIND_CELL || e->kind == CF_KIND_FACE) && cf_choice_has(&plan->choice, e);
}

/* The field that is called density: the one of that name, or the first scalar. */
static const cf_entry *find_density(const cf_registry *r, const cf_vdb_plan *plan) {
  const cf_entry *first = NULL;
  for (int i = 0; i < r->count; ++i) {
    const cf_entry *e = &r->entry[i];
    if (!is_written(plan, e) || e->kind != CF_KIND_CELL) continue;
    if (strcmp(e->name, "density") == 0) return e;
    if (first == NULL) first = e;
  }
  return first;
}

static const char *name_of(const cf_entry *e, const cf_entry *density) {
  if (e == density) return "density";
  return e->kind == CF_KIND_FACE && strcmp(e->name, "velocity") == 0 ? "vel" : e->name;
}

/* --- a file ----------------------------------------------------------------------------------------------- */

typedef struct job {
  source *source;
  cf_vdb_grid *grid;
  int grids;
} job;

static void add_grid(job *w, const cf_registry *r, const cf_vdb_plan *plan, const cf_entry *e,
                     const cf_entry *density) {
  const cf_box *b = &r->grid->box;
  source *s = &w->source[w->grids];
  cf_vdb_grid *g = &w->grid[w->grids++];
  *s = source_of(b, e);
  *g = (cf_vdb_grid){.name = name_of(e, density),
                     .unit = e->unit,
                     .field = e->name,
                     .components = e->kind == CF_KIND_FACE ? 3 : 1,
                     .row = read_row,
                     .context = s,
                     .n = {b->n[0] + 1, b->n[1], b->n[2]}};
  if (e->kind == CF_KIND_FACE) ++g->n[1];
  if (e->kind == CF_KIND_FACE && b->dim == 3) ++g->n[2];
  g->least = (float)(plan->prune * largest(s, g->components));
}

static cf_status write_file(const char *path, const cf_registry *r, const cf_vdb_plan *plan,
                            const cf_stamp *stamp, const job *w) {
  const cf_grid *g = r->grid;
  char program[64], why[256];
  cf_draft draft;
  CF_TRY(cf_draft_begin(&draft, path));
  snprintf(program, sizeof program, "Cattaneo %s", cf_version());
  cf_vdb_file file = {.path = draft.temporary.text,
                      .h = g->h,
                      .half = plan->half,
                      .grids = w->grids,
                      .grid = w->grid,
                      .title = stamp->title == NULL ? "" : stamp->title,
                      .program = program,
                      .time = stamp->time,
                      .rate = plan->rate,
                      .step = stamp->step};
  for (int a = 0; a < 3; ++a) file.place[a] = (a < g->box.dim ? g->origin[a] : 0) + g->h / 2;
  if (cf_vdb_shim_write(&file, why, sizeof why)) return cf_draft_keep(&draft);
  cf_draft_drop(&draft);
  return cf_fail(CF_CANNOT_WRITE, "%s: cannot be written: %s", path, why);
}

cf_status cf_vdb_write(const char *folder, const int64_t frame, const cf_registry *r, const cf_vdb_plan *plan,
                       const cf_stamp *stamp) {
  job w = {0};
  cf_path path;
  if (!cf_vdb_built())
    return cf_fail(CF_BAD_USAGE,
                   "VDB files need OpenVDB, which this program was built without: install libopenvdb-dev and "
                   "libboost-dev and build again, or take vdb out of output.formats");
  CF_TRY(cf_choice_check(&plan->choice, r));
  CF_TRY(cf_path_make(&path, "%s/fields_%06" PRId64 ".vdb", folder, frame));
  const cf_entry *density = find_density(r, plan);
  CF_TRY(CF_NEW(&w.source, r->count));
  cf_status s = CF_NEW(&w.grid, r->count);
  for (int e = 0; s == CF_OK && e < r->count; ++e)
    if (is_written(plan, &r->entry[e])) add_grid(&w, r, plan, &r->entry[e], density);
  if (s == CF_OK && w.grids > 0) s = write_file(path.text, r, plan, stamp, &w);
  cf_free(w.source);
  cf_free(w.grid);
  return s;
}
