/* SPDX-License-Identifier: MIT
 *
 * Model `flow`: an incompressible fluid, and the scalars that it carries and that move it (section 6 of the paper,
 * Figs 5 and 6):
 *
 *     u_t + div(u u) = -grad p + nu div grad u + a,      div u = 0
 *     a = -(sum of buoyancy phi) g + force + confinement
 *     scalars: C (phi_t + div(u phi)) + div q = C W,  their fluxes as in scalars.h
 *
 * (p is pressure over density; density differs from place to place in a alone, Boussinesq.) One step:
 *
 *     v = u + dt/2 (u - u_before)/dt_before                the velocity in the middle of the step
 *     u <- u + dt/2 (a - grad p)                           p of the step before
 *     scalars: half a move with v, diffusion over dt, half a move
 *     u moves with v
 *     u <- u + dt/2 (a - grad p)                           a from the new scalars
 *     u <- u - dt grad p',  p <- p + p',  div u = 0        the change of the pressure
 *
 * Second order in time as a whole: v is centred and free of divergence because both velocities behind it are, moves
 * and accelerations alternate as Strang's, and what the old pressure misses is a gradient, which the projection puts
 * right. One projection a step does for that. What moves is moved in the form of a divergence: momentum changes by forces
 * and walls alone.
 *
 * With viscosity the velocity moves in two halves around its friction, which takes all accelerations into its stages
 * (viscosity.h says why), half of them from the scalars before their diffusion and half after.
 *
 * It does not do: free surfaces, changes of volume, densities that differ much.
 */
#include <math.h>
#include <stdio.h>

#include "grid/sweep.h"
#include "model/flow_part.h"
#include "stencil/courant.h"

/* --- the middle velocity ---------------------------------------------------------------------------------- */

/* v = u + r (u - before), and before <- u. */
CF_CLONES static void middle_row(const int n, const cf_real r, const cf_real *u, cf_real *before,
                                 cf_real *v) {
  CF_ROW_LOOP
  for (int i = 0; i < n; ++i) {
    v[i] = u[i] + r * (u[i] - before[i]);
    before[i] = u[i];
  }
}

static cf_status find_middle(cf_flow *m, const double dt) {
  const cf_box *b = &m->grid->box;
  const cf_real r = (cf_real)(m->last_dt > 0 && !m->solids.changes ? dt / (2 * m->last_dt) : 0);
  for (int a = 0; a < b->dim; ++a)
    CF_PARALLEL_FACE_ROWS (b, m->grid->threads, a, row) {
      const ptrdiff_t p = cf_box_face_row(b, a, row);
      middle_row(cf_box_extent(b, 0, a), r, m->u.at[a] + p, m->before.at[a] + p, m->middle.at[a] + p);
    }
  m->last_dt = dt;
  return cf_scalars_set_velocity(&m->scalars, m->middle);
}

/* --- moves ------------------------------------------------------------------------------------------------ */

static cf_status move_velocity(cf_flow *m, const double t, const double dt, bool begun[CF_ADVECT_SCHEMES]) {
  cf_advect *a = m->scalars.by_scheme[m->scheme];
  if (!begun[m->scheme]) CF_TRY(cf_advect_begin(a, t, dt));
  begun[m->scheme] = true;
  cf_advect_velocity(a, &m->walls, m->u);
  cf_flow_hold(m, m->u);
  return CF_OK;
}

/* Half a step of the scalars, and of the velocity where its friction comes between. */
static cf_status move_half(cf_flow *m, const double t, const double dt) {
  bool begun[CF_ADVECT_SCHEMES] = {false};
  CF_TRY(cf_scalars_move(&m->scalars, false, t, dt / 2, begun));
  return m->viscosity != NULL ? move_velocity(m, t, dt / 2, begun) : CF_OK;
}

static cf_status move_whole(cf_flow *m, const double t, const double dt) {
  bool begun[CF_ADVECT_SCHEMES] = {false};
  return m->viscosity == NULL ? move_velocity(m, t, dt, begun) : CF_OK;
}

static cf_status move_paper(cf_flow *m, const double t, const double dt) {
  bool begun[CF_ADVECT_SCHEMES] = {false};
  return cf_scalars_move(&m->scalars, true, t, dt, begun);
}

/* --- accelerations ---------------------------------------------------------------------------------------- */

CF_CLONES static void add_row(const int n, const cf_real w, const cf_real *from, cf_real *to) {
  CF_ROW_LOOP
  for (int i = 0; i < n; ++i) to[i] += w * from[i];
}

static void add_faces(const cf_flow *m, const double w, const cf_face from, const cf_face to) {
  const cf_box *b = &m->grid->box;
  for (int a = 0; a < b->dim; ++a)
    CF_PARALLEL_FACE_ROWS (b, m->grid->threads, a, r) {
      const ptrdiff_t p = cf_box_face_row(b, a, r);
      add_row(cf_box_extent(b, 0, a), (cf_real)w, from.at[a] + p, to.at[a] + p);
    }
}

static void clear_faces(const cf_flow *m, const cf_face f) {
  const cf_box *b = &m->grid->box;
  for (int a = 0; a < b->dim; ++a)
    CF_PARALLEL_FACE_ROWS (b, m->grid->threads, a, r) {
      cf_real *row = f.at[a] + cf_box_face_row(b, a, r);
      for (int i = 0; i < cf_box_extent(b, 0, a); ++i) row[i] = 0;
    }
}

/* to += dt (a - grad p), a with the scalars as they are and the given force at time t. */
static cf_status accelerate(cf_flow *m, const double t, const double dt, const cf_face to) {
  for (int i = 0; m->force != NULL && i < m->scalars.count; ++i)
    if (m->lift[i] != 0) cf_force_lift(m->force, dt, m->lift[i], m->scalars.item[i].phi, to);
  if (m->given_in_time)
    for (int a = 0; a < m->grid->box.dim; ++a)
      CF_TRY(cf_grid_sample(m->grid, &m->scene->flow.force.axis[a].fn, a, t, m->given.at[a]));
  if (m->given.at[0] != NULL) add_faces(m, dt, m->given, to);
  if (m->confine != NULL) cf_confine_push(m->confine, dt, m->u, to);
  cf_project_push(m->project, dt, m->pressure, to);
  return CF_OK;
}

/* Half of what acts in a step: on u itself, or into what friction will take. */
static cf_status push_half(cf_flow *m, const double t, const double dt) {
  if (m->viscosity != NULL) return accelerate(m, t, 0.5, m->push);
  CF_TRY(accelerate(m, t, dt / 2, m->u));
  cf_flow_hold(m, m->u);
  return CF_OK;
}

static cf_status rub(cf_flow *m, const double dt, cf_step_report *report) {
  cf_solve_report solve;
  CF_TRY(cf_viscosity_step(m->viscosity, dt, m->push, m->u, &solve));
  cf_step_report_add(report, CF_STAGE_FORCE, &solve);
  clear_faces(m, m->push);
  return CF_OK;
}

/* --- a step ----------------------------------------------------------------------------------------------- */

static cf_status project(cf_flow *m, const double dt, cf_step_report *report) {
  cf_solve_report solve;
  cf_flow_hold(m, m->u);
  CF_TRY(cf_project_step(m->project, dt, m->pressure, m->u, &solve));
  if (m->solids.changes) cf_project_fill(m->project, m->pressure);
  cf_step_report_add(report, CF_STAGE_PROJECT, &solve);
  return cf_flow_find_rate(m);
}

/* The velocity of a step ago gets ghosts; the others have theirs. */
static cf_status move_points(cf_flow *m, const double t, const double dt) {
  const cf_drift flow = cf_flow_drift(m);
  if (m->points.set == NULL) return CF_OK;
  cf_courant_ghosts(m->grid, flow.wraps, m->before);
  return cf_drifters_step(&m->points, &flow, t, dt);
}

static cf_status flow_step(void *model, const double t, const double dt, cf_step_report *report) {
  cf_flow *m = model;
  const bool sticky = m->viscosity != NULL;
  double clock = cf_stage_clock();
  /* As they were at the end of the last step, or at a resume. */
  if (m->walls_in_time) CF_TRY(cf_flow_walls_at(m, t));
  CF_TRY(cf_flow_place(m, t, dt));
  cf_flow_hold(m, m->u);
  CF_TRY(find_middle(m, dt));
  CF_TRY(cf_scalars_follow(&m->scalars, dt));
  clock = cf_stage_end(report, CF_STAGE_ADVECT, clock);
  if (!sticky) CF_TRY(push_half(m, t, dt));
  clock = cf_stage_end(report, CF_STAGE_FORCE, clock);
  CF_TRY(move_paper(m, t, dt));
  CF_TRY(move_half(m, t, dt));
  clock = cf_stage_end(report, CF_STAGE_ADVECT, clock);
  if (m->walls_in_time) CF_TRY(cf_flow_walls_at(m, t + dt));
  if (sticky) CF_TRY(push_half(m, t + dt / 2, dt));
  clock = cf_stage_end(report, CF_STAGE_FORCE, clock);
  CF_TRY(cf_scalars_diffuse(&m->scalars, t, dt, report));
  clock = cf_stage_end(report, CF_STAGE_DIFFUSE, clock);
  if (sticky) CF_TRY(push_half(m, t + dt / 2, dt));
  if (sticky) CF_TRY(rub(m, dt, report));
  clock = cf_stage_end(report, CF_STAGE_FORCE, clock);
  CF_TRY(move_half(m, t + dt / 2, dt));
  CF_TRY(move_whole(m, t, dt));
  clock = cf_stage_end(report, CF_STAGE_ADVECT, clock);
  CF_TRY(cf_flow_place(m, t + dt, dt));
  if (!sticky) CF_TRY(push_half(m, t + dt, dt));
  clock = cf_stage_end(report, CF_STAGE_FORCE, clock);
  CF_TRY(project(m, dt, report));
  clock = cf_stage_end(report, CF_STAGE_PROJECT, clock);
  CF_TRY(move_points(m, t, dt));
  cf_stage_end(report, CF_STAGE_TRANSFER, clock);
  return CF_OK;
}

/* --- the model -------------------------------------------------------------------------------------------- */

static bool flow_describe(const void *model, const int line, char *text, const size_t size) {
  return cf_scalars_describe(&((const cf_flow *)model)->scalars, line, text, size);
}

static const char *const flow_keys[] = {"flow",    "diffusion", "advection", "fields",    "velocity",
                                        "sources", "sparse",    "points",    "obstacles", NULL};

static const cf_obstacles *flow_obstacles(const void *model) { return &((const cf_flow *)model)->solids; }

const cf_model cf_model_flow = {
    .name = "flow",
    .summary = "an incompressible fluid, and scalars with C-F diffusion that it carries and that move it",
    .keys = flow_keys,
    .resolve = cf_flow_resolve,
    .shows = cf_flow_shows,
    .memory = cf_flow_memory,
    .check = cf_flow_check,
    .create = cf_flow_create,
    .destroy = cf_flow_destroy,
    .restored = cf_flow_restored,
    .natural_dt = cf_flow_natural_dt,
    .describe = flow_describe,
    .step = flow_step,
    .derived = cf_flow_derived,
    .derive = cf_flow_derive,
    .obstacles = flow_obstacles,
    .show = cf_flow_show,
    .metric_names = cf_flow_metric_names,
    .metrics = cf_flow_metrics,
};
