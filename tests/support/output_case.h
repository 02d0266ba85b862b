/* SPDX-License-Identifier: MIT
 *
 * A small state of every kind, with values that no two places share, and a folder to write it to.
 */
#ifndef CF_TEST_OUTPUT_CASE_H
#define CF_TEST_OUTPUT_CASE_H

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <cmocka.h>

#include "base/mem.h"
#include "grid/registry.h"
#include "io/folder.h"
#include "io/stamp.h"

#define CASE_PARTICLES 7

typedef struct output_case {
  cf_grid grid;
  cf_registry registry;
  cf_cell phi;
  cf_face q;
  double ledger[3];
  int64_t step;
  cf_particles *ink;
  int age; /* the attribute's number */
  cf_stamp stamp;
  cf_path folder;
} output_case;

/* Fields, faces (high walls included), numbers, counter and particles get values that depend on `seed`. */
static inline void output_case_fill(output_case *c, const double seed) {
  const cf_box *b = &c->grid.box;
  for (int k = 0; k < b->n[2] + (b->dim == 3); ++k)
    for (int j = 0; j <= b->n[1]; ++j)
      for (int i = 0; i <= b->n[0]; ++i) {
        const ptrdiff_t p = cf_box_at(b, i, j, k);
        c->phi.at[p] = (cf_real)(seed + i / 3.0 + 10 * j + 100 * k);
        for (int a = 0; a < b->dim; ++a)
          c->q.at[a][p] = (cf_real)(-seed - 1000 * (a + 1) - i / 7.0 - 10 * j - 100 * k);
      }
  for (int i = 0; i < 3; ++i) c->ledger[i] = seed + i / 9.0;
  for (int i = 0; i < c->ink->count; ++i) {
    for (int a = 0; a < b->dim; ++a)
      c->ink->attribute[0].at[a][i] = (cf_real)(seed + (i * b->dim + a) / 11.0);
    c->ink->attribute[c->age].at[0][i] = (cf_real)(2 * seed + i / 13.0);
    c->ink->id[i] = (int64_t)seed + 10 * i;
  }
  c->ink->next_id = (int64_t)(1000 * seed);
  c->step = (int64_t)(7 * seed);
}

static inline void output_case_create(output_case *c, const int dim) {
  const int cells[3] = {5, 4, 3};
  const double origin[3] = {-1, 0.5, 2};
  char folder[] = "/tmp/cattaneo-test-XXXXXX";
  *c = (output_case){.step = 0};
  assert_int_equal(cf_grid_init(&c->grid, dim, cells, 0.25, origin), CF_OK);
  assert_int_equal(cf_registry_init(&c->registry, &c->grid), CF_OK);
  assert_int_equal(cf_cell_create(&c->phi, &c->grid.box), CF_OK);
  assert_int_equal(cf_face_create(&c->q, &c->grid.box), CF_OK);
  assert_int_equal(cf_particles_create(&c->ink, "ink", dim, 2), CF_OK);
  assert_int_equal(cf_particles_attribute(c->ink, "age", "s", 1, CF_CARRIED, &c->age), CF_OK);
  assert_int_equal(cf_particles_append(c->ink, CASE_PARTICLES, NULL), CF_OK);
  assert_int_equal(cf_registry_add_cell(&c->registry, "phi", "kg/m^3", c->phi), CF_OK);
  assert_int_equal(cf_registry_add_face(&c->registry, "q", "kg/m^2/s", c->q), CF_OK);
  assert_int_equal(cf_registry_add_particles(&c->registry, c->ink), CF_OK);
  assert_int_equal(cf_registry_add_numbers(&c->registry, "ledger", "kg", c->ledger, 3), CF_OK);
  assert_int_equal(cf_registry_add_counter(&c->registry, "step", &c->step), CF_OK);
  c->stamp = (cf_stamp){
      .title = "A cone, H_c = 2 \xc2\xb7 \xcf\x84", .scene = "model: tracer\n", .time = 0.1, .step = 12};
  assert_non_null(mkdtemp(folder));
  assert_int_equal(cf_path_make(&c->folder, "%s", folder), CF_OK);
  output_case_fill(c, 1);
}

static inline void case_remove(void *context, const char *name) {
  cf_path path;
  if (strcmp(name, ".") == 0 || strcmp(name, "..") == 0) return;
  if (cf_path_make(&path, "%s/%s", (const char *)context, name) == CF_OK) unlink(path.text);
}

static inline void folder_remove(const char *folder) {
  cf_folder_each(folder, case_remove, (void *)(uintptr_t)folder);
  rmdir(folder);
}

static inline void output_case_destroy(output_case *c) {
  folder_remove(c->folder.text);
  cf_particles_destroy(c->ink);
  cf_face_destroy(&c->q, &c->grid.box);
  cf_cell_destroy(&c->phi, &c->grid.box);
  cf_registry_clear(&c->registry);
}

static inline cf_path case_path(const output_case *c, const char *name) {
  cf_path path;
  assert_int_equal(cf_path_make(&path, "%s/%s", c->folder.text, name), CF_OK);
  return path;
}

static inline void count_entry(void *context, const char *name) {
  int *count = context;
  *count += name[0] != '.' || strstr(name, ".part") != NULL;
}

/* Files in a folder, unfinished ones included. */
static inline int files_in(const char *folder) {
  int count = 0;
  assert_int_equal(cf_folder_each(folder, count_entry, &count), CF_OK);
  return count;
}

static inline void assert_says(const char *part) {
  if (strstr(cf_status_sentence(), part) == NULL)
    fail_msg("\"%s\" is not in: %s", part, cf_status_sentence());
}

/* The same as the set-up and tear-down of a test; the case is its state. */
static inline int output_case_begin(void **state, const int dim) {
  static output_case one;
  output_case_create(&one, dim);
  *state = &one;
  return 0;
}

static inline int output_case_2d(void **state) { return output_case_begin(state, 2); }
static inline int output_case_3d(void **state) { return output_case_begin(state, 3); }

static inline int output_case_end(void **state) {
  output_case_destroy(*state);
  return 0;
}

#endif
