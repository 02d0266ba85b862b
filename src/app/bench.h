/* SPDX-License-Identifier: MIT
 *
 * The tables that `bench` prints, one file each: bench_solver.c, bench_table2.c.
 */
#ifndef CF_APP_BENCH_H
#define CF_APP_BENCH_H

#include "app/options.h"

enum { CF_BENCH_LIST_MAX = 32 };

/* The command's filters, read. A list that was not given has no entries. */
typedef struct cf_bench_filter {
  int boxes, dim[CF_BENCH_LIST_MAX], n[CF_BENCH_LIST_MAX][3];
  int sigmas;
  double sigma[CF_BENCH_LIST_MAX]; /* INFINITY: Poisson */
  int threads;
  bool json;
} cf_bench_filter;

cf_status cf_bench_solver(const cf_bench_filter *f);
cf_status cf_bench_table2(const cf_bench_filter *f);

/* A number of a JSON object: null where it is not finite. */
void cf_bench_json_number(const char *name, double value);

#endif
