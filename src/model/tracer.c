/* SPDX-License-Identifier: MIT
 *
 * Model `tracer`: any number of scalars with C-F diffusion in a medium whose velocity is prescribed (section
 * 5 of the paper, Figs 3 and 4):
 *
 *     C (phi_t + div(u phi)) + div(q_C - F_T k grad phi) = C W
 *     tau [q_t + div(u q) - q.grad u] + q + (1 - F_T) k grad phi = tau B        (objective rate; others as
 * asked)
 *
 * One step is Strang's: half a move with the flow, diffusion, half a move (each half with the velocity at its
 * middle); `scheme: paper` takes Lie's, the whole move with the old velocity and then eqs 13 to 18.
 *
 * The flow does not know of the scalars: for that there is another model.
 */
#include <stdio.h>
#include <string.h>

#include "grid/sweep.h"
#include "model/tracer_part.h"

/* --- a step ----------------------------------------------------------------------------------------------- */

static cf_flux_rate rate_of(const cf_tracer_scalar *s) {
  if (s->paper && !s->scene->given.flux_rate) return CF_RATE_MATERIAL;
  if (s->scene->flux_rate == CF_SCENE_FLUX_RATE_MATERIAL) return CF_RATE_MATERIAL;
  return s->scene->flux_rate == CF_SCENE_FLUX_RATE_CONSERVATIVE ? CF_RATE_CONSERVATIVE : CF_RATE_OBJECTIVE;
}

static cf_status move_scalar(cf_advect *a, cf_tracer_scalar *s) {
  cf_through through = {0, 0};
  CF_TRY(cf_advect_cell(a, &s->walls, s->phi, &through));
  s->ledger.entered += through.entered;
  s->ledger.left += through.left;
  if (!s->has_memory) return CF_OK;
  if (s->plan.scalar_form) return cf_advect_cell(a, &s->memory_walls, s->s, NULL);
  if (s->scene->flux_rate == CF_SCENE_FLUX_RATE_PARTIAL) return CF_OK; /* Appendix A's pitfall */
  return cf_advect_face(a, &s->walls, rate_of(s), s->q);
}

/* Every scalar that is (not) the paper's moves over [t, t + dt] with the velocity of t_velocity. */
static cf_status move(cf_tracer *m, const bool paper, const double t, const double dt,
                      const double t_velocity, cf_step_report *report) {
  if (!m->moves) return CF_OK;
  if (m->velocity_in_time) CF_TRY(cf_tracer_set_velocity(m, t_velocity));
  bool begun[CF_TRACER_ADVECT_SCHEMES] = {false};
  for (int i = 0; i < m->count; ++i) {
    cf_tracer_scalar *s = &m->scalar[i];
    if (s->paper != paper) continue;
    const cf_advect_scheme scheme = cf_tracer_advection(m, s);
    if (!begun[scheme]) CF_TRY(cf_advect_begin(m->by_scheme[scheme], t, dt));
    begun[scheme] = true;
    CF_TRY(move_scalar(m->by_scheme[scheme], s));
  }
  if (m->through_walls > 0 && report->warning[0] == '\0')
    snprintf(report->warning, sizeof report->warning,
             "the velocity passes through insulated walls (up to %g m/s): set to 0 there", m->through_walls);
  return CF_OK;
}

static cf_status diffuse(cf_tracer_scalar *s, const double t, const double dt, cf_step_report *report) {
  cf_solve_report one;
  if (s->plan.scalar_form) {
    CF_TRY(cf_diffuse_step_scalar(s->diffuse, t, dt, s->phi, s->s, &s->ledger, &one));
  } else {
    CF_TRY(cf_diffuse_step(s->diffuse, t, dt, s->phi, s->q, &s->ledger, &one));
    cf_sources_hold_flux(s->sources, t + dt, s->q);
  }
  cf_step_report_add(report, CF_STAGE_DIFFUSE, &one);
  return CF_OK;
}

static cf_status tracer_step(void *model, const double t, const double dt, cf_step_report *report) {
  cf_tracer *m = model;
  double clock = cf_stage_clock();
  CF_TRY(move(m, true, t, dt, t, report));
  CF_TRY(move(m, false, t, dt / 2, t + dt / 4, report));
  clock = cf_stage_end(report, CF_STAGE_ADVECT, clock);
  for (int i = 0; i < m->count; ++i) CF_TRY(diffuse(&m->scalar[i], t, dt, report));
  clock = cf_stage_end(report, CF_STAGE_DIFFUSE, clock);
  CF_TRY(move(m, false, t + dt / 2, dt / 2, t + 3 * dt / 4, report));
  cf_stage_end(report, CF_STAGE_ADVECT, clock);
  return CF_OK;
}

/* The velocity has been read back as the last step had it: the length of the next one may hang on that. */
static cf_status tracer_restored(void *model) {
  cf_tracer *m = model;
  for (int s = 0; s < CF_TRACER_ADVECT_SCHEMES; ++s)
    if (m->by_scheme[s] != NULL)
      CF_TRY(cf_advect_set_velocity(m->by_scheme[s], m->u, &m->scene->domain.walls.walls));
  return CF_OK;
}

static bool tracer_describe(const void *model, const int line, char *text, const size_t size) {
  const cf_tracer *m = model;
  if (line >= m->count) return false;
  const cf_tracer_scalar *s = &m->scalar[line];
  snprintf(text, size, "%s: %s%s", s->name, s->plan.why,
           s->plan.scalar_form ? "; the flux is kept as its divergence" : "");
  return true;
}

/* --- metrics ---------------------------------------------------------------------------------------------- */

static int tracer_metric_names(const void *model, cf_metric *names) {
  static const char *const per_scalar[4] = {"sum", "min", "max", "error"};
  const cf_tracer *m = model;
  for (int i = 0; i < m->count; ++i)
    for (int c = 0; c < 4; ++c)
      snprintf(names[4 * i + c].name, CF_NAME_MAX, "%s_%.*s", per_scalar[c], CF_NAME_MAX - 8,
               m->scalar[i].name);
  return 4 * m->count;
}

static void tracer_metrics(const void *model, double *values) {
  const cf_tracer *m = model;
  for (int i = 0; i < m->count; ++i) {
    const cf_tracer_scalar *s = &m->scalar[i];
    const cf_range range = cf_sweep_range(&m->grid->box, m->grid->threads, s->phi.at, m->rows);
    values[4 * i] = range.sum * cf_grid_volume(m->grid);
    values[4 * i + 1] = range.min;
    values[4 * i + 2] = range.max;
    values[4 * i + 3] = cf_ledger_error(&s->ledger, cf_diffuse_content(s->diffuse, s->phi));
  }
}

static const char *const tracer_keys[] = {"diffusion", "advection", "fields", "velocity", "sources", NULL};

static bool tracer_shows(const cf_scene *scene, const char *name) {
  return scene->given.velocity && strcmp(name, "velocity") == 0;
}

const cf_model cf_model_tracer = {
    .name = "tracer",
    .summary = "scalars with C-F diffusion in a prescribed flow",
    .keys = tracer_keys,
    .shows = tracer_shows,
    .memory = cf_tracer_memory,
    .create = cf_tracer_create,
    .destroy = cf_tracer_destroy,
    .restored = tracer_restored,
    .natural_dt = cf_tracer_natural_dt,
    .describe = tracer_describe,
    .step = tracer_step,
    .metric_names = tracer_metric_names,
    .metrics = tracer_metrics,
};
