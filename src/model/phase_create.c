/* SPDX-License-Identifier: MIT
 *
 * Making a crystal: which way its steps are taken, and the state it lives in.
 */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "base/mem.h"
#include "grid/sweep.h"
#include "model/phase_part.h"

/* What a step of implicit stages costs in explicit substeps; measured. */
#define IMPLICIT_COST 6

/* --- the plan --------------------------------------------------------------------------------------------- */

static double step_wanted(const cf_crystal *m, const cf_phase_limits *l) {
  const cf_scene_time *time = &m->scene->time;
  const double dt = isnan(time->dt) ? cf_crystal_step_of(l, time->cfl) : time->dt;
  return fmin(fmin(dt, time->end), time->frames > 0 ? 1 / time->frames : INFINITY);
}

static bool wants_implicit(cf_crystal *m, const cf_phase_limits *l) {
  const int scheme = m->scene->phase.scheme;
  const double n = cf_crystal_substeps(l, step_wanted(m, l));
  m->order = scheme == CF_SCENE_PHASE_EULER ? 1 : 3;
  const char *why = "the scene says so";
  bool implicit = scheme == CF_SCENE_PHASE_IMPLICIT;
  if (scheme == CF_SCENE_PHASE_AUTO) {
    const bool must = m->acts.hold != NULL || m->params.tau_eta == 0;
    implicit = m->params.form != CF_PHASE_PAPER && (must || n > IMPLICIT_COST);
    why = must       ? "T is held somewhere, or tau_eta is 0"
          : implicit ? "explicit substeps would cost more"
                     : "it costs less";
  }
  if (implicit)
    snprintf(m->why, sizeof m->why, "implicit, two stages of the phase and two of heat a step: %s", why);
  else
    snprintf(m->why, sizeof m->why, "explicit, %.0f substep%s of %s a step: %s", n, n == 1 ? "" : "s",
             m->order == 1 ? "first order" : "three stages", why);
  return implicit;
}

/* --- parts ------------------------------------------------------------------------------------------------ */

static cf_status fail_phase(const cf_crystal *m) {
  char why[CF_SENTENCE_MAX];
  snprintf(why, sizeof why, "%s", cf_status_sentence());
  return cf_scene_fail_at(m->scene, "phase", "phase: %s", why);
}

static bool has_own_angles(const cf_scene *scene) {
  for (int i = 0; i < scene->phase.seeds.count; ++i)
    if (scene->phase.seeds.item[i].given.angle) return true;
  return false;
}

static cf_status make_fields(cf_crystal *m) {
  const cf_box *box = &m->grid->box;
  const cf_scene_phase *s = &m->scene->phase;
  const bool grains = has_own_angles(m->scene);
  const bool turns = grains || !cf_crystal_is_constant(m->scene, CF_CRYSTAL_ANGLE) ||
                     !cf_crystal_is_constant(m->scene, CF_CRYSTAL_STRENGTH);
  const bool masked = s->given.mask || s->given.distance || cf_crystal_has_map(m->scene, CF_CRYSTAL_MASK) ||
                      cf_crystal_has_map(m->scene, CF_CRYSTAL_DISTANCE);
  cf_cell *fields[] = {&m->y.eta,
                       &m->y.T,
                       &m->arrival,
                       cf_phase_has_memory(&m->params) ? &m->y.r : NULL,
                       cf_phase_heat_has_memory(&m->params) ? &m->y.w : NULL,
                       grains ? &m->grain : NULL,
                       grains ? &m->next_grain : NULL,
                       turns ? &m->places.strength : NULL,
                       turns ? &m->places.C : NULL,
                       turns ? &m->places.S : NULL,
                       masked ? &m->places.mobility : NULL,
                       s->noise.amplitude > 0 ? &m->places.noise : NULL};
  for (size_t i = 0; i < sizeof fields / sizeof *fields; ++i)
    if (fields[i] != NULL) CF_TRY(cf_cell_create(fields[i], box));
  return CF_OK;
}

CF_CLONES static void join_row(const int n, const cf_real *more, cf_real *W) {
  CF_ROW_LOOP
  for (int i = 0; i < n; ++i) W[i] += more[i];
}

/* dT/dt of a stage of diffusion: what the scene adds, and what freezing gives off. */
static cf_status rate_of_heat(void *context, const double t, const cf_cell W) {
  cf_crystal *m = context;
  const cf_box *box = &m->grid->box;
  if (m->acts.rate != NULL) CF_TRY(m->acts.rate(m->acts.context, t, W));
  CF_PARALLEL_ROWS (box, m->grid->threads, r) {
    const ptrdiff_t p = cf_box_row(box, r);
    if (m->acts.rate != NULL)
      join_row(box->n[0], m->W.at + p, W.at + p);
    else
      memcpy(W.at + p, m->W.at + p, (size_t)box->n[0] * sizeof *W.at);
  }
  return CF_OK;
}

static cf_status hold_of_heat(void *context, const double t, const cf_cell fraction, const cf_cell value) {
  const cf_crystal *m = context;
  return m->acts.hold(m->acts.context, t, fraction, value);
}

static cf_status make_heat(cf_crystal *m) {
  const cf_box *box = &m->grid->box;
  const cf_scene_diffusion *d = &m->scene->fields.item[m->T_field].diffusion;
  const cf_diffuse_params p = {.k = d->k.fn,
                               .capacity = d->capacity.fn,
                               .tau = d->tau,
                               .f_t = d->f_t,
                               .scheme = CF_DIFFUSE_SDIRK2,
                               .solver = m->params.solver,
                               .levels = (int)m->scene->solver.levels};
  const cf_source source = {
      .rate = rate_of_heat, .hold = m->acts.hold != NULL ? hold_of_heat : NULL, .context = m};
  CF_TRY(cf_cell_create(&m->h_now, box));
  CF_TRY(cf_cell_create(&m->h_before, box));
  if (m->y.w.at == NULL) CF_TRY(cf_cell_create(&m->y.w, box)); /* diffusion wants it, and leaves it 0 */
  const cf_status s = cf_diffuse_create(&m->diffuse, m->grid, &m->walls.T, &p, &source);
  return s == CF_BAD_ARGUMENT ? fail_phase(m) : s;
}

static cf_status make_phase(cf_crystal *m) {
  const cf_scene *scene = m->scene;
  cf_status s = cf_phase_create(&m->phase, m->grid, &m->walls, &m->params, &m->places, false);
  /* Which way costs less depends on limits that the explicit object knows. */
  if (s == CF_OK || m->params.tau_eta == 0) {
    cf_phase_limits l = {0};
    if (s == CF_OK) l = cf_phase_limits_of(m->phase);
    m->implicit = wants_implicit(m, &l);
    if (m->implicit) {
      cf_phase_destroy(m->phase);
      s = cf_phase_create(&m->phase, m->grid, &m->walls, &m->params, &m->places, true);
    }
  }
  if (s == CF_BAD_ARGUMENT) return fail_phase(m);
  CF_TRY(s);
  if (!m->implicit && m->acts.hold != NULL)
    return cf_scene_fail_at(scene, "phase.scheme",
                            "phase.scheme: where `sources` hold T, steps must be implicit");
  if (m->implicit || m->acts.rate != NULL) CF_TRY(cf_cell_create(&m->W, &m->grid->box));
  return m->implicit ? make_heat(m) : CF_OK;
}

/* --- the registry ----------------------------------------------------------------------------------------- */

static cf_status register_all(cf_crystal *m, cf_registry *r) {
  const cf_scene *scene = m->scene;
  CF_TRY(cf_registry_add_cell(r, "eta", scene->fields.item[m->eta_field].unit, m->y.eta));
  CF_TRY(cf_registry_add_cell(r, "T", scene->fields.item[m->T_field].unit, m->y.T));
  CF_TRY(cf_registry_add_cell(r, "arrival", "s", m->arrival));
  if (m->y.r.at != NULL) CF_TRY(cf_registry_add_cell(r, "div_q_eta", "", m->y.r));
  if (m->y.w.at != NULL) CF_TRY(cf_registry_add_cell(r, "div_q_T", "", m->y.w));
  if (m->grain.at != NULL) CF_TRY(cf_registry_add_cell(r, "grain", "", m->grain));
  if (m->h_before.at != NULL) CF_TRY(cf_registry_add_cell(r, "enthalpy_before", "", m->h_before));
  if (m->h_before.at != NULL) CF_TRY(cf_registry_add_numbers(r, "dt_before", "s", &m->dt_before, 1));
  if (m->window_axis >= 0) CF_TRY(cf_registry_add_numbers(r, "window_cells", "", &m->window_cells, 1));
  if (m->moves) CF_TRY(cf_registry_add_face(r, "velocity", "m/s", m->u));
  if (m->moves) CF_TRY(cf_registry_add_counter(r, "sweep_parity", cf_advect_parity(m->carry)));
  return cf_registry_add_numbers(r, "ledger_heat", "", &m->heat.first, 3);
}

static const char *const followed[] = {"x+", "y+", "z+"};

static cf_status make(cf_crystal *m, cf_registry *r) {
  const cf_scene *scene = m->scene;
  m->eta_field = cf_scene_field_index(scene, "eta");
  m->T_field = cf_scene_field_index(scene, "T");
  m->params = cf_crystal_params_at(scene, 0);
  m->scheduled = cf_crystal_is_scheduled(scene);
  m->walls.eta = scene->fields.item[m->eta_field].walls.walls;
  m->walls.T = scene->fields.item[m->T_field].walls.walls;
  m->noise_of = -1;
  m->window_axis = -1;
  for (int a = 0; a < scene->dim; ++a)
    if (strcmp(scene->phase.window.follow, followed[a]) == 0) m->window_axis = a;
  m->now = cf_registry_find(r, "time")->number;
  CF_TRY(CF_NEW(&m->rows, 3 * cf_box_rows(&m->grid->box)));
  CF_TRY(make_fields(m));
  CF_TRY(cf_crystal_read_maps(scene, m->map));
  CF_TRY(cf_sources_create(&m->sources, scene, m->grid, m->T_field, "q_T", &m->acts));
  CF_TRY(cf_crystal_seed(m));
  CF_TRY(cf_crystal_make_places(m));
  CF_TRY(make_phase(m));
  CF_TRY(cf_crystal_make_flow(m));
  cf_crystal_note_arrival(m, 0);
  m->heat.first = cf_phase_heat_content(m->phase, &m->y);
  return register_all(m, r);
}

void cf_crystal_destroy(void *model) {
  cf_crystal *m = model;
  if (m == NULL) return;
  const cf_box *box = &m->grid->box;
  cf_cell *cells[] = {&m->y.eta,
                      &m->y.r,
                      &m->y.T,
                      &m->y.w,
                      &m->grain,
                      &m->next_grain,
                      &m->arrival,
                      &m->W,
                      &m->h_now,
                      &m->h_before,
                      &m->places.C,
                      &m->places.S,
                      &m->places.strength,
                      &m->places.mobility,
                      &m->places.noise};
  for (size_t i = 0; i < sizeof cells / sizeof *cells; ++i) cf_cell_destroy(cells[i], box);
  cf_crystal_drop_maps(m->map);
  cf_face_destroy(&m->u, box);
  cf_advect_destroy(m->carry);
  cf_diffuse_destroy(m->diffuse);
  cf_sources_destroy(m->sources);
  cf_phase_destroy(m->phase);
  cf_free(m->rows);
  cf_free(m);
}

cf_status cf_crystal_create(void **model, const cf_scene *scene, cf_registry *registry) {
  cf_crystal *m;
  CF_TRY(CF_NEW(&m, 1));
  m->scene = scene;
  m->still = *registry->grid;
  m->grid = &m->still;
  const cf_status s = make(m, registry);
  if (s != CF_OK) {
    cf_crystal_destroy(m);
    return s;
  }
  *model = m;
  return CF_OK;
}
