/* SPDX-License-Identifier: MIT
 *
 * What held cells of a region add to the right sides of the cells beside them: 2 beta x_held/h^2 a face.
 */
#ifndef CF_SOLVE_HELD_H
#define CF_SOLVE_HELD_H

#include "grid/region.h"

/* A region in a box, and beta on its faces: a field or, where that is NULL, a number. */
typedef struct cf_held {
  const cf_region *region;
  bool periodic[3];
  cf_face beta;
  double number;
} cf_held;

/* For cell p, which is at (i, j, k). */
static inline double cf_held_beside(const cf_held *h, const int at[3], const ptrdiff_t p) {
  const cf_grid *g = &h->region->grid;
  double sum = 0;
  if (h->region->kind[p] != CF_CELL_INSIDE) return 0;
  for (int a = 0; a < g->box.dim; ++a)
    for (int side = 0; side < 2; ++side) {
      const int n = g->box.n[a];
      const ptrdiff_t s = g->box.stride[a];
      const bool end = at[a] == (side ? n - 1 : 0);
      if (end && !h->periodic[a]) continue;
      const ptrdiff_t q = !end ? (side ? p + s : p - s) : side ? p - (n - 1) * s : p + (n - 1) * s;
      if (h->region->kind[q] != CF_CELL_HELD) continue;
      sum += (h->beta.at[0] != NULL ? (double)h->beta.at[a][side ? p + s : p] : h->number) *
             (double)h->region->value.at[q];
    }
  return 2 / (g->h * g->h) * sum;
}

#endif
