/* SPDX-License-Identifier: MIT */
#include <math.h>

#include "base/mem.h"
#include "grid/halo.h"
#include "physics/advect_part.h"
#include "stencil/courant.h"
#include "stencil/stretch.h"
#include "stencil/weno5.h"

#define SAFE_K 0.9 /* at K = 1 all of a cell may be gone after the first sweeps, and rho = 0 */

/* --- making one --------------------------------------------------------------------------------------- */

static cf_status take_scratch(cf_advect *a) {
  const cf_box *b = &a->grid->box;
  CF_TRY(cf_cell_create(&a->work, b));
  CF_TRY(cf_face_create(&a->turned, b));
  const bool weno5 = a->scheme == CF_ADVECT_WENO5;
  if (weno5) CF_TRY(cf_cell_create(&a->second, b));
  CF_TRY(CF_NEW(&a->rows, (weno5 ? cf_weno5_rows(a->grid) : cf_ppm_rows(a->grid)) * a->grid->threads));
  for (int f = 0; f < CF_PPM_FIELDS; ++f) {
    CF_TRY(CF_NEW(&a->lines[f], weno5 ? cf_weno5_lines(a->grid) : cf_ppm_lines(a->grid)));
    for (int axis = 0; axis < b->dim; ++axis)
      for (int side = 0; side < 2; ++side) {
        const cf_wall_side w = cf_wall_side_of(b, axis, side);
        CF_TRY(CF_NEW(&a->walls[f].at[axis][side], (size_t)w.n_b * (size_t)w.n_c));
      }
  }
  return CF_OK;
}

static void set_grid(cf_advect *a, const cf_grid *g) {
  a->grid = g;
  for (int f = 0; f < CF_PPM_FIELDS; ++f) a->walls[f].grid = g;
}

cf_status cf_advect_create(cf_advect **advect, const cf_grid *g, const cf_advect_scheme scheme) {
  *advect = NULL;
  cf_advect *a;
  CF_TRY(CF_NEW(&a, 1));
  set_grid(a, g);
  a->scheme = scheme;
  a->substeps = 1;
  const cf_status s = take_scratch(a);
  if (s != CF_OK) {
    cf_advect_destroy(a);
    return s;
  }
  *advect = a;
  return CF_OK;
}

void cf_advect_destroy(cf_advect *a) {
  if (a == NULL) return;
  cf_cell_destroy(&a->work, &a->grid->box);
  cf_cell_destroy(&a->second, &a->grid->box);
  cf_face_destroy(&a->turned, &a->grid->box);
  cf_free(a->rows);
  for (int f = 0; f < CF_PPM_FIELDS; ++f) {
    cf_free(a->lines[f]);
    cf_wall_values_destroy(&a->walls[f]);
  }
  cf_free(a);
}

/* --- the velocity and the step ------------------------------------------------------------------------ */

cf_status cf_advect_set_velocity(cf_advect *a, const cf_face u, const cf_walls *walls) {
  a->u = u;
  for (int axis = 0; axis < a->grid->box.dim; ++axis)
    a->wrap[axis] = walls->kind[axis][0] == CF_WALL_PERIODIC;
  cf_courant_ghosts(a->grid, a->wrap, u);
  for (int axis = 0; axis < a->grid->box.dim; ++axis) a->still[axis] = cf_courant_still(a->grid, u, axis);
  return cf_courant_rate(a->grid, u, &a->rate);
}

double cf_advect_rate(const cf_advect *a) { return a->rate; }

double cf_advect_substeps(const cf_advect *a, const double dt) {
  /* K is the most that one axis carries off; all axes at once can do so much each. */
  const int axes = a->scheme == CF_ADVECT_WENO5 ? a->grid->box.dim : 1;
  const double wanted = ceil(axes * a->rate * dt / SAFE_K);
  return cf_advect_is_traced(a) || wanted < 1 ? 1 : wanted;
}

int64_t *cf_advect_parity(cf_advect *a) { return &a->parity; }

cf_status cf_advect_begin(cf_advect *a, const double t, const double dt) {
  if (!(dt >= 0)) return cf_fail(CF_BAD_ARGUMENT, "a step of %g s: must be >= 0", dt);
  const double substeps = cf_advect_substeps(a, dt);
  if (!(substeps <= CF_ADVECT_SUBSTEPS_MAX))
    return cf_fail(CF_OVER_LIMIT,
                   "a step of %g s carries things through %g cells, in %g substeps: more than %d; shorten dt",
                   dt, a->rate * dt, substeps, CF_ADVECT_SUBSTEPS_MAX);
  a->substeps = (int)substeps;
  a->time = t;
  a->dt = dt / substeps;
  a->first = a->parity;
  a->parity += a->substeps;
  return CF_OK;
}

/* --- cells -------------------------------------------------------------------------------------------- */

static cf_ghost ghost_of_cells(const cf_wall kind) {
  if (kind == CF_WALL_PERIODIC) return CF_GHOST_WRAP;
  return kind == CF_WALL_INSULATED ? CF_GHOST_MIRROR : CF_GHOST_INFLOW;
}

/* What flows in through the walls of a field: 0 where open, else the wall's function. */
static void take_walls(const cf_box *b, const cf_walls *walls, cf_wall_values *v) {
  v->walls = *walls;
  v->known = false;
  for (int axis = 0; axis < b->dim; ++axis)
    for (int side = 0; side < 2; ++side) {
      const cf_wall_side w = cf_wall_side_of(b, axis, side);
      cf_wall *kind = &v->walls.kind[axis][side];
      if (*kind == CF_WALL_RADIATE) *kind = CF_WALL_VALUE;
      if (*kind != CF_WALL_OPEN) continue;
      for (ptrdiff_t i = 0; i < (ptrdiff_t)w.n_b * w.n_c; ++i) v->at[axis][side][i] = 0;
    }
}

/* A field that wraps where the velocity does not, or the reverse, has no meaning. */
static cf_status check_walls(const cf_advect *a, const cf_walls *walls) {
  for (int axis = 0; axis < a->grid->box.dim; ++axis)
    for (int side = 0; side < 2; ++side)
      if ((walls->kind[axis][side] == CF_WALL_PERIODIC) != a->wrap[axis])
        return cf_fail(CF_BAD_ARGUMENT,
                       "walls of axis %c: periodic for the velocity or for what it carries, but not for both",
                       "xyz"[axis]);
  return CF_OK;
}

static cf_moved moved_of(const cf_advect *a, const cf_carried *f, const cf_wall_values *v) {
  const int *n = a->grid->box.n;
  cf_moved m = {.component = CF_CENTRES,
                .count = {n[0], n[1], n[2]},
                .mass = true,
                .at = f->phi.at,
                .through = f->through};
  for (int axis = 0; axis < 3; ++axis)
    for (int side = 0; side < 2; ++side) {
      m.ghost[axis][side] = ghost_of_cells(f->walls->kind[axis][side]);
      m.inflow[axis][side] = v->at[axis][side];
    }
  return m;
}

cf_status cf_advect_cells(cf_advect *a, const cf_carried *f, const int count) {
  cf_moved m[CF_PPM_FIELDS];
  for (int i = 0; i < count; ++i) {
    CF_TRY(check_walls(a, f[i].walls));
    take_walls(&a->grid->box, f[i].walls, &a->walls[i]);
    m[i] = moved_of(a, &f[i], &a->walls[i]);
  }
  for (int substep = 0; substep < a->substeps; ++substep) {
    for (int i = 0; i < count; ++i) cf_wall_values_sample(&a->walls[i], a->time + (substep + 0.5) * a->dt);
    cf_advect_move(a, m, count, substep);
  }
  return CF_OK;
}

cf_status cf_advect_cell(cf_advect *a, const cf_walls *walls, const cf_cell phi, cf_through *through) {
  return cf_advect_cells(a, &(cf_carried){walls, phi, through}, 1);
}

cf_status cf_advect_cells_in(cf_advect *a, const cf_grid *part, const ptrdiff_t corner, const cf_carried *f,
                             const int count) {
  const cf_grid *whole = a->grid;
  const cf_face u = a->u;
  cf_carried inside[CF_PPM_FIELDS];
  for (int i = 0; i < count; ++i) inside[i] = (cf_carried){f[i].walls, {f[i].phi.at + corner}, f[i].through};
  set_grid(a, part);
  for (int axis = 0; axis < part->box.dim; ++axis) a->u.at[axis] = u.at[axis] + corner;
  const cf_status s = cf_advect_cells(a, inside, count);
  set_grid(a, whole);
  a->u = u;
  return s;
}

/* --- faces -------------------------------------------------------------------------------------------- */

static cf_ghost ghost_of_faces(const cf_wall kind, const bool own_axis) {
  if (kind == CF_WALL_PERIODIC) return CF_GHOST_WRAP;
  if (kind != CF_WALL_INSULATED) return CF_GHOST_COPY;
  return own_axis ? CF_GHOST_ODD : CF_GHOST_MIRROR;
}

/* Component c of a flux. Where its own axis wraps, the last layer of faces is the image of the first. */
static cf_moved component_of(const cf_advect *a, const cf_walls *walls, const int c, const cf_face q) {
  const cf_box *b = &a->grid->box;
  cf_moved m = {.component = c, .at = q.at[c]};
  for (int axis = 0; axis < 3; ++axis) {
    m.count[axis] = b->n[axis] + (axis == c && !a->wrap[axis] ? 1 : 0);
    for (int side = 0; side < 2; ++side)
      m.ghost[axis][side] = ghost_of_faces(walls->kind[axis][side], axis == c);
  }
  return m;
}

/* Half of the stretch before the sweeps and half after them: second order. Midpoint rule for each. */
static void stretch(cf_advect *a, const cf_walls *walls, const double dt, const cf_face q) {
  cf_stretch(a->grid, walls, a->u, dt / 2, q, q, a->turned);
  cf_stretch(a->grid, walls, a->u, dt, a->turned, q, q);
}

static void carry_component(cf_advect *a, const cf_moved *m, const int substep) {
  cf_advect_move(a, m, 1, substep);
  if (!a->wrap[m->component]) return;
  cf_halo image = {0};
  image.rule[m->component][0] = image.rule[m->component][1] = CF_HALO_WRAP;
  cf_halo_fill(&a->grid->box, &image, 0, m->component, m->at);
}

cf_status cf_advect_face(cf_advect *a, const cf_walls *walls, const cf_flux_rate rate, const cf_face q) {
  CF_TRY(check_walls(a, walls));
  const bool stretched = rate == CF_RATE_OBJECTIVE;
  cf_stretch_close(a->grid, walls, q);
  for (int substep = 0; substep < a->substeps; ++substep) {
    if (stretched) stretch(a, walls, substep == 0 ? a->dt / 2 : a->dt, q);
    for (int c = 0; c < a->grid->box.dim; ++c) {
      cf_moved m = component_of(a, walls, c, q);
      m.mass = rate != CF_RATE_MATERIAL;
      carry_component(a, &m, substep);
    }
  }
  if (stretched) stretch(a, walls, a->dt / 2, q);
  return CF_OK;
}

/* --- the velocity itself ------------------------------------------------------------------------------ */

/* Through a wall that lets in comes what its inlet says; through an open one what stands still outside. */
static cf_ghost ghost_of_velocity(const cf_flow_walls *w, const int axis, const int side,
                                  const bool own_axis) {
  if (w->kind[axis][side] == CF_FLOW_PERIODIC) return CF_GHOST_WRAP;
  if (w->kind[axis][side] == CF_FLOW_OPEN || w->lets_in[axis][side]) return CF_GHOST_INFLOW;
  return own_axis ? CF_GHOST_ODD : CF_GHOST_MIRROR;
}

void cf_advect_velocity(cf_advect *a, const cf_flow_walls *walls, const cf_face u) {
  for (int substep = 0; substep < a->substeps; ++substep)
    for (int c = 0; c < a->grid->box.dim; ++c) {
      cf_moved m = {.component = c, .mass = true, .at = u.at[c]};
      for (int axis = 0; axis < 3; ++axis) {
        m.count[axis] = cf_flow_count(walls, axis, c);
        for (int side = 0; side < 2; ++side) {
          m.ghost[axis][side] = ghost_of_velocity(walls, axis, side, axis == c);
          m.inflow[axis][side] = walls->value[axis][side][c];
        }
      }
      carry_component(a, &m, substep);
    }
}
