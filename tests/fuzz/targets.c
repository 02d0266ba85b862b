/* SPDX-License-Identifier: MIT
 *
 * Everything that reads what others wrote, as functions of bytes: whatever these are, the answer is a result or a
 * status with a sentence, never a crash, a leak or a hang. Two programs use this file: fuzz.c with libFuzzer, and
 * replay.c with the corpora and fixed changes of them.
 */
#define _GNU_SOURCE
#include "targets.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/mem.h"
#include "base/units.h"
#include "grid/mesh.h"
#include "io/checkpoint.h"
#include "io/expr.h"
#include "io/frame.h"
#include "io/image.h"
#include "io/info.h"
#include "io/mesh.h"
#include "io/npy.h"
#include "io/points.h"
#include "model/atlas.h"
#include "model/scene.h"
#include "session/space.h"

/* The bytes as a zero-terminated text. */
static char *text_of(const uint8_t *bytes, const size_t size) {
  char *text = malloc(size + 1);
  if (text == NULL) abort();
  if (size > 0) memcpy(text, bytes, size);
  text[size] = '\0';
  return text;
}

/* The bytes as a file in memory, its name ending as asked. */
static const char *file_of(const uint8_t *bytes, const size_t size, const char *ending) {
  static char path[64];
  snprintf(path, sizeof path, "/dev/shm/cattaneo-fuzz-%ld%s", (long)getpid(), ending);
  FILE *file = fopen(path, "wb");
  if (file == NULL || (size > 0 && fwrite(bytes, 1, size, file) != size)) abort();
  fclose(file);
  return path;
}

/* A failure says why. */
static void judge(const cf_status s) {
  if (s != CF_OK && strlen(cf_status_sentence()) < 8) abort();
}

/* A scene that is good is written, and read again as the same. */
static void scene(const uint8_t *bytes, const size_t size) {
  cf_scene *s = NULL, *again = NULL;
  char *first = NULL, *second = NULL;
  const char *path = file_of(bytes, size, ".yaml");
  cf_status status = cf_scene_read(&s, path, 0, NULL);
  judge(status);
  if (status == CF_OK && cf_scene_write(s, &first) == CF_OK) {
    if (!(cf_space_memory(s) >= 0)) abort();
    path = file_of((const uint8_t *)first, strlen(first), ".yaml");
    if (cf_scene_read(&again, path, 0, NULL) != CF_OK || cf_scene_write(again, &second) != CF_OK ||
        strcmp(first, second) != 0) {
      fprintf(stderr, "%s\n--- is not read again as it was: %s\n%s", first, cf_status_sentence(),
              second != NULL ? second : "");
      abort();
    }
  }
  cf_free(first);
  cf_free(second);
  cf_scene_destroy(s);
  cf_scene_destroy(again);
  unlink(path);
}

/* An override of a good scene. */
static void override(const uint8_t *bytes, const size_t size) {
  static const char good[] =
      "cattaneo: 1\nmodel: tracer\ndomain: {size: [1, 1], cells: [8, 8]}\ntime: {end: 1}\n"
      "fields: {phi: {}}\nsources: [{shape: everywhere, rate: 1}]\n";
  char *text = text_of(bytes, size);
  cf_scene *s = NULL;
  const char *const set[] = {text}, *path = file_of((const uint8_t *)good, sizeof good - 1, ".yaml");
  judge(cf_scene_read(&s, path, 1, set));
  cf_scene_destroy(s);
  unlink(path);
  free(text);
}

static void expression(const uint8_t *bytes, const size_t size) {
  char *text = text_of(bytes, size);
  cf_expr *e = NULL;
  const cf_status status = cf_expr_create(&e, text, NULL, CF_EXPR_SPACE_TIME, NULL);
  judge(status);
  if (status == CF_OK) {
    const double x[4] = {0, 0.5, 1, -3}, y[4] = {1, 2, 3, 4}, z[4] = {0};
    double out[4];
    const cf_fn f = cf_expr_fn(e);
    cf_fn_row(&f, 4, x, y, z, 0.25, out);
  }
  cf_expr_destroy(e);
  free(text);
}

static void unit(const uint8_t *bytes, const size_t size) {
  char *text = text_of(bytes, size);
  cf_unit_change change;
  judge(cf_units_change(text, "m^2/s", &change));
  judge(cf_units_change(text, NULL, &change));
  free(text);
}

static void checkpoint(const uint8_t *bytes, const size_t size) {
  cf_checkpoint_facts facts;
  char *saved = NULL;
  const char *path = file_of(bytes, size, ".h5");
  judge(cf_checkpoint_describe(path, &facts, &saved));
  cf_free(saved);
  unlink(path);
}

/* What pictures are made of, and what `info` tells. */
static void frame(const uint8_t *bytes, const size_t size) {
  const char *path = file_of(bytes, size, ".vtkhdf");
  cf_frame f;
  cf_points p;
  cf_cell values;
  float *ages;
  char *text;
  judge(cf_info_text(path, &text));
  cf_free(text);
  const cf_status fields = cf_frame_read(&f, path);
  judge(fields);
  if (fields == CF_OK && f.count > 0 && cf_cell_create(&values, &f.grid.box) == CF_OK) {
    judge(cf_frame_read_cell(&f, f.field[0].name, 0, values));
    cf_cell_destroy(&values, &f.grid.box);
  }
  const cf_status points = cf_points_read(&p, path);
  judge(points);
  if (points == CF_OK) {
    judge(cf_points_attribute(&p, "age", 1, &ages));
    cf_free(ages);
  }
  cf_points_clear(&p);
  unlink(path);
}

static void read_mesh(const uint8_t *bytes, const size_t size, const char *ending) {
  cf_mesh *mesh;
  const char *path = file_of(bytes, size, ending);
  if (cf_mesh_create(&mesh) != CF_OK) abort();
  judge(cf_mesh_read(mesh, path));
  cf_mesh_destroy(mesh);
  unlink(path);
}

static void ply(const uint8_t *bytes, const size_t size) { read_mesh(bytes, size, ".ply"); }
static void obj(const uint8_t *bytes, const size_t size) { read_mesh(bytes, size, ".obj"); }

static void image(const uint8_t *bytes, const size_t size) {
  int width, height;
  uint8_t *pixels = NULL;
  const char *path = file_of(bytes, size, ".png");
  judge(cf_image_read(path, &width, &height, &pixels));
  cf_free(pixels);
  pixels = NULL;
  judge(cf_image_read_cover(path, &width, &height, &pixels));
  cf_free(pixels);
  unlink(path);
}

static void npy(const uint8_t *bytes, const size_t size) {
  int axes, n[3];
  float *values = NULL;
  const char *path = file_of(bytes, size, ".npy");
  judge(cf_npy_read(path, &axes, n, &values));
  cf_free(values);
  unlink(path);
}

static void atlas(const uint8_t *bytes, const size_t size) {
  cf_atlas *a = NULL;
  const char *path = file_of(bytes, size, ".json");
  judge(cf_atlas_read(&a, path));
  cf_atlas_destroy(a);
  unlink(path);
}

const target targets[] = {
#define TARGET(name) {#name, name},
    TARGETS(TARGET)
#undef TARGET
        {NULL, NULL},
};
