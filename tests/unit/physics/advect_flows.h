/* SPDX-License-Identifier: MIT
 *
 * Flows and fields for the tests of advection. All flows are curls of a potential sampled at the corners (2D) or
 * edges (3D) of cells, so they are free of divergence to round-off.
 */
#ifndef TEST_ADVECT_FLOWS_H
#define TEST_ADVECT_FLOWS_H

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "base/mem.h"
#include "grid/sweep.h"
#include "physics/advect.h"

#define PI       3.14159265358979323846
#define OK(call) assert_int_equal((call), CF_OK)

typedef struct scene {
  cf_grid grid;
  cf_walls walls;
  cf_advect *advect;
  cf_face u;
  cf_cell phi;
} scene;

static inline cf_walls walls_all(const cf_wall kind) {
  cf_walls w = {0};
  for (int a = 0; a < 3; ++a) w.kind[a][0] = w.kind[a][1] = kind;
  return w;
}

static inline void scene_open_scheme(scene *s, const int dim, const int *cells, const cf_walls walls,
                                     const cf_advect_scheme scheme) {
  OK(cf_grid_init(&s->grid, dim, cells, 1.0 / cells[0], NULL));
  s->walls = walls;
  OK(cf_advect_create(&s->advect, &s->grid, scheme));
  OK(cf_face_create(&s->u, &s->grid.box));
  OK(cf_cell_create(&s->phi, &s->grid.box));
}

static inline void scene_open(scene *s, const int dim, const int *cells, const cf_walls walls) {
  scene_open_scheme(s, dim, cells, walls, CF_ADVECT_PPM);
}

static inline void scene_close(scene *s) {
  cf_advect_destroy(s->advect);
  cf_face_destroy(&s->u, &s->grid.box);
  cf_cell_destroy(&s->phi, &s->grid.box);
}

/* A number in [0, 1) for a place and a stream. */
static inline double noise(const int64_t place, const int64_t stream) {
  uint64_t x = (uint64_t)place * 0x9E3779B97F4A7C15u + (uint64_t)stream * 0xD1B54A32D192ED03u + 0x2545F491u;
  x = (x ^ (x >> 30)) * 0xBF58476D1CE4E5B9u;
  x = (x ^ (x >> 27)) * 0x94D049BB133111EBu;
  return (double)((x ^ (x >> 31)) >> 11) / 9007199254740992.0;
}

/* The potential along `axis` at a lower edge (2D: axis 2, a corner), from its index and place. */
typedef double (*potential)(int axis, const int i[3], const double x[3], const void *context);

static inline double potential_at(const scene *s, const potential A, const void *context, const int axis,
                                  const int i[3]) {
  double x[3];
  int wrapped[3];
  for (int a = 0; a < 3; ++a) {
    const int n = s->grid.box.n[a];
    wrapped[a] = s->walls.kind[a][0] == CF_WALL_PERIODIC && i[a] == n ? 0 : i[a];
    x[a] = s->grid.origin[a] + (wrapped[a] + (a == axis ? 0.5 : 0)) * s->grid.h;
  }
  return A(axis, wrapped, x, context);
}

/* u = curl A. In 2D A has its z component alone. */
static inline void set_curl(scene *s, const potential A, const void *context) {
  const cf_box *b = &s->grid.box;
  for (int a = 0; a < b->dim; ++a)
    for (int k = 0; k < cf_box_extent(b, 2, a); ++k)
      for (int j = 0; j < cf_box_extent(b, 1, a); ++j)
        for (int i = 0; i < cf_box_extent(b, 0, a); ++i) {
          const int at[3] = {i, j, k};
          double curl = 0;
          for (int d = 1; d <= 2; ++d) { /* d_{a+1} A_{a+2} - d_{a+2} A_{a+1} */
            const int along = (a + d) % 3, of = (a + 3 - d) % 3;
            if (along >= b->dim || (b->dim == 2 && of != 2)) continue;
            int next[3] = {i, j, k};
            next[along] += 1;
            const double difference =
                potential_at(s, A, context, of, next) - potential_at(s, A, context, of, at);
            curl += (d == 1 ? difference : -difference) / s->grid.h;
          }
          s->u.at[a][cf_box_at(b, i, j, k)] = (cf_real)curl;
        }
}

/* Noise that vanishes on walls where `closed`: a new flow for every `stream`. */
typedef struct random_flow {
  int64_t stream;
  const scene *scene;
  int closed;
} random_flow;

static inline double random_potential(const int axis, const int i[3], const double x[3],
                                      const void *context) {
  const random_flow *r = context;
  (void)x;
  for (int a = 0; a < r->scene->grid.box.dim; ++a)
    if (r->closed && a != axis && (i[a] == 0 || i[a] == r->scene->grid.box.n[a])) return 0;
  return noise(((i[2] * 1009 + i[1]) * 1009 + i[0]) * 4 + axis, r->stream) - 0.5;
}

static inline void set_random_flow(scene *s, const int64_t stream, const int closed) {
  const random_flow r = {stream, s, closed};
  set_curl(s, random_potential, &r);
}

typedef double (*profile)(const double x[3]);

static inline void set_cells(scene *s, const profile f) {
  const cf_box *b = &s->grid.box;
  for (int k = 0; k < b->n[2]; ++k)
    for (int j = 0; j < b->n[1]; ++j)
      for (int i = 0; i < b->n[0]; ++i) {
        const double x[3] = {cf_grid_place(&s->grid, 0, i, 0), cf_grid_place(&s->grid, 1, j, 0),
                             cf_grid_place(&s->grid, 2, k, 0)};
        s->phi.at[cf_box_at(b, i, j, k)] = (cf_real)f(x);
      }
}

static inline cf_range range_of(const scene *s) {
  double *rows;
  OK(CF_NEW(&rows, 3 * cf_box_rows(&s->grid.box)));
  const cf_range r = cf_sweep_range(&s->grid.box, 1, s->phi.at, rows);
  cf_free(rows);
  return r;
}

/* sum |phi - f| / sum |f|. */
static inline double error_against(const scene *s, const profile f) {
  const cf_box *b = &s->grid.box;
  double wrong = 0, all = 0;
  for (int k = 0; k < b->n[2]; ++k)
    for (int j = 0; j < b->n[1]; ++j)
      for (int i = 0; i < b->n[0]; ++i) {
        const double x[3] = {cf_grid_place(&s->grid, 0, i, 0), cf_grid_place(&s->grid, 1, j, 0),
                             cf_grid_place(&s->grid, 2, k, 0)};
        wrong += fabs((double)s->phi.at[cf_box_at(b, i, j, k)] - f(x));
        all += fabs(f(x));
      }
  return wrong / all;
}

/* One step at time t whose K is `k`; returns its length. */
static inline double step_of(const scene *s, const double k) { return k / cf_advect_rate(s->advect); }

static inline void move_cells(scene *s, const double t, const double dt, cf_through *through) {
  OK(cf_advect_begin(s->advect, t, dt));
  OK(cf_advect_cell(s->advect, &s->walls, s->phi, through));
}

#endif
