/* SPDX-License-Identifier: MIT */
#include "physics/force.h"

#include <math.h>

#include "base/mem.h"
#include "grid/halo.h"
#include "grid/sweep.h"

struct cf_force {
  const cf_grid *grid;
  double gravity[3];
  const cf_region *region; /* of the fluid; NULL: all */
  cf_halo outside;         /* of phi: copied at walls, wrapped */
  bool balanced[3];        /* the common part of layers across the axis is taken off */
  bool through[3];         /* but for its mean: fluid can pass through both ends */
  double *rows;            /* one a row */
  double *layer;           /* the mean of each layer of cells, with a ghost at either end: element 0 */
  cf_real *row;            /* the same on the faces of a row along x */
};

static bool has_open(const cf_flow_walls *w, const int axis) {
  return w->kind[axis][0] == CF_FLOW_OPEN || w->kind[axis][1] == CF_FLOW_OPEN;
}

static cf_status make(cf_force *f, const cf_flow_walls *w) {
  const cf_box *b = &f->grid->box;
  for (int a = 0; a < b->dim; ++a) {
    f->balanced[a] = true;
    for (int e = 0; e < b->dim; ++e)
      if (e != a && has_open(w, e)) f->balanced[a] = false;
    f->through[a] = w->kind[a][0] != CF_FLOW_CLOSED && w->kind[a][1] != CF_FLOW_CLOSED;
    for (int side = 0; side < 2; ++side)
      f->outside.rule[a][side] = w->kind[a][side] == CF_FLOW_PERIODIC ? CF_HALO_WRAP : CF_HALO_COPY;
  }
  const int longest = CF_MAX(b->n[0], CF_MAX(b->n[1], b->n[2]));
  CF_TRY(CF_NEW(&f->rows, cf_box_rows(b)));
  CF_TRY(CF_NEW(&f->layer, longest + 2));
  return CF_NEW(&f->row, b->n[0] + 1);
}

cf_status cf_force_create(cf_force **force, const cf_flow_walls *walls, const double gravity[3]) {
  *force = NULL;
  cf_force *f;
  CF_TRY(CF_NEW(&f, 1));
  f->grid = walls->grid;
  for (int a = 0; a < 3; ++a) f->gravity[a] = gravity[a];
  const cf_status s = make(f, walls);
  if (s != CF_OK) {
    cf_force_destroy(f);
    return s;
  }
  *force = f;
  return CF_OK;
}

void cf_force_destroy(cf_force *f) {
  if (f == NULL) return;
  cf_free(f->rows);
  cf_free(f->layer);
  cf_free(f->row);
  cf_free(f);
}

void cf_force_set_region(cf_force *f, const cf_region *region) { f->region = region; }

/* --- the layers ------------------------------------------------------------------------------------------- */

/* Layers across x: every layer has one cell of each row, and rows are added in their order. */
static void sum_columns(const cf_force *f, const cf_cell phi) {
  const cf_box *b = &f->grid->box;
  for (ptrdiff_t r = 0; r < cf_box_rows(b); ++r) {
    const cf_real *row = phi.at + cf_box_row(b, r);
    for (int i = 0; i < b->n[0]; ++i) f->layer[1 + i] += (double)row[i];
  }
}

static void sum_rows(const cf_force *f, const int axis, const cf_cell phi) {
  const cf_box *b = &f->grid->box;
  CF_PARALLEL_ROWS (b, f->grid->threads, r) f->rows[r] = cf_sweep_row_sum(b->n[0], phi.at + cf_box_row(b, r));
  for (ptrdiff_t r = 0; r < cf_box_rows(b); ++r)
    f->layer[1 + (axis == 1 ? r % b->n[1] : r / b->n[1])] += f->rows[r];
}

/* Beside solids a layer has as many cells as are fluid; one without any has the mean of the last before it. */
static void mean_of_fluid(const cf_force *f, const int axis, const cf_cell phi) {
  const cf_box *b = &f->grid->box;
  int at[3];
  for (int l = 0; l < b->n[axis]; ++l) {
    const int o1 = axis == 0 ? 1 : 0, o2 = axis == 2 ? 1 : 2;
    double sum = 0;
    ptrdiff_t cells = 0;
    at[axis] = l;
    for (at[o2] = 0; at[o2] < b->n[o2]; ++at[o2])
      for (at[o1] = 0; at[o1] < b->n[o1]; ++at[o1]) {
        const ptrdiff_t p = cf_box_at(b, at[0], at[1], at[2]);
        if (f->region->kind[p] != CF_CELL_INSIDE) continue;
        sum += (double)phi.at[p];
        ++cells;
      }
    f->layer[1 + l] = cells > 0 ? sum / (double)cells : f->layer[l];
  }
}

static void find_means(const cf_force *f, const int axis, const cf_cell phi) {
  const cf_box *b = &f->grid->box;
  const double cells = (double)cf_box_cells(b) / b->n[axis];
  if (f->region != NULL) {
    mean_of_fluid(f, axis, phi);
    return;
  }
  if (axis == 0)
    sum_columns(f, phi);
  else
    sum_rows(f, axis, phi);
  for (int i = 1; i <= b->n[axis]; ++i) f->layer[i] /= cells;
}

/* What is taken off each layer of cells, ghosts included. */
static void find_layers(const cf_force *f, const int axis, const cf_cell phi) {
  const cf_box *b = &f->grid->box;
  const int n = b->n[axis];
  for (int i = 0; i < n + 2; ++i) f->layer[i] = 0;
  if (!f->balanced[axis]) return;
  find_means(f, axis, phi);
  double mean = 0;
  for (int i = 1; i <= n; ++i) mean += f->layer[i] / n;
  const bool wraps = f->outside.rule[axis][0] == CF_HALO_WRAP;
  f->layer[0] = f->layer[wraps ? n : 1];
  f->layer[n + 1] = f->layer[wraps ? 1 : n];
  if (f->through[axis])
    for (int i = 0; i < n + 2; ++i) f->layer[i] -= mean;
}

/* --- the push --------------------------------------------------------------------------------------------- */

/* u += w ((phi + phi_below)/2 - common). */
CF_CLONES static void lift_row(const int n, const cf_real w, const ptrdiff_t below, const cf_real *phi,
                               const cf_real common, cf_real *u) {
  CF_ROW_LOOP
  for (int i = 0; i < n; ++i) u[i] += w * ((phi[i] + phi[i - below]) / 2 - common);
}

CF_CLONES static void lift_along_row(const int n, const cf_real w, const cf_real *phi, const cf_real *common,
                                     cf_real *u) {
  CF_ROW_LOOP
  for (int i = 0; i < n; ++i) u[i] += w * ((phi[i] + phi[i - 1]) / 2 - common[i]);
}

static void push_axis(const cf_force *f, const int a, const double w, const cf_cell phi, const cf_face u) {
  const cf_box *b = &f->grid->box;
  find_layers(f, a, phi);
  for (int i = 0; a == 0 && i <= b->n[0]; ++i) f->row[i] = (cf_real)((f->layer[i] + f->layer[i + 1]) / 2);
  CF_PARALLEL_FACE_ROWS (b, f->grid->threads, a, r) {
    const ptrdiff_t p = cf_box_face_row(b, a, r);
    const ptrdiff_t i = a == 1 ? r % cf_box_extent(b, 1, a) : r / cf_box_extent(b, 1, a);
    if (a == 0)
      lift_along_row(b->n[0] + 1, (cf_real)w, phi.at + p, f->row, u.at[0] + p);
    else
      lift_row(b->n[0], (cf_real)w, b->stride[a], phi.at + p, (cf_real)((f->layer[i] + f->layer[i + 1]) / 2),
               u.at[a] + p);
  }
}

void cf_force_lift(const cf_force *f, const double dt, const double lift, const cf_cell phi,
                   const cf_face u) {
  cf_halo_fill(&f->grid->box, &f->outside, 1, CF_CENTRES, phi.at);
  for (int a = 0; a < f->grid->box.dim; ++a) {
    const double w = -dt * lift * f->gravity[a];
    if (w != 0) push_axis(f, a, w, phi, u);
  }
}
