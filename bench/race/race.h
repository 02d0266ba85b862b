/* SPDX-License-Identifier: MIT
 *
 * A race: several ways to solve the systems of app/bench_case.h, in one process and by turns (A B C A B C ...), so
 * that whatever else the machine does meets all of them. What counts are ratios within a round, and of those
 * the median.
 */
#ifndef CF_BENCH_RACE_H
#define CF_BENCH_RACE_H

#include "app/bench_case.h"

/* One way to solve; `made` is what create returns. All get the same b, and leave x in the system, where its true
 * residual is measured. */
typedef struct race_solver {
  const char *name;
  cf_status (*create)(void **made, const cf_bench_case *c, const cf_bench_system *s);
  /* Seconds of one solve; `iterations` is 0 for direct solvers. */
  cf_status (*solve)(void *made, const cf_bench_case *c, const cf_bench_system *s, double *seconds,
                     int *iterations);
  void (*destroy)(void *made);
} race_solver;

extern const race_solver race_ours;
extern const race_solver race_fftw;             /* transforms along all axes */
extern const race_solver race_fftw_tridiagonal; /* along all but the last, and elimination there */
extern const race_solver race_hypre; /* conjugate gradients around PFMG; one process, so one thread */

/* 2 - 2 cos of the i-th mode of an axis: the second difference's eigenvalue. */
double race_eigenvalue(char wall, int n, int i);

#endif
