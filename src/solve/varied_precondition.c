/* SPDX-License-Identifier: MIT
 *
 * The cycle over levels of couplings that conjugate gradients go around: a V- or W-cycle; a symmetric V-cycle, where they must
 * not stall; the finest level and clusters below it (clusters.h), where coefficients jump.
 */
#include "solve/clusters.h"
#include "solve/varied_part.h"

/* Full sweeps after the coarse correction below the finest level, where they cost little: in a V-cycle; in a W-cycle. */
#define COARSE_SWEEPS_V 3
#define COARSE_SWEEPS_W 1
/* On a coarsest level that is not eliminated because little is left to smooth there. */
#define LAST_SWEEPS 4
#define OMEGA       1.15f

static void solve_last(const cf_varied *v, const int at) {
  const cf_coupled *l = &v->level[at];
  if (cf_varied_eliminates(v)) {
    cf_band_solve(&v->band, l);
    return;
  }
  const cf_band_sweeps none = {0, 1};
  cf_coupled_smooth_first(l, 1, none, false);
  if (v->careful)
    cf_coupled_smooth_back(l, 1, none);
  else
    cf_coupled_smooth(l, 1, none, at == 0 ? 1 : LAST_SWEEPS);
}

/* Smoothing in opposite orders and transfers that are each other's transposes: with elimination, or few half sweeps, at
 * the bottom this is symmetric and positive definite, however wrong coarse couplings are. */
static void careful_cycle(const cf_varied *v, const int at) {
  const cf_coupled *l = &v->level[at];
  if (at == v->depth - 1) {
    solve_last(v, at);
    return;
  }
  cf_coupled_smooth_first(l, 1, v->band_sweeps, true);
  cf_coupled_restrict_alike(l, &v->level[at + 1]);
  careful_cycle(v, at + 1);
  cf_coupled_prolong_alike(&v->level[at + 1], l);
  cf_coupled_smooth_back(l, 1, v->band_sweeps);
}

/* Three sweeps on either side, which cost little beside what is below. */
static void clustered_cycle(const cf_varied *v) {
  const cf_coupled *l = &v->level[0];
  const cf_band_sweeps none = {0, 1};
  cf_coupled_smooth_first(l, 1, none, false);
  cf_coupled_smooth(l, 1, none, 1);
  cf_coupled_smooth_again(l, 1);
  cf_clusters_correct(&v->clusters, l);
  for (int sweep = 0; sweep < 3; ++sweep) cf_coupled_smooth_back(l, 1, none);
}

void cf_varied_cycle(const cf_varied *v, const int at) {
  const cf_coupled *l = &v->level[at], *coarse = l + 1;
  if (v->clustered) {
    clustered_cycle(v);
    return;
  }
  if (v->careful) {
    careful_cycle(v, at);
    return;
  }
  if (at == v->depth - 1) {
    solve_last(v, at);
    return;
  }
  cf_coupled_smooth_first(l, OMEGA, v->band_sweeps, true);
  cf_coupled_restrict(l, coarse);
  cf_varied_cycle(v, at + 1);
  if (v->thorough && at + 1 < v->depth - 1) {
    cf_coupled_prolong(coarse, l);
    cf_coupled_smooth_again(l, OMEGA);
    cf_coupled_restrict(l, coarse);
    cf_varied_cycle(v, at + 1);
  }
  cf_coupled_prolong(coarse, l);
  cf_coupled_smooth(l, OMEGA, v->band_sweeps, at == 0 ? 1 : v->thorough ? COARSE_SWEEPS_W : COARSE_SWEEPS_V);
}
