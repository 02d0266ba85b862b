/* SPDX-License-Identifier: MIT
 *
 * The parts of a region that are cut off from each other, and those of them whose level nothing fixes: no alpha, no known
 * value. Each such pocket has the constant as its own null space.
 *
 * Parts are found row by row: cells of a row that are joined share a label, labels that meet in another axis are united
 * (union-find), in a fixed order.
 */
#ifndef CF_SOLVE_POCKETS_H
#define CF_SOLVE_POCKETS_H

#include "solve/coupled.h"

typedef struct cf_pockets {
  int count; /* pockets */
  ptrdiff_t labels, room;
  int32_t *united;    /* label -> another label of the same part; after finding, label -> pocket, or -1 */
  int32_t *label;     /* of every cell, in pages like the level's */
  double *sum, *mean; /* one a pocket (at most as many as labels) */
  double *cells;
  int32_t widest; /* the pocket with the most cells; most rows of a region have cells of no other: */
  unsigned char
      *plain;   /* whether row j + n[1] k is such a row: all of its cells that have an equation are in it */
  double *rows; /* then what the row sums to */
  bool all;     /* it is every cell of the box */
  bool single;  /* there is one pocket, and every cell that has an equation is in it */
  int64_t followed; /* the update of the tiles that the labels are right for */
} cf_pockets;

/* The parts that nothing fixes; `loose`: those as well that alpha alone fixes. CF_NO_MEMORY. */
cf_status cf_pockets_find(cf_pockets *q, const cf_coupled *l, bool loose);
cf_status cf_pockets_take_all(cf_pockets *q, const cf_coupled *l); /* the whole box is one */
void cf_pockets_clear(cf_pockets *q, const cf_coupled *l);         /* a zeroed one is fine */

/* Subtracts from f its mean over every pocket. */
void cf_pockets_remove_means(const cf_pockets *q, const cf_coupled *l, cf_cell f);

/* Keeps the means of f, and shifts f back to the means kept. */
void cf_pockets_keep_means(const cf_pockets *q, const cf_coupled *l, cf_cell f);
void cf_pockets_restore_means(const cf_pockets *q, const cf_coupled *l, cf_cell f);

/* The same for a single pocket, where the sum of f is known. */
void cf_pockets_take_mean(const cf_pockets *q, double sum);
void cf_pockets_restore_mean(const cf_pockets *q, const cf_coupled *l, double sum, cf_cell f);

/* With loose pockets: the means that alpha and b ask for, to be restored; and a correction without means. The cycle makes constants
 * of small pockets far too large where alpha is small, for coarse cells that hold a part of one hold others as well. */
void cf_pockets_ask_means(const cf_pockets *q, const cf_coupled *l, double alpha, cf_cell b);
void cf_pockets_level_out(const cf_pockets *q, const cf_coupled *l, float *e);

/* f += amount on the single pocket that there is. */
void cf_pockets_lift(const cf_coupled *l, double amount, cf_cell f);

#endif
