/* SPDX-License-Identifier: MIT */
#include "io/info.h"

#include <inttypes.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "base/mem.h"
#include "grid/sweep.h"
#include "io/checkpoint.h"
#include "io/checksum.h"
#include "io/frame.h"
#include "io/hdf5.h"

#define NUMBERS_SHOWN 4

/* --- text that grows ---------------------------------------------------------------------------------------- */

typedef struct report {
  char *text;
  size_t length, room;
  cf_checksum all; /* of the arrays of a file: of their checksums, in order */
} report;

static cf_status say(report *r, const char *format, ...) CF_PRINTF(2, 3);

static cf_status say(report *r, const char *format, ...) {
  char line[2 * CF_SENTENCE_MAX];
  va_list values;
  va_start(values, format);
  vsnprintf(line, sizeof line, format, values);
  va_end(values);
  const size_t more = strlen(line);
  if (r->length + more + 1 > r->room) {
    char *larger;
    const size_t room = 2 * (r->room + more + 1);
    CF_TRY(CF_NEW(&larger, room));
    if (r->length > 0) memcpy(larger, r->text, r->length);
    cf_free(r->text);
    r->text = larger;
    r->room = room;
  }
  memcpy(r->text + r->length, line, more + 1);
  r->length += more;
  return CF_OK;
}

/* --- one array ------------------------------------------------------------------------------------------------ */

typedef struct facts {
  cf_range range;
  uint64_t checksum;
  bool finite;
  int where[3];
} facts;

/* One component of an array (of a field, or with `shape` of rank 1 or 2 of particles), read without gaps. */
static cf_status read_array(cf_hdf5 *h, const char *path, const cf_array *shape, const int component,
                            facts *a) {
  const bool field = shape->rank > 2;
  const int lead = field ? 3 : 1, n = (int)shape->n[0];
  cf_box b = {.dim = 3, .n = {n, 1, 1}, .stride = {1, n, n}};
  cf_real *values;
  double *rows;
  if (field) b = (cf_box){.dim = 3, .n = {(int)shape->n[2], (int)shape->n[1], n}};
  if (field) b.stride[0] = 1, b.stride[1] = b.n[0], b.stride[2] = (ptrdiff_t)b.n[0] * b.n[1];
  CF_TRY(CF_NEW(&values, cf_box_cells(&b)));
  cf_slabs s = cf_slabs_of_cell(&b, (cf_cell){values});
  if (!field) s = cf_slabs_of_list(n, 1, &values);
  cf_status status =
      cf_hdf5_read_component(h, path, &s, shape->rank > lead ? (int)shape->n[lead] : 1, component);
  if (status == CF_OK) status = CF_NEW(&rows, 3 * (size_t)cf_box_rows(&b));
  if (status == CF_OK) {
    a->range = cf_sweep_range(&b, 1, values, rows);
    a->finite = cf_sweep_finite(&b, 1, values, a->where) != 0;
    a->checksum = cf_checksum_of(values, (size_t)cf_box_cells(&b), sizeof *values);
    cf_free(rows);
  }
  cf_free(values);
  return status;
}

static void add_to_all(report *r, const uint64_t checksum) {
  cf_checksum_add_values(&r->all, &checksum, 1, 8);
}

static cf_status say_facts(report *r, const char *name, const char *unit, const facts *a,
                           const double weight) {
  add_to_all(r, a->checksum);
  CF_TRY(say(r, "  %-16s %-10s %24.17g %24.17g %24.17g  %016" PRIx64 "%s", name, unit, a->range.min,
             a->range.max, a->range.sum * weight, a->checksum, a->finite ? "\n" : "  NOT FINITE"));
  if (a->finite) return CF_OK;
  return say(r, " at (%d, %d, %d)\n", a->where[0], a->where[1], a->where[2]);
}

/* --- a file --------------------------------------------------------------------------------------------------- */

typedef struct listing {
  report *r;
  const char *group;        /* "/state" ... */
  char prefix[CF_NAME_MAX]; /* "q/" where the group is an entry of several parts */
  double volume;            /* of a cell */
  bool list;                /* arrays of one value a particle, not of numbers */
} listing;

static cf_status say_group(report *r, cf_hdf5 *h, const char *group, const char *prefix, double volume);

static cf_status say_numbers(report *r, cf_hdf5 *h, const char *path, const char *name,
                             const cf_array *shape) {
  double *values;
  const cf_array a = {CF_ELEMENT_NUMBER, 1, {shape->n[0]}};
  CF_TRY(CF_NEW(&values, shape->n[0]));
  cf_status s = cf_hdf5_read(h, path, &a, values);
  if (s == CF_OK) s = say(r, "  %-16s", name);
  for (int64_t i = 0; s == CF_OK && i < shape->n[0] && i < NUMBERS_SHOWN; ++i)
    s = say(r, " %.17g", values[i]);
  if (s == CF_OK)
    s = say(r, shape->n[0] > NUMBERS_SHOWN ? " ... (%" PRId64 " numbers)\n" : "\n", shape->n[0]);
  cf_free(values);
  return s;
}

/* The unit stands at the array, or (faces of a checkpoint) at its group. */
static void find_unit(cf_hdf5 *h, const char *path, char unit[CF_NAME_MAX]) {
  cf_path group;
  if (cf_hdf5_get_text(h, path, "unit", unit, CF_NAME_MAX) == CF_OK) return;
  snprintf(group.text, sizeof group.text, "%s", path);
  *strrchr(group.text, '/') = '\0';
  if (cf_hdf5_get_text(h, group.text, "unit", unit, CF_NAME_MAX) != CF_OK) unit[0] = '\0';
}

/* Ids. */
static cf_status say_integers(report *r, cf_hdf5 *h, const char *path, const char *name,
                              const cf_array *shape) {
  const cf_array a = {CF_ELEMENT_INTEGER, 1, {shape->n[0]}};
  int64_t *values, least, most;
  CF_TRY(CF_NEW(&values, shape->n[0]));
  cf_status s = cf_hdf5_read(h, path, &a, values);
  if (s == CF_OK) {
    least = most = values[0];
    for (int64_t i = 1; i < shape->n[0]; ++i)
      least = CF_MIN(least, values[i]), most = CF_MAX(most, values[i]);
    const uint64_t sum = cf_checksum_of(values, (size_t)shape->n[0], sizeof *values);
    add_to_all(r, sum);
    s = say(r, "  %-16s %-10s %24" PRId64 " %24" PRId64 " %24s  %016" PRIx64 "\n", name, "", least, most, "",
            sum);
  }
  cf_free(values);
  return s;
}

static cf_status say_components(report *r, cf_hdf5 *h, const char *path, const char *name,
                                const cf_array *shape, const double weight) {
  char unit[CF_NAME_MAX], full[2 * CF_NAME_MAX];
  const int lead = shape->rank > 2 ? 3 : 1, components = shape->rank > lead ? (int)shape->n[lead] : 1;
  find_unit(h, path, unit);
  for (int c = 0; c < components; ++c) {
    facts a;
    CF_TRY(read_array(h, path, shape, c, &a));
    snprintf(full, sizeof full, components > 1 ? "%s.%c" : "%s", name,
             components <= 3 ? "xyz"[c] : '0' + c % 10);
    CF_TRY(say_facts(r, full, unit, &a, weight));
  }
  return CF_OK;
}

static cf_status visit_array(void *context, cf_hdf5 *h, const char *name) {
  const listing *l = context;
  cf_path path;
  cf_array shape;
  char full[2 * CF_NAME_MAX];
  CF_TRY(cf_path_make(&path, "%s/%s", l->group, name));
  snprintf(full, sizeof full, "%s%s", l->prefix, name);
  if (cf_hdf5_shape(h, path.text, &shape) != CF_OK) return say_group(l->r, h, path.text, full, 1);
  if (shape.rank > 2) return say_components(l->r, h, path.text, full, &shape, l->volume);
  if (shape.n[0] == 0) return say(l->r, "  %-16s none\n", full);
  if (shape.rank == 1 && !l->list) return say_numbers(l->r, h, path.text, full, &shape);
  if (shape.n[0] > INT32_MAX) return say(l->r, "  %-16s %" PRId64 " values\n", full, shape.n[0]);
  if (shape.element == CF_ELEMENT_INTEGER) return say_integers(l->r, h, path.text, full, &shape);
  return say_components(l->r, h, path.text, full, &shape, 1);
}

/* `prefix`, if not "", is the name of a face field or a set of particles, whose parts the group holds. */
static cf_status say_group(report *r, cf_hdf5 *h, const char *group, const char *prefix,
                           const double volume) {
  listing l = {r, group, "", volume, prefix[0] != '\0' || strcmp(group, "/VTKHDF/PointData") == 0};
  if (prefix[0] != '\0') snprintf(l.prefix, sizeof l.prefix, "%.60s/", prefix);
  return cf_hdf5_has(h, group) ? cf_hdf5_each(h, group, visit_array, &l) : CF_OK;
}

static cf_status say_head(report *r, cf_hdf5 *h) {
  char title[256], version[64], precision[16];
  double time;
  int64_t step;
  CF_TRY(cf_hdf5_get_text(h, "/", "title", title, sizeof title));
  CF_TRY(cf_hdf5_get_text(h, "/", "version", version, sizeof version));
  CF_TRY(cf_hdf5_get_text(h, "/", "precision", precision, sizeof precision));
  CF_TRY(cf_hdf5_get_numbers(h, "/", "time", 1, &time));
  CF_TRY(cf_hdf5_get_integers(h, "/", "step", 1, &step));
  CF_TRY(say(r, "  scene    %s\n  program  Cattaneo %s, %s precision%s\n", title, version, precision,
             strcmp(precision, CF_PRECISION) == 0 ? ""
                                                  : " (checksums are of the values as read, in " CF_PRECISION
                                                    ")"));
  return say(r, "  time     %.17g s, step %" PRId64 "\n", time, step);
}

static const char columns[] =
    "  field            unit                            min                      max                      "
    "sum  "
    "checksum\n";

static cf_status say_state(report *r, cf_hdf5 *h) {
  int64_t dim, n[3];
  double spacing;
  CF_TRY(say_head(r, h));
  CF_TRY(cf_hdf5_get_integers(h, "/", "dim", 1, &dim));
  CF_TRY(cf_hdf5_get_integers(h, "/", "cells", 3, n));
  CF_TRY(cf_hdf5_get_numbers(h, "/", "spacing", 1, &spacing));
  CF_TRY(say(r, "  grid     %" PRId64 " x %" PRId64 " x %" PRId64 " cells, h = %.17g m\n%s", n[0], n[1], n[2],
             spacing, columns));
  return say_group(r, h, "/state", "", pow(spacing, (double)dim));
}

/* Where particles are, or the vertices of a surface, and its triangles. */
static cf_status say_points(report *r, cf_hdf5 *h) {
  const listing l = {.r = r, .group = "/VTKHDF", .list = true};
  const listing triangles = {.r = r, .group = "/VTKHDF/Polygons", .prefix = "triangles/", .list = true};
  cf_array shape;
  CF_TRY(visit_array((void *)(uintptr_t)&l, h, "Points"));
  CF_TRY(cf_hdf5_shape(h, "/VTKHDF/Polygons/Connectivity", &shape));
  return shape.n[0] > 0 ? visit_array((void *)(uintptr_t)&triangles, h, "Connectivity") : CF_OK;
}

static cf_status say_frame(report *r, cf_hdf5 *h) {
  char type[32];
  int64_t dim, extent[6];
  double spacing[3] = {1, 1, 1};
  CF_TRY(say_head(r, h));
  CF_TRY(cf_hdf5_get_text(h, "/VTKHDF", "Type", type, sizeof type));
  CF_TRY(cf_hdf5_get_integers(h, "/", "dim", 1, &dim));
  if (strcmp(type, "ImageData") == 0) {
    CF_TRY(cf_hdf5_get_integers(h, "/VTKHDF", "WholeExtent", 6, extent));
    CF_TRY(cf_hdf5_get_numbers(h, "/VTKHDF", "Spacing", 3, spacing));
    CF_TRY(say(r, "  grid     %" PRId64 " x %" PRId64 " x %" PRId64 " cells, h = %.17g m\n", extent[1],
               extent[3], extent[5], spacing[0]));
  }
  CF_TRY(say(r, "%s", columns));
  CF_TRY(say_group(r, h, "/VTKHDF/CellData", "", pow(spacing[0], (double)dim)));
  CF_TRY(say_group(r, h, "/faces", "", 1));
  if (strcmp(type, "PolyData") == 0) CF_TRY(say_points(r, h));
  return say_group(r, h, "/VTKHDF/PointData", "", 1);
}

static cf_status say_all(report *r, const cf_status so_far) {
  CF_TRY(so_far);
  return say(r, "  checksum of all arrays: %016" PRIx64 "\n", cf_checksum_end(&r->all));
}

static cf_status say_file(report *r, const char *path) {
  cf_hdf5 h;
  cf_checksum_start(&r->all);
  const cf_status whole = cf_checkpoint_check(path);
  if (whole == CF_OK) {
    CF_TRY(say(r, "%s: a checkpoint, whole\n", path));
    CF_TRY(cf_hdf5_open(&h, path));
    return cf_hdf5_close(&h, say_all(r, say_state(r, &h)));
  }
  /* A damaged checkpoint is not handed to HDF5. */
  if (strstr(cf_status_sentence(), "is not a checkpoint") == NULL) return whole;
  CF_TRY(cf_hdf5_open(&h, path));
  cf_status s = CF_OK;
  if (!cf_hdf5_has(&h, "/VTKHDF")) s = cf_fail(CF_BAD_FILE, "%s: is neither a frame nor a checkpoint", path);
  if (s == CF_OK) s = say(r, "%s: a frame\n", path);
  if (s == CF_OK) s = say_all(r, say_frame(r, &h));
  return cf_hdf5_close(&h, s);
}

/* --- a folder ------------------------------------------------------------------------------------------------- */

static cf_status say_checkpoints(report *r, const char *path) {
  int count;
  int64_t *steps;
  cf_status s;
  CF_TRY(cf_folder_numbers(path, "checkpoint", "h5", &count, &steps));
  s = say(r, "  checkpoints  %d\n", count);
  for (int i = 0; i < count && s == CF_OK; ++i) {
    cf_path file;
    s = cf_path_make(&file, "%s/checkpoint_%06" PRId64 ".h5", path, steps[i]);
    if (s != CF_OK) break;
    const bool whole = cf_checkpoint_check(file.text) == CF_OK;
    s = whole ? say(r, "    step %" PRId64 ": whole\n", steps[i])
              : say(r, "    step %" PRId64 ": not usable: %s\n", steps[i], cf_status_sentence());
  }
  cf_free(steps);
  return s;
}

typedef struct search {
  int64_t latest; /* number of the last frame, -1: none */
  int files;      /* VTKHDF files of that frame */
  cf_path file[8];
  const char *folder;
} search;

static bool is_frame(const char *name, int64_t *number) {
  const char *dot = strrchr(name, '.');
  return dot != NULL && strcmp(dot, ".vtkhdf") == 0 && cf_file_kind_of(name, number) == CF_FILE_FRAME;
}

static void visit_latest(void *context, const char *name) {
  search *s = context;
  int64_t number;
  if (is_frame(name, &number)) s->latest = CF_MAX(s->latest, number);
}

static void visit_files(void *context, const char *name) {
  search *s = context;
  int64_t number;
  if (!is_frame(name, &number) || number != s->latest || s->files == 8) return;
  if (cf_path_make(&s->file[s->files], "%s/%s", s->folder, name) == CF_OK) ++s->files;
}

static int compare_paths(const void *a, const void *b) {
  return strcmp(((const cf_path *)a)->text, ((const cf_path *)b)->text);
}

/* How many frames there are of what the file shows. */
static cf_status count_frames(const char *folder, const char *file, int *count) {
  const char *name = strrchr(file, '/') + 1, *bar = strrchr(name, '_');
  char word[CF_PATH_MAX];
  int64_t *numbers;
  snprintf(word, sizeof word, "%.*s", (int)(bar - name), name);
  CF_TRY(cf_folder_numbers(folder, word, "vtkhdf", count, &numbers));
  cf_free(numbers);
  return CF_OK;
}

/* Frames, checkpoints, and what the last frame's files hold: fields, surface, particles. */
static cf_status say_folder(report *r, const char *path) {
  search s = {.latest = -1, .folder = path};
  int frames = 0;
  CF_TRY(cf_folder_each(path, visit_latest, &s));
  CF_TRY(cf_folder_each(path, visit_files, &s));
  qsort(s.file, (size_t)s.files, sizeof *s.file, compare_paths);
  if (s.files > 0) CF_TRY(count_frames(path, s.file[0].text, &frames));
  CF_TRY(say(r, "%s: the folder of a run\n  frames       %d\n", path, frames));
  CF_TRY(say_checkpoints(r, path));
  for (int i = 0; i < s.files; ++i) CF_TRY(say_file(r, s.file[i].text));
  return CF_OK;
}

cf_status cf_info_text(const char *path, char **text) {
  report r = {.text = NULL};
  struct stat what;
  *text = NULL;
  const bool folder = stat(path, &what) == 0 && S_ISDIR(what.st_mode);
  const cf_status s = folder ? say_folder(&r, path) : say_file(&r, path);
  if (s == CF_OK)
    *text = r.text;
  else
    cf_free(r.text);
  return s;
}
