/* SPDX-License-Identifier: MIT
 *
 * From a level to the next one of clusters (clusters.h): matching, and the couplings between what has been matched.
 */
#ifndef CF_SOLVE_MATCHING_H
#define CF_SOLVE_MATCHING_H

#include "solve/clusters.h"

/* Fills `coarse` from `of`, or from the cells of l where `of` is NULL; times: how often to match. coarse->n = 0: nothing was
 * matched, or too little to be worth a level. CF_NO_MEMORY; what was made is freed by clear. */
cf_status cf_matching_make(cf_cluster_level *coarse, const cf_coupled *l, const cf_cluster_level *of,
                           int times);
void cf_matching_clear(cf_cluster_level *q);

#endif
