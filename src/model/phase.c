/* SPDX-License-Identifier: MIT
 *
 * Model `phase`: crystals and coral, section 7 of the paper in the form of physics/phase.h: the phase eta and the
 * temperature T, both with memory, in a medium that may move (D/Dt, with D eta/Dt as the source of heat).
 *
 * A step is Strang's where something moves: half a move, growth, half a move. Growth is explicit for phase and
 * heat together, or implicit: the phase by two stages of its own, then heat by those of physics/diffuse.h with
 * K (eta_new - eta_old)/dt as its source, so that T - K eta is kept to round-off either way.
 */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "grid/sweep.h"
#include "model/phase_part.h"

/* Explicit substeps stay this far below their limit. */
#define MARGIN 0.95

/* --- parameters ------------------------------------------------------------------------------------------- */

static double at_time(const cf_function *f, const double t) { return cf_fn_at(&f->fn, 0, 0, 0, t); }

bool cf_crystal_is_scheduled(const cf_scene *scene) {
  const cf_scene_phase *p = &scene->phase;
  return p->tau_eta.fn.in_time || p->tau_1.fn.in_time || p->alpha.fn.in_time || p->gamma.fn.in_time;
}

static cf_anisotropy_params anisotropy_of(const cf_scene *scene) {
  const cf_scene_phase_anisotropy *a = &scene->phase.anisotropy;
  const double pi = acos(-1);
  cf_anisotropy_params p = {.angle = cf_fn_at(&a->angle.fn, 0, 0, 0, 0) * pi / 180};
  if (!cf_crystal_is_constant(scene, CF_CRYSTAL_ANGLE)) p.angle = 0;
  p.printed = a->pole == CF_SCENE_PHASE_PRINTED;
  p.polar_n = (int)a->polar_folds;
  p.polar_strength = a->polar_strength;
  if (a->law == CF_SCENE_PHASE_NONE || a->law == CF_SCENE_PHASE_DRIVING) return p;
  p.cubic = a->law == CF_SCENE_PHASE_CUBIC;
  p.n = p.cubic ? 4 : (int)a->folds;
  p.strength = cf_crystal_is_constant(scene, CF_CRYSTAL_STRENGTH) ? a->strength.fn.value : 0;
  return p;
}

cf_phase_params cf_crystal_params_at(const cf_scene *scene, const double t) {
  const cf_scene_phase *p = &scene->phase;
  const cf_scene_diffusion *heat = &scene->fields.item[cf_scene_field_index(scene, "T")].diffusion;
  const bool driving = p->anisotropy.law == CF_SCENE_PHASE_DRIVING;
  return (cf_phase_params){
      .form = p->form == CF_SCENE_PHASE_PAPER ? CF_PHASE_PAPER : CF_PHASE_STABLE,
      .plain = p->stencil == CF_SCENE_PHASE_FIVE_POINT,
      .width = p->width,
      .tau_eta = at_time(&p->tau_eta, t),
      .tau_1 = at_time(&p->tau_1, t),
      .f_eta = p->f_eta,
      .alpha = at_time(&p->alpha, t),
      .gamma = at_time(&p->gamma, t),
      .drive_strength = !driving                                             ? 0
                        : cf_crystal_is_constant(scene, CF_CRYSTAL_STRENGTH) ? p->anisotropy.strength.fn.value
                                                                             : 1,
      .karma_rappel = p->driving == CF_SCENE_PHASE_KARMA_RAPPEL,
      .coupling = p->coupling,
      .anisotropy = anisotropy_of(scene),
      .star = p->star,
      .latent = p->latent,
      .D = heat->k.fn.value,
      .tau_2 = heat->tau,
      .f_t = heat->f_t,
      .solver = {scene->solver.tolerance, (int)scene->solver.max_iterations},
  };
}

/* --- how long a step is ----------------------------------------------------------------------------------- */

double cf_crystal_step_of(const cf_phase_limits *l, const double cfl) {
  return l->reaction > 0 ? cfl * l->reaction : cfl * l->heat;
}

int cf_crystal_substeps(const cf_phase_limits *l, const double dt) {
  const double n = ceil(dt / (MARGIN * l->both) * (1 - 1e-12));
  return n > 1 ? (int)fmin(n, 1e6) : 1;
}

double cf_crystal_natural_dt(const void *model, const double t) {
  const cf_crystal *m = model;
  const cf_phase_limits l = cf_phase_limits_of(m->phase);
  const double cfl = m->scene->time.cfl, rate = m->moves ? cf_advect_rate(m->carry) : 0;
  double dt = cf_crystal_step_of(&l, cfl);
  (void)t;
  if (m->order == 1 && !m->implicit) dt = fmin(dt, cfl * l.both);
  if (rate > 0) dt = fmin(dt, cfl / rate);
  return fmin(dt, m->scene->time.end / 10);
}

/* --- growth ----------------------------------------------------------------------------------------------- */

static double integral(const cf_crystal *m, const cf_cell f) {
  return cf_sweep_sum(&m->grid->box, m->grid->threads, f.at, m->rows) * cf_grid_volume(m->grid);
}

static cf_status grow_explicitly(cf_crystal *m, const double t, const double dt) {
  const cf_phase_limits l = cf_phase_limits_of(m->phase);
  cf_phase_explicit how = {
      m->order, cf_crystal_substeps(&l, dt * (m->order == 1 ? 1.3 : 1)), {NULL}, m->moves};
  if (m->acts.rate != NULL) {
    CF_TRY(m->acts.rate(m->acts.context, t + dt / 2, m->W));
    how.W = m->W;
    cf_ledger_add(&m->heat, dt * integral(m, m->W));
  }
  double through = 0;
  CF_TRY(cf_phase_step_explicit(m->phase, t, dt, &how, &m->y, &through));
  cf_ledger_add(&m->heat, through);
  return CF_OK;
}

CF_CLONES static void enthalpy_row(const int n, const cf_real K, const cf_real *T, const cf_real *eta,
                                   cf_real *h) {
  CF_ROW_LOOP
  for (int i = 0; i < n; ++i) h[i] = T[i] - K * eta[i];
}

/* W = eta, h = T - K eta. */
static void remember(cf_crystal *m) {
  const cf_box *box = &m->grid->box;
  CF_PARALLEL_ROWS (box, m->grid->threads, r) {
    const ptrdiff_t p = cf_box_row(box, r);
    memcpy(m->W.at + p, m->y.eta.at + p, (size_t)box->n[0] * sizeof *m->W.at);
    enthalpy_row(box->n[0], (cf_real)m->params.latent, m->y.T.at + p, m->y.eta.at + p, m->h_now.at + p);
  }
}

CF_CLONES static void release_row(const int n, const cf_real per, const cf_real *eta, cf_real *W) {
  CF_ROW_LOOP
  for (int i = 0; i < n; ++i) W[i] = per * (eta[i] - W[i]);
}

/* W = K (eta - W)/dt: what freezing gives off; h becomes the one before. Returns the integral of W. */
static double release(cf_crystal *m, const double dt) {
  const cf_box *box = &m->grid->box;
  CF_PARALLEL_ROWS (box, m->grid->threads, r) {
    const ptrdiff_t p = cf_box_row(box, r);
    release_row(box->n[0], (cf_real)(m->params.latent / dt), m->y.eta.at + p, m->W.at + p);
    m->rows[r] = cf_sweep_row_sum(box->n[0], m->W.at + p);
    memcpy(m->h_before.at + p, m->h_now.at + p, (size_t)box->n[0] * sizeof *m->h_now.at);
  }
  return cf_sum_ordered(m->rows, cf_box_rows(box)) * cf_grid_volume(m->grid);
}

static cf_status grow_implicitly(cf_crystal *m, const double t, const double dt, cf_step_report *report) {
  cf_solve_report one;
  cf_ledger moved = {0, 0, 0};
  remember(m);
  const cf_phase_heat heat = {m->h_now, m->h_before, m->dt_before};
  CF_TRY(cf_phase_step_implicit(m->phase, t, dt, &heat, m->y.eta, m->y.r, &one));
  cf_step_report_add(report, CF_STAGE_REACT, &one);
  const double freed = release(m, dt);
  m->dt_before = dt;
  CF_TRY(cf_diffuse_step_scalar(m->diffuse, t, dt, m->y.T, m->y.w, &moved, &one));
  cf_step_report_add(report, CF_STAGE_DIFFUSE, &one);
  cf_ledger_add(&m->heat, moved.entered - moved.left - dt * freed);
  return CF_OK;
}

/* --- a step ----------------------------------------------------------------------------------------------- */

static cf_status crystal_step(void *model, const double t, const double dt, cf_step_report *report) {
  cf_crystal *m = model;
  double clock = cf_stage_clock();
  if (m->scheduled) {
    m->params = cf_crystal_params_at(m->scene, t + dt / 2);
    CF_TRY(cf_phase_set(m->phase, &m->params));
  }
  cf_crystal_make_noise(m, t);
  CF_TRY(cf_crystal_move(m, t, dt / 2, report));
  clock = cf_stage_end(report, CF_STAGE_ADVECT, clock);
  if (m->implicit)
    CF_TRY(grow_implicitly(m, t, dt, report));
  else
    CF_TRY(grow_explicitly(m, t, dt));
  clock = cf_stage_end(report, CF_STAGE_REACT, clock);
  CF_TRY(cf_crystal_move(m, t + dt / 2, dt / 2, report));
  clock = cf_stage_end(report, CF_STAGE_ADVECT, clock);
  cf_crystal_grow_grains(m);
  cf_crystal_note_arrival(m, t + dt);
  const cf_status s = cf_crystal_follow(m);
  cf_stage_end(report, CF_STAGE_OTHER, clock);
  return s;
}

/* Orientations follow from the grains and the window. */
static cf_status crystal_restored(void *model) {
  cf_crystal *m = model;
  m->noise_of = -1;
  CF_TRY(cf_crystal_make_places(m));
  return m->moves ? cf_advect_set_velocity(m->carry, m->u, &m->scene->domain.walls.walls) : CF_OK;
}

static void crystal_moved(const void *model, double by[3]) {
  const cf_crystal *m = model;
  if (m->window_axis >= 0) by[m->window_axis] = m->window_cells * m->grid->h;
}

static bool crystal_describe(const void *model, const int line, char *text, const size_t size) {
  const cf_crystal *m = model;
  if (line > 0) return false;
  snprintf(text, size, "phase and heat: %s", m->why);
  return true;
}

static const char *const crystal_keys[] = {"phase",     "fields",  "diffusion", "velocity",
                                           "advection", "sources", NULL};
static const char *const crystal_fields[] = {"eta", "T", NULL};
static const char *const crystal_outputs[] = {"eta", "T", NULL};

const cf_model cf_model_phase = {
    .name = "phase",
    .summary = "crystals that grow into what is colder than their melting point",
    .keys = crystal_keys,
    .fields = crystal_fields,
    .outputs = crystal_outputs,
    .resolve = cf_crystal_resolve,
    .shows = cf_crystal_shows,
    .memory = cf_crystal_memory,
    .law = cf_crystal_law,
    .check = cf_crystal_check,
    .create = cf_crystal_create,
    .destroy = cf_crystal_destroy,
    .restored = crystal_restored,
    .moved = crystal_moved,
    .natural_dt = cf_crystal_natural_dt,
    .describe = crystal_describe,
    .step = crystal_step,
    .derived = cf_crystal_derived,
    .derive = cf_crystal_derive,
    .mesh = cf_crystal_mesh,
    .metric_names = cf_crystal_metric_names,
    .metrics = cf_crystal_metrics,
};
