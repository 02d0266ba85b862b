/* SPDX-License-Identifier: MIT */
#include "grid/flow_walls.h"

#include <math.h>

#include "base/mem.h"
#include "grid/halo.h"

/* The two other axes of a wall, the lower one first. */
static int other(const int axis, const int which) {
  return which == 0 ? (axis == 0 ? 1 : 0) : (axis == 2 ? 1 : 2);
}

cf_status cf_flow_walls_create(cf_flow_walls *w, const cf_grid *g, cf_flow_wall kind[3][2]) {
  *w = (cf_flow_walls){.grid = g};
  for (int a = 0; a < g->box.dim; ++a)
    for (int side = 0; side < 2; ++side) w->kind[a][side] = kind[a][side];
  for (int a = 0; a < g->box.dim; ++a)
    for (int side = 0; side < 2; ++side)
      for (int c = 0; c < g->box.dim; ++c) {
        const ptrdiff_t n = (ptrdiff_t)cf_flow_count(w, other(a, 0), c) * cf_flow_count(w, other(a, 1), c);
        const cf_status s = CF_NEW(&w->value[a][side][c], n);
        if (s != CF_OK) {
          cf_flow_walls_destroy(w);
          return s;
        }
      }
  return CF_OK;
}

void cf_flow_walls_destroy(cf_flow_walls *w) {
  for (int a = 0; a < 3; ++a)
    for (int side = 0; side < 2; ++side)
      for (int c = 0; c < 3; ++c) {
        cf_free(w->value[a][side][c]);
        w->value[a][side][c] = NULL;
      }
}

cf_walls cf_flow_walls_of_pressure(const cf_flow_walls *w) {
  static const cf_wall of[] = {[CF_FLOW_CLOSED] = CF_WALL_INSULATED,
                               [CF_FLOW_OPEN] = CF_WALL_OPEN,
                               [CF_FLOW_PERIODIC] = CF_WALL_PERIODIC};
  cf_walls walls = {0};
  for (int a = 0; a < w->grid->box.dim; ++a)
    for (int side = 0; side < 2; ++side) walls.kind[a][side] = of[w->kind[a][side]];
  return walls;
}

/* --- the layers of a wall --------------------------------------------------------------------------------- */

/* The volumes of component c at a wall: the element of the outermost one, and how they follow each other. */
typedef struct layer {
  ptrdiff_t at, step[2], outward; /* outward: to the ghost */
  int n[2];
} layer;

static layer layer_of(const cf_flow_walls *w, const int axis, const int side, const int c) {
  const cf_box *b = &w->grid->box;
  layer l = {.outward = side == 0 ? -b->stride[axis] : b->stride[axis]};
  l.at = side == 0 ? 0 : (cf_flow_count(w, axis, c) - 1) * b->stride[axis];
  for (int o = 0; o < 2; ++o) {
    l.step[o] = b->stride[other(axis, o)];
    l.n[o] = cf_flow_count(w, other(axis, o), c);
  }
  return l;
}

void cf_flow_walls_hold(const cf_flow_walls *w, const cf_face u) {
  const cf_box *b = &w->grid->box;
  for (int a = 0; a < b->dim; ++a) {
    if (w->kind[a][0] == CF_FLOW_PERIODIC) {
      cf_halo image = {0};
      image.rule[a][0] = image.rule[a][1] = CF_HALO_WRAP;
      cf_halo_fill(b, &image, 0, a, u.at[a]);
      continue;
    }
    for (int side = 0; side < 2; ++side) {
      if (w->kind[a][side] != CF_FLOW_CLOSED) continue;
      const layer l = layer_of(w, a, side, a);
      const double *value = w->value[a][side][a];
      for (int j = 0; j < l.n[1]; ++j)
        for (int i = 0; i < l.n[0]; ++i)
          u.at[a][l.at + i * l.step[0] + j * l.step[1]] = (cf_real)value[i + (ptrdiff_t)l.n[0] * j];
    }
  }
}

void cf_flow_walls_ghosts(const cf_flow_walls *w, const int c, cf_real *u) {
  const cf_box *b = &w->grid->box;
  cf_halo halo = {0};
  for (int a = 0; a < b->dim; ++a)
    for (int side = 0; side < 2; ++side)
      halo.rule[a][side] = w->kind[a][side] == CF_FLOW_PERIODIC ? CF_HALO_WRAP : CF_HALO_COPY;
  cf_halo_fill(b, &halo, 1, c, u);
  for (int a = 0; a < b->dim; ++a)
    for (int side = 0; side < 2; ++side) {
      if (a == c || w->kind[a][side] != CF_FLOW_CLOSED || !w->sticks[a][side]) continue;
      const layer l = layer_of(w, a, side, c);
      const double *value = w->value[a][side][c];
      for (int j = 0; j < l.n[1]; ++j)
        for (int i = 0; i < l.n[0]; ++i) {
          const ptrdiff_t p = l.at + i * l.step[0] + j * l.step[1];
          u[p + l.outward] = (cf_real)(2 * value[i + (ptrdiff_t)l.n[0] * j]) - u[p];
        }
    }
}

double cf_flow_walls_inflow(const cf_flow_walls *w, double *gross) {
  const double area = cf_grid_area(w->grid);
  double net = 0;
  *gross = 0;
  for (int a = 0; a < w->grid->box.dim; ++a)
    for (int side = 0; side < 2; ++side) {
      if (w->kind[a][side] != CF_FLOW_CLOSED) continue;
      const layer l = layer_of(w, a, side, a);
      for (ptrdiff_t i = 0; i < (ptrdiff_t)l.n[0] * l.n[1]; ++i) {
        const double in = (side == 0 ? 1 : -1) * w->value[a][side][a][i] * area;
        net += in;
        *gross += fabs(in);
      }
    }
  return net;
}
