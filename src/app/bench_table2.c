/* SPDX-License-Identifier: MIT
 *
 * cattaneo bench table2
 */
#include "app/bench.h"

cf_status cf_bench_table2(const cf_bench_filter *f) {
  (void)f;
  return CF_OK;
}
