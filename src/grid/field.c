/* SPDX-License-Identifier: MIT */
#include "grid/field.h"

#include "base/mem.h"

static size_t bytes_of(const cf_box *b) { return (size_t)b->size * sizeof(cf_real); }

cf_status cf_cell_create(cf_cell *f, const cf_box *b) {
  f->at = NULL;
  void *pages;
  CF_TRY(cf_pages_reserve(&pages, bytes_of(b), true));
  f->at = (cf_real *)pages + b->first;
  return CF_OK;
}

void cf_cell_destroy(cf_cell *f, const cf_box *b) {
  if (f->at != NULL) cf_pages_release(f->at - b->first, bytes_of(b));
  f->at = NULL;
}

cf_status cf_face_create(cf_face *f, const cf_box *b) {
  *f = (cf_face){{NULL, NULL, NULL}};
  for (int a = 0; a < b->dim; ++a) {
    cf_cell component;
    const cf_status s = cf_cell_create(&component, b);
    if (s != CF_OK) {
      cf_face_destroy(f, b);
      return s;
    }
    f->at[a] = component.at;
  }
  return CF_OK;
}

void cf_face_destroy(cf_face *f, const cf_box *b) {
  for (int a = 0; a < 3; ++a) {
    cf_cell component = {f->at[a]};
    cf_cell_destroy(&component, b);
    f->at[a] = NULL;
  }
}
