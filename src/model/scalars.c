/* SPDX-License-Identifier: MIT
 *
 * A step of the scalars, and what is told of them.
 */
#include "model/scalars.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "grid/sweep.h"
#include "stencil/regime.h"

/* `dt: auto` where only Fourier diffusion limits the step: so many explicit steps in one. */
#define FOURIER_STEPS 16

/* --- moving ----------------------------------------------------------------------------------------------- */

cf_advect_scheme cf_scalars_scheme(const int word) {
  static const cf_advect_scheme by_word[] = {[CF_SCENE_ADVECTION_PPM] = CF_ADVECT_PPM,
                                             [CF_SCENE_ADVECTION_LINEAR] = CF_ADVECT_LINEAR,
                                             [CF_SCENE_ADVECTION_WENO5] = CF_ADVECT_WENO5,
                                             [CF_SCENE_ADVECTION_CUBIC] = CF_ADVECT_CUBIC};
  return by_word[word];
}

static cf_advect_scheme scheme_of(const cf_scalars *s, const cf_scalar *i) {
  if (i->paper && !s->scene->advection.given.scheme) return CF_ADVECT_LINEAR;
  return cf_scalars_scheme(s->scene->advection.scheme);
}

cf_status cf_scalars_carry(cf_scalars *s, const int more) {
  bool wanted[CF_ADVECT_SCHEMES] = {false};
  for (int i = 0; i < s->count; ++i) wanted[scheme_of(s, &s->item[i])] = true;
  if (more >= 0) wanted[more] = true;
  s->moves = true;
  for (int a = 0; a < CF_ADVECT_SCHEMES; ++a)
    if (wanted[a]) CF_TRY(cf_advect_create(&s->by_scheme[a], s->grid, (cf_advect_scheme)a));
  return CF_OK;
}

cf_status cf_scalars_set_velocity(cf_scalars *s, const cf_face u) {
  for (int a = 0; a < CF_ADVECT_SCHEMES; ++a)
    if (s->by_scheme[a] != NULL)
      CF_TRY(cf_advect_set_velocity(s->by_scheme[a], u, &s->scene->domain.walls.walls));
  return CF_OK;
}

cf_status cf_scalars_register_moves(const cf_scalars *s, cf_registry *r) {
  static const char *const parity[CF_ADVECT_SCHEMES] = {"sweep_parity", "sweep_parity_linear",
                                                        "sweep_parity_weno5", "sweep_parity_cubic"};
  for (int a = 0; a < CF_ADVECT_SCHEMES; ++a)
    if (s->by_scheme[a] != NULL)
      CF_TRY(cf_registry_add_counter(r, parity[a], cf_advect_parity(s->by_scheme[a])));
  return CF_OK;
}

static cf_flux_rate rate_of(const cf_scalar *i) {
  if (i->paper && !i->scene->given.flux_rate) return CF_RATE_MATERIAL;
  if (i->scene->flux_rate == CF_SCENE_FLUX_RATE_MATERIAL) return CF_RATE_MATERIAL;
  return i->scene->flux_rate == CF_SCENE_FLUX_RATE_CONSERVATIVE ? CF_RATE_CONSERVATIVE : CF_RATE_OBJECTIVE;
}

/* phi, and its flux where that is kept as its divergence (which is 0 where k is). In a part of the box 0 comes in through what is no wall of
 * the box. */
static cf_status move_cells(const cf_scalars *s, cf_advect *a, const cf_scalar *i, cf_through *through) {
  const bool both = i->has_memory && i->plan.scalar_form && i->D > 0;
  cf_carried f[2] = {{&i->carried, i->phi, through}, {&i->carried_flux, i->s, NULL}};
  if (!s->follows) return cf_advect_cells(a, f, both ? 2 : 1);
  cf_walls ends[2];
  for (int n = 0; n < (both ? 2 : 1); ++n) {
    ends[n] = cf_scalars_ends(s, f[n].walls, CF_WALL_OPEN);
    f[n].walls = &ends[n];
  }
  return cf_advect_cells_in(a, &s->part, s->corner, f, both ? 2 : 1);
}

/* In obstacles stands for the move what phi continues to, so that it has no slope at their surface; one that moves
 * brings in and takes away some of that with its faces. */
static cf_status move_phi(const cf_scalars *s, cf_advect *a, cf_scalar *i) {
  cf_through through = {0, 0};
  const bool around = i->region != NULL;
  double inside = 0;
  if (around) cf_rim_fill(&s->rim, i->phi);
  if (around) inside = cf_diffuse_sum_outside(i->diffuse, i->phi);
  CF_TRY(move_cells(s, a, i, &through));
  i->ledger.entered += through.entered;
  i->ledger.left += through.left;
  if (!around) return CF_OK;
  if (s->obstacles->changes) cf_ledger_add(&i->ledger, inside - cf_diffuse_sum_outside(i->diffuse, i->phi));
  cf_diffuse_set_outside(i->diffuse, i->phi);
  return CF_OK;
}

static cf_status move_one(const cf_scalars *s, cf_advect *a, cf_scalar *i) {
  CF_TRY(move_phi(s, a, i));
  if (!i->has_memory || i->plan.scalar_form) return CF_OK;
  if (i->scene->flux_rate == CF_SCENE_FLUX_RATE_PARTIAL) return CF_OK; /* Appendix A's pitfall */
  CF_TRY(cf_advect_face(a, &i->walls, rate_of(i), i->q));
  cf_diffuse_close_faces(i->diffuse, i->q);
  return CF_OK;
}

cf_status cf_scalars_move(cf_scalars *s, const bool paper, const double t, const double dt,
                          bool begun[CF_ADVECT_SCHEMES]) {
  for (int i = 0; i < s->count; ++i) {
    cf_scalar *one = &s->item[i];
    if (one->paper != paper) continue;
    const cf_advect_scheme scheme = scheme_of(s, one);
    if (!begun[scheme]) CF_TRY(cf_advect_begin(s->by_scheme[scheme], t, dt));
    begun[scheme] = true;
    CF_TRY(move_one(s, s->by_scheme[scheme], one));
  }
  return CF_OK;
}

/* --- diffusion -------------------------------------------------------------------------------------------- */

static cf_status diffuse_one(const cf_scalars *s, cf_scalar *i, const double t, const double dt,
                             cf_step_report *report) {
  cf_solve_report one;
  if (i->plan.scalar_form) {
    const cf_cell phi = {i->phi.at + s->corner}, div_q = {i->s.at + s->corner};
    CF_TRY(cf_diffuse_step_scalar(i->diffuse, t, dt, phi, div_q, &i->ledger, &one));
  } else {
    CF_TRY(cf_diffuse_step(i->diffuse, t, dt, i->phi, i->q, &i->ledger, &one));
    cf_sources_hold_flux(i->sources, t + dt, i->q);
  }
  cf_step_report_add(report, CF_STAGE_DIFFUSE, &one);
  return CF_OK;
}

cf_status cf_scalars_diffuse(cf_scalars *s, const double t, const double dt, cf_step_report *report) {
  for (int i = 0; i < s->count; ++i) CF_TRY(diffuse_one(s, &s->item[i], t, dt, report));
  cf_scalars_clear_ghosts(s);
  return CF_OK;
}

double cf_scalars_rate(const cf_scalars *s) {
  const double h = s->grid->h;
  double rate = 0;
  for (int i = 0; i < s->count; ++i) {
    const cf_scalar *one = &s->item[i];
    const double tau = one->scene->tau, f_t = tau > 0 ? one->scene->f_t : 1;
    if (tau > 0) rate = CF_MAX(rate, cf_regime_speed(one->D, tau, f_t) / h);
    rate = CF_MAX(rate, f_t * one->D / (FOURIER_STEPS * h * h));
  }
  return rate;
}

double cf_scalars_natural_dt(const cf_scalars *s, const double flow_rate) {
  const double rate = flow_rate + cf_scalars_rate(s), longest = s->scene->time.end / 100;
  return rate > 0 ? CF_MIN(s->scene->time.cfl / rate, longest) : longest;
}

/* --- telling ---------------------------------------------------------------------------------------------- */

bool cf_scalars_describe(const cf_scalars *s, const int line, char *text, const size_t size) {
  if (line >= s->count) return false;
  const cf_scalar *i = &s->item[line];
  snprintf(text, size, "%s: %s%s", i->name, i->plan.why,
           i->plan.scalar_form ? "; the flux is kept as its divergence" : "");
  return true;
}

int cf_scalars_metric_names(const cf_scalars *s, cf_metric *names) {
  static const char *const of_each[CF_SCALAR_METRICS] = {"sum", "min", "max", "error"};
  for (int i = 0; i < s->count; ++i)
    for (int c = 0; c < CF_SCALAR_METRICS; ++c)
      snprintf(names[CF_SCALAR_METRICS * i + c].name, CF_NAME_MAX, "%s_%.*s", of_each[c], CF_NAME_MAX - 8,
               s->item[i].name);
  return CF_SCALAR_METRICS * s->count;
}

void cf_scalars_metrics(const cf_scalars *s, double *values) {
  for (int i = 0; i < s->count; ++i) {
    const cf_scalar *one = &s->item[i];
    cf_range range = one->region != NULL
                         ? cf_scalars_range_around(s, one)
                         : cf_sweep_range(&s->part.box, s->grid->threads, one->phi.at + s->corner, s->rows);
    if (cf_scalars_share(s) < 1) range.min = CF_MIN(range.min, 0), range.max = CF_MAX(range.max, 0);
    double *v = values + CF_SCALAR_METRICS * i;
    v[0] = range.sum * cf_grid_volume(s->grid);
    v[1] = range.min;
    v[2] = range.max;
    v[3] =
        cf_ledger_error(&one->ledger, cf_diffuse_content(one->diffuse, (cf_cell){one->phi.at + s->corner}));
  }
}
