/* SPDX-License-Identifier: MIT */
#define _GNU_SOURCE
#include "app/bench_case.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#include "app/bench_region.h"
#include "base/mem.h"
#include "base/rng.h"
#include "grid/sweep.h"

enum { TIMES_MAX = 25, BLOBS = 5 };

const char *const cf_bench_side_name[CF_BENCH_SIDES] = {"mixed", "smooth", "noisy"};

double cf_bench_clock(const bool own_time) {
  struct timespec t;
  clock_gettime(own_time ? CLOCK_THREAD_CPUTIME_ID : CLOCK_MONOTONIC, &t);
  return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static int by_value(const void *a, const void *b) {
  const double x = *(const double *)a, y = *(const double *)b;
  return (x > y) - (x < y);
}

double cf_bench_median(double *v, const int count) {
  qsort(v, (size_t)count, sizeof *v, by_value);
  return count % 2 == 1 ? v[count / 2] : (v[count / 2 - 1] + v[count / 2]) / 2;
}

/* --- the system ------------------------------------------------------------------------------------------- */

static cf_walls walls_of(const cf_bench_case *c) {
  cf_walls w = {0};
  for (int a = 0; a < c->dim && c->walls != NULL; ++a)
    for (int side = 0; side < 2; ++side)
      w.kind[a][side] = c->walls[a] == 'p'   ? CF_WALL_PERIODIC
                        : c->walls[a] == 'o' ? CF_WALL_OPEN
                                             : CF_WALL_INSULATED;
  return w;
}

/* Blobs are products of their shapes along the axes: shape[(a * BLOBS + blob) * n_max + i]. */
static void fill_shapes(const cf_bench_case *c, const int n_max, double *shape) {
  static const double centre[BLOBS][3] = {
      {0.3, 0.35, 0.6}, {0.75, 0.2, 0.4}, {0.55, 0.7, 0.3}, {0.2, 0.8, 0.7}, {0.8, 0.6, 0.8}};
  static const double width[BLOBS] = {0.08, 0.05, 0.06, 0.04, 0.07};
  for (int a = 0; a < c->dim; ++a)
    for (int blob = 0; blob < BLOBS; ++blob)
      for (int i = 0; i < c->n[a]; ++i) {
        const double d = ((i + 0.5) / c->n[a] - centre[blob][a]) / width[blob];
        shape[(ptrdiff_t)(a * BLOBS + blob) * n_max + i] = exp(-d * d / 2);
      }
}

static void fill_row(const cf_bench_case *c, const double *shape, const int n_max, const int j, const int k,
                     cf_real *row) {
  static const double height[BLOBS] = {1, -1.2, 0.9, -0.7, 0.8};
  const uint64_t first = ((uint64_t)k * (uint64_t)c->n[1] + (uint64_t)j) * (uint64_t)c->n[0];
  const double noise = c->side == CF_BENCH_NOISY ? 1 : c->side == CF_BENCH_MIXED ? 0.1 : 0;
  for (int i = 0; i < c->n[0]; ++i) {
    double v = noise * (2 * cf_random(1, 0, 0, first + (uint64_t)i) - 1);
    for (int blob = 0; blob < BLOBS && c->side != CF_BENCH_NOISY; ++blob)
      v += height[blob] * shape[(ptrdiff_t)blob * n_max + i] * shape[(ptrdiff_t)(BLOBS + blob) * n_max + j] *
           (c->dim == 3 ? shape[(ptrdiff_t)(2 * BLOBS + blob) * n_max + k] : 1);
    row[i] = (cf_real)v;
  }
}

cf_status cf_bench_fill_side(const cf_bench_case *c, const cf_grid *g, const cf_cell b) {
  const int n_max = CF_MAX(c->n[0], CF_MAX(c->n[1], c->n[2]));
  double *shape;
  CF_TRY(CF_NEW(&shape, (ptrdiff_t)3 * BLOBS * n_max));
  fill_shapes(c, n_max, shape);
  CF_PARALLEL_ROWS (&g->box, g->threads, r)
    fill_row(c, shape, n_max, (int)(r % g->box.n[1]), (int)(r / g->box.n[1]), b.at + cf_box_row(&g->box, r));
  cf_free(shape);
  return CF_OK;
}

/* Poisson's equation between walls that hold nothing has a solution only where b has no mean. */
static bool wants_no_mean(const cf_bench_case *c) {
  return isinf(c->sigma) && (c->walls == NULL || strchr(c->walls, 'o') == NULL);
}

static cf_status remove_mean(const cf_grid *g, const cf_cell b) {
  double *rows;
  CF_TRY(CF_NEW(&rows, 3 * cf_box_rows(&g->box)));
  const double mean = cf_sweep_sum(&g->box, g->threads, b.at, rows) / (double)cf_box_cells(&g->box);
  cf_free(rows);
  CF_PARALLEL_ROWS (&g->box, g->threads, r)
    for (int i = 0; i < g->box.n[0]; ++i) b.at[cf_box_row(&g->box, r) + i] -= (cf_real)mean;
  return CF_OK;
}

double cf_bench_resident(void) {
  FILE *f = fopen("/proc/self/statm", "re");
  long whole = 0, resident = 0;
  if (f == NULL) return 0;
  if (fscanf(f, "%ld %ld", &whole, &resident) != 2) resident = 0;
  fclose(f);
  return (double)resident * (double)sysconf(_SC_PAGESIZE);
}

/* `other`: some that have nothing in common with them. */
static cf_status set_coefficients(const cf_bench_system *s, const cf_bench_case *c, const bool other) {
  const bool poisson = isinf(c->sigma);
  return cf_helmholtz_set(s->A, &(cf_coefficients){.alpha = (poisson ? 0 : 1) + (other ? 0.5 : 0),
                                                   .beta = poisson ? 1 : c->sigma,
                                                   .beta_at = c->varied ? &s->beta : NULL,
                                                   .region = s->region});
}

/* Faces of axis a, those of the last wall as well. */
static void fill_beta(const cf_bench_case *c, const cf_grid *g, const int a, cf_real *beta) {
  const cf_box *box = &g->box;
  const double pi = 3.14159265358979, base = isinf(c->sigma) ? 1 : c->sigma;
  for (int k = 0; k < box->n[2] + (a == 2); ++k)
    for (int j = 0; j < box->n[1] + (a == 1); ++j)
      for (int i = 0; i < box->n[0] + (a == 0); ++i) {
        const double wave =
            sin(2 * pi * i / box->n[0]) * sin(4 * pi * j / box->n[1]) * cos(2 * pi * k / box->n[2]);
        const uint64_t place = ((uint64_t)k * 4096 + (uint64_t)j) * 4096 + (uint64_t)i;
        beta[cf_box_at(box, i, j, k)] =
            (cf_real)(base * exp(wave) * (0.5 + cf_random(2, (uint64_t)a, 0, place)));
      }
}

static cf_status system_make(cf_bench_system *s, const cf_bench_case *c) {
  CF_TRY(cf_grid_init(&s->grid, c->dim, c->n, 1, NULL));
  s->grid.threads = c->threads;
  CF_TRY(cf_cell_create(&s->b, &s->grid.box));
  CF_TRY(cf_bench_fill_side(c, &s->grid, s->b));
  if (wants_no_mean(c)) CF_TRY(remove_mean(&s->grid, s->b));
  s->resident = cf_bench_resident();
  const cf_walls walls = walls_of(c);
  CF_TRY(cf_helmholtz_create(&s->A, &s->grid, &walls, 0));
  s->cells = cf_box_cells(&s->grid.box);
  if (c->region != NULL) {
    CF_TRY(cf_bench_region_create(c->region, &s->grid, &s->region, &s->tiles));
    s->cells = cf_region_inside(s->region);
  }
  CF_TRY(s->tiles != NULL ? cf_tiles_cell_create(s->tiles, &s->x) : cf_cell_create(&s->x, &s->grid.box));
  if (c->varied) CF_TRY(cf_face_create(&s->beta, &s->grid.box));
  for (int a = 0; a < c->dim && c->varied; ++a) fill_beta(c, &s->grid, a, s->beta.at[a]);
  return set_coefficients(s, c, false);
}

cf_status cf_bench_system_create(cf_bench_system *s, const cf_bench_case *c) {
  *s = (cf_bench_system){0};
  const cf_status status = system_make(s, c);
  if (status != CF_OK) cf_bench_system_destroy(s);
  return status;
}

void cf_bench_system_destroy(cf_bench_system *s) {
  cf_helmholtz_destroy(s->A);
  cf_region_destroy(s->region);
  cf_tiles_destroy(s->tiles);
  cf_cell_destroy(&s->x, &s->grid.box);
  cf_cell_destroy(&s->b, &s->grid.box);
  cf_face_destroy(&s->beta, &s->grid.box);
  *s = (cf_bench_system){0};
}

/* --- timing ----------------------------------------------------------------------------------------------- */

static void clear_tiles(const cf_bench_system *s) {
  const cf_tiles *t = s->tiles;
  for (ptrdiff_t v = 0; v < t->rows; ++v)
    CF_TILE_ROWS (t, v, j, k)
      CF_TILE_RUNS (t, v, run)
        memset(s->x.at + cf_box_at(&t->box, run->low, j, k), 0,
               (size_t)(run->high - run->low) * sizeof(cf_real));
}

cf_status cf_bench_system_solve(const cf_bench_system *s, const cf_bench_case *c, cf_solve_report *report,
                                double *seconds) {
  const cf_box *box = &s->grid.box;
  if (s->tiles != NULL)
    clear_tiles(s);
  else
    CF_PARALLEL_ROWS (box, s->grid.threads, r)
      memset(s->x.at + cf_box_row(box, r), 0, (size_t)box->n[0] * sizeof(cf_real));
  if (c->set_up) CF_TRY(set_coefficients(s, c, true));
  const double begun = cf_bench_clock(c->own_time);
  if (c->set_up) CF_TRY(set_coefficients(s, c, false));
  CF_TRY(cf_helmholtz_solve(s->A, s->b, &(cf_solve_options){c->tolerance, 200}, s->x, report));
  *seconds = cf_bench_clock(c->own_time) - begun;
  return CF_OK;
}

/* The first solve, which touches the memory, is not among those timed. */
static cf_status time_solves(const cf_bench_system *s, const cf_bench_case *c, const int least,
                             const double enough, cf_bench_result *result) {
  double seconds[TIMES_MAX], sum = 0, first;
  CF_TRY(cf_bench_system_solve(s, c, &result->report, &first));
  result->bytes_per_cell = (cf_bench_resident() - s->resident) / (double)s->cells;
  while (result->times < TIMES_MAX && (result->times < least || sum < enough)) {
    CF_TRY(cf_bench_system_solve(s, c, &result->report, &seconds[result->times]));
    sum += seconds[result->times++];
  }
  result->seconds = cf_bench_median(seconds, result->times);
  result->cells = s->cells;
  result->residual = cf_helmholtz_residual(s->A, s->x, s->b);
  return CF_OK;
}

cf_status cf_bench_case_run(const cf_bench_case *c, const int least, const double seconds,
                            cf_bench_result *result) {
  cf_bench_system s;
  *result = (cf_bench_result){0};
  CF_TRY(cf_bench_system_create(&s, c));
  const cf_status status = time_solves(&s, c, least, seconds, result);
  cf_bench_system_destroy(&s);
  return status;
}

double cf_bench_least_bytes(const cf_bench_result *result) {
  const double x = sizeof(cf_real), r = sizeof(float);
  return (double)result->cells * (2 * x + r + result->report.iterations * 2 * (x + r));
}

/* --- the memory ------------------------------------------------------------------------------------------- */

static void triad(const ptrdiff_t n, const int threads, const double s, const double *b, const double *c,
                  double *a) {
#pragma omp parallel for simd schedule(static) num_threads(threads)
  for (ptrdiff_t i = 0; i < n; ++i) a[i] = b[i] + s * c[i];
}

cf_status cf_bench_stream(const int threads, double *bytes_per_second) {
  const ptrdiff_t n = (ptrdiff_t)1 << 24;
  void *pages;
  CF_TRY(cf_pages_reserve(&pages, (size_t)n * 3 * sizeof(double), true));
  double *a = pages, best = INFINITY;
#pragma omp parallel for schedule(static) num_threads(threads)
  for (ptrdiff_t i = 0; i < n; ++i)
    a[i] = a[n + i] = a[2 * n + i] = 1; /* untouched pages cost nothing to read */
  for (int t = 0; t < 8; ++t) {
    const double begun = cf_bench_clock(false);
    triad(n, threads, 0.5, a + n, a + 2 * n, a);
    if (t > 0) best = CF_MIN(best, cf_bench_clock(false) - begun);
  }
  cf_pages_release(pages, (size_t)n * 3 * sizeof(double));
  *bytes_per_second = 3 * sizeof(double) * (double)n / best;
  return CF_OK;
}
