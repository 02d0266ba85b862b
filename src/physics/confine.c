/* SPDX-License-Identifier: MIT */
#include "physics/confine.h"

#include <math.h>

#include "base/mem.h"
#include "grid/halo.h"
#include "grid/sweep.h"

struct cf_confine {
  const cf_flow_walls *walls;
  double strength;
  cf_cell size; /* |w| */
  cf_face push; /* the acceleration at cells, one field an axis */
};

cf_status cf_confine_create(cf_confine **confine, const cf_flow_walls *walls, const double strength) {
  *confine = NULL;
  cf_confine *c;
  CF_TRY(CF_NEW(&c, 1));
  c->walls = walls;
  c->strength = strength;
  cf_status s = cf_cell_create(&c->size, &walls->grid->box);
  if (s == CF_OK) s = cf_face_create(&c->push, &walls->grid->box);
  if (s != CF_OK) {
    cf_confine_destroy(c);
    return s;
  }
  *confine = c;
  return CF_OK;
}

void cf_confine_destroy(cf_confine *c) {
  if (c == NULL) return;
  cf_cell_destroy(&c->size, &c->walls->grid->box);
  cf_face_destroy(&c->push, &c->walls->grid->box);
  cf_free(c);
}

/* --- rows ------------------------------------------------------------------------------------------------- */

typedef struct whirl {
  const cf_real *u[3];
  ptrdiff_t stride[3];
  cf_real quarter; /* 1/(4 h) */
  cf_real *size, *push[3];
} whirl;

/* du_c/dx_a at the centre of cell p, from the faces of c on both sides of it. */
CF_KERNEL cf_real slope(const whirl *w, const int c, const int a, const ptrdiff_t p) {
  const ptrdiff_t s = w->stride[a], f = w->stride[c];
  return ((w->u[c][p + s] - w->u[c][p - s]) + (w->u[c][p + f + s] - w->u[c][p + f - s])) * w->quarter;
}

/* The component of curl u along axis c, from the two axes after it. */
CF_KERNEL cf_real curl(const whirl *w, const int c, const ptrdiff_t p) {
  const int a = (c + 1) % 3, b = (c + 2) % 3;
  return slope(w, b, a, p) - slope(w, a, b, p);
}

CF_KERNEL void size_row(const int dim, const int n, const whirl *w, const ptrdiff_t at) {
  CF_ROW_LOOP
  for (int i = 0; i < n; ++i) {
    const cf_real z = curl(w, 2, at + i);
    cf_real square = z * z;
    if (dim == 3) {
      const cf_real x = curl(w, 0, at + i), y = curl(w, 1, at + i);
      square += x * x + y * y;
    }
    w->size[at + i] = (cf_real)sqrt((double)square);
  }
}
CF_CLONED(size_row, const whirl *, const ptrdiff_t)

/* N x w, where N is of length 1 or nothing. */
CF_KERNEL void push_row(const int dim, const int n, const whirl *w, const ptrdiff_t at) {
  CF_ROW_LOOP
  for (int i = 0; i < n; ++i) {
    const ptrdiff_t p = at + i;
    cf_real g[3] = {0, 0, 0}, v[3] = {0, 0, 0};
    CF_AXIS_LOOP
    for (int a = 0; a < dim; ++a) g[a] = w->size[p + w->stride[a]] - w->size[p - w->stride[a]];
    v[2] = curl(w, 2, p);
    if (dim == 3) v[0] = curl(w, 0, p), v[1] = curl(w, 1, p);
    const double length = sqrt((double)(g[0] * g[0] + g[1] * g[1] + g[2] * g[2]));
    const cf_real per = (cf_real)(length > 1e-30 ? 1 / length : 0);
    w->push[0][p] = (g[1] * v[2] - g[2] * v[1]) * per;
    w->push[1][p] = (g[2] * v[0] - g[0] * v[2]) * per;
    if (dim == 3) w->push[2][p] = (g[0] * v[1] - g[1] * v[0]) * per;
  }
}
CF_CLONED(push_row, const whirl *, const ptrdiff_t)

CF_CLONES static void mean_row(const int n, const cf_real weight, const ptrdiff_t below, const cf_real *f,
                               cf_real *to) {
  CF_ROW_LOOP
  for (int i = 0; i < n; ++i) to[i] += weight * (f[i] + f[i - below]);
}

/* --- sweeps ----------------------------------------------------------------------------------------------- */

static whirl whirl_of(const cf_flow_walls *walls, const cf_face u, const cf_cell size) {
  const cf_box *b = &walls->grid->box;
  whirl w = {.quarter = (cf_real)(1 / (4 * walls->grid->h)), .size = size.at};
  for (int a = 0; a < b->dim; ++a) {
    w.u[a] = u.at[a];
    w.stride[a] = b->stride[a];
    cf_flow_walls_ghosts(walls, a, u.at[a]);
  }
  return w;
}

void cf_confine_vorticity(const cf_flow_walls *walls, const cf_face u, const cf_cell out) {
  const cf_box *b = &walls->grid->box;
  const whirl w = whirl_of(walls, u, out);
  CF_PARALLEL_ROWS (b, walls->grid->threads, r) size_row_by_dim(b->dim, b->n[0], &w, cf_box_row(b, r));
}

static void copy_outside(const cf_flow_walls *walls, cf_real *f) {
  cf_halo halo = {0};
  for (int a = 0; a < walls->grid->box.dim; ++a)
    for (int side = 0; side < 2; ++side)
      halo.rule[a][side] = walls->kind[a][side] == CF_FLOW_PERIODIC ? CF_HALO_WRAP : CF_HALO_COPY;
  cf_halo_fill(&walls->grid->box, &halo, 1, CF_CENTRES, f);
}

void cf_confine_push(const cf_confine *c, const double dt, const cf_face u, const cf_face to) {
  const cf_grid *g = c->walls->grid;
  const cf_box *b = &g->box;
  whirl w = whirl_of(c->walls, u, c->size);
  for (int a = 0; a < b->dim; ++a) w.push[a] = c->push.at[a];
  CF_PARALLEL_ROWS (b, g->threads, r) size_row_by_dim(b->dim, b->n[0], &w, cf_box_row(b, r));
  copy_outside(c->walls, c->size.at);
  CF_PARALLEL_ROWS (b, g->threads, r) push_row_by_dim(b->dim, b->n[0], &w, cf_box_row(b, r));
  for (int a = 0; a < b->dim; ++a) {
    copy_outside(c->walls, c->push.at[a]);
    CF_PARALLEL_FACE_ROWS (b, g->threads, a, r) {
      const ptrdiff_t p = cf_box_face_row(b, a, r);
      mean_row(cf_box_extent(b, 0, a), (cf_real)(dt * c->strength * g->h / 2), b->stride[a],
               c->push.at[a] + p, to.at[a] + p);
    }
  }
}
