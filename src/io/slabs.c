/* SPDX-License-Identifier: MIT */
#include "io/slabs.h"

#include <string.h>

#define PIECE_VALUES 131072 /* a buffer of about 1 MB */

static void cut_into_pieces(cf_slabs *s) {
  s->rows = CF_MAX(1, CF_MIN(PIECE_VALUES / (s->n[0] * s->components), s->n[1]));
}

static cf_slabs of_box(const cf_box *b, const int component, const int components) {
  cf_slabs s = {.components = components, .axes = 3};
  for (int a = 0; a < 3; ++a) {
    s.n[a] = cf_box_extent(b, a, component);
    s.stride[a] = b->stride[a];
  }
  cut_into_pieces(&s);
  return s;
}

cf_slabs cf_slabs_of_cell(const cf_box *b, const cf_cell f) {
  cf_slabs s = of_box(b, -1, 1);
  s.at[0] = f.at;
  return s;
}

cf_slabs cf_slabs_of_face(const cf_box *b, const cf_face *f, const int axis) {
  cf_slabs s = of_box(b, axis, 1);
  s.at[0] = f->at[axis];
  return s;
}

cf_slabs cf_slabs_of_vectors(const cf_box *b, const cf_face *f) {
  cf_slabs s = of_box(b, -1, 3);
  s.means = true;
  for (int a = 0; a < b->dim; ++a) s.at[a] = f->at[a];
  return s;
}

cf_slabs cf_slabs_of_list(const int count, const int components, cf_real *const *at) {
  cf_slabs s = {.n = {1, count, 1}, .stride = {1, 1, count}, .components = components, .axes = 1};
  for (int c = 0; c < components; ++c) s.at[c] = at[c];
  cut_into_pieces(&s);
  return s;
}

cf_slabs cf_slabs_of_attribute(const cf_particles *set, const int attribute) {
  const cf_attribute *a = &set->attribute[attribute];
  return cf_slabs_of_list((int)set->count, a->components, a->at);
}

size_t cf_slabs_room(const cf_slabs *s) { return (size_t)s->rows * (size_t)s->n[0] * (size_t)s->components; }

bool cf_slabs_piece(const cf_slabs *s, const int64_t i, cf_slab *p) {
  const int64_t pieces = (s->n[1] + s->rows - 1) / s->rows; /* of a plane */
  if (pieces == 0) return false;
  p->k = (int)(i / pieces);
  p->j = (int)(i % pieces) * s->rows;
  p->rows = CF_MIN(s->rows, s->n[1] - p->j);
  return p->k < s->n[2];
}

/* Component c of a row. */
static void gather_row(const cf_slabs *s, const int c, const ptrdiff_t p, cf_real *values) {
  const cf_real *f = s->at[c] + p;
  const ptrdiff_t next = s->means ? s->stride[c] : 0;
  for (int i = 0; i < s->n[0]; ++i)
    values[s->components * i + c] = s->means ? (f[i] + f[i + next]) / 2 : f[i];
}

void cf_slab_gather(const cf_slabs *s, const cf_slab p, cf_real *values) {
  const size_t row = (size_t)s->n[0] * (size_t)s->components;
  for (int j = 0; j < p.rows; ++j, values += row) {
    const ptrdiff_t at = (p.j + j) * s->stride[1] + p.k * s->stride[2];
    if (s->components == 1)
      memcpy(values, s->at[0] + at, row * sizeof *values);
    else
      for (int c = 0; c < s->components; ++c) {
        if (s->at[c] != NULL)
          gather_row(s, c, at, values);
        else
          for (int i = 0; i < s->n[0]; ++i) values[s->components * i + c] = 0;
      }
  }
}

void cf_slab_scatter(const cf_slabs *s, const cf_slab p, const cf_real *values) {
  const size_t row = (size_t)s->n[0] * (size_t)s->components;
  for (int j = 0; j < p.rows; ++j, values += row) {
    const ptrdiff_t at = (p.j + j) * s->stride[1] + p.k * s->stride[2];
    for (int c = 0; c < s->components; ++c)
      for (int i = 0; i < s->n[0]; ++i) s->at[c][at + i] = values[s->components * i + c];
  }
}

/* --- arrays as files have them ------------------------------------------------------------------------- */

size_t cf_element_size(const cf_element e) {
  return e == CF_ELEMENT_BYTE ? 1 : e == CF_ELEMENT_REAL ? sizeof(cf_real) : 8;
}

uint64_t cf_array_bytes(const cf_array *a) {
  uint64_t bytes = cf_element_size(a->element);
  for (int d = 0; d < a->rank; ++d) bytes *= (uint64_t)a->n[d];
  return bytes;
}

cf_array cf_slabs_array(const cf_slabs *s) {
  cf_array a = {.element = CF_ELEMENT_REAL, .rank = s->axes};
  if (s->axes == 1)
    a.n[0] = s->n[1];
  else
    for (int d = 0; d < s->axes; ++d) a.n[d] = s->n[s->axes - 1 - d];
  if (s->components > 1) a.n[a.rank++] = s->components;
  return a;
}

void cf_slab_window(const cf_slabs *s, const cf_slab p, uint64_t start[4], uint64_t count[4]) {
  const uint64_t first[3] = {(uint64_t)p.k, (uint64_t)p.j, 0};
  const uint64_t extent[3] = {1, (uint64_t)p.rows, (uint64_t)s->n[0]};
  const int skip = s->axes == 3 ? 0 : 1; /* a plane, or a list, has no k */
  for (int d = 0; d < s->axes; ++d) {
    start[d] = first[d + skip];
    count[d] = extent[d + skip];
  }
  start[s->axes] = 0;
  count[s->axes] = (uint64_t)s->components;
}
