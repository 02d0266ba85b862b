/* SPDX-License-Identifier: MIT
 *
 * What a flow tells of itself: metrics, and fields that are no state.
 *
 *     H_c, H_c_NAME   |u|/c of a scalar: where it is above 1 its diffusion cannot run upstream (section 5); 0 for scalars
 *                     without waves
 *     vorticity       |curl u|
 *     speed           |u| at the centres of cells
 */
#include <math.h>
#include <stdio.h>

#include "grid/sweep.h"
#include "model/flow_part.h"
#include "stencil/regime.h"

/* --- derived fields --------------------------------------------------------------------------------------- */

enum { VORTICITY, SPEED, H_C };

bool cf_flow_derived(const void *model, const int i, cf_derived *field) {
  const cf_flow *m = model;
  static const char *const name[] = {"vorticity", "speed"}, *const unit[] = {"1/s", "m/s"};
  *field = (cf_derived){.unit = ""};
  if (i < H_C) {
    snprintf(field->name, sizeof field->name, "%s", name[i]);
    snprintf(field->unit, sizeof field->unit, "%s", unit[i]);
    return true;
  }
  if (i - H_C > m->scalars.count) return false;
  if (i == H_C)
    snprintf(field->name, sizeof field->name, "H_c");
  else
    snprintf(field->name, sizeof field->name, "H_c_%.*s", CF_NAME_MAX - 8, m->scalars.item[i - H_C - 1].name);
  return true;
}

static double speed_at(const cf_flow *m, const ptrdiff_t p) {
  const cf_box *b = &m->grid->box;
  double square = 0;
  for (int a = 0; a < b->dim; ++a) {
    const double u = ((double)m->u.at[a][p] + (double)m->u.at[a][p + b->stride[a]]) / 2;
    square += u * u;
  }
  return sqrt(square);
}

/* 1/c of a scalar, 0 where it has no waves. */
static double slowness(const cf_scalar *s) {
  const double c = s->scene->tau > 0 ? cf_regime_speed(s->D, s->scene->tau, s->scene->f_t) : 0;
  return c > 0 ? 1 / c : 0;
}

cf_status cf_flow_derive(void *model, const int i, const cf_cell out) {
  const cf_flow *m = model;
  const cf_box *b = &m->grid->box;
  if (i == VORTICITY) {
    cf_confine_vorticity(&m->walls, m->u, out);
    return CF_OK;
  }
  const double factor = i == SPEED ? 1 : slowness(&m->scalars.item[i == H_C ? 0 : i - H_C - 1]);
  CF_PARALLEL_ROWS (b, m->grid->threads, r)
    for (int x = 0; x < b->n[0]; ++x) {
      const ptrdiff_t p = cf_box_row(b, r) + x;
      out.at[p] = (cf_real)(factor * speed_at(m, p));
    }
  return CF_OK;
}

/* --- metrics ---------------------------------------------------------------------------------------------- */

static const char *const own[] = {"divergence", "kinetic_energy", "speed_max"};
enum { OWN = 3 };

int cf_flow_metric_names(const void *model, cf_metric *names) {
  const cf_flow *m = model;
  const int count = cf_scalars_metric_names(&m->scalars, names);
  for (int i = 0; i < OWN; ++i) snprintf(names[count + i].name, CF_NAME_MAX, "%s", own[i]);
  return count + OWN + cf_drifters_metric_names(&m->points, names + count + OWN);
}

/* Integral of u^2/2, every component on its own volumes (half ones on walls), and the largest speed at a cell. */
static void find_energy(const cf_flow *m, double *energy, double *most) {
  const cf_box *b = &m->grid->box;
  const ptrdiff_t rows = cf_box_rows(b);
  double *sum = m->scalars.rows, *top = sum + rows;
  CF_PARALLEL_ROWS (b, m->grid->threads, r) {
    double squares = 0, fastest = 0;
    for (int i = 0; i < b->n[0]; ++i) {
      const ptrdiff_t p = cf_box_row(b, r) + i;
      for (int a = 0; a < b->dim; ++a) {
        const double low = (double)m->u.at[a][p], high = (double)m->u.at[a][p + b->stride[a]];
        squares += low * low + high * high;
      }
      fastest = CF_MAX(fastest, speed_at(m, p));
    }
    sum[r] = squares;
    top[r] = fastest;
  }
  *energy = cf_sum_ordered(sum, rows) / 4 * cf_grid_volume(m->grid);
  *most = 0;
  for (ptrdiff_t r = 0; r < rows; ++r) *most = CF_MAX(*most, top[r]);
}

void cf_flow_metrics(const void *model, double *values) {
  const cf_flow *m = model;
  double *v = values + CF_SCALAR_METRICS * m->scalars.count;
  cf_scalars_metrics(&m->scalars, values);
  v[0] = cf_project_divergence(m->project, m->u);
  find_energy(m, &v[1], &v[2]);
  (void)cf_drifters_metrics(&m->points, v + OWN);
}

/* --- points ----------------------------------------------------------------------------------------------- */

cf_drift cf_flow_drift(const cf_flow *m) {
  cf_drift d = {.grid = m->grid, .u = {m->before, m->middle, m->u}};
  for (int a = 0; a < m->grid->box.dim; ++a) {
    d.wraps[a] = m->walls.kind[a][0] == CF_FLOW_PERIODIC;
    for (int side = 0; side < 2; ++side)
      d.open[a][side] = m->walls.kind[a][side] == CF_FLOW_OPEN || m->walls.lets_in[a][side];
  }
  return d;
}

cf_status cf_flow_show(void *model) {
  const cf_flow *m = model;
  const cf_drift flow = cf_flow_drift(m);
  cf_drifters_show(&m->points, &flow);
  return CF_OK;
}
