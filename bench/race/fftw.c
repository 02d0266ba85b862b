/* SPDX-License-Identifier: MIT
 *
 * The box solved directly by FFTW's real transforms in double precision: cosines between insulated walls, sines
 * between open ones (half a cell off either end: kinds 10 and 01), and half-complex transforms where the axis is
 * periodic. Either along all axes, or along all but the last, where a tridiagonal system is eliminated for
 * every mode, a block of modes at a time.
 *
 * Planning and the copy of b into place are not timed.
 */
#include <fftw3.h>
#include <math.h>
#include <omp.h>

#include "base/mem.h"
#include "grid/sweep.h"
#include "race.h"

enum { BLOCK = 64 };

typedef struct transforms {
  fftw_plan forward, backward;
  double *u;        /* cells without ghosts */
  double *value[3]; /* eigenvalues of the axes */
  double *pivot;    /* BLOCK modes a plane of the last axis and thread */
  int axes;         /* transformed */
  double scale;
} transforms;

double race_eigenvalue(const char wall, const int n, const int i) {
  const double pi = acos(-1);
  if (wall == 'p') return 2 - 2 * cos(2 * pi * i / n);
  return 2 - 2 * cos(pi * (wall == 'o' ? i + 1 : i) / n);
}

static fftw_r2r_kind kind_of(const char wall, const bool forward) {
  if (wall == 'p') return forward ? FFTW_R2HC : FFTW_HC2R;
  if (wall == 'o') return forward ? FFTW_RODFT10 : FFTW_RODFT01;
  return forward ? FFTW_REDFT10 : FFTW_REDFT01;
}

static ptrdiff_t cells_of(const cf_bench_case *c) { return (ptrdiff_t)c->n[0] * c->n[1] * c->n[2]; }

static void transforms_destroy(void *made) {
  transforms *t = made;
  if (t == NULL) return;
  if (t->forward != NULL) fftw_destroy_plan(t->forward);
  if (t->backward != NULL) fftw_destroy_plan(t->backward);
  fftw_free(t->u);
  for (int a = 0; a < 3; ++a) cf_free(t->value[a]);
  cf_free(t->pivot);
  cf_free(t);
}

/* FFTW counts axes from the slowest. */
static fftw_plan plan_of(const transforms *t, const cf_bench_case *c, const bool forward) {
  int n[3], many = 1;
  fftw_r2r_kind kind[3];
  ptrdiff_t stride = 1;
  for (int a = 0; a < t->axes; ++a) {
    n[t->axes - 1 - a] = c->n[a];
    kind[t->axes - 1 - a] = kind_of(c->walls[a], forward);
    stride *= c->n[a];
  }
  for (int a = t->axes; a < c->dim; ++a) many *= c->n[a];
  return fftw_plan_many_r2r(t->axes, n, many, t->u, NULL, 1, (int)stride, t->u, NULL, 1, (int)stride, kind,
                            FFTW_MEASURE);
}

static cf_status transforms_fill(transforms *t, const cf_bench_case *c) {
  t->u = fftw_malloc((size_t)cells_of(c) * sizeof(double));
  if (t->u == NULL) return cf_fail(CF_NO_MEMORY, "no memory for the transforms");
  t->scale = 1;
  for (int a = 0; a < c->dim; ++a) {
    CF_TRY(CF_NEW(&t->value[a], c->n[a]));
    for (int i = 0; i < c->n[a]; ++i) t->value[a][i] = race_eigenvalue(c->walls[a], c->n[a], i);
    if (a < t->axes) t->scale /= c->walls[a] == 'p' ? c->n[a] : 2 * c->n[a];
  }
  CF_TRY(CF_NEW(&t->pivot, (ptrdiff_t)BLOCK * c->n[c->dim - 1] * c->threads));
  fftw_plan_with_nthreads(c->threads);
  t->forward = plan_of(t, c, true);
  t->backward = plan_of(t, c, false);
  if (t->forward == NULL || t->backward == NULL) return cf_fail(CF_BAD_ARGUMENT, "FFTW has no plan for this");
  return CF_OK;
}

static cf_status transforms_create(void **made, const cf_bench_case *c, const int axes) {
  static bool begun = false;
  if (!begun) fftw_init_threads();
  begun = true;
  *made = NULL;
  transforms *t;
  CF_TRY(CF_NEW(&t, 1));
  t->axes = axes;
  const cf_status status = transforms_fill(t, c);
  if (status != CF_OK) {
    transforms_destroy(t);
    return status;
  }
  *made = t;
  return CF_OK;
}

static void load(const cf_bench_case *c, const cf_bench_system *s, double *u) {
  CF_PARALLEL_ROWS (&s->grid.box, c->threads, r)
    for (int i = 0; i < c->n[0]; ++i) u[r * c->n[0] + i] = (double)s->b.at[cf_box_row(&s->grid.box, r) + i];
}

static void store(const cf_bench_case *c, const cf_bench_system *s, const double *u) {
  CF_PARALLEL_ROWS (&s->grid.box, c->threads, r)
    for (int i = 0; i < c->n[0]; ++i) s->x.at[cf_box_row(&s->grid.box, r) + i] = (cf_real)u[r * c->n[0] + i];
}

/* u /= alpha + beta (sum of the axes' eigenvalues). */
static void divide(const transforms *t, const cf_bench_case *c, const double alpha, const double beta) {
#pragma omp parallel for schedule(static) num_threads(c->threads)
  for (ptrdiff_t r = 0; r < cells_of(c) / c->n[0]; ++r) {
    const double y = t->value[1][r % c->n[1]], z = c->dim == 3 ? t->value[2][r / c->n[1]] : 0;
    const double rest = alpha + beta * (y + z), *x = t->value[0], scale = t->scale;
    double *u = t->u + r * c->n[0];
    for (int i = 0; i < c->n[0]; ++i) u[i] *= scale / (rest + beta * x[i]);
  }
  if (alpha == 0 && t->value[0][0] + t->value[1][0] + (c->dim == 3 ? t->value[2][0] : 0) == 0) t->u[0] = 0;
}

/* Thomas' algorithm along the last axis for `count` modes side by side: shift + beta (0 to 2 neighbours or walls). */
static void eliminate(const int n, const ptrdiff_t step, const int count, const double wall,
                      const double beta, const double *shift, const double scale, double *u, double *pivot) {
  for (int k = 0; k < n; ++k) {
    const double around = (k > 0 ? 1 : wall) + (k < n - 1 ? 1 : wall), below = k > 0 ? beta : 0;
    double *restrict p = pivot + (ptrdiff_t)k * BLOCK, *restrict v = u + k * step;
    const double *p0 = k > 0 ? p - BLOCK : p, *v0 = k > 0 ? v - step : v;
    for (int i = 0; i < count; ++i) {
      const double d = shift[i] + around * beta - (k > 0 ? below * below * p0[i] : 0);
      p[i] = d > 1e-9 * beta ? 1 / d : 0; /* the constant, where it is free */
      v[i] = (scale * v[i] + (k > 0 ? below * v0[i] : 0)) * p[i];
    }
  }
  for (int k = n - 2; k >= 0; --k) {
    const double *restrict p = pivot + (ptrdiff_t)k * BLOCK;
    double *restrict v = u + k * step;
    for (int i = 0; i < count; ++i) v[i] += beta * p[i] * v[i + step];
  }
}

static void eliminate_all(const transforms *t, const cf_bench_case *c, const double alpha,
                          const double beta) {
  const int last = c->dim - 1, n = c->n[last];
  const ptrdiff_t step = cells_of(c) / n;
  const double wall = c->walls[last] == 'o' ? 2 : 0;
#pragma omp parallel for schedule(static) num_threads(c->threads)
  for (ptrdiff_t first = 0; first < step; first += BLOCK) {
    double shift[BLOCK];
    const int count = (int)CF_MIN(BLOCK, step - first);
    for (int i = 0; i < count; ++i) {
      const ptrdiff_t m = first + i;
      const double y = last == 2 ? t->value[1][m / c->n[0]] : 0;
      shift[i] = alpha + beta * (t->value[0][m % c->n[0]] + y);
    }
    double *pivot = t->pivot;
    pivot += (ptrdiff_t)omp_get_thread_num() * BLOCK * n;
    eliminate(n, step, count, wall, beta, shift, t->scale, t->u + first, pivot);
  }
}

static cf_status transforms_solve(void *made, const cf_bench_case *c, const cf_bench_system *s,
                                  double *seconds, int *iterations) {
  const transforms *t = made;
  const double alpha = isinf(c->sigma) ? 0 : 1, beta = isinf(c->sigma) ? 1 : c->sigma;
  *iterations = 0;
  load(c, s, t->u);
  const double begun = cf_bench_clock(c->own_time);
  fftw_execute(t->forward);
  if (t->axes == c->dim)
    divide(t, c, alpha, beta);
  else
    eliminate_all(t, c, alpha, beta);
  fftw_execute(t->backward);
  *seconds = cf_bench_clock(c->own_time) - begun;
  store(c, s, t->u);
  return CF_OK;
}

static cf_status all_create(void **made, const cf_bench_case *c, const cf_bench_system *s) {
  (void)s;
  return transforms_create(made, c, c->dim);
}

static cf_status tridiagonal_create(void **made, const cf_bench_case *c, const cf_bench_system *s) {
  (void)s;
  return transforms_create(made, c, c->dim - 1);
}

const race_solver race_fftw = {"fftw", all_create, transforms_solve, transforms_destroy};
const race_solver race_fftw_tridiagonal = {"fftw+tridiagonal", tridiagonal_create, transforms_solve,
                                           transforms_destroy};
