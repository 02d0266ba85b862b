/* SPDX-License-Identifier: MIT
 *
 * From coefficients to the couplings of the finest level, a face at a time (grid/region.h says what a face is).
 */
#include <math.h>

#include "solve/varied_part.h"

/* What a level is filled from. */
typedef struct filling {
  cf_varied *v;
  const cf_coefficients *c;
  double scale, h2; /* of the level; 1/h^2 */
} filling;

static double beta_of(const cf_coefficients *c, const int a, const ptrdiff_t p) {
  return c->beta_at != NULL ? (double)c->beta_at->at[a][p] : c->beta;
}

static int kind_of(const cf_varied *v, const ptrdiff_t p) {
  return v->region != NULL ? v->region->kind[p] : CF_CELL_INSIDE;
}

/* One face of a cell inside: `next` is the kind beyond it, -1 for a wall of the box. Returns the coupling (0: closed or
 * known); what a known value adds to the diagonal goes to `held`, and to `surplus` what the tables of walls do not know. */
static double face_of(const filling *f, const int next, const double beta, const double table, double *held,
                      double *surplus) {
  if (next == CF_CELL_INSIDE) return beta * f->h2;
  if (next < 0) *held += beta * table;
  if (next > CF_CELL_INSIDE) {
    *held += 2 * beta * f->h2;
    *surplus += 2 * beta * f->h2;
  }
  return 0;
}

static void fill_cell(const filling *f, const int at[3], const ptrdiff_t p) {
  cf_varied *v = f->v;
  cf_coupled *l = &v->level[0];
  const bool inside = kind_of(v, p) == CF_CELL_INSIDE;
  const double alpha = !inside ? 0 : f->c->alpha_at != NULL ? (double)f->c->alpha_at->at[p] : f->c->alpha;
  double held = 0, surplus = 0;
  for (int a = 0; a < l->dim; ++a) {
    const int n = l->box.n[a];
    const ptrdiff_t s = l->box.stride[a];
    for (int side = 0; side < 2; ++side) {
      const bool end = at[a] == (side ? n - 1 : 0), wall = end && !(v->A->level[0].axis[a].periodic && n > 1);
      const ptrdiff_t face = side ? p + s : p;
      const ptrdiff_t other = !end ? (side ? p + s : p - s) : side ? p - (n - 1) * s : p + (n - 1) * s;
      const int next = wall ? -1 : kind_of(v, other);
      const double beta = inside ? beta_of(f->c, a, face) : 0;
      const double table = v->A->level[0].axis[a].periodic ? 0
                           : side                          ? (double)v->hi[a][n - 1]
                                                           : (double)v->lo[a][0];
      const double c = inside ? face_of(f, next, beta, table, &held, &surplus) : 0;
      if (side == 0) l->c[a][p] = (float)(f->scale * c);
      if (v->own_beta.at[0] != NULL && (side == 0 || end))
        v->own_beta.at[a][face] = (cf_real)(wall || c > 0 ? beta : 0);
    }
  }
  l->free[p] = (float)(f->scale * alpha);
  l->held[p] = (float)(f->scale * held);
  if (v->alpha.at != NULL && v->alpha.at == v->own_alpha.at) v->own_alpha.at[p] = (cf_real)(alpha + surplus);
}

/* Least and largest of what is met. */
typedef struct range {
  double least, most;
} range;

static range wider(const range a, const range b) {
  return (range){b.least < a.least ? b.least : a.least, b.most > a.most ? b.most : a.most};
}

/* Of a run of f, where the cells are inside; kind NULL: all are. */
CF_CLONES static range range_of_run(const int n, const cf_real *f, const unsigned char *kind) {
  cf_real least = (cf_real)INFINITY, most = -(cf_real)INFINITY;
  if (kind == NULL) {
#pragma omp simd reduction(min : least) reduction(max : most)
    for (int i = 0; i < n; ++i) {
      least = f[i] < least ? f[i] : least;
      most = f[i] > most ? f[i] : most;
    }
    return (range){(double)least, (double)most};
  }
#pragma omp simd reduction(min : least) reduction(max : most)
  for (int i = 0; i < n; ++i) {
    const bool inside = kind[i] == CF_CELL_INSIDE;
    least = inside && f[i] < least ? f[i] : least;
    most = inside && f[i] > most ? f[i] : most;
  }
  return (range){(double)least, (double)most};
}

/* Of a field that has the cells' indices. */
static range range_of(const cf_varied *v, const cf_real *f) {
  const cf_coupled *l = &v->level[0];
  double least = INFINITY, most = -INFINITY;
#pragma omp parallel for schedule(static) num_threads(cf_coupled_threads(l)) reduction(min      \
                                                                                       : least) \
    reduction(max                                                                               \
              : most)
  for (ptrdiff_t r = 0; r < l->rows; ++r)
    CF_TILE_ROWS (l, r, j, k)
      CF_TILE_RUNS (l, r, run) {
        const ptrdiff_t p = cf_box_at(&l->box, run->low, j, k);
        const range all =
            wider((range){least, most},
                  range_of_run(run->high - run->low, f + p, v->region != NULL ? v->region->kind + p : NULL));
        least = all.least, most = all.most;
      }
  return (range){least, most};
}

/* The largest alpha and beta that the equation meets, and the least alpha. */
void cf_varied_find_range(const cf_varied *v, const cf_coefficients *c, double *alpha, double *least,
                          double *beta) {
  range of_alpha = {c->alpha, c->alpha}, of_beta = {0, c->beta};
  if (c->alpha_at != NULL) of_alpha = wider((range){INFINITY, 0}, range_of(v, c->alpha_at->at));
  if (c->beta_at != NULL) of_beta.most = 0;
  for (int a = 0; a < v->A->grid.box.dim && c->beta_at != NULL; ++a)
    of_beta = wider(of_beta, range_of(v, c->beta_at->at[a]));
  *alpha = of_alpha.most;
  *least = of_alpha.least;
  *beta = of_beta.most;
}

cf_status cf_varied_fill(cf_varied *v, const cf_coefficients *c, const cf_part *w) {
  const filling f = {v, c, v->scale, 1 / (v->A->grid.h * v->A->grid.h)};
  cf_coupled *l = &v->level[0];
  CF_PARALLEL_PART (l, w, r)
    CF_TILE_ROWS (w, r, j, k)
      CF_TILE_RUNS (w, r, run)
        for (int i = run->low; i < run->high; ++i)
          fill_cell(&f, (int[]){i, j, k}, cf_box_at(&l->box, i, j, k));
  return cf_coupled_finish(l, w);
}
