/* SPDX-License-Identifier: MIT
 *
 * The volumes around the faces of an axis are a box of their own, one longer on that axis where it does not wrap, in the
 * same memory: so a component of the velocity is a cell field to the solver. Its first and last layer on closed walls
 * are known; there alpha is so large that the change is nothing.
 *
 * The same holds for volumes around the faces of solids. Between two solid cells a volume is no fluid: beside it the
 * fluid slips, or has the solid's velocity half a cell away.
 */
#include "physics/viscosity.h"

#include <math.h>

#include "base/mem.h"
#include "grid/sweep.h"

#define STAGE (1 - 0.70710678118654752440)
#define HOLD  1e6

/* One component: its box, and its equation. */
typedef struct component {
  cf_grid grid;
  cf_helmholtz *A;
  cf_cell alpha;      /* where a layer or the face of a solid is held; else NULL */
  cf_region *volumes; /* which are fluid; NULL: all */
} component;

struct cf_viscosity {
  const cf_flow_walls *walls;
  double nu, delta; /* delta: of the stage that the operators are set for */
  cf_solve_options solver;
  component of[3];
  cf_cell change, b;
  const cf_region *region; /* of cells; NULL: all fluid */
};

/* --- making ----------------------------------------------------------------------------------------------- */

static bool is_held(const cf_flow_walls *w, const int c, const int side) {
  return w->kind[c][side] == CF_FLOW_CLOSED;
}

static cf_walls walls_of(const cf_flow_walls *w, const int c) {
  cf_walls walls = {0};
  for (int a = 0; a < w->grid->box.dim; ++a)
    for (int side = 0; side < 2; ++side) {
      if (w->kind[a][side] == CF_FLOW_PERIODIC) walls.kind[a][side] = CF_WALL_PERIODIC;
      if (a != c && w->kind[a][side] == CF_FLOW_CLOSED && w->sticks[a][side])
        walls.kind[a][side] = CF_WALL_OPEN;
    }
  return walls;
}

/* What the volume around the low face of cell p along c is: `above` and `below` are the kinds of the two cells. */
static cf_cell_kind kind_of(const int above, const int below) {
  if (above == CF_CELL_INSIDE || below == CF_CELL_INSIDE) return CF_CELL_INSIDE;
  return above == CF_CELL_HELD || below == CF_CELL_HELD ? CF_CELL_HELD : CF_CELL_WALL;
}

typedef struct volume {
  cf_cell_kind kind;
  bool held; /* its velocity is known */
} volume;

/* Beyond walls of the box a cell is what the one beside the wall is. */
static volume volume_at(const cf_viscosity *v, const int c, const int at[3]) {
  const cf_flow_walls *w = v->walls;
  const cf_box *b = &w->grid->box;
  const int n = b->n[c], last = cf_flow_count(w, c, c) - 1;
  volume f = {CF_CELL_INSIDE, (at[c] == 0 && is_held(w, c, 0)) || (at[c] == last && is_held(w, c, 1))};
  if (v->region == NULL) return f;
  const bool wraps = w->kind[c][0] == CF_FLOW_PERIODIC;
  int low[3] = {at[0], at[1], at[2]}, high[3] = {at[0], at[1], at[2]};
  low[c] = at[c] > 0 ? at[c] - 1 : wraps ? n - 1 : 0;
  high[c] = at[c] < n ? at[c] : n - 1;
  const int below = v->region->kind[cf_box_at(b, low[0], low[1], low[2])];
  const int above = v->region->kind[cf_box_at(b, high[0], high[1], high[2])];
  f.kind = kind_of(above, below);
  f.held = f.held || above != CF_CELL_INSIDE || below != CF_CELL_INSIDE;
  return f;
}

/* 1 in cells, HOLD where the velocity is known. */
static void fill_alpha(const cf_viscosity *v, const int c) {
  const component *k = &v->of[c];
  const int *n = k->grid.box.n;
  for (int z = 0; z < n[2]; ++z)
    for (int y = 0; y < n[1]; ++y)
      for (int x = 0; x < n[0]; ++x) {
        const int at[3] = {x, y, z};
        const ptrdiff_t p = cf_box_at(&k->grid.box, x, y, z);
        const volume f = volume_at(v, c, at);
        k->alpha.at[p] = (cf_real)(f.held ? HOLD : 1);
        if (k->volumes != NULL) cf_region_kinds(k->volumes)[p] = (unsigned char)f.kind;
      }
}

static cf_status make_component(cf_viscosity *v, const int c, const int levels) {
  const cf_flow_walls *w = v->walls;
  component *k = &v->of[c];
  k->grid = *w->grid;
  k->grid.box.n[c] = cf_flow_count(w, c, c);
  k->grid.box.halo -= k->grid.box.n[c] - w->grid->box.n[c];
  const cf_walls walls = walls_of(w, c);
  CF_TRY(cf_helmholtz_create(&k->A, &k->grid, &walls, levels));
  if (!is_held(w, c, 0) && !is_held(w, c, 1)) return CF_OK;
  CF_TRY(cf_cell_create(&k->alpha, &w->grid->box));
  fill_alpha(v, c);
  return CF_OK;
}

static cf_status make(cf_viscosity *v, const int levels) {
  const cf_box *b = &v->walls->grid->box;
  for (int c = 0; c < b->dim; ++c) CF_TRY(make_component(v, c, levels));
  CF_TRY(cf_cell_create(&v->change, b));
  return cf_cell_create(&v->b, b);
}

cf_status cf_viscosity_create(cf_viscosity **viscosity, const cf_flow_walls *walls, const double nu,
                              const cf_solve_options *o, const int levels) {
  *viscosity = NULL;
  cf_viscosity *v;
  CF_TRY(CF_NEW(&v, 1));
  v->walls = walls;
  v->nu = nu;
  v->solver = *o;
  const cf_status s = make(v, levels);
  if (s != CF_OK) {
    cf_viscosity_destroy(v);
    return s;
  }
  *viscosity = v;
  return CF_OK;
}

void cf_viscosity_destroy(cf_viscosity *v) {
  if (v == NULL) return;
  const cf_box *b = &v->walls->grid->box;
  for (int c = 0; c < 3; ++c) {
    cf_helmholtz_destroy(v->of[c].A);
    cf_cell_destroy(&v->of[c].alpha, b);
    cf_region_destroy(v->of[c].volumes);
  }
  cf_cell_destroy(&v->change, b);
  cf_cell_destroy(&v->b, b);
  cf_free(v);
}

static cf_status set_component(cf_viscosity *v, const int c) {
  component *k = &v->of[c];
  bool wraps[3] = {false, false, false};
  if (k->alpha.at == NULL) CF_TRY(cf_cell_create(&k->alpha, &v->walls->grid->box));
  if (k->volumes == NULL) CF_TRY(cf_region_create(&k->volumes, &k->grid));
  fill_alpha(v, c);
  for (int a = 0; a < v->walls->grid->box.dim; ++a) wraps[a] = v->walls->kind[a][0] == CF_FLOW_PERIODIC;
  cf_region_ghosts(k->volumes, wraps);
  return cf_region_update(k->volumes);
}

cf_status cf_viscosity_set_region(cf_viscosity *v, const cf_region *region) {
  v->region = region;
  v->delta = 0; /* the operators are set anew */
  for (int c = 0; c < v->walls->grid->box.dim && region != NULL; ++c) CF_TRY(set_component(v, c));
  return CF_OK;
}

/* --- a stage ---------------------------------------------------------------------------------------------- */

typedef struct right_side {
  const cf_real *u, *a;
  cf_real *b;
  ptrdiff_t stride[3];
  cf_real bend, push; /* delta nu/h^2, delta */
} right_side;

CF_KERNEL void right_side_row(const int dim, const int n, const right_side *s, const ptrdiff_t at) {
  CF_ROW_LOOP
  for (int i = 0; i < n; ++i) {
    const ptrdiff_t p = at + i;
    cf_real sum = 0;
    CF_AXIS_LOOP
    for (int a = 0; a < dim; ++a)
      sum += (s->u[p + s->stride[a]] - s->u[p]) - (s->u[p] - s->u[p - s->stride[a]]);
    s->b[p] = s->bend * sum + s->push * s->a[p];
  }
}
CF_CLONED(right_side_row, const right_side *, const ptrdiff_t)

CF_CLONES static void add_row(const int n, const cf_real w, const cf_real *from, cf_real *to) {
  CF_ROW_LOOP
  for (int i = 0; i < n; ++i) to[i] += w * from[i];
}

/* What a neighbour across a face adds to the sum above: nothing where the fluid slips along it, and twice as much where
 * it sticks to it, half as far away. */
static cf_real across(const right_side *s, const unsigned char *kind, const ptrdiff_t p,
                      const ptrdiff_t next) {
  if (kind[next] == CF_CELL_WALL) return 0;
  return (kind[next] == CF_CELL_HELD ? 2 : 1) * (s->u[next] - s->u[p]);
}

/* The same beside solids, whose own velocities do not change. */
static void right_side_of_solids(const component *k, const right_side *s, const ptrdiff_t at) {
  const cf_box *b = &k->grid.box;
  const unsigned char *kind = k->volumes->kind;
  for (ptrdiff_t p = at; p < at + b->n[0]; ++p) {
    cf_real sum = 0;
    bool beside = kind[p] != CF_CELL_INSIDE || k->alpha.at[p] > 1;
    for (int a = 0; a < b->dim && !beside; ++a)
      beside = kind[p - b->stride[a]] != CF_CELL_INSIDE || kind[p + b->stride[a]] != CF_CELL_INSIDE;
    if (!beside) continue;
    for (int a = 0; a < b->dim; ++a)
      sum += across(s, kind, p, p + b->stride[a]) + across(s, kind, p, p - b->stride[a]);
    s->b[p] = kind[p] != CF_CELL_INSIDE || k->alpha.at[p] > 1 ? 0 : s->bend * sum + s->push * s->a[p];
  }
}

/* Nothing changes on the layers of closed walls. */
static void clear_held(const cf_viscosity *v, const int c) {
  const cf_box *b = &v->of[c].grid.box;
  const int o1 = c == 0 ? 1 : 0, o2 = c == 2 ? 1 : 2;
  for (int side = 0; side < 2; ++side) {
    if (!is_held(v->walls, c, side)) continue;
    cf_real *f = v->b.at + (side == 0 ? 0 : b->n[c] - 1) * b->stride[c];
    for (int j = 0; j < b->n[o2]; ++j)
      for (int i = 0; i < b->n[o1]; ++i) f[i * b->stride[o1] + j * b->stride[o2]] = 0;
  }
}

static void add_report(const cf_solve_report *one, cf_solve_report *report) {
  report->iterations += one->iterations;
  report->levels = one->levels;
  report->residual = CF_MAX(report->residual, one->residual);
  report->converged = report->converged && one->converged;
  report->method = one->method;
}

/* u += weight (stage of u - u). */
static cf_status stage(cf_viscosity *v, const int c, const double weight, const cf_real *a, cf_real *u,
                       cf_solve_report *report) {
  const component *k = &v->of[c];
  const cf_box *b = &k->grid.box;
  const double h = k->grid.h;
  right_side s = {
      .u = u, .a = a, .b = v->b.at, .bend = (cf_real)(v->delta * v->nu / (h * h)), .push = (cf_real)v->delta};
  for (int axis = 0; axis < 3; ++axis) s.stride[axis] = b->stride[axis];
  cf_flow_walls_ghosts(v->walls, c, u);
  CF_PARALLEL_ROWS (b, k->grid.threads, r) {
    right_side_row_by_dim(b->dim, b->n[0], &s, cf_box_row(b, r));
    if (v->region != NULL) right_side_of_solids(k, &s, cf_box_row(b, r));
  }
  clear_held(v, c);
  CF_PARALLEL_ROWS (b, k->grid.threads, r)
    for (int i = 0; i < b->n[0]; ++i) v->change.at[cf_box_row(b, r) + i] = 0;
  cf_solve_report one;
  CF_TRY(cf_helmholtz_solve(k->A, v->b, &v->solver, v->change, &one));
  add_report(&one, report);
  CF_PARALLEL_ROWS (b, k->grid.threads, r) {
    const ptrdiff_t p = cf_box_row(b, r);
    add_row(b->n[0], (cf_real)weight, v->change.at + p, u + p);
  }
  return CF_OK;
}

static cf_status set_stage(cf_viscosity *v, const double delta) {
  if (v->delta == delta) return CF_OK;
  v->delta = delta;
  for (int c = 0; c < v->walls->grid->box.dim; ++c) {
    const component *k = &v->of[c];
    const cf_coefficients of = {.alpha = 1,
                                .beta = delta * v->nu,
                                .alpha_at = k->alpha.at != NULL ? &k->alpha : NULL,
                                .region = v->region != NULL ? k->volumes : NULL};
    CF_TRY(cf_helmholtz_set(k->A, &of));
  }
  return CF_OK;
}

cf_status cf_viscosity_step(cf_viscosity *v, const double dt, const cf_face a, const cf_face u,
                            cf_solve_report *report) {
  *report = (cf_solve_report){.converged = true};
  CF_TRY(set_stage(v, STAGE * dt));
  if (v->region == NULL) cf_flow_walls_hold(v->walls, u);
  for (int c = 0; c < v->walls->grid->box.dim; ++c) {
    CF_TRY(stage(v, c, 1 + sqrt(2.0), a.at[c], u.at[c], report));
    CF_TRY(stage(v, c, 1, a.at[c], u.at[c], report));
  }
  if (v->region == NULL) cf_flow_walls_hold(v->walls, u);
  return CF_OK;
}
