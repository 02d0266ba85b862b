/* SPDX-License-Identifier: MIT
 *
 * What a crystal shows: fields worked out from its state, its surface, and a line of metrics a step.
 */
#include <math.h>
#include <stdio.h>

#include "grid/halo.h"
#include "grid/isosurface.h"
#include "grid/sweep.h"
#include "model/phase_part.h"

enum { AGE, THICKNESS, HEAT_FLUX, PSI, SHOWN };

bool cf_crystal_derived(const void *model, const int i, cf_derived *field) {
  static const cf_derived all[SHOWN] = {{"age", "s"}, {"thickness", "m"}, {"heat_flux", ""}, {"psi", ""}};
  (void)model;
  if (i >= SHOWN) return false;
  *field = all[i];
  return true;
}

static double age_at(const cf_crystal *m, const ptrdiff_t p) {
  const double arrival = (double)m->arrival.at[p];
  return arrival >= 0 ? fmax(0, *m->now - arrival) : 0;
}

/* Of a flake in 2D: what froze first has had the longest to thicken; thin at the rim, where eta falls off. */
static double thickness_at(const cf_crystal *m, const ptrdiff_t p) {
  const double eta = fmax(0, fmin(1, (double)m->y.eta.at[p]));
  return eta * sqrt(2 * m->scene->phase.thickening * (age_at(m, p) + m->scene->time.end / 400));
}

/* k |grad T|, by central differences. */
static double flux_at(const cf_crystal *m, const ptrdiff_t p) {
  const cf_box *box = &m->grid->box;
  double sum = 0;
  for (int a = 0; a < box->dim; ++a) {
    const double d =
        (double)(m->y.T.at[p + box->stride[a]] - m->y.T.at[p - box->stride[a]]) / (2 * m->grid->h);
    sum += d * d;
  }
  return m->params.D * sqrt(sum);
}

static double psi_at(const cf_crystal *m, const ptrdiff_t p) {
  const double T = (double)m->y.T.at[p], e = (double)m->y.eta.at[p];
  if (m->params.karma_rappel) return -2 * m->params.coupling * T * e * (1 - e);
  return -m->params.alpha / acos(-1) * atan(m->params.gamma * T);
}

static double shown_at(const cf_crystal *m, const int i, const ptrdiff_t p) {
  if (i == AGE) return age_at(m, p);
  if (i == THICKNESS) return thickness_at(m, p);
  return i == HEAT_FLUX ? flux_at(m, p) : psi_at(m, p);
}

cf_status cf_crystal_derive(void *model, const int i, const cf_cell out) {
  const cf_crystal *m = model;
  const cf_box *box = &m->grid->box;
  cf_halo halo = {0};
  for (int a = 0; a < box->dim; ++a)
    for (int side = 0; side < 2; ++side)
      halo.rule[a][side] = m->walls.T.kind[a][side] == CF_WALL_PERIODIC ? CF_HALO_WRAP : CF_HALO_COPY;
  if (i == HEAT_FLUX) cf_halo_fill(box, &halo, 1, CF_CENTRES, m->y.T.at);
  CF_PARALLEL_ROWS (box, m->grid->threads, r) {
    const ptrdiff_t start = cf_box_row(box, r);
    for (int c = 0; c < box->n[0]; ++c) out.at[start + c] = (cf_real)shown_at(m, i, start + c);
  }
  return CF_OK;
}

/* The surface eta = 1/2, always by the same rule, with the age, temperature and heat flux at its vertices. */
cf_status cf_crystal_mesh(void *model, struct cf_mesh *mesh) {
  cf_crystal *m = model;
  const cf_grid at = cf_crystal_window(m);
  if (m->grid->box.dim == 2) return cf_mesh_resize(mesh, 0, 0, false);
  CF_TRY(cf_isosurface_make(mesh, &at, m->y.eta, &(cf_isosurface){.level = 0.5, .caps = true}));
  CF_TRY(cf_mesh_sample(mesh, &at, m->y.T, "T", "K"));
  CF_TRY(cf_mesh_sample(mesh, &at, m->arrival, "arrival", "s"));
  static const struct {
    int what;
    const char *name, *unit;
  } more[] = {{AGE, "age", "s"}, {HEAT_FLUX, "flux", ""}};
  for (size_t i = 0; i < sizeof more / sizeof *more; ++i) {
    cf_cell values;
    CF_TRY(cf_cell_create(&values, &m->grid->box));
    cf_status s = cf_crystal_derive(m, more[i].what, values);
    if (s == CF_OK) s = cf_mesh_sample(mesh, &at, values, more[i].name, more[i].unit);
    cf_cell_destroy(&values, &m->grid->box);
    CF_TRY(s);
  }
  return CF_OK;
}

/* --- metrics ---------------------------------------------------------------------------------------------- */

static const char *const metric_names[] = {"sum_eta", "min_eta",    "max_eta", "sum_T",  "min_T",
                                           "max_T",   "error_heat", "solid",   "energy", "tip",
                                           "tip_x",   "tip_y",      "tip_z"};

int cf_crystal_metric_names(const void *model, cf_metric *names) {
  const cf_crystal *m = model;
  const int count = (int)(sizeof metric_names / sizeof *metric_names) - (m->grid->box.dim == 2 ? 1 : 0);
  for (int i = 0; i < count; ++i) snprintf(names[i].name, CF_NAME_MAX, "%s", metric_names[i]);
  return count;
}

void cf_crystal_metrics(const void *model, double *values) {
  const cf_crystal *m = model;
  const cf_box *box = &m->grid->box;
  const double volume = cf_grid_volume(m->grid);
  const cf_range eta = cf_sweep_range(box, m->grid->threads, m->y.eta.at, m->rows);
  const cf_range T = cf_sweep_range(box, m->grid->threads, m->y.T.at, m->rows);
  const double from[3] = {cf_crystal_centre(m, 0), cf_crystal_centre(m, 1), cf_crystal_centre(m, 2)};
  double where[3];
  values[0] = eta.sum * volume, values[1] = eta.min, values[2] = eta.max;
  values[3] = T.sum * volume, values[4] = T.min, values[5] = T.max;
  values[6] = cf_ledger_error(&m->heat, cf_phase_heat_content(m->phase, &m->y));
  values[7] = eta.sum / (double)cf_box_cells(box);
  values[8] = cf_phase_energy(m->phase, &m->y);
  values[9] = cf_phase_tip(m->phase, m->y.eta, from, -1, where);
  for (int a = 0; a < box->dim; ++a)
    values[10 + a] = where[a] + (a == m->window_axis ? m->window_cells * m->grid->h : 0);
}
