/* SPDX-License-Identifier: MIT */
#include "grid/wall.h"

#include "base/mem.h"
#include "grid/halo.h"

cf_wall_side cf_wall_side_of(const cf_box *box, const int axis, const int side) {
  const int b = axis == 0 ? 1 : 0, c = axis == 2 ? 1 : 2;
  return (cf_wall_side){
      axis, side, b, c, box->n[b], box->n[c], side == 0 ? -box->stride[axis] : box->stride[axis]};
}

cf_status cf_wall_values_create(cf_wall_values *v, const cf_grid *g, const cf_walls *walls) {
  *v = (cf_wall_values){.grid = g, .walls = *walls};
  for (int a = 0; a < g->box.dim; ++a)
    for (int side = 0; side < 2; ++side) {
      if (!cf_wall_is_held(walls->kind[a][side])) continue;
      const cf_wall_side w = cf_wall_side_of(&g->box, a, side);
      const cf_status s = CF_NEW(&v->at[a][side], (ptrdiff_t)w.n_b * w.n_c);
      if (s != CF_OK) {
        cf_wall_values_destroy(v);
        return s;
      }
    }
  return CF_OK;
}

void cf_wall_values_destroy(cf_wall_values *v) {
  for (int a = 0; a < 3; ++a)
    for (int side = 0; side < 2; ++side) {
      cf_free(v->at[a][side]);
      v->at[a][side] = NULL;
    }
}

static void sample_side(const cf_wall_values *v, const int axis, const int side, const double t) {
  const cf_grid *g = v->grid;
  const cf_fn *f = &v->walls.value[axis][side];
  const cf_wall_side w = cf_wall_side_of(&g->box, axis, side);
  double place[3] = {0, 0, 0};
  place[axis] = g->origin[axis] + (side == 0 ? 0 : g->box.n[axis]) * g->h;
  for (int i_c = 0; i_c < w.n_c; ++i_c)
    for (int i_b = 0; i_b < w.n_b; ++i_b) {
      place[w.b] = cf_grid_place(g, w.b, i_b, 0);
      if (g->box.dim == 3) place[w.c] = cf_grid_place(g, w.c, i_c, 0);
      v->at[axis][side][i_b + (ptrdiff_t)w.n_b * i_c] = cf_fn_at(f, place[0], place[1], place[2], t);
    }
}

void cf_wall_values_sample(cf_wall_values *v, const double t) {
  for (int a = 0; a < v->grid->box.dim; ++a)
    for (int side = 0; side < 2; ++side)
      if (v->walls.kind[a][side] == CF_WALL_VALUE && (!v->known || v->walls.value[a][side].in_time))
        sample_side(v, a, side, t);
  v->known = true;
}

void cf_wall_ghosts(const cf_wall_values *v, const cf_cell phi) {
  const cf_box *box = &v->grid->box;
  cf_halo halo = {.threads = v->grid->threads};
  for (int a = 0; a < box->dim; ++a)
    for (int side = 0; side < 2; ++side)
      halo.rule[a][side] = v->walls.kind[a][side] == CF_WALL_PERIODIC ? CF_HALO_WRAP : CF_HALO_COPY;
  cf_halo_fill(box, &halo, 1, CF_CENTRES, phi.at);
  for (int a = 0; a < box->dim; ++a)
    for (int side = 0; side < 2; ++side) {
      if (v->at[a][side] == NULL) continue;
      const cf_wall_side w = cf_wall_side_of(box, a, side);
      for (int i_c = 0; i_c < w.n_c; ++i_c)
        for (int i_b = 0; i_b < w.n_b; ++i_b) {
          const ptrdiff_t p = cf_wall_cell(box, &w, i_b, i_c);
          const double wall = v->at[a][side][i_b + (ptrdiff_t)w.n_b * i_c];
          phi.at[p + w.outward] = (cf_real)(2 * wall) - phi.at[p];
        }
    }
}
