/* SPDX-License-Identifier: MIT
 *
 * One linear system to time: a box of cells with h = 1, walls, and a right side of known kind,
 *
 *     (alpha - beta laplacian) x = b,    sigma = beta/(alpha h^2);   sigma infinite: Poisson's equation.
 *
 * The right side is a few Gaussian blobs, white noise, or blobs with 10 % noise. The noise is counted
 * (base/rng.h), hence the same for everybody who solves the system.
 */
#ifndef CF_APP_BENCH_CASE_H
#define CF_APP_BENCH_CASE_H

#include "grid/region.h"
#include "solve/helmholtz.h"

typedef enum cf_bench_side { CF_BENCH_MIXED, CF_BENCH_SMOOTH, CF_BENCH_NOISY, CF_BENCH_SIDES } cf_bench_side;
extern const char *const cf_bench_side_name[CF_BENCH_SIDES];

typedef struct cf_bench_case {
  const char *name;
  int dim, n[3];
  double sigma; /* INFINITY: Poisson */
  double tolerance;
  int threads;
  const char *walls; /* a letter an axis: i insulated, o open, p periodic; NULL: all insulated */
  cf_bench_side side;
  const char *region; /* of bench_region.h; NULL: the whole box */
  bool varied;        /* beta is a field: sigma times factors from 0.2 to 4, smooth and noisy */
  bool set_up;        /* other coefficients are set before every solve, then these, which is timed too */
  bool
      own_time; /* seconds are those of the calling thread alone: for one thread where others want the machine */
} cf_bench_case;

typedef struct cf_bench_system {
  cf_grid grid;
  cf_helmholtz *A;
  cf_region *region;
  cf_tiles *tiles;
  cf_cell x, b;
  cf_face beta;    /* of a varied case */
  ptrdiff_t cells; /* that have an equation */
  double resident; /* bytes that this process held when only b was there */
} cf_bench_system;

typedef struct cf_bench_result {
  double seconds;  /* median of one solve from x = 0, without set-up */
  int times;       /* that it was solved */
  ptrdiff_t cells; /* that have an equation */
  cf_solve_report report;
  double residual;       /* |b - A x| / |b|, computed afresh */
  double bytes_per_cell; /* of x and all that the solver touched; b is not counted */
} cf_bench_result;

/* CF_NO_MEMORY, CF_BAD_ARGUMENT. What was made is destroyed on failure. */
cf_status cf_bench_system_create(cf_bench_system *s, const cf_bench_case *c);
void cf_bench_system_destroy(cf_bench_system *s);

/* The right side of the case. CF_NO_MEMORY. */
cf_status cf_bench_fill_side(const cf_bench_case *c, const cf_grid *g, cf_cell b);

/* x = 0, then one solve; its seconds. */
cf_status cf_bench_system_solve(const cf_bench_system *s, const cf_bench_case *c, cf_solve_report *report,
                                double *seconds);

/* Creates, solves until `least` times and `seconds` are reached (at most 25 times), destroys. */
cf_status cf_bench_case_run(const cf_bench_case *c, int least, double seconds, cf_bench_result *result);

/* Bytes that even a perfect cache must move a solve: what starts it (b and x read, r written) and, an iteration, x
 * and r read and written. Coefficients that are fields are not counted. */
double cf_bench_least_bytes(const cf_bench_result *result);

/* Bytes a second of a triad, a = b + s c, far out of the caches: the best of some tries, three streams
 * counted. CF_NO_MEMORY. */
cf_status cf_bench_stream(int threads, double *bytes_per_second);

/* Bytes of memory in use by this process; 0 where there is no telling. */
double cf_bench_resident(void);

double cf_bench_clock(bool own_time); /* s */

/* Sorts v. */
double cf_bench_median(double *v, int count);

#endif
