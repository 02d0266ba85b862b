/* SPDX-License-Identifier: MIT
 *
 * One substep of advection: sweeps along the axes (stencil/ppm.h), three stages (stencil/weno5.h), or back along the
 * paths (stencil/trace.h). An axis along which nothing moves is not swept: there every flux is 0, so nothing changes.
 */
#include <string.h>

#include "grid/halo.h"
#include "grid/sweep.h"
#include "physics/advect_part.h"
#include "stencil/trace.h"
#include "stencil/weno5.h"

bool cf_advect_is_traced(const cf_advect *a) {
  return a->scheme == CF_ADVECT_LINEAR || a->scheme == CF_ADVECT_CUBIC;
}

/* Field f of a sweep along s->axis, out of what the sweep before left. */
static void aim(const cf_advect *a, const cf_moved *m, const int f, const bool in_place, cf_ppm_sweep *s) {
  cf_ppm_field *field = &s->field[f];
  cf_real *const scratch = f == 0 ? a->work.at : a->turned.at[0];
  for (int side = 0; side < 2; ++side) {
    field->ghost[side] = m->ghost[s->axis][side];
    field->inflow[side] = m->inflow[s->axis][side];
  }
  field->lines = m->through != NULL && !a->wrap[s->axis] ? a->lines[f] : NULL;
  field->from = s->swept == 0 ? m->at : field->to;
  field->to = in_place ? (cf_real *)field->from : field->from == m->at ? scratch : m->at;
}

static void take_home(const cf_advect *a, const cf_moved *m, const cf_real *from) {
  const cf_box *b = &a->grid->box;
  const ptrdiff_t rows = (ptrdiff_t)m->count[1] * m->count[2];
#pragma omp parallel for schedule(static) num_threads(cf_sweep_threads(b, a->grid->threads))
  for (ptrdiff_t r = 0; r < rows; ++r) {
    const ptrdiff_t p = cf_box_at(b, 0, (int)(r % m->count[1]), (int)(r / m->count[1]));
    memcpy(m->at + p, from + p, (size_t)m->count[0] * sizeof *m->at);
  }
}

/* The axes along which something moves, in the order of this substep. */
static int take_axes(const cf_advect *a, const int substep, int axes[3]) {
  const int dim = a->grid->box.dim;
  const bool reversed = (a->first + substep) % 2 != 0;
  int count = 0;
  for (int i = 0; i < dim; ++i) {
    const int axis = reversed ? dim - 1 - i : i;
    if (!a->still[axis]) axes[count++] = axis;
  }
  return count;
}

/* A sweep an axis, each from one field into the other, so that the last of two ends where the first began. Of one or
 * three the one along x, which may, stays in place. Fields differ in their ghosts alone. */
static void carry(cf_advect *a, const cf_moved *m, const int fields, const int substep) {
  int axes[3];
  const int count = take_axes(a, substep, axes);
  cf_ppm_sweep s = {.grid = a->grid,
                    .component = m->component,
                    .count = {m->count[0], m->count[1], m->count[2]},
                    .half = (cf_real)(a->dt / (2 * a->grid->h)),
                    .u = a->u,
                    .rows = a->rows,
                    .fields = fields};
  for (s.swept = 0; s.swept < count; ++s.swept) {
    s.axis = axes[s.swept];
    s.mass = m->mass && s.swept == count - 1;
    for (int f = 0; f < fields; ++f) aim(a, &m[f], f, s.axis == 0 && count % 2 != 0, &s);
    cf_ppm_sweep_run(&s);
    if (s.swept < 2) s.before[s.swept] = s.axis;
  }
  for (int f = 0; f < fields && count > 0; ++f) {
    if (s.field[f].to != m[f].at) take_home(a, &m[f], s.field[f].to);
    if (m[f].through == NULL) continue;
    m[f].through->entered += s.field[f].entered * cf_grid_volume(a->grid);
    m[f].through->left += s.field[f].left * cf_grid_volume(a->grid);
  }
}

/* Three stages of Runge-Kutta; what passes the walls in them counts 1/6, 1/6 and 2/3. */
static void reconstruct(cf_advect *a, const cf_moved *m) {
  static const double share[3] = {0, 0.75, 1.0 / 3}, weight[3] = {1.0 / 6, 1.0 / 6, 2.0 / 3};
  cf_real *const into[3] = {a->work.at, a->second.at, m->at};
  cf_weno5_stage s = {.grid = a->grid,
                      .component = m->component,
                      .count = {m->count[0], m->count[1], m->count[2]},
                      .mass = m->mass,
                      .half = (cf_real)(a->dt / (2 * a->grid->h)),
                      .u = a->u,
                      .old = m->at,
                      .from = m->at,
                      .rows = a->rows,
                      .lines = m->through != NULL ? a->lines[0] : NULL};
  for (int axis = 0; axis < 3; ++axis)
    for (int side = 0; side < 2; ++side) {
      s.ghost[axis][side] = m->ghost[axis][side];
      s.inflow[axis][side] = m->inflow[axis][side];
    }
  double passed[2] = {0, 0};
  for (int stage = 0; stage < 3; ++stage) {
    s.share = (cf_real)share[stage];
    s.to = into[stage];
    cf_weno5_stage_run(&s, weight[stage], passed);
    s.from = s.to;
  }
  if (m->through == NULL) return;
  m->through->entered += passed[0] * cf_grid_volume(a->grid);
  m->through->left += passed[1] * cf_grid_volume(a->grid);
}

/* The paper's step: back along the path, and linear; or cubic. */
static void trace(cf_advect *a, const cf_moved *m) {
  const cf_box *b = &a->grid->box;
  cf_halo halo = {0};
  cf_trace t = {.grid = a->grid,
                .component = m->component,
                .count = {m->count[0], m->count[1], m->count[2]},
                .dt = a->dt,
                .u = a->u,
                .cubic = a->scheme == CF_ADVECT_CUBIC,
                .from = m->at,
                .to = a->work.at};
  for (int axis = 0; axis < b->dim; ++axis) {
    t.wrap[axis] = a->wrap[axis];
    for (int side = 0; side < 2; ++side) {
      if (m->ghost[axis][side] == CF_GHOST_INFLOW && m->component == CF_CENTRES)
        t.inflow[axis][side] = m->inflow[axis][side];
      halo.rule[axis][side] = t.wrap[axis] ? CF_HALO_WRAP : CF_HALO_COPY;
    }
  }
  cf_halo_fill(b, &halo, t.cubic ? 2 : 1, m->component, m->at);
  cf_trace_run(&t);
  take_home(a, m, a->work.at);
}

void cf_advect_move(cf_advect *a, const cf_moved *m, const int fields, const int substep) {
  if (!cf_advect_is_traced(a) && a->scheme != CF_ADVECT_WENO5) {
    carry(a, m, fields, substep);
    return;
  }
  for (int f = 0; f < fields; ++f)
    if (cf_advect_is_traced(a))
      trace(a, &m[f]);
    else
      reconstruct(a, &m[f]);
}
