/* SPDX-License-Identifier: MIT
 *
 * race [NAME] [--own] [--n N] [--sigma S,...] [--threads N] [--rounds N]
 *
 * --own: one thread, and its own time, for machines that others use as well.
 *
 * Every race is a set of heats; a heat is a set of entries, each a solver with a system. Rounds go through the
 * entries in turn. Printed are an entry's median, what it takes a cell, and the median of (first entry's time a cell /
 * this entry's time a cell) over the rounds, with the range of that ratio; the first entry is the one that goals speak
 * of. See docs/solver.md.
 */
#include "race.h"

#include <math.h>
#include <omp.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/real.h"

enum { ENTRIES_MAX = 8, ROUNDS_MAX = 101, SIGMAS_MAX = 16 };

/* --- our own ---------------------------------------------------------------------------------------------- */

static cf_status ours_create(void **made, const cf_bench_case *c, const cf_bench_system *s) {
  (void)c, (void)s;
  *made = NULL;
  return CF_OK;
}

static cf_status ours_solve(void *made, const cf_bench_case *c, const cf_bench_system *s, double *seconds,
                            int *iterations) {
  (void)made;
  cf_solve_report report;
  CF_TRY(cf_bench_system_solve(s, c, &report, seconds));
  *iterations = report.iterations;
  return CF_OK;
}

static void ours_destroy(void *made) { (void)made; }

const race_solver race_ours = {"cattaneo", ours_create, ours_solve, ours_destroy};

/* --- a heat ----------------------------------------------------------------------------------------------- */

typedef struct entry {
  const race_solver *solver;
  cf_bench_case c;
  cf_bench_system system;
  void *made;
  double seconds[ROUNDS_MAX], residual;
  int iterations;
} entry;

typedef struct heat {
  int entries;
  entry entry[ENTRIES_MAX];
} heat;

static void enter(heat *h, const race_solver *solver, const cf_bench_case *c) {
  if (h->entries == ENTRIES_MAX) return;
  h->entry[h->entries++] = (entry){.solver = solver, .c = *c};
}

static double cells_of(const entry *e) { return (double)e->system.cells; }

static void print_entry(const heat *h, const int rounds, const int v) {
  const entry *e = &h->entry[v];
  double seconds[ROUNDS_MAX], ratio[ROUNDS_MAX];
  for (int r = 0; r < rounds; ++r) {
    seconds[r] = e->seconds[r];
    ratio[r] = (h->entry[0].seconds[r] / cells_of(&h->entry[0])) / (e->seconds[r] / cells_of(e));
  }
  char sigma[24] = "Poisson", box[48];
  if (isfinite(e->c.sigma)) snprintf(sigma, sizeof sigma, "%g", e->c.sigma);
  snprintf(box, sizeof box, e->c.dim == 3 ? "%dx%dx%d" : "%dx%d", e->c.n[0], e->c.n[1], e->c.n[2]);
  if (e->c.varied) strncat(box, " + set", sizeof box - strlen(box) - 1);
  if (e->c.region != NULL)
    snprintf(box, sizeof box, "%d %s%s", e->c.n[0], e->c.region, e->c.set_up ? " + set" : "");
  const double median = cf_bench_median(seconds, rounds), middle = cf_bench_median(ratio, rounds);
  printf("%-18s%-15s%-5s%-8s%8s%7.0e%4d%11.3f%9.2f%5d%10.1e", e->solver->name, box, e->c.walls,
         cf_bench_side_name[e->c.side], sigma, e->c.tolerance, e->c.threads, 1e3 * median,
         1e9 * median / cells_of(e), e->iterations, e->residual);
  if (v > 0) printf("%9.3f  (%.3f to %.3f)", middle, ratio[0], ratio[rounds - 1]);
  printf("\n");
  fflush(stdout);
}

static cf_status heat_make(heat *h) {
  for (int v = 0; v < h->entries; ++v) {
    entry *e = &h->entry[v];
    CF_TRY(cf_bench_system_create(&e->system, &e->c));
    CF_TRY(e->solver->create(&e->made, &e->c, &e->system));
  }
  return CF_OK;
}

static cf_status heat_rounds(heat *h, const int rounds) {
  for (int r = -1; r < rounds; ++r) /* round -1 touches the memory */
    for (int v = 0; v < h->entries; ++v) {
      entry *e = &h->entry[v];
      double seconds;
      CF_TRY(e->solver->solve(e->made, &e->c, &e->system, &seconds, &e->iterations));
      if (r >= 0) e->seconds[r] = seconds;
      if (r == rounds - 1) e->residual = cf_helmholtz_residual(e->system.A, e->system.x, e->system.b);
    }
  return CF_OK;
}

static cf_status run(heat *h, const int rounds) {
  cf_status status = heat_make(h);
  if (status == CF_OK) status = heat_rounds(h, rounds);
  for (int v = 0; v < h->entries && status == CF_OK; ++v) print_entry(h, rounds, v);
  for (int v = 0; v < h->entries; ++v) {
    h->entry[v].solver->destroy(h->entry[v].made);
    cf_bench_system_destroy(&h->entry[v].system);
  }
  printf("\n");
  return status;
}

/* --- races ------------------------------------------------------------------------------------------------ */

typedef struct options {
  int n, rounds, sigmas;
  double sigma[SIGMAS_MAX];
  cf_bench_case c; /* what heats start from: n^3, insulated, mixed, 1e-6 */
} options;

/* Against direct solvers (D1 to D3). */
static cf_status race_direct(const options *o, const cf_bench_case *c) {
  heat h = {0};
  enter(&h, &race_ours, c);
  enter(&h, &race_fftw, c);
  if (c->walls[c->dim - 1] != 'p') enter(&h, &race_fftw_tridiagonal, c);
  return run(&h, o->rounds);
}

/* Against multigrid for general matrices, one thread (D4). */
static cf_status race_general(const options *o, const cf_bench_case *c) {
  cf_bench_case one = *c;
  heat h = {0};
  one.threads = 1;
  enter(&h, &race_ours, &one);
  enter(&h, &race_hypre, &one);
  return run(&h, o->rounds);
}

/* The same with coefficients that vary, each time from setting them up on (D5). */
static cf_status race_varied(const options *o, const cf_bench_case *c) {
  cf_bench_case varied = *c;
  varied.varied = varied.set_up = true;
  return race_general(o, &varied);
}

/* 1e-10 over 1e-6 (D8). */
static cf_status race_tolerance(const options *o, const cf_bench_case *c) {
  cf_bench_case tight = *c;
  heat h = {0};
  tight.tolerance = 1e-10;
  enter(&h, &race_ours, &tight);
  enter(&h, &race_ours, c);
  return run(&h, o->rounds);
}

/* Twice the side over once, a cell (D10). */
static cf_status race_size(const options *o, const cf_bench_case *c) {
  cf_bench_case large = *c;
  heat h = {0};
  for (int a = 0; a < c->dim; ++a) large.n[a] *= 2;
  enter(&h, &race_ours, &large);
  enter(&h, &race_ours, c);
  return run(&h, o->rounds);
}

/* One thread over several (D11). */
static cf_status race_threads(const options *o, const cf_bench_case *c) {
  cf_bench_case one = *c;
  heat h = {0};
  one.threads = 1;
  enter(&h, &race_ours, &one);
  enter(&h, &race_ours, c);
  return run(&h, o->rounds);
}

/* Extents near a power of two over that power, a cell; each in a heat of its own. */
static cf_status race_uneven(const options *o, const cf_bench_case *c) {
  const int n = o->n;
  const int extent[][3] = {{n - 1, n - 1, n - 1}, {n + 2, n - 6, n + 10}, {n - 13, n + 14, n - 6}};
  for (int v = 0; v < 3; ++v) {
    cf_bench_case uneven = *c;
    heat h = {0};
    memcpy(uneven.n, extent[v], sizeof uneven.n);
    enter(&h, &race_ours, &uneven);
    enter(&h, &race_ours, c);
    CF_TRY(run(&h, o->rounds));
  }
  return CF_OK;
}

/* Other walls over insulated ones. */
static cf_status race_walls(const options *o, const cf_bench_case *c) {
  static const char *const walls[] = {"ooo", "ppp", "pii", "iip", "oip"};
  for (int v = 0; v < 5; ++v) {
    cf_bench_case other = *c;
    heat h = {0};
    other.walls = walls[v];
    enter(&h, &race_ours, &other);
    enter(&h, &race_ours, c);
    CF_TRY(run(&h, o->rounds));
  }
  return CF_OK;
}

/* Around obstacles over an empty box, a cell that has an equation: alone, and with setting up (D7). */
static cf_status race_obstacles(const options *o, const cf_bench_case *c) {
  static const char *const regions[] = {"ball", "slalom", "porous"};
  for (int v = 0; v < 3; ++v) {
    cf_bench_case around = *c;
    heat h = {0};
    around.region = regions[v];
    enter(&h, &race_ours, &around);
    enter(&h, &race_ours, c);
    around.set_up = true;
    enter(&h, &race_ours, &around);
    CF_TRY(run(&h, o->rounds));
  }
  return CF_OK;
}

/* A ball of 2 % of a box of twice the extents, on tiles, over a box of about as many cells. */
static cf_status race_sparse(const options *o, const cf_bench_case *c) {
  cf_bench_case drop = *c, box = *c;
  heat h = {0};
  for (int a = 0; a < c->dim; ++a) {
    drop.n[a] *= 2;
    box.n[a] = (int)lround(drop.n[a] * pow(0.02, 1.0 / c->dim));
  }
  drop.region = "drop";
  enter(&h, &race_ours, &drop);
  enter(&h, &race_ours, &box);
  drop.set_up = true;
  enter(&h, &race_ours, &drop);
  return run(&h, o->rounds);
}

/* Two dimensions against direct solvers. */
static cf_status race_square(const options *o, const cf_bench_case *c) {
  for (int n = 256; n <= 4096; n *= 2) {
    cf_bench_case square = *c;
    square.dim = 2;
    square.n[0] = square.n[1] = n;
    square.n[2] = 1;
    square.walls = "ii";
    CF_TRY(race_direct(o, &square));
  }
  return CF_OK;
}

/* --- the command line ------------------------------------------------------------------------------------- */

static const struct {
  const char *name;
  cf_status (*race)(const options *, const cf_bench_case *);
} races[] = {
    {"direct", race_direct},       {"general", race_general}, {"varied", race_varied},
    {"tolerance", race_tolerance}, {"size", race_size},       {"threads", race_threads},
    {"uneven", race_uneven},       {"walls", race_walls},     {"square", race_square},
    {"obstacles", race_obstacles}, {"sparse", race_sparse},
};
enum { RACES = sizeof races / sizeof *races };

static int usage(void) {
  fputs("usage: race [NAME] [--own] [--n N] [--sigma S,...] [--threads N] [--rounds N]; names:", stderr);
  for (int v = 0; v < RACES; ++v) fprintf(stderr, " %s", races[v].name);
  fputs("; inf is Poisson\n", stderr);
  return 2;
}

static void read_sigmas(options *o, char *list) {
  o->sigmas = 0;
  for (char *word = strtok(list, ","); word != NULL && o->sigmas < SIGMAS_MAX; word = strtok(NULL, ","))
    o->sigma[o->sigmas++] = strtod(word, NULL);
}

/* The name of the race, NULL for all; false: nothing to make of it. */
static bool read_arguments(const int argc, char **argv, options *o, const char **name) {
  for (int v = 1; v < argc; ++v) {
    const char *word = argv[v];
    char *value = v + 1 < argc ? argv[v + 1] : NULL;
    if (word[0] != '-') {
      *name = word;
      continue;
    }
    if (strcmp(word, "--own") == 0) {
      o->c.own_time = true;
      o->c.threads = 1;
      continue;
    }
    if (value == NULL) return false;
    if (strcmp(word, "--n") == 0)
      o->n = atoi(value);
    else if (strcmp(word, "--rounds") == 0)
      o->rounds = CF_MIN(atoi(value), ROUNDS_MAX);
    else if (strcmp(word, "--threads") == 0)
      o->c.threads = atoi(value);
    else if (strcmp(word, "--sigma") == 0)
      read_sigmas(o, value);
    else
      return false;
    ++v;
  }
  return o->n > 0 && o->rounds > 0 && o->c.threads > 0;
}

int main(const int argc, char **argv) {
  options o = {.n = 256,
               .rounds = 7,
               .sigmas = 7,
               .sigma = {0.25, 1, 4, 16, 100, 1e4, INFINITY},
               .c = {.dim = 3, .tolerance = 1e-6, .threads = omp_get_num_procs(), .walls = "iii"}};
  const char *name = NULL;
  if (!read_arguments(argc, argv, &o, &name)) return usage();
  for (int a = 0; a < 3; ++a) o.c.n[a] = o.n;
  printf("%-18s%-15s%-5s%-8s%8s%7s%4s%11s%9s%5s%10s%9s\n", "solver", "cells", "wall", "side", "sigma", "tol",
         "thr", "ms", "ns/cell", "its", "residual", "ratio");
  int raced = 0;
  for (int v = 0; v < RACES; ++v) {
    if (name != NULL && strcmp(name, races[v].name) != 0) continue;
    ++raced;
    for (int s = 0; s < o.sigmas; ++s) {
      o.c.sigma = o.sigma[s];
      if (races[v].race(&o, &o.c) == CF_OK) continue;
      fprintf(stderr, "race: %s\n", cf_status_sentence());
      return 1;
    }
  }
  return raced > 0 ? 0 : usage();
}
