/* SPDX-License-Identifier: MIT
 *
 * What the files of water in bodies share: poro.c takes the step, poro_cells.c says what each cell and face is.
 */
#ifndef CF_PHYSICS_PORO_PART_H
#define CF_PHYSICS_PORO_PART_H

#include "physics/poro.h"

/* Nodes that are filled less than this are no part of a body. */
#define CF_PORO_LEAST_FILL 1e-9

/* NEAR: free, with a held cell among its neighbours. */
enum { CF_PORO_NONE, CF_PORO_FREE, CF_PORO_NEAR, CF_PORO_HELD_SURFACE, CF_PORO_HELD_CELL };

/* p in a body, not held. */
static inline bool cf_poro_is_free(const cf_poro *w, const ptrdiff_t p) {
  const unsigned char kind = w->kind[p + w->grid->box.first];
  return kind == CF_PORO_FREE || kind == CF_PORO_NEAR;
}

/* Runs over the cells p of active tiles, in parallel. */
#define FOR_CELLS(w, p)                                                \
  CF_PARALLEL_TILES ((w)->tiles, (w)->grid->threads, r_)               \
    CF_TILE_ROWS ((w)->tiles, r_, j_, k_)                              \
      CF_TILE_RUNS ((w)->tiles, r_, run_) {                            \
        const ptrdiff_t from_ = cf_box_at(&(w)->grid->box, 0, j_, k_); \
        for (ptrdiff_t p = from_ + run_->low; p < from_ + run_->high; ++p)
#define END_CELLS }

/* The kind of every cell and the value of held ones, at time t. */
cf_status cf_poro_find_cells(cf_poro *w, double t);

/* beta on faces, for the stage that is set; with a mixture kappa as well. */
void cf_poro_set_faces(const cf_poro *w);

/* k and k F_T of a cell. */
static inline double cf_poro_k(const cf_poro *w, const ptrdiff_t p) {
  return w->p.mixture != NULL ? (double)w->k.at[p] : w->p.k;
}
static inline double cf_poro_k_now(const cf_poro *w, const ptrdiff_t p) {
  return w->p.mixture != NULL ? (double)w->k_now.at[p] : w->p.k * w->p.f_t;
}

/* What would conduct between free cell p and held cell q with k = 1. */
double cf_poro_to_held(const cf_poro *w, ptrdiff_t p, ptrdiff_t q);

/* Sources that add: m grows by what comes in a time d before t. */
void cf_poro_add_rates(const cf_poro *w, double t, double d);

/* What sources of a finite amount have given in a step, of all that was gained. */
void cf_poro_note_given(const cf_poro *w, double t, double dt, double gained);

#endif
