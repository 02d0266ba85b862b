/* SPDX-License-Identifier: MIT */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "base/mem.h"
#include "io/frame.h"
#include "io/hdf5.h"

static cf_status read_grid(cf_hdf5 *h, cf_grid *g) {
  int64_t extent[6], dim;
  double origin[3], spacing[3];
  char type[32];
  int cells[3];
  CF_TRY(cf_hdf5_get_text(h, "/VTKHDF", "Type", type, sizeof type));
  if (strcmp(type, "ImageData") != 0)
    return cf_fail(CF_BAD_FILE, "%s: holds %s, expected ImageData", h->draft.path.text, type);
  CF_TRY(cf_hdf5_get_integers(h, "/VTKHDF", "WholeExtent", 6, extent));
  CF_TRY(cf_hdf5_get_numbers(h, "/VTKHDF", "Origin", 3, origin));
  CF_TRY(cf_hdf5_get_numbers(h, "/VTKHDF", "Spacing", 3, spacing));
  CF_TRY(cf_hdf5_get_integers(h, "/", "dim", 1, &dim));
  for (int a = 0; a < 3; ++a) {
    if (extent[2 * a] != 0 || extent[2 * a + 1] < 1 || extent[2 * a + 1] > 1 << 30)
      return cf_fail(CF_BAD_FILE, "%s: has an extent that makes no sense", h->draft.path.text);
    cells[a] = (int)extent[2 * a + 1];
  }
  if (dim < 2 || dim > 3 || (dim == 2 && cells[2] != 1))
    return cf_fail(CF_BAD_FILE, "%s: has a dimension that makes no sense", h->draft.path.text);
  if (cf_grid_init(g, (int)dim, cells, spacing[0], origin) == CF_OK &&
      cf_box_init(&g->box, (int)dim, cells, 0) == CF_OK)
    return CF_OK;
  char why[256];
  snprintf(why, sizeof why, "%s", cf_status_sentence());
  return cf_fail(CF_BAD_FILE, "%s: has a grid that makes no sense: %s", h->draft.path.text, why);
}

static cf_status read_stamp(cf_hdf5 *h, cf_frame *f) {
  CF_TRY(cf_hdf5_get_text(h, "/", "title", f->title, sizeof f->title));
  CF_TRY(cf_hdf5_get_text(h, "/", "version", f->version, sizeof f->version));
  CF_TRY(cf_hdf5_get_text(h, "/", "precision", f->precision, sizeof f->precision));
  CF_TRY(cf_hdf5_get_numbers(h, "/", "time", 1, &f->time));
  CF_TRY(cf_hdf5_get_integers(h, "/", "step", 1, &f->step));
  return cf_hdf5_get_integers(h, "/", "frame", 1, &f->frame);
}

static bool is_of_grid(const cf_array *a, const cf_box *b) {
  return a->n[0] == b->n[2] && a->n[1] == b->n[1] && a->n[2] == b->n[0];
}

static cf_status visit_field(void *context, cf_hdf5 *h, const char *name) {
  cf_frame *f = context;
  cf_path path;
  cf_array a;
  if (f->count == CF_FRAME_FIELDS || strlen(name) >= CF_NAME_MAX) return CF_OK;
  cf_frame_field *field = &f->field[f->count];
  CF_TRY(cf_path_make(&path, "/VTKHDF/CellData/%s", name));
  CF_TRY(cf_hdf5_shape(h, path.text, &a));
  if (a.rank < 3 || (a.rank == 4 && a.n[3] != 3) || !is_of_grid(&a, &f->grid.box)) return CF_OK;
  snprintf(field->name, sizeof field->name, "%s", name);
  if (cf_hdf5_get_text(h, path.text, "unit", field->unit, sizeof field->unit) != CF_OK) field->unit[0] = '\0';
  field->components = a.rank == 4 ? 3 : 1;
  ++f->count;
  return CF_OK;
}

cf_status cf_frame_read(cf_frame *f, const char *path) {
  cf_hdf5 h;
  *f = (cf_frame){.count = 0};
  CF_TRY(cf_path_make(&f->path, "%s", path));
  CF_TRY(cf_hdf5_open(&h, path));
  cf_status s = CF_OK;
  if (!cf_hdf5_has(&h, "/VTKHDF/CellData")) s = cf_fail(CF_BAD_FILE, "%s: is not a frame of fields", path);
  if (s == CF_OK) s = read_stamp(&h, f);
  if (s == CF_OK) s = read_grid(&h, &f->grid);
  if (s == CF_OK) s = cf_hdf5_each(&h, "/VTKHDF/CellData", visit_field, f);
  return cf_hdf5_close(&h, s);
}

static const cf_frame_field *find_field(const cf_frame *f, const char *name) {
  for (int i = 0; i < f->count; ++i)
    if (strcmp(f->field[i].name, name) == 0) return &f->field[i];
  return NULL;
}

static cf_status no_field(const cf_frame *f, const char *name) {
  char list[512] = "none";
  for (int i = 0; i < f->count; ++i) {
    const size_t length = i == 0 ? 0 : strlen(list);
    snprintf(list + length, sizeof list - length, "%s%s", i > 0 ? ", " : "", f->field[i].name);
  }
  return cf_fail(CF_BAD_ARGUMENT, "%s: has no field \"%s\"; it has: %s", f->path.text, name, list);
}

cf_status cf_frame_read_cell(const cf_frame *f, const char *name, const int component, const cf_cell values) {
  const cf_frame_field *field = find_field(f, name);
  const cf_slabs slabs = cf_slabs_of_cell(&f->grid.box, values);
  cf_path path;
  cf_hdf5 h;
  if (field == NULL) return no_field(f, name);
  if (component >= field->components)
    return cf_fail(CF_BAD_ARGUMENT, "%s: component %d of %s, which has %d", f->path.text, component, name,
                   field->components);
  CF_TRY(cf_path_make(&path, "/VTKHDF/CellData/%s", name));
  CF_TRY(cf_hdf5_open(&h, f->path.text));
  return cf_hdf5_close(&h, cf_hdf5_read_component(&h, path.text, &slabs, field->components, component));
}
