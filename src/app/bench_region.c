/* SPDX-License-Identifier: MIT */
#include "app/bench_region.h"

#include <math.h>
#include <string.h>

#include "base/mem.h"
#include "base/rng.h"

enum { PLATES = 3, GRAIN = 4 };

static const double ball_radius = 0.23, porosity = 0.7, drop_share = 0.02;

static bool is_wall(const char *name, const cf_box *b, const int i, const int j, const int k) {
  if (strcmp(name, "slalom") == 0) {
    const double y = (j + 0.5) / b->n[1];
    for (int v = 1; v <= PLATES; ++v)
      if (i == v * b->n[0] / (PLATES + 1)) return v % 2 == 1 ? y < 0.75 : y > 0.25;
    return false;
  }
  const uint64_t grain =
      ((uint64_t)(k / GRAIN) << 40) + ((uint64_t)(j / GRAIN) << 20) + (uint64_t)(i / GRAIN);
  return cf_random(2, 0, 0, grain) > porosity;
}

static void build_walls(const char *name, const cf_grid *g, cf_region *r) {
  const cf_box *b = &g->box;
  unsigned char *kind = cf_region_kinds(r);
  for (int k = 0; k < b->n[2]; ++k)
    for (int j = 0; j < b->n[1]; ++j)
      for (int i = 0; i < b->n[0]; ++i)
        if (is_wall(name, b, i, j, k)) kind[cf_box_at(b, i, j, k)] = CF_CELL_WALL;
}

static cf_shape ball_in(const cf_grid *g, const double radius) {
  double centre[3] = {0, 0, 0};
  for (int a = 0; a < g->box.dim; ++a) centre[a] = cf_grid_place(g, a, 0, 1) + g->h * g->box.n[a] / 2;
  return cf_shape_sphere(centre, radius * g->h * g->box.n[0]);
}

/* The tiles that a ball in the middle meets. */
static void cover(const cf_box *b, const double radius, cf_tiles *t) {
  for (int tk = 0; tk < t->n[2]; ++tk)
    for (int tj = 0; tj < t->n[1]; ++tj)
      for (int ti = 0; ti < t->n[0]; ++ti) {
        const int at[3] = {ti, tj, tk};
        double r2 = 0;
        for (int a = 0; a < b->dim; ++a) {
          const double low = at[a] << t->shift[a], centre = b->n[a] / 2.0;
          const double near = fmin(fmax(centre, low), low + t->edge[a]);
          r2 += (near - centre) * (near - centre);
        }
        if (r2 <= radius * radius) cf_tiles_add(t, ti, tj, tk);
      }
}

static cf_status create_drop(const cf_grid *g, cf_region **r, cf_tiles **tiles) {
  const double pi = acos(-1);
  const double radius = g->box.dim == 3 ? cbrt(3 * drop_share / (4 * pi)) : sqrt(drop_share / pi);
  const cf_shape ball = ball_in(g, radius);
  CF_TRY(cf_tiles_create(tiles, &g->box, NULL));
  cover(&g->box, radius * g->box.n[0] + 1, *tiles);
  CF_TRY(cf_tiles_update(*tiles));
  CF_TRY(cf_region_create_on(r, g, *tiles));
  CF_TRY(cf_region_add(*r, &ball, NULL, 0, CF_CELL_INSIDE, NULL));
  return cf_region_update(*r);
}

cf_status cf_bench_region_create(const char *name, const cf_grid *g, cf_region **r, cf_tiles **tiles) {
  *r = NULL;
  *tiles = NULL;
  if (strcmp(name, "drop") == 0) return create_drop(g, r, tiles);
  CF_TRY(cf_region_create(r, g));
  if (strcmp(name, "ball") == 0) {
    const cf_shape ball = ball_in(g, ball_radius);
    CF_TRY(cf_region_add(*r, &ball, NULL, 0, CF_CELL_WALL, NULL));
  } else if (strcmp(name, "slalom") == 0 || strcmp(name, "porous") == 0) {
    build_walls(name, g, *r);
  } else {
    return cf_fail(CF_BAD_ARGUMENT, "no region is called '%s'", name);
  }
  return cf_region_update(*r);
}
