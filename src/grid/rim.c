/* SPDX-License-Identifier: MIT */
#include "grid/rim.h"

#include <string.h>

#include "base/mem.h"
#include "grid/sweep.h"

enum { NONE, INSIDE, FIRST };

cf_status cf_rim_create(cf_rim *rim, const cf_box *b) {
  void *pages;
  *rim = (cf_rim){.box = *b};
  CF_TRY(cf_pages_reserve(&pages, (size_t)b->size, false));
  rim->layer = (unsigned char *)pages + b->first;
  return CF_NEW(&rim->from, cf_box_rows(b) + 1);
}

void cf_rim_destroy(cf_rim *rim) {
  if (rim->layer != NULL) cf_pages_release(rim->layer - rim->box.first, (size_t)rim->box.size);
  cf_free(rim->cell);
  cf_free(rim->from);
  *rim = (cf_rim){0};
}

/* Whether a neighbour of p is in the layer before `layer`, or inside for the first. Beyond the box is no layer. */
static bool touches(const cf_rim *rim, const ptrdiff_t p, const int before) {
  for (int a = 0; a < rim->box.dim; ++a)
    if (rim->layer[p + rim->box.stride[a]] == before || rim->layer[p - rim->box.stride[a]] == before)
      return true;
  return false;
}

/* The cells of row r that belong to layer l; cell NULL: they are only counted. */
static ptrdiff_t find_in_row(const cf_rim *rim, const ptrdiff_t r, const int l, ptrdiff_t *cell) {
  const ptrdiff_t row = cf_box_row(&rim->box, r);
  ptrdiff_t count = 0;
  for (ptrdiff_t p = row; p < row + rim->box.n[0]; ++p) {
    if (rim->layer[p] != NONE || !touches(rim, p, INSIDE + l)) continue;
    if (cell != NULL) cell[count] = p;
    ++count;
  }
  return count;
}

static cf_status make_room(cf_rim *rim, const ptrdiff_t used, const ptrdiff_t count) {
  ptrdiff_t *larger;
  if (count <= rim->room) return CF_OK;
  const ptrdiff_t room = CF_MAX(1024, count + count / 2);
  CF_TRY(CF_NEW(&larger, room));
  if (used > 0) memcpy(larger, rim->cell, (size_t)used * sizeof *larger);
  cf_free(rim->cell);
  rim->cell = larger;
  rim->room = room;
  return CF_OK;
}

static void mark_inside(const cf_rim *rim, const cf_region *region) {
  const cf_box *b = &rim->box;
  CF_PARALLEL_ROWS (b, region->grid.threads, r)
    for (int i = 0; i < b->n[0]; ++i) {
      const ptrdiff_t p = cf_box_row(b, r) + i;
      rim->layer[p] = region->kind[p] == CF_CELL_INSIDE ? INSIDE : NONE;
    }
}

/* Rows are counted, then each knows where its cells go: in the order of the box, whatever the threads. */
static cf_status find_layer(cf_rim *rim, const int l, const int threads) {
  const cf_box *b = &rim->box;
  ptrdiff_t *from = rim->from;
  const ptrdiff_t rows = cf_box_rows(b), begin = rim->begin[l];
  CF_PARALLEL_ROWS (b, threads, r) from[r + 1] = find_in_row(rim, r, l, NULL);
  from[0] = begin;
  for (ptrdiff_t r = 0; r < rows; ++r) from[r + 1] += from[r];
  const ptrdiff_t end = from[rows];
  CF_TRY(make_room(rim, begin, end));
  CF_PARALLEL_ROWS (b, threads, r)
    if (from[r + 1] > from[r]) find_in_row(rim, r, l, rim->cell + from[r]);
  for (ptrdiff_t c = begin; c < end; ++c) rim->layer[rim->cell[c]] = (unsigned char)(FIRST + l);
  rim->begin[l + 1] = end;
  return CF_OK;
}

cf_status cf_rim_find(cf_rim *rim, const cf_region *region) {
  mark_inside(rim, region);
  for (int l = 0; l < CF_RIM_LAYERS; ++l) CF_TRY(find_layer(rim, l, region->grid.threads));
  return CF_OK;
}

void cf_rim_fill(const cf_rim *rim, const cf_cell f) {
  const cf_box *b = &rim->box;
  for (int l = 0; l < CF_RIM_LAYERS; ++l)
    for (ptrdiff_t c = rim->begin[l]; c < rim->begin[l + 1]; ++c) {
      const ptrdiff_t p = rim->cell[c];
      double sum = 0;
      int known = 0;
      for (int a = 0; a < b->dim; ++a)
        for (int side = -1; side <= 1; side += 2) {
          const ptrdiff_t o = p + side * b->stride[a];
          if (rim->layer[o] != INSIDE + l) continue;
          sum += (double)f.at[o];
          ++known;
        }
      f.at[p] = (cf_real)(sum / known);
    }
}
