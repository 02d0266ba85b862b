/* SPDX-License-Identifier: MIT
 *
 * Model `gel`: elastic porous bodies that take up water and swell (section 8 of the paper; Figs 2, 9, 10). One step:
 *
 *     particles -> nodes     mass, momentum, the elastic and swelling force;  C, m_f, A, fill          (29), (30), (32)
 *     nodes                  gravity, obstacles; beta > 0: the semi-implicit solve                     (33), (35)
 *     nodes                  one C-F step of the saturation on the cells of the bodies                 (34)
 *     nodes -> particles     velocity and its gradient, F, place; changes of m_f and A                 (36)
 *     particles              what is stretched over more than a cell becomes two; now and then the filter of what
 *                            nodes cannot see
 *
 * with the corrections that physics/mpm.h and physics/poro.h tell. Water's velocity against the body and its inertia are
 * not modelled, nor is contact without the grid.
 */
#include <inttypes.h>
#include <math.h>
#include <stdio.h>

#include "model/gel_part.h"

/* The filter waits until its exponent is worth a round of the particles. */
#define FILTER_WORTH 0.02

/* --- where particles may be -------------------------------------------------------------------------------- */

static cf_status lost(const cf_gel *g, const int64_t i) {
  double x[3] = {0, 0, 0};
  for (int a = 0; a < g->grid->box.dim; ++a) x[a] = (double)g->set->attribute[g->at.position].at[a][i];
  if (isfinite(x[0]) && isfinite(x[1]) && isfinite(x[2]))
    return cf_fail(CF_OVER_LIMIT,
                   "particle %" PRId64 " of gel left the lattice at (%g, %g, %g): it has %d cells an axis",
                   g->set->id[i], x[0], x[1], x[2], g->lattice.box.n[0]);
  return cf_fail(CF_NOT_FINITE,
                 "the place of particle %" PRId64
                 " of gel stopped being finite: the step is too long for the body's "
                 "stiffness (take dt: auto, or gel.implicitness: 1)",
                 g->set->id[i]);
}

/* Particles that were pushed through a wall by more than two cells are put back; without walls none may leave. */
static cf_status keep_inside(cf_gel *g) {
  const bool walls = g->keys->walls != CF_GEL_WALL_NONE;
  const int64_t count = g->set->count;
  int64_t first = INT64_MAX;
  for (int a = 0; a < g->grid->box.dim; ++a) {
    cf_real *x = g->set->attribute[g->at.position].at[a], *v = g->set->attribute[g->at.velocity].at[a];
    const cf_grid *where = walls ? g->grid : &g->lattice;
    const double margin = (walls ? 2 : -3) * where->h;
    const cf_real low = (cf_real)(where->origin[a] - margin);
    const cf_real high = (cf_real)(where->origin[a] + where->box.n[a] * where->h + margin);
#pragma omp parallel for schedule(static) num_threads(g->grid->threads) reduction(min : first)
    for (int64_t i = 0; i < count; ++i) {
      if (x[i] >= low && x[i] <= high) continue;
      if (!walls || !isfinite((double)x[i])) {
        first = CF_MIN(first, i);
        continue;
      }
      x[i] = x[i] < low ? low : high;
      v[i] = 0;
    }
  }
  return first == INT64_MAX ? CF_OK : lost(g, first);
}

/* --- a step ------------------------------------------------------------------------------------------------ */

/* No water moves: nodes have no changes of it. */
static void still_water(cf_gel *g) {
  CF_PARALLEL_BLOCKS(g->mpm->nodes, g->lattice.threads, b)
  for (ptrdiff_t at = (ptrdiff_t)b * CF_BLOCK_NODES; at < ((ptrdiff_t)b + 1) * CF_BLOCK_NODES; ++at)
    for (int c = CF_NODE_CAPACITY; c <= CF_NODE_FILL; ++c) g->mpm->nodes->at[at][c] = 0;
}

static cf_status move_water(cf_gel *g, const double t, const double dt, double *gained,
                            cf_step_report *report) {
  cf_solve_report solve;
  *gained = 0;
  if (g->poro == NULL) {
    still_water(g);
    return CF_OK;
  }
  if (g->mpm->mixture != NULL) cf_mpm_mix(g->mpm);
  CF_TRY(cf_poro_step(g->poro, g->mpm->nodes, t, dt, gained, &solve));
  cf_step_report_add(report, CF_STAGE_DIFFUSE, &solve);
  return CF_OK;
}

/* Every body by what its own k does to a wave as long as two cells. */
static void filter(cf_gel *g, const double dt) {
  if (g->poro == NULL) return;
  const int bodies = g->keys->bodies.count;
  double most = 0;
  for (int i = 0; i < bodies; ++i) {
    const cf_mpm_material *a = &g->material[i];
    g->filter_due[i] += cf_poro_filter_rate(a->k, g->poro->p.tau, a->f_t, g->lattice.h) * dt;
    most = CF_MAX(most, g->filter_due[i]);
  }
  if (most < FILTER_WORTH) return;
  for (int i = 0; i < bodies; ++i) {
    g->eta[i] = -expm1(-g->filter_due[i]);
    g->filter_due[i] = 0;
  }
  cf_mpm_filter(g->mpm, g->eta);
}

static cf_status gel_step(void *model, const double t, const double dt, cf_step_report *report) {
  cf_gel *g = model;
  double gained, clock = cf_stage_clock();
  cf_solve_report solve;
  CF_TRY(keep_inside(g)); /* whoever looked at the state between steps may have written to it */
  cf_mpm_scatter(g->mpm, dt);
  clock = cf_stage_end(report, CF_STAGE_TRANSFER, clock);
  CF_TRY(cf_mpm_move_nodes(g->mpm, t, dt, &solve));
  if (g->keys->implicitness > 0) cf_step_report_add(report, CF_STAGE_FORCE, &solve);
  clock = cf_stage_end(report, CF_STAGE_FORCE, clock);
  CF_TRY(move_water(g, t, dt, &gained, report));
  clock = cf_stage_end(report, CF_STAGE_DIFFUSE, clock);
  cf_mpm_gather(g->mpm, dt);
  if (g->keys->split > 0) cf_mpm_split(g->mpm, g->keys->split);
  cf_ledger_add(&g->water, gained - g->mpm->returned);
  CF_TRY(keep_inside(g));
  clock = cf_stage_end(report, CF_STAGE_TRANSFER, clock);
  filter(g, dt);
  cf_stage_end(report, CF_STAGE_DIFFUSE, clock);
  return CF_OK;
}

/* Waves and speeds, each over cfl; a semi-implicit step is bound by speeds alone, and by a tenth of them at most. */
static double gel_natural_dt(const void *model, const double t) {
  (void)t;
  const cf_gel *g = model;
  const cf_mpm_limits most = cf_mpm_limits_of(g->mpm);
  const double explicit_share = g->keys->implicitness >= 0.5 ? 0.1 : 1;
  const double rate = CF_MAX(most.speed, explicit_share * most.waves) / g->lattice.h;
  const double longest = g->scene->time.end / 10;
  return rate > 0 ? CF_MIN(g->scene->time.cfl / rate, longest) : longest;
}

static const char *const gel_keys[] = {"gel", "obstacles", "diffusion", NULL};
static const char *const gel_fields[] = {NULL};
static const char *const gel_outputs[] = {"saturation", "gel", NULL};

const cf_model cf_model_gel = {
    .name = "gel",
    .summary = "elastic porous bodies that take up water and swell",
    .keys = gel_keys,
    .fields = gel_fields,
    .outputs = gel_outputs,
    .resolve = cf_gel_resolve,
    .shows = cf_gel_shows,
    .memory = cf_gel_memory,
    .check = cf_gel_check,
    .create = cf_gel_create,
    .destroy = cf_gel_destroy,
    .natural_dt = gel_natural_dt,
    .describe = cf_gel_describe,
    .step = gel_step,
    .derived = cf_gel_derived,
    .derive = cf_gel_derive,
    .show = cf_gel_show,
    .mesh = cf_gel_mesh,
    .metric_names = cf_gel_metric_names,
    .metrics = cf_gel_metrics,
};
