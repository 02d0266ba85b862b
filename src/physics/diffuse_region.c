/* SPDX-License-Identifier: MIT
 *
 * Diffusion in a part of the box (grid/region.h). Kernels of rows know nothing of it: what holds on a face is in its k,
 *
 *     inside | inside     the harmonic mean of both, as everywhere
 *     inside | held       twice the inside cell's own, and the held cell has the value: 2 k (x_p - value)/h is the
 *                         flux to a value half a cell away
 *     closed              0, and q is 0 there
 *
 * so walls see no flux and stay 0, and held cells take up what passes into them. That is read off and counted before
 * they get their value back; only cells inside are content.
 */
#include "physics/diffuse_part.h"

#define FOR_ROWS_OF(d, r) CF_PARALLEL_ROWS (&(d)->grid->box, (d)->grid->threads, r)

/* --- faces ------------------------------------------------------------------------------------------------- */

static double harmonic(const double a, const double b) { return a + b > 0 ? 2 * a * b / (a + b) : 0; }

/* The kinds on both sides of the low face of axis a at place i along it; beyond a wall of the box that is not
 * periodic the kind is that of the cell before it. p, o: their cells. */
static void sides(const cf_diffuse *d, const int a, const int i, ptrdiff_t *p, ptrdiff_t *o) {
  const cf_box *box = &d->grid->box;
  const bool wrap = d->walls.walls.kind[a][0] == CF_WALL_PERIODIC;
  const ptrdiff_t around = wrap ? (box->n[a] - 1) * box->stride[a] : 0, here = *p;
  *o = i > 0 ? here - box->stride[a] : here + around;
  if (i == box->n[a]) *p = *o - around;
}

/* 0 closed, 1 between two cells inside (or inside and a wall of the box), 2 with a known value. */
static int kind_of_face(const cf_region *r, const ptrdiff_t p, const ptrdiff_t o) {
  const cf_cell_kind here = cf_region_kind(r, p), below = cf_region_kind(r, o);
  if (here == CF_CELL_INSIDE && below == CF_CELL_INSIDE) return 1;
  if (here != CF_CELL_INSIDE && below != CF_CELL_INSIDE) return 0;
  return here == CF_CELL_WALL || below == CF_CELL_WALL ? 0 : 2;
}

/* What is done to one face: `kind` as above, its cells p and o. */
typedef void face_action(const cf_diffuse *d, cf_real *face, int kind, ptrdiff_t p, ptrdiff_t o,
                         const void *context);

static void for_faces(const cf_diffuse *d, const cf_face f, face_action *act, const void *context) {
  const cf_box *box = &d->grid->box;
  for (int a = 0; a < box->dim; ++a) {
    const int n1 = cf_box_extent(box, 1, a), rows = n1 * cf_box_extent(box, 2, a);
#pragma omp parallel for schedule(static) num_threads(cf_sweep_threads(box, d->grid->threads))
    for (int r = 0; r < rows; ++r)
      for (int i = 0; i < cf_box_extent(box, 0, a); ++i) {
        const int at[3] = {i, r % n1, r / n1};
        const ptrdiff_t face = cf_box_at(box, at[0], at[1], at[2]);
        ptrdiff_t p = face, o;
        sides(d, a, at[a], &p, &o);
        act(d, &f.at[a][face], kind_of_face(d->p.region, p, o), p, o, context);
      }
  }
}

static void set_k(const cf_diffuse *d, cf_real *face, const int kind, const ptrdiff_t p, const ptrdiff_t o,
                  const void *context) {
  const cf_cell cells = d->k_cells;
  const double here = cells.at != NULL ? (double)cells.at[p] : d->p.k.value;
  const double below = cells.at != NULL ? (double)cells.at[o] : d->p.k.value;
  const bool inside = cf_region_kind(d->p.region, p) == CF_CELL_INSIDE;
  (void)context;
  *face = (cf_real)(kind == 0 ? 0 : kind == 1 ? harmonic(here, below) : 2 * (inside ? here : below));
}

static void close_face(const cf_diffuse *d, cf_real *face, const int kind, const ptrdiff_t p,
                       const ptrdiff_t o, const void *context) {
  (void)d, (void)p, (void)o, (void)context;
  if (kind == 0) *face = 0;
}

static void halve_face(const cf_diffuse *d, cf_real *face, const int kind, const ptrdiff_t p,
                       const ptrdiff_t o, const void *context) {
  (void)d, (void)p, (void)o, (void)context;
  if (kind == 2) *face /= 2;
}

cf_status cf_diffuse_region_changed(cf_diffuse *d) {
  d->delta = -1; /* the operator must be set again */
  bool wraps[3];
  for (int a = 0; a < 3; ++a) wraps[a] = d->walls.walls.kind[a][0] == CF_WALL_PERIODIC;
  cf_region_ghosts(d->p.region, wraps);
  for_faces(d, d->k, set_k, NULL);
  return d->p.front_filter ? cf_rim_find(&d->rim, d->p.region) : CF_OK;
}

void cf_diffuse_close_faces(const cf_diffuse *d, const cf_face q) {
  if (d->p.region != NULL) for_faces(d, q, close_face, NULL);
}

void cf_diffuse_halve_held(const cf_diffuse *d, const cf_face beta) {
  if (d->p.region != NULL) for_faces(d, beta, halve_face, NULL);
}

/* --- cells ------------------------------------------------------------------------------------------------- */

void cf_diffuse_fill_outside(const cf_diffuse *d, const cf_real value, const cf_cell f) {
  const cf_region *region = d->p.region;
  if (region == NULL) return;
  FOR_ROWS_OF(d, r)
  for (int i = 0; i < d->grid->box.n[0]; ++i) {
    const ptrdiff_t p = cf_box_row(&d->grid->box, r) + i;
    if (region->kind[p] != CF_CELL_INSIDE) f.at[p] = value;
  }
}

void cf_diffuse_clear_outside(const cf_diffuse *d, const cf_cell f) { cf_diffuse_fill_outside(d, 0, f); }

void cf_diffuse_set_outside(const cf_diffuse *d, const cf_cell phi) {
  const cf_region *region = d->p.region;
  if (region == NULL) return;
  FOR_ROWS_OF(d, r)
  for (int i = 0; i < d->grid->box.n[0]; ++i) {
    const ptrdiff_t p = cf_box_row(&d->grid->box, r) + i;
    if (region->kind[p] != CF_CELL_INSIDE)
      phi.at[p] = region->kind[p] == CF_CELL_HELD ? region->value.at[p] : 0;
  }
}

/* Integral of C f over the cells that are (not) inside. */
static double sum_where(const cf_diffuse *d, const cf_cell f, const bool inside) {
  const cf_box *box = &d->grid->box;
  FOR_ROWS_OF(d, r) {
    const ptrdiff_t start = cf_box_row(box, r);
    double lane[CF_SUM_LANES] = {0};
    for (int i = 0; i < box->n[0]; ++i) {
      const ptrdiff_t p = start + i;
      const double c = d->c_varies ? (double)d->capacity.at[p] : 1;
      if ((d->p.region->kind[p] == CF_CELL_INSIDE) == inside) lane[i % CF_SUM_LANES] += c * (double)f.at[p];
    }
    d->rows[r] = cf_sum_lanes(lane);
  }
  return cf_grid_volume(d->grid) * cf_sum_ordered(d->rows, cf_box_rows(box));
}

double cf_diffuse_sum_inside(const cf_diffuse *d, const cf_cell phi) { return sum_where(d, phi, true); }
double cf_diffuse_sum_outside(const cf_diffuse *d, const cf_cell phi) { return sum_where(d, phi, false); }

void cf_diffuse_take_outside(const cf_diffuse *d, const cf_cell phi, cf_ledger *ledger) {
  if (d->p.region == NULL) return;
  cf_ledger_add(ledger, -cf_diffuse_sum_outside(d, phi));
  cf_diffuse_set_outside(d, phi);
}
