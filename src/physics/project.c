/* SPDX-License-Identifier: MIT
 *
 * Three sweeps and a solve. The pressure has a layer of ghosts: mirrored at closed walls, so that nothing happens on
 * their faces, and of opposite sign at open ones, where it is 0 on the wall.
 */
#include "physics/project.h"

#include <math.h>

#include "base/mem.h"
#include "grid/sweep.h"
#include "grid/wall.h"

/* However small the change of the pressure is, this much of it is found. */
#define LOOSEST 0.1

struct cf_project {
  const cf_grid *grid;
  const cf_flow_walls *walls;
  cf_solve_options solver;
  cf_wall_values outside; /* of the pressure: 0 on open walls */
  cf_region *region;      /* of the fluid; NULL: everywhere */
  cf_helmholtz *A;
  cf_cell change, b; /* components of `spare`, or its own: */
  bool owns;
  double *rows; /* 2 a row */
};

static cf_status make(cf_project *p, const int levels, const cf_face *spare) {
  const cf_box *b = &p->grid->box;
  const cf_walls walls = cf_flow_walls_of_pressure(p->walls);
  CF_TRY(cf_wall_values_create(&p->outside, p->grid, &walls));
  CF_TRY(cf_helmholtz_create(&p->A, p->grid, &walls, levels));
  CF_TRY(cf_helmholtz_set(p->A, &(cf_coefficients){.alpha = 0, .beta = 1}));
  p->owns = spare == NULL;
  if (p->owns) {
    CF_TRY(cf_cell_create(&p->change, b));
    CF_TRY(cf_cell_create(&p->b, b));
  } else {
    p->change.at = spare->at[0];
    p->b.at = spare->at[1];
  }
  return CF_NEW(&p->rows, 2 * cf_box_rows(b));
}

cf_status cf_project_create(cf_project **project, const cf_flow_walls *walls, const cf_solve_options *o,
                            const int levels, const cf_face *spare) {
  *project = NULL;
  cf_project *p;
  CF_TRY(CF_NEW(&p, 1));
  p->grid = walls->grid;
  p->walls = walls;
  p->solver = *o;
  const cf_status s = make(p, levels, spare);
  if (s != CF_OK) {
    cf_project_destroy(p);
    return s;
  }
  *project = p;
  return CF_OK;
}

void cf_project_destroy(cf_project *p) {
  if (p == NULL) return;
  cf_helmholtz_destroy(p->A);
  cf_wall_values_destroy(&p->outside);
  if (p->owns) {
    cf_cell_destroy(&p->change, &p->grid->box);
    cf_cell_destroy(&p->b, &p->grid->box);
  }
  cf_free(p->rows);
  cf_free(p);
}

/* --- solids ----------------------------------------------------------------------------------------------- */

cf_status cf_project_set_region(cf_project *p, cf_region *region) {
  bool wraps[3] = {false, false, false};
  for (int a = 0; a < p->grid->box.dim; ++a) wraps[a] = p->walls->kind[a][0] == CF_FLOW_PERIODIC;
  p->region = region;
  if (region != NULL) cf_region_ghosts(region, wraps);
  return cf_helmholtz_set(p->A, &(cf_coefficients){.alpha = 0, .beta = 1, .region = region});
}

static void fill_cell(const cf_project *p, const cf_real *from, const ptrdiff_t at, cf_real *to) {
  const cf_box *b = &p->grid->box;
  const unsigned char *kind = p->region->kind;
  cf_real sum = 0;
  int neighbours = 0;
  for (int a = 0; a < b->dim; ++a)
    for (int side = -1; side <= 1; side += 2) {
      const ptrdiff_t next = at + side * b->stride[a];
      if (kind[next] != CF_CELL_INSIDE) continue;
      sum += from[next];
      ++neighbours;
    }
  if (neighbours > 0) to[at] = sum / (cf_real)neighbours;
}

void cf_project_fill(const cf_project *p, const cf_cell pressure) {
  const cf_box *b = &p->grid->box;
  if (p->region == NULL) return;
  cf_wall_ghosts(&p->outside, pressure);
  CF_PARALLEL_ROWS (b, p->grid->threads, r)
    for (ptrdiff_t at = cf_box_row(b, r), end = at + b->n[0]; at < end; ++at)
      if (p->region->kind[at] != CF_CELL_INSIDE) fill_cell(p, pressure.at, at, pressure.at);
}

/* --- sweeps ----------------------------------------------------------------------------------------------- */

/* u -= w (p - p_below). */
CF_CLONES static void push_row(const int n, const cf_real w, const ptrdiff_t below, const cf_real *p,
                               cf_real *u) {
  CF_ROW_LOOP
  for (int i = 0; i < n; ++i) u[i] -= w * (p[i] - p[i - below]);
}

/* The same on faces between two cells of the fluid. */
CF_CLONES static void push_open_row(const int n, const cf_real w, const ptrdiff_t below, const cf_real *p,
                                    const unsigned char *kind, cf_real *u) {
  CF_ROW_LOOP
  for (int i = 0; i < n; ++i) {
    const cf_real open = kind[i] == CF_CELL_INSIDE && kind[i - below] == CF_CELL_INSIDE ? w : 0;
    u[i] -= open * (p[i] - p[i - below]);
  }
}

void cf_project_push(const cf_project *p, const double dt, const cf_cell pressure, const cf_face u) {
  const cf_box *b = &p->grid->box;
  const cf_real w = (cf_real)(dt / p->grid->h);
  cf_wall_ghosts(&p->outside, pressure);
  for (int a = 0; a < b->dim; ++a)
    CF_PARALLEL_FACE_ROWS (b, p->grid->threads, a, r) {
      const ptrdiff_t q = cf_box_face_row(b, a, r);
      const int n = cf_box_extent(b, 0, a);
      if (p->region == NULL)
        push_row(n, w, b->stride[a], pressure.at + q, u.at[a] + q);
      else
        push_open_row(n, w, b->stride[a], pressure.at + q, p->region->kind + q, u.at[a] + q);
    }
}

typedef struct divergence {
  const cf_real *u[3], *p;   /* p: the pressure that has acted already */
  const unsigned char *kind; /* NULL: fluid everywhere */
  cf_real *b;
  ptrdiff_t stride[3];
  cf_real w, p_w; /* 1/(h dt), 1/h^2 */
} divergence;

CF_KERNEL double sum_of_squares(const cf_real *f, const int n) {
  double lane[CF_SUM_LANES] = {0};
  int i = 0;
  for (; i + CF_SUM_LANES <= n; i += CF_SUM_LANES)
    for (int l = 0; l < CF_SUM_LANES; ++l) lane[l] += (double)f[i + l] * (double)f[i + l];
  for (int l = 0; i < n; ++i, ++l) lane[l] += (double)f[i] * (double)f[i];
  return cf_sum_lanes(lane);
}

#define CHUNK 256

/* b = -div u/dt; sums[0] += b^2, sums[1] += (b - div grad p)^2. */
CF_KERNEL void divergence_row(const int dim, const int n, const divergence *d, double *sums) {
  cf_real whole[CHUNK];
  sums[0] = sums[1] = 0;
  for (int from = 0; from < n; from += CHUNK) {
    const int m = n - from < CHUNK ? n - from : CHUNK;
    CF_ROW_LOOP
    for (int i = 0; i < m; ++i) {
      const int x = from + i;
      cf_real out = 0, bend = 0;
      CF_AXIS_LOOP
      for (int a = 0; a < dim; ++a) {
        out += d->u[a][x + d->stride[a]] - d->u[a][x];
        bend += (d->p[x + d->stride[a]] - d->p[x]) - (d->p[x] - d->p[x - d->stride[a]]);
      }
      d->b[x] = -out * d->w;
      whole[i] = d->b[x] - bend * d->p_w;
    }
    for (int i = 0; d->kind != NULL && i < m; ++i)
      if (d->kind[from + i] != CF_CELL_INSIDE) d->b[from + i] = whole[i] = 0;
    sums[0] += sum_of_squares(d->b + from, m);
    sums[1] += sum_of_squares(whole, m);
  }
}
CF_CLONED(divergence_row, const divergence *, double *)

static divergence divergence_at(const cf_project *p, const cf_face u, const cf_cell pressure, const double dt,
                                const ptrdiff_t q) {
  const cf_box *b = &p->grid->box;
  const double h = p->grid->h;
  divergence d = {
      .p = pressure.at + q, .b = p->b.at + q, .w = (cf_real)(1 / (h * dt)), .p_w = (cf_real)(1 / (h * h))};
  for (int a = 0; a < b->dim; ++a) d.u[a] = u.at[a] + q, d.stride[a] = b->stride[a];
  d.kind = p->region != NULL ? p->region->kind + q : NULL;
  return d;
}

/* The right side, and how large it is beside what it would be without the pressure that has acted. */
static double make_right_side(const cf_project *p, const double dt, const cf_cell pressure, const cf_face u) {
  const cf_box *b = &p->grid->box;
  const ptrdiff_t rows = cf_box_rows(b);
  CF_PARALLEL_ROWS (b, p->grid->threads, r) {
    const divergence d = divergence_at(p, u, pressure, dt, cf_box_row(b, r));
    double sums[2];
    divergence_row_by_dim(b->dim, b->n[0], &d, sums);
    p->rows[r] = sums[0];
    p->rows[rows + r] = sums[1];
  }
  const double bb = cf_sum_ordered(p->rows, rows), whole = cf_sum_ordered(p->rows + rows, rows);
  return bb > 0 ? sqrt(whole / bb) : 1;
}

CF_CLONES static void add_row(const int n, const cf_real *from, cf_real *to) {
  CF_ROW_LOOP
  for (int i = 0; i < n; ++i) to[i] += from[i];
}

static void clear(const cf_project *p, const cf_cell f) {
  const cf_box *b = &p->grid->box;
  CF_PARALLEL_ROWS (b, p->grid->threads, r) {
    cf_real *row = f.at + cf_box_row(b, r);
    for (int i = 0; i < b->n[0]; ++i) row[i] = 0;
  }
}

cf_status cf_project_step(cf_project *p, const double dt, const cf_cell pressure, const cf_face u,
                          cf_solve_report *report) {
  const cf_box *b = &p->grid->box;
  cf_solve_options o = p->solver;
  cf_wall_ghosts(&p->outside, pressure);
  const double whole = make_right_side(p, dt, pressure, u);
  o.tolerance = CF_MAX(o.tolerance, CF_MIN(LOOSEST, o.tolerance * whole));
  clear(p, p->change);
  CF_TRY(cf_helmholtz_solve(p->A, p->b, &o, p->change, report));
  report->residual /= CF_MAX(1, whole);
  cf_project_push(p, dt, p->change, u);
  if (p->region == NULL) cf_flow_walls_hold(p->walls, u);
  CF_PARALLEL_ROWS (b, p->grid->threads, r) {
    const ptrdiff_t q = cf_box_row(b, r);
    add_row(b->n[0], p->change.at + q, pressure.at + q);
  }
  return CF_OK;
}

double cf_project_divergence(const cf_project *p, const cf_face u) {
  const cf_box *b = &p->grid->box;
  CF_PARALLEL_ROWS (b, p->grid->threads, r) {
    const ptrdiff_t q = cf_box_row(b, r);
    double most = 0;
    for (int i = 0; i < b->n[0]; ++i) {
      double out = 0;
      if (p->region != NULL && p->region->kind[q + i] != CF_CELL_INSIDE) continue;
      for (int a = 0; a < b->dim; ++a) out += (double)(u.at[a][q + i + b->stride[a]] - u.at[a][q + i]);
      most = CF_MAX(most, fabs(out));
    }
    p->rows[r] = most;
  }
  double most = 0;
  for (ptrdiff_t r = 0; r < cf_box_rows(b); ++r) most = CF_MAX(most, p->rows[r]);
  return most / p->grid->h;
}
