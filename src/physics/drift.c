/* SPDX-License-Identifier: MIT
 *
 * Every point by itself, so the result does not hang on threads or on the order they are in.
 */
#include "physics/drift.h"

#include <math.h>

#include "grid/sweep.h"

/* What a row of points needs: the box in cells, and three velocities. */
typedef struct row {
  const cf_real *u[3][3];
  cf_real *x[3];
  const cf_real *born; /* NULL: all move by dt */
  uint32_t *key;
  cf_real *to[3]; /* of velocity_row */
  ptrdiff_t stride[3];
  int n[3];
  cf_real low[3], size[3], per_h, dt, until;
  bool wraps[3], open[3][2];
} row;

/* --- the velocity at a place ------------------------------------------------------------------------------ */

/* A place along an axis, in cells: the face in the middle of the spline, the cell below, and their weights. */
typedef struct spot {
  ptrdiff_t face, cell;
  cf_real w[3], v[2];
} spot;

/* Beyond the box counts as on its wall; so does NaN, which then stays in x itself. */
CF_KERNEL cf_real within(const cf_real at, const cf_real n, const bool wraps) {
  const cf_real turned = wraps ? at - n * (cf_real)floor((double)(at / n)) : at;
  const cf_real above = turned > 0 ? turned : 0;
  return above < n ? above : n;
}

CF_KERNEL spot spot_of(const cf_real at, const ptrdiff_t stride) {
  const int face = (int)(at + (cf_real)0.5), above = (int)(at + (cf_real)0.5); /* the cell above at - 1/2 */
  const cf_real f = at - (cf_real)face, g = at + (cf_real)0.5 - (cf_real)above, low = (cf_real)0.5 - f,
                high = (cf_real)0.5 + f;
  return (spot){.face = face * stride,
                .cell = (above - 1) * stride,
                .w = {low * low / 2, (cf_real)0.75 - f * f, high * high / 2},
                .v = {1 - g, g}};
}

/* Along the component's own axis: three faces. */
CF_KERNEL cf_real spline(const cf_real *u, const spot *s, const ptrdiff_t stride) {
  return s->w[0] * u[-stride] + s->w[1] * u[0] + s->w[2] * u[stride];
}

CF_KERNEL cf_real component(const int dim, const row *r, const cf_real *u, const spot s[3], const int c) {
  const int d = c == 0 ? 1 : 0, e = c == 2 ? 1 : 2;
  const ptrdiff_t own = r->stride[c];
  const cf_real *low = u + s[c].face + s[d].cell + (dim == 3 ? s[e].cell : 0);
  const cf_real v0 = s[d].v[0] * spline(low, &s[c], own) + s[d].v[1] * spline(low + r->stride[d], &s[c], own);
  if (dim == 2) return v0;
  const cf_real *high = low + r->stride[e];
  const cf_real v1 =
      s[d].v[0] * spline(high, &s[c], own) + s[d].v[1] * spline(high + r->stride[d], &s[c], own);
  return s[e].v[0] * v0 + s[e].v[1] * v1;
}

CF_KERNEL void velocity_at(const int dim, const row *r, const int when, const cf_real x[3], cf_real v[3]) {
  spot s[3] = {{0}};
  CF_AXIS_LOOP
  for (int a = 0; a < dim; ++a)
    s[a] = spot_of(within((x[a] - r->low[a]) * r->per_h, (cf_real)r->n[a], r->wraps[a]), r->stride[a]);
  CF_AXIS_LOOP
  for (int a = 0; a < dim; ++a) v[a] = component(dim, r, r->u[when][a], s, a);
}

/* --- a move ----------------------------------------------------------------------------------------------- */

/* Back into the box; whether it has left for good. */
CF_KERNEL bool put_back(const row *r, const int a, cf_real *x) {
  const cf_real high = r->low[a] + r->size[a];
  if (*x >= r->low[a] && *x <= high) return false;
  if (r->wraps[a]) {
    *x -= r->size[a] * (cf_real)floor((double)((*x - r->low[a]) / r->size[a]));
    return false;
  }
  if (*x < r->low[a] && !r->open[a][0]) *x = r->low[a];
  if (*x > high && !r->open[a][1]) *x = high;
  return *x < r->low[a] || *x > high;
}

CF_KERNEL void move_row(const int dim, const int n, const row *r, const int64_t first) {
  const cf_real half = (cf_real)0.5, sixth = (cf_real)(1.0 / 6);
  for (int64_t i = first; i < first + n; ++i) {
    const cf_real dt = r->born != NULL ? r->until - r->born[i] : r->dt;
    cf_real x[3] = {0}, y[3] = {0}, k1[3], k2[3], k3[3];
    CF_AXIS_LOOP
    for (int a = 0; a < dim; ++a) x[a] = r->x[a][i];
    velocity_at(dim, r, 0, x, k1);
    CF_AXIS_LOOP
    for (int a = 0; a < dim; ++a) y[a] = x[a] + half * dt * k1[a];
    velocity_at(dim, r, 1, y, k2);
    CF_AXIS_LOOP
    for (int a = 0; a < dim; ++a) y[a] = x[a] + dt * (2 * k2[a] - k1[a]);
    velocity_at(dim, r, 2, y, k3);
    bool out = false;
    CF_AXIS_LOOP
    for (int a = 0; a < dim; ++a) {
      cf_real to = x[a] + sixth * dt * (k1[a] + 4 * k2[a] + k3[a]);
      out = put_back(r, a, &to) || out;
      r->x[a][i] = to;
    }
    r->key[i] = out;
  }
}
CF_CLONED(move_row, const row *, const int64_t)

CF_KERNEL void velocity_row(const int dim, const int n, const row *r, const int64_t first) {
  for (int64_t i = first; i < first + n; ++i) {
    cf_real x[3] = {0}, v[3];
    CF_AXIS_LOOP
    for (int a = 0; a < dim; ++a) x[a] = r->x[a][i];
    velocity_at(dim, r, 2, x, v);
    CF_AXIS_LOOP
    for (int a = 0; a < dim; ++a) r->to[a][i] = v[a];
  }
}
CF_CLONED(velocity_row, const row *, const int64_t)

/* --- all of them ------------------------------------------------------------------------------------------ */

static row row_of(const cf_drift *d, const cf_particles *set) {
  const cf_grid *g = d->grid;
  row r = {.key = set->key, .per_h = (cf_real)(1 / g->h)};
  for (int a = 0; a < g->box.dim; ++a) {
    for (int when = 0; when < 3; ++when) r.u[when][a] = d->u[when].at[a];
    r.x[a] = set->attribute[CF_PARTICLE_POSITION].at[a];
    r.stride[a] = g->box.stride[a];
    r.n[a] = g->box.n[a];
    r.low[a] = (cf_real)g->origin[a];
    r.size[a] = (cf_real)(g->box.n[a] * g->h);
    r.wraps[a] = d->wraps[a];
    for (int side = 0; side < 2; ++side) r.open[a][side] = d->open[a][side];
  }
  return r;
}

#define CHUNK 4096 /* points that a thread takes at a time */

static int threads_of(const cf_grid *g, const int64_t points) {
  return points < CF_SERIAL_CELLS ? 1 : g->threads;
}

/* A row function over the points from `first` on. */
static void run(const cf_drift *d, void (*kernel)(int, int, const row *, int64_t), const row *r,
                const int64_t first, const int64_t count) {
#pragma omp parallel for schedule(static) num_threads(threads_of(d->grid, count - first))
  for (int64_t from = first; from < count; from += CHUNK)
    kernel(d->grid->box.dim, (int)CF_MIN(count - from, CHUNK), r, from);
}

void cf_drift_move(const cf_drift *d, const double dt, cf_particles *set, const int64_t first) {
  row r = row_of(d, set);
  r.dt = (cf_real)dt;
  run(d, move_row_by_dim, &r, first, set->count);
}

void cf_drift_move_born(const cf_drift *d, const double until, const int born, cf_particles *set,
                        const int64_t first) {
  row r = row_of(d, set);
  r.born = set->attribute[born].at[0];
  r.until = (cf_real)until;
  for (int when = 0; when < 2; ++when)
    for (int a = 0; a < d->grid->box.dim; ++a) r.u[when][a] = d->u[2].at[a];
  run(d, move_row_by_dim, &r, first, set->count);
}

void cf_drift_velocity(const cf_drift *d, cf_particles *set, const int to) {
  row r = row_of(d, set);
  for (int a = 0; a < d->grid->box.dim; ++a) r.to[a] = set->attribute[to].at[a];
  run(d, velocity_row_by_dim, &r, 0, set->count);
}

/* --- order ------------------------------------------------------------------------------------------------ */

static uint32_t block_of(const cf_grid *g, cf_real *const *x, const int64_t i) {
  static const int shift[3] = {3, 2, 2};
  uint32_t key = 0;
  for (int a = g->box.dim - 1; a >= 0; --a) {
    const cf_real at = within((x[a][i] - (cf_real)g->origin[a]) / (cf_real)g->h, (cf_real)g->box.n[a], false);
    key = key * (uint32_t)((g->box.n[a] >> shift[a]) + 1) + ((uint32_t)at >> shift[a]);
  }
  return key;
}

void cf_drift_sort(const cf_grid *g, cf_particles *set) {
  cf_real *const *x = set->attribute[CF_PARTICLE_POSITION].at;
#pragma omp parallel for schedule(static) num_threads(threads_of(g, set->count))
  for (int64_t i = 0; i < set->count; ++i) set->key[i] = block_of(g, x, i);
  cf_particles_sort(set, g->threads);
}
