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
  return CF_OK;
}

void cf_rim_destroy(cf_rim *rim) {
  if (rim->layer != NULL) cf_pages_release(rim->layer - rim->box.first, (size_t)rim->box.size);
  cf_free(rim->cell);
  *rim = (cf_rim){0};
}

/* Whether a neighbour of p is in the layer before `layer`, or inside for the first. Beyond the box is no layer. */
static bool touches(const cf_rim *rim, const ptrdiff_t p, const int before) {
  for (int a = 0; a < rim->box.dim; ++a)
    if (rim->layer[p + rim->box.stride[a]] == before || rim->layer[p - rim->box.stride[a]] == before)
      return true;
  return false;
}

static cf_status append(cf_rim *rim, const ptrdiff_t count, const ptrdiff_t p) {
  if (count == rim->room) {
    ptrdiff_t *larger;
    const ptrdiff_t room = CF_MAX(1024, 2 * rim->room);
    CF_TRY(CF_NEW(&larger, room));
    if (count > 0) memcpy(larger, rim->cell, (size_t)count * sizeof *larger);
    cf_free(rim->cell);
    rim->cell = larger;
    rim->room = room;
  }
  rim->cell[count] = p;
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

cf_status cf_rim_find(cf_rim *rim, const cf_region *region) {
  const cf_box *b = &rim->box;
  ptrdiff_t count = 0;
  mark_inside(rim, region);
  for (int l = 0; l < CF_RIM_LAYERS; ++l) {
    rim->begin[l] = count;
    for (ptrdiff_t r = 0; r < cf_box_rows(b); ++r)
      for (int i = 0; i < b->n[0]; ++i) {
        const ptrdiff_t p = cf_box_row(b, r) + i;
        if (rim->layer[p] != NONE || !touches(rim, p, INSIDE + l)) continue;
        CF_TRY(append(rim, count++, p));
      }
    for (ptrdiff_t c = rim->begin[l]; c < count; ++c) rim->layer[rim->cell[c]] = (unsigned char)(FIRST + l);
    rim->begin[l + 1] = count;
  }
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
