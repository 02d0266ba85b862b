/* SPDX-License-Identifier: MIT */
#include "io/points.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "base/mem.h"
#include "base/real.h"
#include "io/hdf5.h"

/* All of an array of one or two axes, `has` numbers a row. */
static cf_status read_rows(cf_hdf5 *h, const char *path, int64_t *rows, int *has, cf_real **values) {
  cf_array a;
  CF_TRY(cf_hdf5_shape(h, path, &a));
  if (a.rank > 2 || a.n[0] < 0 || (a.rank == 2 && (a.n[1] < 1 || a.n[1] > 64)))
    return cf_fail(CF_BAD_FILE, "%s: %s has a shape that makes no sense", h->draft.path.text, path);
  *rows = a.n[0], *has = a.rank == 2 ? (int)a.n[1] : 1;
  a.element = CF_ELEMENT_REAL;
  CF_TRY(CF_NEW(values, CF_MAX((size_t)*rows * (size_t)*has, 1)));
  const cf_status s = cf_hdf5_read(h, path, &a, *values);
  if (s == CF_OK) return CF_OK;
  cf_free(*values);
  *values = NULL;
  return s;
}

static cf_status read_places(cf_points *p, cf_hdf5 *h) {
  cf_real *values;
  int has;
  if (!cf_hdf5_has(h, "/VTKHDF/Points"))
    return cf_fail(CF_BAD_FILE, "%s: is not a frame of particles", p->path.text);
  CF_TRY(cf_hdf5_get_numbers(h, "/", "time", 1, &p->time));
  CF_TRY(read_rows(h, "/VTKHDF/Points", &p->count, &has, &values));
  cf_status s = has == 3 ? CF_NEW(&p->place, CF_MAX(p->count, 1))
                         : cf_fail(CF_BAD_FILE, "%s: places of %d numbers", p->path.text, has);
  for (int64_t i = 0; s == CF_OK && i < p->count; ++i)
    for (int a = 0; a < 3; ++a) p->place[i][a] = (float)values[3 * i + a];
  cf_free(values);
  return s;
}

cf_status cf_points_read(cf_points *p, const char *path) {
  cf_hdf5 h;
  *p = (cf_points){.count = 0};
  CF_TRY(cf_path_make(&p->path, "%s", path));
  CF_TRY(cf_hdf5_open(&h, path));
  const cf_status s = cf_hdf5_close(&h, read_places(p, &h));
  if (s != CF_OK) cf_points_clear(p);
  return s;
}

void cf_points_clear(cf_points *p) {
  cf_free(p->place);
  *p = (cf_points){.count = 0};
}

typedef struct listing {
  char text[512];
} listing;

static cf_status add_name(void *context, cf_hdf5 *h, const char *name) {
  listing *l = context;
  const size_t length = strlen(l->text);
  (void)h;
  snprintf(l->text + length, sizeof l->text - length, "%s%s", length > 0 ? ", " : "", name);
  return CF_OK;
}

/* Keeps `wanted` of `has` numbers a row, or the length of all. */
static void pick(const cf_real *in, const int64_t rows, const int has, const int wanted, float *out) {
  for (int64_t i = 0; i < rows; ++i) {
    double square = 0;
    for (int c = 0; c < has; ++c) square += (double)in[i * has + c] * (double)in[i * has + c];
    for (int c = 0; c < wanted; ++c)
      out[i * wanted + c] = wanted == 1 && has > 1 ? (float)sqrt(square) : (float)in[i * has + c];
  }
}

static cf_status read_attribute(const cf_points *p, cf_hdf5 *h, const char *name, const int components,
                                float **values) {
  cf_path path;
  cf_real *rows;
  int64_t count;
  int has;
  CF_TRY(cf_path_make(&path, "/VTKHDF/PointData/%s", name));
  if (!cf_hdf5_has(h, path.text)) {
    listing l = {""};
    CF_TRY(cf_hdf5_each(h, "/VTKHDF/PointData", add_name, &l));
    return cf_fail(CF_BAD_FILE, "%s: has no attribute \"%s\"; it has: %s", p->path.text, name, l.text);
  }
  CF_TRY(read_rows(h, path.text, &count, &has, &rows));
  cf_status s = CF_OK;
  if (count != p->count || has < components)
    s = cf_fail(CF_BAD_FILE, "%s: %s has %lld times %d numbers, expected %lld times %d", p->path.text, name,
                (long long)count, has, (long long)p->count, components);
  if (s == CF_OK) s = CF_NEW(values, CF_MAX((size_t)count * (size_t)components, 1));
  if (s == CF_OK) pick(rows, count, has, components, *values);
  cf_free(rows);
  return s;
}

cf_status cf_points_attribute(const cf_points *p, const char *name, const int components, float **values) {
  cf_hdf5 h;
  *values = NULL;
  CF_TRY(cf_hdf5_open(&h, p->path.text));
  return cf_hdf5_close(&h, read_attribute(p, &h, name, components, values));
}
