/* SPDX-License-Identifier: MIT
 *
 * What moves: the medium, with phase and heat or with heat alone, and the box, after the tip.
 *
 * A wall that is insulated for diffusion does not stop a prescribed flow: through it comes what is far off, eta = 0
 * and the first T. The memories r and w come in as 0.
 */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "grid/sweep.h"
#include "model/phase_part.h"
#include "model/scalars.h"

/* --- the flow --------------------------------------------------------------------------------------------- */

static const cf_function *velocity_of(const cf_scene *scene, const int axis) {
  return &scene->velocity.axis[scene->velocity.count > 1 ? axis : 0];
}

cf_status cf_crystal_set_flow(cf_crystal *m, const double t) {
  const cf_grid at = cf_crystal_window(m);
  for (int a = 0; a < at.box.dim; ++a)
    CF_TRY(cf_grid_sample(&at, &velocity_of(m->scene, a)->fn, a, t, m->u.at[a]));
  return cf_advect_set_velocity(m->carry, m->u, &m->scene->domain.walls.walls);
}

static void let_in(cf_walls *walls, const double far) {
  for (int a = 0; a < 3; ++a)
    for (int side = 0; side < 2; ++side) {
      if (walls->kind[a][side] != CF_WALL_INSULATED) continue;
      walls->kind[a][side] = CF_WALL_VALUE;
      walls->value[a][side] = (cf_fn){.value = far};
    }
}

cf_status cf_crystal_make_flow(cf_crystal *m) {
  for (int a = 0; a < m->grid->box.dim; ++a) {
    const cf_fn *f = &velocity_of(m->scene, a)->fn;
    m->moves = m->moves || f->eval != NULL || f->value != 0;
    m->velocity_in_time = m->velocity_in_time || f->in_time;
  }
  if (!m->moves) return CF_OK;
  m->carried_eta = m->carried_memory = m->walls.eta;
  m->carried_T = m->walls.T;
  let_in(&m->carried_eta, 0);
  let_in(&m->carried_T, cf_crystal_far_T(m));
  let_in(&m->carried_memory, 0);
  CF_TRY(cf_face_create(&m->u, &m->grid->box));
  CF_TRY(cf_advect_create(&m->carry, m->grid, cf_scalars_scheme(m->scene->advection.scheme)));
  return cf_crystal_set_flow(m, 0);
}

cf_status cf_crystal_move(cf_crystal *m, const double t, const double dt, cf_step_report *report) {
  cf_through T = {0, 0}, eta = {0, 0};
  (void)report;
  if (!m->moves) return CF_OK;
  if (m->velocity_in_time) CF_TRY(cf_crystal_set_flow(m, t + dt / 2));
  CF_TRY(cf_advect_begin(m->carry, t, dt));
  const cf_carried warm[] = {{&m->carried_T, m->y.T, &T}, {&m->carried_memory, m->y.w, NULL}};
  const cf_carried solid[] = {{&m->carried_eta, m->y.eta, &eta}, {&m->carried_memory, m->y.r, NULL}};
  CF_TRY(cf_advect_cells(m->carry, warm, m->y.w.at != NULL ? 2 : 1));
  if (m->scene->phase.carried == CF_SCENE_PHASE_BOTH)
    CF_TRY(cf_advect_cells(m->carry, solid, m->y.r.at != NULL ? 2 : 1));
  m->dt_before = 0; /* T - K eta has moved: nothing to extrapolate from */
  cf_ledger_add(&m->heat, (T.entered - T.left) - m->params.latent * (eta.entered - eta.left));
  return CF_OK;
}

/* --- the window ------------------------------------------------------------------------------------------- */

/* Everything moves down axis a by `cells`; what is new has the value `far`. */
static void shift(const cf_crystal *m, const cf_cell f, const int a, const int cells, const double far) {
  const cf_box *box = &m->grid->box;
  if (f.at == NULL) return;
  for (int k = 0; k < box->n[2]; ++k)
    for (int j = 0; j < box->n[1]; ++j) {
      const int at[3] = {0, j, k}, kept = a == 0                      ? box->n[0] - cells
                                          : at[a] + cells < box->n[a] ? box->n[0]
                                                                      : 0;
      cf_real *row = f.at + cf_box_at(box, 0, j, k);
      if (kept > 0) memmove(row, row + cells * box->stride[a], (size_t)kept * sizeof *row);
      for (int i = kept; i < box->n[0]; ++i) row[i] = (cf_real)far;
    }
}

cf_status cf_crystal_follow(cf_crystal *m) {
  const int a = m->window_axis;
  const cf_box *box = &m->grid->box;
  double where[3];
  if (a < 0) return CF_OK;
  const double reach = cf_phase_tip(m->phase, m->y.eta, m->grid->origin, a, where);
  const int cells = (int)ceil((reach - m->scene->phase.window.at * box->n[a] * m->grid->h) / m->grid->h);
  if (cells <= 0) return CF_OK;
  const int by = cells < box->n[a] ? cells : box->n[a] - 1;
  const double T = cf_crystal_far_T(m), before = cf_phase_heat_content(m->phase, &m->y);
  shift(m, m->y.eta, a, by, 0);
  shift(m, m->y.r, a, by, 0);
  shift(m, m->y.T, a, by, T);
  shift(m, m->y.w, a, by, 0);
  shift(m, m->h_before, a, by, T);
  shift(m, m->arrival, a, by, -1);
  shift(m, m->grain, a, by, 0);
  m->window_cells += by;
  m->noise_of = -1;
  cf_ledger_add(&m->heat, cf_phase_heat_content(m->phase, &m->y) - before);
  if (m->moves && !m->velocity_in_time) CF_TRY(cf_crystal_set_flow(m, 0));
  return cf_crystal_make_places(m);
}
