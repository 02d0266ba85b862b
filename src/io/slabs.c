/* SPDX-License-Identifier: MIT */
#include "io/slabs.h"

#include <string.h>

#define PIECE_VALUES 131072 /* a buffer of about 1 MB */

static cf_slabs make(const cf_box *b, const int component, const int components) {
  cf_slabs s = {.box = b, .components = components};
  for (int a = 0; a < 3; ++a) s.n[a] = cf_box_extent(b, a, component);
  s.rows = PIECE_VALUES / (s.n[0] * components);
  s.rows = CF_MAX(1, CF_MIN(s.rows, s.n[1]));
  return s;
}

cf_slabs cf_slabs_of_cell(const cf_box *b, const cf_cell f) {
  cf_slabs s = make(b, -1, 1);
  s.at[0] = f.at;
  return s;
}

cf_slabs cf_slabs_of_face(const cf_box *b, const cf_face *f, const int axis) {
  cf_slabs s = make(b, axis, 1);
  s.at[0] = f->at[axis];
  return s;
}

cf_slabs cf_slabs_of_vectors(const cf_box *b, const cf_face *f) {
  cf_slabs s = make(b, -1, 3);
  for (int a = 0; a < b->dim; ++a) s.at[a] = f->at[a];
  return s;
}

size_t cf_slabs_room(const cf_slabs *s) { return (size_t)s->rows * (size_t)s->n[0] * (size_t)s->components; }

bool cf_slabs_piece(const cf_slabs *s, const int64_t i, cf_slab *p) {
  const int64_t pieces = (s->n[1] + s->rows - 1) / s->rows; /* of a plane */
  p->k = (int)(i / pieces);
  p->j = (int)(i % pieces) * s->rows;
  p->rows = CF_MIN(s->rows, s->n[1] - p->j);
  return p->k < s->n[2];
}

/* Component c of a row of vectors: the mean of low and high face; 0 beyond dim. */
static void gather_means(const cf_slabs *s, const int c, const ptrdiff_t p, cf_real *values) {
  const cf_real *f = s->at[c];
  for (int i = 0; i < s->n[0]; ++i)
    values[3 * i + c] = f == NULL ? 0 : (f[p + i] + f[p + i + s->box->stride[c]]) / 2;
}

void cf_slab_gather(const cf_slabs *s, const cf_slab p, cf_real *values) {
  const size_t row = (size_t)s->n[0] * (size_t)s->components;
  for (int j = 0; j < p.rows; ++j, values += row) {
    const ptrdiff_t at = cf_box_at(s->box, 0, p.j + j, p.k);
    if (s->components == 1)
      memcpy(values, s->at[0] + at, row * sizeof *values);
    else
      for (int c = 0; c < 3; ++c) gather_means(s, c, at, values);
  }
}

void cf_slab_scatter(const cf_slabs *s, const cf_slab p, const cf_real *values) {
  const size_t row = (size_t)s->n[0];
  for (int j = 0; j < p.rows; ++j, values += row)
    memcpy(s->at[0] + cf_box_at(s->box, 0, p.j + j, p.k), values, row * sizeof *values);
}
