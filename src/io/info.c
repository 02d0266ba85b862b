/* SPDX-License-Identifier: MIT */
#include "io/info.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/mem.h"
#include "grid/sweep.h"
#include "io/checkpoint.h"
#include "io/checksum.h"
#include "io/frame.h"
#include "io/hdf5.h"
#include "io/info_part.h"

#define NUMBERS_SHOWN 4

/* --- one array ------------------------------------------------------------------------------------------------ */

typedef struct facts {
  cf_range range;
  uint64_t checksum;
  bool finite;
  int where[3];
} facts;

static cf_status look_at(const cf_box *b, const cf_real *values, facts *a) {
  double *rows;
  CF_TRY(CF_NEW(&rows, 3 * (size_t)cf_box_rows(b)));
  a->range = cf_sweep_range(b, 1, values, rows);
  a->finite = cf_sweep_finite(b, 1, values, a->where) != 0;
  a->checksum = cf_checksum_of(values, (size_t)cf_box_cells(b), sizeof *values);
  cf_free(rows);
  return CF_OK;
}

static cf_box list_box(const int n) { return (cf_box){.dim = 3, .n = {n, 1, 1}, .stride = {1, n, n}}; }

/* One component of an array (of a field, or with `shape` of rank 1 or 2 of particles), read without gaps. */
static cf_status read_array(cf_hdf5 *h, const char *path, const cf_array *shape, const int component,
                            facts *a) {
  const bool field = shape->rank > 2;
  const int lead = field ? 3 : 1, n = (int)shape->n[0];
  cf_box b = list_box(n);
  cf_real *values;
  if (field) b = (cf_box){.dim = 3, .n = {(int)shape->n[2], (int)shape->n[1], n}};
  if (field) b.stride[0] = 1, b.stride[1] = b.n[0], b.stride[2] = (ptrdiff_t)b.n[0] * b.n[1];
  CF_TRY(CF_NEW(&values, cf_box_cells(&b)));
  cf_slabs s = cf_slabs_of_cell(&b, (cf_cell){values});
  if (!field) s = cf_slabs_of_list(n, 1, &values);
  cf_status status =
      cf_hdf5_read_component(h, path, &s, shape->rank > lead ? (int)shape->n[lead] : 1, component);
  if (status == CF_OK) status = look_at(&b, values, a);
  cf_free(values);
  return status;
}

static void add_to_all(cf_report *r, const uint64_t checksum) {
  cf_checksum_add_values(&r->all, &checksum, 1, 8);
}

static cf_status say_facts(cf_report *r, const char *name, const char *unit, const facts *a,
                           const double weight) {
  add_to_all(r, a->checksum);
  CF_TRY(cf_report_say(r, "  %-16s %-10s %24.17g %24.17g %24.17g  %016" PRIx64 "%s", name, unit, a->range.min,
                       a->range.max, a->range.sum * weight, a->checksum, a->finite ? "\n" : "  NOT FINITE"));
  if (a->finite) return CF_OK;
  return cf_report_say(r, " at (%d, %d, %d)\n", a->where[0], a->where[1], a->where[2]);
}

const char cf_report_columns[] =
    "  field            unit                            min                      max                      "
    "sum  "
    "checksum\n";

cf_status cf_report_list(cf_report *r, const char *name, const char *unit, const int n,
                         const cf_real *values) {
  const cf_box b = list_box(n);
  facts a;
  CF_TRY(look_at(&b, values, &a));
  return say_facts(r, name, unit, &a, 1);
}

/* --- a file --------------------------------------------------------------------------------------------------- */

typedef struct listing {
  cf_report *r;
  const char *group;        /* "/state" ... */
  char prefix[CF_NAME_MAX]; /* "q/" where the group is an entry of several parts */
  double volume;            /* of a cell */
  bool list;                /* arrays of one value a particle, not of numbers */
} listing;

static cf_status say_group(cf_report *r, cf_hdf5 *h, const char *group, const char *prefix, double volume);

static cf_status say_numbers(cf_report *r, cf_hdf5 *h, const char *path, const char *name,
                             const cf_array *shape) {
  double *values;
  const cf_array a = {CF_ELEMENT_NUMBER, 1, {shape->n[0]}};
  CF_TRY(CF_NEW(&values, shape->n[0]));
  cf_status s = cf_hdf5_read(h, path, &a, values);
  if (s == CF_OK) s = cf_report_say(r, "  %-16s", name);
  for (int64_t i = 0; s == CF_OK && i < shape->n[0] && i < NUMBERS_SHOWN; ++i)
    s = cf_report_say(r, " %.17g", values[i]);
  if (s == CF_OK)
    s = cf_report_say(r, shape->n[0] > NUMBERS_SHOWN ? " ... (%" PRId64 " numbers)\n" : "\n", shape->n[0]);
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
static cf_status say_integers(cf_report *r, cf_hdf5 *h, const char *path, const char *name,
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
    s = cf_report_say(r, "  %-16s %-10s %24" PRId64 " %24" PRId64 " %24s  %016" PRIx64 "\n", name, "", least,
                      most, "", sum);
  }
  cf_free(values);
  return s;
}

static cf_status say_components(cf_report *r, cf_hdf5 *h, const char *path, const char *name,
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
  if (shape.n[0] == 0) return cf_report_say(l->r, "  %-16s none\n", full);
  if (shape.rank == 1 && !l->list) return say_numbers(l->r, h, path.text, full, &shape);
  if (shape.n[0] > INT32_MAX) return cf_report_say(l->r, "  %-16s %" PRId64 " values\n", full, shape.n[0]);
  if (shape.element == CF_ELEMENT_INTEGER) return say_integers(l->r, h, path.text, full, &shape);
  return say_components(l->r, h, path.text, full, &shape, 1);
}

/* `prefix`, if not "", is the name of a face field or a set of particles, whose parts the group holds. */
static cf_status say_group(cf_report *r, cf_hdf5 *h, const char *group, const char *prefix,
                           const double volume) {
  listing l = {r, group, "", volume, prefix[0] != '\0' || strcmp(group, "/VTKHDF/PointData") == 0};
  if (prefix[0] != '\0') snprintf(l.prefix, sizeof l.prefix, "%.60s/", prefix);
  return cf_hdf5_has(h, group) ? cf_hdf5_each(h, group, visit_array, &l) : CF_OK;
}

static cf_status say_head(cf_report *r, cf_hdf5 *h) {
  char title[256], version[64], precision[16];
  double time;
  int64_t step;
  CF_TRY(cf_hdf5_get_text(h, "/", "title", title, sizeof title));
  CF_TRY(cf_hdf5_get_text(h, "/", "version", version, sizeof version));
  CF_TRY(cf_hdf5_get_text(h, "/", "precision", precision, sizeof precision));
  CF_TRY(cf_hdf5_get_numbers(h, "/", "time", 1, &time));
  CF_TRY(cf_hdf5_get_integers(h, "/", "step", 1, &step));
  CF_TRY(cf_report_say(
      r, "  scene    %s\n  program  Cattaneo %s, %s precision%s\n", title, version, precision,
      strcmp(precision, CF_PRECISION) == 0 ? ""
                                           : " (checksums are of the values as read, in " CF_PRECISION ")"));
  return cf_report_say(r, "  time     %.17g s, step %" PRId64 "\n", time, step);
}

static cf_status say_state(cf_report *r, cf_hdf5 *h) {
  int64_t dim, n[3];
  double spacing;
  CF_TRY(say_head(r, h));
  CF_TRY(cf_hdf5_get_integers(h, "/", "dim", 1, &dim));
  CF_TRY(cf_hdf5_get_integers(h, "/", "cells", 3, n));
  CF_TRY(cf_hdf5_get_numbers(h, "/", "spacing", 1, &spacing));
  CF_TRY(cf_report_say(r, "  grid     %" PRId64 " x %" PRId64 " x %" PRId64 " cells, h = %.17g m\n%s", n[0],
                       n[1], n[2], spacing, cf_report_columns));
  return say_group(r, h, "/state", "", pow(spacing, (double)dim));
}

/* Where particles are, or the vertices of a surface, and its triangles. */
static cf_status say_points(cf_report *r, cf_hdf5 *h) {
  const listing l = {.r = r, .group = "/VTKHDF", .list = true};
  const listing triangles = {.r = r, .group = "/VTKHDF/Polygons", .prefix = "triangles/", .list = true};
  cf_array shape;
  CF_TRY(visit_array((void *)(uintptr_t)&l, h, "Points"));
  CF_TRY(cf_hdf5_shape(h, "/VTKHDF/Polygons/Connectivity", &shape));
  return shape.n[0] > 0 ? visit_array((void *)(uintptr_t)&triangles, h, "Connectivity") : CF_OK;
}

static cf_status say_frame(cf_report *r, cf_hdf5 *h) {
  char type[32];
  int64_t dim, extent[6];
  double spacing[3] = {1, 1, 1};
  CF_TRY(say_head(r, h));
  CF_TRY(cf_hdf5_get_text(h, "/VTKHDF", "Type", type, sizeof type));
  CF_TRY(cf_hdf5_get_integers(h, "/", "dim", 1, &dim));
  if (strcmp(type, "ImageData") == 0) {
    CF_TRY(cf_hdf5_get_integers(h, "/VTKHDF", "WholeExtent", 6, extent));
    CF_TRY(cf_hdf5_get_numbers(h, "/VTKHDF", "Spacing", 3, spacing));
    CF_TRY(cf_report_say(r, "  grid     %" PRId64 " x %" PRId64 " x %" PRId64 " cells, h = %.17g m\n",
                         extent[1], extent[3], extent[5], spacing[0]));
  }
  CF_TRY(cf_report_say(r, "%s", cf_report_columns));
  CF_TRY(say_group(r, h, "/VTKHDF/CellData", "", pow(spacing[0], (double)dim)));
  CF_TRY(say_group(r, h, "/faces", "", 1));
  if (strcmp(type, "PolyData") == 0) CF_TRY(say_points(r, h));
  return say_group(r, h, "/VTKHDF/PointData", "", 1);
}

static cf_status say_all(cf_report *r, const cf_status so_far) {
  CF_TRY(so_far);
  return cf_report_say(r, "  checksum of all arrays: %016" PRIx64 "\n", cf_checksum_end(&r->all));
}

static cf_status say_checkpoint(cf_report *r, const char *path) {
  cf_hdf5 h;
  CF_TRY(cf_report_say(r, "%s: a checkpoint, whole\n", path));
  CF_TRY(cf_hdf5_open(&h, path));
  return cf_hdf5_close(&h, say_state(r, &h));
}

static cf_status say_frame_file(cf_report *r, const char *path) {
  cf_hdf5 h;
  CF_TRY(cf_hdf5_open(&h, path));
  cf_status s = CF_OK;
  if (!cf_hdf5_has(&h, "/VTKHDF")) s = cf_fail(CF_BAD_FILE, "%s: is neither a frame nor a checkpoint", path);
  if (s == CF_OK) s = cf_report_say(r, "%s: a frame\n", path);
  if (s == CF_OK) s = say_frame(r, &h);
  return cf_hdf5_close(&h, s);
}

/* A file that is no checkpoint says so; a damaged one is not handed to HDF5. */
static cf_status say_ours(cf_report *r, const char *path) {
  const cf_status whole = cf_checkpoint_check(path);
  if (whole == CF_OK) return say_checkpoint(r, path);
  return strstr(cf_status_sentence(), "is not a checkpoint") != NULL ? say_frame_file(r, path) : whole;
}

static cf_status say_file(cf_report *r, const char *path) {
  static const struct {
    const char *ending;
    cf_status (*say)(cf_report *r, const char *path);
  } kinds[] = {{".ply", cf_report_mesh}, {".obj", cf_report_mesh}, {".vdb", cf_report_volume}};
  const char *dot = strrchr(path, '.');
  cf_checksum_start(&r->all);
  for (size_t k = 0; dot != NULL && k < sizeof kinds / sizeof *kinds; ++k)
    if (strcasecmp(dot, kinds[k].ending) == 0) return kinds[k].say(r, path);
  return say_all(r, say_ours(r, path));
}

/* --- a folder ------------------------------------------------------------------------------------------------- */

static cf_status say_checkpoints(cf_report *r, const char *path) {
  int count;
  int64_t *steps;
  cf_status s;
  CF_TRY(cf_folder_numbers(path, "checkpoint", "h5", &count, &steps));
  s = cf_report_say(r, "  checkpoints  %d\n", count);
  for (int i = 0; i < count && s == CF_OK; ++i) {
    cf_path file;
    s = cf_path_make(&file, "%s/checkpoint_%06" PRId64 ".h5", path, steps[i]);
    if (s != CF_OK) break;
    const bool whole = cf_checkpoint_check(file.text) == CF_OK;
    s = whole ? cf_report_say(r, "    step %" PRId64 ": whole\n", steps[i])
              : cf_report_say(r, "    step %" PRId64 ": not usable: %s\n", steps[i], cf_status_sentence());
  }
  cf_free(steps);
  return s;
}

typedef struct search {
  const char *ending; /* of the files that are looked for */
  int64_t latest;     /* number of the last frame, -1: none */
  int files;          /* of that frame */
  cf_path file[8];
  const char *folder;
} search;

static bool is_frame(const search *s, const char *name, int64_t *number) {
  const char *dot = strrchr(name, '.');
  return dot != NULL && strcmp(dot + 1, s->ending) == 0 && cf_file_kind_of(name, number) == CF_FILE_FRAME;
}

static void visit_latest(void *context, const char *name) {
  search *s = context;
  int64_t number;
  if (is_frame(s, name, &number)) s->latest = CF_MAX(s->latest, number);
}

static void visit_files(void *context, const char *name) {
  search *s = context;
  int64_t number;
  if (!is_frame(s, name, &number) || number != s->latest || s->files == 8) return;
  if (cf_path_make(&s->file[s->files], "%s/%s", s->folder, name) == CF_OK) ++s->files;
}

static int compare_paths(const void *a, const void *b) {
  return strcmp(((const cf_path *)a)->text, ((const cf_path *)b)->text);
}

/* How many frames there are of what the file shows. */
static cf_status count_frames(const search *s, int *count) {
  const char *name = strrchr(s->file[0].text, '/') + 1, *bar = strrchr(name, '_');
  char word[CF_PATH_MAX];
  int64_t *numbers;
  snprintf(word, sizeof word, "%.*s", (int)(bar - name), name);
  CF_TRY(cf_folder_numbers(s->folder, word, s->ending, count, &numbers));
  cf_free(numbers);
  return CF_OK;
}

/* The files of the last frame, in the format that says most of those the run wrote. */
static cf_status find_latest(search *s) {
  static const char *const endings[] = {"vtkhdf", "vdb", "ply", NULL};
  for (const char *const *ending = endings; s->latest < 0 && *ending != NULL; ++ending) {
    s->ending = *ending;
    CF_TRY(cf_folder_each(s->folder, visit_latest, s));
  }
  CF_TRY(cf_folder_each(s->folder, visit_files, s));
  qsort(s->file, (size_t)s->files, sizeof *s->file, compare_paths);
  return CF_OK;
}

/* Where there is nothing of a run. */
static cf_status refuse(const char *path) {
  int64_t *steps;
  cf_path scene;
  int checkpoints;
  CF_TRY(cf_path_make(&scene, "%s/run.yaml", path));
  CF_TRY(cf_folder_numbers(path, "checkpoint", "h5", &checkpoints, &steps));
  cf_free(steps);
  if (checkpoints > 0 || access(scene.text, F_OK) == 0) return CF_OK;
  return cf_fail(CF_BAD_FILE, "%s: is not the folder of a run: it has no run.yaml, frames or checkpoints",
                 path);
}

/* Frames, checkpoints, and what the last frame's files hold: fields, surface, particles. */
static cf_status say_folder(cf_report *r, const char *path) {
  search s = {.latest = -1, .folder = path};
  int frames = 0;
  CF_TRY(find_latest(&s));
  CF_TRY(s.files > 0 ? count_frames(&s, &frames) : refuse(path));
  CF_TRY(cf_report_say(r, "%s: the folder of a run\n  frames       %d\n", path, frames));
  CF_TRY(say_checkpoints(r, path));
  for (int i = 0; i < s.files; ++i) CF_TRY(say_file(r, s.file[i].text));
  return CF_OK;
}

cf_status cf_info_text(const char *path, char **text) {
  cf_report r = {.text = NULL};
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
