/* SPDX-License-Identifier: MIT
 *
 * The cells of a coarse cell of a level of couplings: 2 cells along each axis that is coarsened, fewer where the axis ends.
 */
#ifndef CF_SOLVE_BLOCK_H
#define CF_SOLVE_BLOCK_H

#include "solve/coupled.h"

typedef struct cf_block {
  int count;
  int at[8][3];
  ptrdiff_t p[8], parent;
} cf_block;

static inline void cf_block_find(cf_block *b, const cf_coupled *l, const cf_coupled *coarse,
                                 const int at[3]) {
  int low[3], pair[3]; /* 1: two cells along this axis */
  for (int a = 0; a < 3; ++a) {
    low[a] = l->coarsened[a] ? 2 * at[a] : at[a];
    pair[a] = l->coarsened[a] && low[a] + 1 < l->box.n[a];
  }
  b->parent = cf_box_at(&coarse->box, at[0], at[1], at[2]);
  b->count = 1 << (pair[0] + pair[1] + pair[2]);
  for (int v = 0; v < 8; ++v) {
    int *cell = b->at[v];
    cell[0] = low[0] + (v & pair[0]);
    cell[1] = low[1] + (v >> pair[0] & pair[1]);
    cell[2] = low[2] + (v >> (pair[0] + pair[1]) & pair[2]);
    b->p[v] = cf_box_at(&l->box, cell[0], cell[1], cell[2]);
  }
}

/* The coarse cell around the cell at a place. */
static inline ptrdiff_t cf_block_parent_of(const cf_coupled *l, const cf_coupled *coarse, const int at[3]) {
  int c[3];
  for (int a = 0; a < 3; ++a) c[a] = l->coarsened[a] ? at[a] / 2 : at[a];
  return cf_box_at(&coarse->box, c[0], c[1], c[2]);
}

/* Whether the low face of axis a of a cell lies within a block. */
static inline bool cf_block_is_inner(const cf_coupled *l, const int a, const int i) {
  return l->coarsened[a] && i % 2 == 1;
}

#endif
