/* SPDX-License-Identifier: MIT
 *
 * From coefficients to the couplings of the finest level, a face at a time (grid/region.h says what a face is).
 */
#include <math.h>
#include <string.h>

#include "solve/open.h"

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
      const bool end = at[a] == (side ? n - 1 : 0), wall = end && !v->A->level[0].axis[a].periodic;
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

/* --- many at once ------------------------------------------------------------------------------------- */

/* Cells of a row that are filled together where they and their neighbours are inside. */
enum { TOGETHER = 32 };

/* to = scale (beta h2), or of the number where there is no field; and what faces keep of it (NULL: nothing). */
CF_CLONES static void fill_couplings(const int n, const cf_real *beta, const double number,
                                     const double scale, const double h2, float *to, cf_real *kept) {
  CF_ROW_LOOP
  for (int i = 0; i < n; ++i) to[i] = (float)(scale * ((beta != NULL ? (double)beta[i] : number) * h2));
  if (kept == NULL) return;
  CF_ROW_LOOP
  for (int i = 0; i < n; ++i) kept[i] = beta != NULL ? beta[i] : (cf_real)number;
}

CF_CLONES static void fill_free(const int n, const cf_real *alpha, const double number, const double scale,
                                float *to, cf_real *kept) {
  CF_ROW_LOOP
  for (int i = 0; i < n; ++i) to[i] = (float)(scale * (alpha != NULL ? (double)alpha[i] : number));
  if (kept == NULL) return;
  CF_ROW_LOOP
  for (int i = 0; i < n; ++i) kept[i] = alpha != NULL ? alpha[i] : (cf_real)number;
}

static bool are_inside(const unsigned char *kind, const int n) {
  int others = 0;
  for (int i = 0; i < n; ++i) others |= kind[i] ^ CF_CELL_INSIDE;
  return others == 0;
}

/* Whether n cells from `at` on have neighbours in the box on all sides, all of them inside. */
static bool is_inner(const cf_varied *v, const int at[3], const int n, const ptrdiff_t p) {
  const cf_box *b = &v->level[0].box;
  for (int a = 0; a < b->dim; ++a)
    if (at[a] == 0 || at[a] + (a == 0 ? n : 1) >= b->n[a]) return false;
  if (v->region == NULL) return true;
  const unsigned char *kind = v->region->kind + p;
  bool inside = are_inside(kind - 1, n + 2);
  for (int a = 1; a < b->dim && inside; ++a)
    inside = are_inside(kind - b->stride[a], n) && are_inside(kind + b->stride[a], n);
  return inside;
}

/* As fill_cell does it, for cells without a wall near them. */
static void fill_inner(const filling *f, const int n, const ptrdiff_t p) {
  const cf_varied *v = f->v;
  const cf_coupled *l = &v->level[0];
  const bool keeps_beta = v->own_beta.at[0] != NULL,
             keeps_alpha = v->alpha.at != NULL && v->alpha.at == v->own_alpha.at;
  for (int a = 0; a < l->dim; ++a)
    fill_couplings(n, f->c->beta_at != NULL ? f->c->beta_at->at[a] + p : NULL, f->c->beta, f->scale, f->h2,
                   l->c[a] + p, keeps_beta ? v->own_beta.at[a] + p : NULL);
  fill_free(n, f->c->alpha_at != NULL ? f->c->alpha_at->at + p : NULL, f->c->alpha, f->scale, l->free + p,
            keeps_alpha ? v->own_alpha.at + p : NULL);
  memset(l->held + p, 0, (size_t)n * sizeof *l->held);
}

/* Whether none of n cells from `at` on is inside, nor at a high end of the box, where a row has one more face. */
static bool is_void(const cf_varied *v, const int at[3], const int n, const ptrdiff_t p) {
  const cf_box *b = &v->level[0].box;
  for (int a = 0; a < b->dim; ++a)
    if (at[a] + (a == 0 ? n : 1) >= b->n[a]) return false;
  return v->region != NULL && memchr(v->region->kind + p, CF_CELL_INSIDE, (size_t)n) == NULL;
}

static void fill_void(const filling *f, const int n, const ptrdiff_t p) {
  const cf_varied *v = f->v;
  const cf_coupled *l = &v->level[0];
  const size_t floats = (size_t)n * sizeof(float), reals = (size_t)n * sizeof(cf_real);
  for (int a = 0; a < l->dim; ++a) {
    memset(l->c[a] + p, 0, floats);
    if (v->own_beta.at[0] != NULL) memset(v->own_beta.at[a] + p, 0, reals);
  }
  memset(l->free + p, 0, floats);
  memset(l->held + p, 0, floats);
  if (v->alpha.at != NULL && v->alpha.at == v->own_alpha.at) memset(v->own_alpha.at + p, 0, reals);
}

static void fill_run(const filling *f, const cf_run *run, const int j, const int k) {
  const int last = f->v->level[0].box.n[0] - 2;
  for (int from = run->low, end; from < run->high; from = end) {
    const int at[3] = {from, j, k}, most = from < 1 || from > last ? 1 : CF_MIN(TOGETHER, last + 1 - from);
    const ptrdiff_t p = cf_box_at(&f->v->level[0].box, from, j, k);
    end = CF_MIN(from + most, run->high);
    if (is_inner(f->v, at, end - from, p))
      fill_inner(f, end - from, p);
    else if (is_void(f->v, at, end - from, p))
      fill_void(f, end - from, p);
    else
      for (int i = from; i < end; ++i) fill_cell(f, (int[]){i, j, k}, p + i - from);
  }
}

/* --- the range of coefficients -------------------------------------------------------------------------- */

/* Rows of a sample, about. */
#define SAMPLE 500

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

/* Of some rows of all of a box. */
static range range_of_sample(const cf_box *b, const cf_real *f) {
  const ptrdiff_t rows = cf_box_rows(b), step = (rows / SAMPLE) | 1;
  range all = {INFINITY, -INFINITY};
  for (ptrdiff_t r = 0; r < rows; r += step)
    all = wider(all, range_of_run(b->n[0], f + cf_box_row(b, r), NULL));
  return all;
}

/* Of a field that has the cells' indices. */
static range range_of(const cf_varied *v, const bool sample, const cf_real *f) {
  const cf_coupled *l = &v->level[0];
  if (sample) return range_of_sample(&l->box, f);
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
void cf_varied_find_range(const cf_varied *v, const cf_coefficients *c, const bool sample, double *alpha,
                          double *least, double *beta) {
  range of_alpha = {c->alpha, c->alpha}, of_beta = {0, c->beta};
  if (c->alpha_at != NULL) of_alpha = wider((range){INFINITY, 0}, range_of(v, sample, c->alpha_at->at));
  if (c->beta_at != NULL) of_beta.most = 0;
  for (int a = 0; a < v->A->grid.box.dim && c->beta_at != NULL; ++a)
    of_beta = wider(of_beta, range_of(v, sample, c->beta_at->at[a]));
  *alpha = of_alpha.most;
  *least = of_alpha.least;
  *beta = of_beta.most;
}

cf_status cf_varied_fill(cf_varied *v, const cf_coefficients *c, const cf_part *w) {
  const filling f = {v, c, v->scale, 1 / (v->A->grid.h * v->A->grid.h)};
  cf_coupled *l = &v->level[0];
  if (cf_open_fill(v, c)) return CF_OK;
  CF_PARALLEL_PART (l, w, r)
    CF_TILE_ROWS (w, r, j, k)
      CF_TILE_RUNS (w, r, run) fill_run(&f, run, j, k);
  return cf_coupled_finish(l, w);
}
