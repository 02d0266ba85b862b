/* SPDX-License-Identifier: MIT
 *
 * cattaneo bench solver: a row a linear system.
 *
 * The default set goes through extents and sigma with the settings of the solver as they are, and then varies one
 * thing at a time: tolerance, right side, walls, extents that are no powers of two, two dimensions, threads, obstacles
 * (bench_region.h), coefficients that are fields. A cell is one that has an equation.
 */
#include <math.h>
#include <stdio.h>

#include "app/bench.h"
#include "app/bench_case.h"

#define POISSON INFINITY

enum { TIMES_LEAST = 5, LIST = 7 };

/* Rows for every extent with every sigma; a 0 ends either list. */
typedef struct group {
  const char *name;
  int n[4][3];
  double sigma[LIST + 1], tolerance;
  const char *walls;
  cf_bench_side side;
  bool one_thread, varied;
  const char *region; /* NULL: the whole box */
} group;

static const group default_set[] = {
    {.name = "box",
     .n = {{64, 64, 64}, {128, 128, 128}, {256, 256, 256}},
     .sigma = {0.25, 1, 4, 16, 100, 1e4, POISSON}},
    {.name = "box", .n = {{256, 256, 256}}, .sigma = {16, POISSON}, .tolerance = 1e-10},
    {.name = "box", .n = {{256, 256, 256}}, .sigma = {16, POISSON}, .side = CF_BENCH_SMOOTH},
    {.name = "box", .n = {{256, 256, 256}}, .sigma = {16, POISSON}, .side = CF_BENCH_NOISY},
    {.name = "box", .n = {{256, 256, 256}}, .sigma = {0.25, 16, POISSON}, .one_thread = true},
    {.name = "uneven", .n = {{243, 250, 270}}, .sigma = {0.25, 16, POISSON}},
    {.name = "walls", .n = {{256, 256, 256}}, .sigma = {0.25, 16, POISSON}, .walls = "ooo"},
    {.name = "walls", .n = {{256, 256, 256}}, .sigma = {0.25, 16, POISSON}, .walls = "ppp"},
    {.name = "walls", .n = {{256, 256, 256}}, .sigma = {0.25, 16, POISSON}, .walls = "pio"},
    {.name = "square", .n = {{256, 256, 1}, {1024, 1024, 1}, {4096, 4096, 1}}, .sigma = {0.25, 16, POISSON}},
    {.name = "ball", .n = {{128, 128, 128}}, .sigma = {16, POISSON}, .region = "ball"},
    {.name = "slalom", .n = {{128, 128, 128}}, .sigma = {16, POISSON}, .region = "slalom"},
    {.name = "porous", .n = {{128, 128, 128}}, .sigma = {16, POISSON}, .region = "porous"},
    {.name = "drop", .n = {{256, 256, 256}}, .sigma = {16, POISSON}, .region = "drop"},
    {.name = "fields", .n = {{128, 128, 128}}, .sigma = {1, 16, POISSON}, .varied = true},
};
enum { GROUPS = sizeof default_set / sizeof *default_set };

/* --- a row ------------------------------------------------------------------------------------------------ */

typedef struct page {
  bool json;
  int threads[2];
  double stream[2]; /* bytes a second with so many threads */
} page;

static double stream_of(const page *p, const int threads) {
  return p->stream[threads == p->threads[0] ? 0 : 1];
}

static void print_json(const cf_bench_case *c, const cf_bench_result *r, const double share) {
  printf("{\"bench\": \"solver\", \"case\": \"%s\", \"n\": [%d, %d", c->name, c->n[0], c->n[1]);
  if (c->dim == 3) printf(", %d", c->n[2]);
  printf("], \"cells\": %td", r->cells);
  cf_bench_json_number("sigma", c->sigma);
  cf_bench_json_number("tolerance", c->tolerance);
  printf(", \"threads\": %d, \"walls\": \"%s\", \"side\": \"%s\", \"method\": \"%s\"", c->threads, c->walls,
         cf_bench_side_name[c->side], r->report.method);
  cf_bench_json_number("seconds", r->seconds);
  printf(", \"times\": %d, \"iterations\": %d, \"converged\": %s", r->times, r->report.iterations,
         r->report.converged ? "true" : "false");
  cf_bench_json_number("relres", r->residual);
  cf_bench_json_number("bytes_per_cell", r->bytes_per_cell);
  cf_bench_json_number("stream_fraction", share);
  printf("}\n");
}

static void print_head(const page *p) {
  for (int v = 0; v < 2 && p->threads[v] > 0; ++v)
    printf("memory: %.1f GB/s (triad, %d thread%s)\n", p->stream[v] * 1e-9, p->threads[v],
           p->threads[v] > 1 ? "s" : "");
  printf("%-7s%-15s%-5s%-8s%8s%7s%4s%10s%9s%8s%10s%7s%8s  %s\n", "case", "cells", "wall", "side", "sigma",
         "tol", "thr", "ms", "ns/cell", "cycles", "residual", "B/cell", "stream", "method");
}

static void print_row(const cf_bench_case *c, const cf_bench_result *r, const double share) {
  char extents[48], sigma[24] = "Poisson";
  snprintf(extents, sizeof extents, c->dim == 3 ? "%dx%dx%d" : "%dx%d", c->n[0], c->n[1], c->n[2]);
  if (isfinite(c->sigma)) snprintf(sigma, sizeof sigma, "%g", c->sigma);
  printf("%-7s%-15s%-5s%-8s%8s%7.0e%4d%10.3f%9.3f%8d%10.2e%7.1f%7.1f%%  %s\n", c->name, extents, c->walls,
         cf_bench_side_name[c->side], sigma, c->tolerance, c->threads, 1e3 * r->seconds,
         1e9 * r->seconds / (double)r->cells, r->report.iterations, r->residual, r->bytes_per_cell,
         100 * share, r->report.method);
}

static cf_status bench_row(const page *p, const cf_bench_case *c) {
  cf_bench_result r;
  CF_TRY(cf_bench_case_run(c, TIMES_LEAST, 0.5, &r));
  const double share = cf_bench_least_bytes(&r) / r.seconds / stream_of(p, c->threads);
  (p->json ? print_json : print_row)(c, &r, share);
  fflush(stdout);
  return CF_OK;
}

/* --- the set ---------------------------------------------------------------------------------------------- */

static cf_status bench_extents(const page *p, const group *g, const int n[3], const int dim,
                               const cf_bench_filter *f) {
  cf_bench_case c = {.name = g->name,
                     .dim = dim,
                     .n = {n[0], n[1], n[2]},
                     .tolerance = g->tolerance > 0 ? g->tolerance : 1e-6,
                     .threads = g->one_thread ? 1 : p->threads[0],
                     .walls = g->walls != NULL ? g->walls
                              : dim == 3       ? "iii"
                                               : "ii",
                     .side = g->side,
                     .region = g->region,
                     .varied = g->varied};
  const double *sigma = f->sigmas > 0 ? f->sigma : g->sigma;
  for (int s = 0; f->sigmas > 0 ? s < f->sigmas : s < LIST && sigma[s] > 0; ++s) {
    c.sigma = sigma[s];
    CF_TRY(bench_row(p, &c));
  }
  return CF_OK;
}

static cf_status bench_default_set(const page *p, const cf_bench_filter *f) {
  for (int g = 0; g < GROUPS; ++g) {
    if (default_set[g].one_thread && p->threads[0] == 1) continue;
    for (int v = 0; v < 4 && default_set[g].n[v][0] > 0; ++v) {
      const int *n = default_set[g].n[v];
      CF_TRY(bench_extents(p, &default_set[g], n, n[2] > 1 ? 3 : 2, f));
    }
  }
  return CF_OK;
}

cf_status cf_bench_solver(const cf_bench_filter *f) {
  page p = {.json = f->json, .threads = {f->threads, f->threads > 1 && f->boxes == 0 ? 1 : 0}};
  for (int v = 0; v < 2 && p.threads[v] > 0; ++v) CF_TRY(cf_bench_stream(p.threads[v], &p.stream[v]));
  if (!p.json) print_head(&p);
  if (f->boxes == 0) return bench_default_set(&p, f);
  for (int v = 0; v < f->boxes; ++v) {
    group g = default_set[0];
    if (f->dim[v] == 2) g.name = "square";
    CF_TRY(bench_extents(&p, &g, f->n[v], f->dim[v], f));
  }
  return CF_OK;
}
