/* SPDX-License-Identifier: MIT
 *
 * The coarsest level of couplings, solved by elimination within the band of its matrix: cells are numbered along the
 * longest axis last, so that neighbours are at most `width` numbers apart.
 *
 * Cells leave one by one without a subtraction, by couplings and surplus as in direct.h: the pivots keep their digits
 * however small alpha is beside beta, and a pivot of 0 says that the rest of a region is free to float; it stays at 0.
 */
#ifndef CF_SOLVE_BAND_H
#define CF_SOLVE_BAND_H

#include "solve/coupled.h"

typedef struct cf_band {
  ptrdiff_t cells, width, room; /* room: of numbers in `coupling` */
  double *coupling;             /* of cells i and i + 1 + j at i width + j */
  double *surplus, *pivot, *solution;
  ptrdiff_t *place; /* of cell i on the level */
  ptrdiff_t cells_room;
} cf_band;

/* What the elimination would take: cells times width squared. */
double cf_band_work(const cf_box *b, const bool periodic[3]);

/* CF_NO_MEMORY: the band grows with the level. */
cf_status cf_band_factor(cf_band *s, const cf_coupled *l);

/* l->e with A e = l->r. */
void cf_band_solve(const cf_band *s, const cf_coupled *l);

void cf_band_destroy(cf_band *s); /* a zeroed one is fine */

#endif
