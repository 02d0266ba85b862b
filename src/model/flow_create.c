/* SPDX-License-Identifier: MIT
 *
 * Making a flow: walls, scalars, the velocity at time 0 made free of divergence, and the equations that the scene asks
 * for.
 */
#include <math.h>
#include <string.h>

#include "base/mem.h"
#include "grid/sweep.h"
#include "model/flow_part.h"
#include "stencil/courant.h"

/* --- the length of a step --------------------------------------------------------------------------------- */

cf_status cf_flow_find_rate(cf_flow *m) {
  bool wrap[3] = {false, false, false};
  for (int a = 0; a < m->grid->box.dim; ++a) wrap[a] = m->walls.kind[a][0] == CF_FLOW_PERIODIC;
  cf_courant_ghosts(m->grid, wrap, m->u);
  return cf_courant_rate(m->grid, m->u, &m->rate);
}

/* The largest acceleration by buoyancy, m/s^2. */
static double largest_push(const cf_flow *m) {
  double g[3], a = 0;
  cf_flow_gravity(m->scene, g);
  for (int i = 0; i < m->scalars.count; ++i) {
    if (m->lift == NULL || m->lift[i] == 0) continue;
    const cf_range r =
        cf_sweep_range(&m->grid->box, m->grid->threads, m->scalars.item[i].phi.at, m->scalars.rows);
    a += fabs(m->lift[i]) * CF_MAX(fabs(r.min), fabs(r.max));
  }
  return a * sqrt(g[0] * g[0] + g[1] * g[1] + g[2] * g[2]);
}

/* What moves at `rate` cells a second and is accelerated comes cfl cells far in dt: rate dt + (a/h) dt^2 = cfl. */
double cf_flow_natural_dt(const void *model, const double t) {
  (void)t;
  const cf_flow *m = model;
  const double cfl = m->scene->time.cfl, a = largest_push(m) / m->grid->h;
  const double rate = (m->rate + sqrt(m->rate * m->rate + 4 * a * cfl)) / 2;
  return cf_scalars_natural_dt(&m->scalars, rate);
}

/* --- the equations ---------------------------------------------------------------------------------------- */

static cf_solve_options solver_of(const cf_scene *scene) {
  return (cf_solve_options){scene->solver.tolerance, (int)scene->solver.max_iterations};
}

static cf_status make_lift(cf_flow *m) {
  const cf_param_constants *b = &m->scene->flow.buoyancy;
  double g[3];
  cf_flow_gravity(m->scene, g);
  CF_TRY(CF_NEW(&m->lift, CF_MAX(1, m->scalars.count)));
  for (int i = 0; i < m->scalars.count; ++i)
    for (int k = 0; k < b->count; ++k)
      if (strcmp(b->name[k], m->scalars.item[i].name) == 0) m->lift[i] = b->value[k];
  return b->count > 0 ? cf_force_create(&m->force, &m->walls, g) : CF_OK;
}

static cf_status make_given(cf_flow *m) {
  if (!m->scene->flow.given.force) return CF_OK;
  CF_TRY(cf_face_create(&m->given, &m->grid->box));
  for (int a = 0; a < m->grid->box.dim; ++a) {
    const cf_fn *f = &m->scene->flow.force.axis[a].fn;
    CF_TRY(cf_grid_sample(m->grid, f, a, 0, m->given.at[a]));
    m->given_in_time = m->given_in_time || f->in_time;
  }
  return CF_OK;
}

static cf_status make_equations(cf_flow *m) {
  const cf_scene_flow *f = &m->scene->flow;
  const cf_solve_options o = solver_of(m->scene);
  const int levels = (int)m->scene->solver.levels;
  /* Nobody wants the velocity in the middle of the step when it is projected, but for points. */
  CF_TRY(
      cf_project_create(&m->project, &m->walls, &o, levels, m->scene->points.count > 0 ? NULL : &m->middle));
  CF_TRY(make_lift(m));
  CF_TRY(make_given(m));
  if (f->confinement > 0) CF_TRY(cf_confine_create(&m->confine, &m->walls, f->confinement));
  if (f->viscosity > 0) {
    CF_TRY(cf_viscosity_create(&m->viscosity, &m->walls, f->viscosity, &o, levels));
    CF_TRY(cf_face_create(&m->push, &m->grid->box));
  }
  return CF_OK;
}

/* --- the start -------------------------------------------------------------------------------------------- */

static void copy_faces(const cf_flow *m, const cf_face from, const cf_face to) {
  const cf_box *b = &m->grid->box;
  for (int a = 0; a < b->dim; ++a)
    CF_PARALLEL_FACE_ROWS (b, m->grid->threads, a, r) {
      const ptrdiff_t p = cf_box_face_row(b, a, r);
      memcpy(to.at[a] + p, from.at[a] + p, (size_t)cf_box_extent(b, 0, a) * sizeof(cf_real));
    }
}

/* What the scene says, made free of divergence; the pressure that did it is that of no time, and forgotten. */
static cf_status start(cf_flow *m) {
  cf_solve_report report;
  const cf_box *b = &m->grid->box;
  for (int a = 0; a < b->dim; ++a)
    CF_TRY(cf_grid_sample(m->grid, &m->scene->velocity.axis[a].fn, a, 0, m->u.at[a]));
  cf_flow_hold(m, m->u);
  CF_TRY(cf_project_step(m->project, 1, m->pressure, m->u, &report));
  CF_PARALLEL_ROWS (b, m->grid->threads, r)
    for (int i = 0; i < b->n[0]; ++i) m->pressure.at[cf_box_row(b, r) + i] = 0;
  copy_faces(m, m->u, m->before);
  return cf_flow_find_rate(m);
}

static cf_status make_fields(cf_flow *m) {
  const cf_box *b = &m->grid->box;
  CF_TRY(cf_face_create(&m->u, b));
  CF_TRY(cf_face_create(&m->before, b));
  CF_TRY(cf_face_create(&m->middle, b));
  return cf_cell_create(&m->pressure, b);
}

static cf_status register_flow(cf_flow *m, cf_registry *r) {
  CF_TRY(cf_scalars_register_moves(&m->scalars, r));
  CF_TRY(cf_registry_add_face(r, "velocity", "m/s", m->u));
  CF_TRY(cf_registry_add_face(r, "velocity_before", "m/s", m->before));
  CF_TRY(cf_registry_add_cell(r, "pressure", "m^2/s^2", m->pressure));
  return cf_registry_add_numbers(r, "flow_dt", "s", &m->last_dt, 1);
}

/* Through open walls and inlets the flow takes scalars along. */
static void open_scalars(cf_flow *m) {
  for (int a = 0; a < m->grid->box.dim; ++a)
    for (int side = 0; side < 2; ++side)
      if (m->walls.kind[a][side] == CF_FLOW_OPEN || m->walls.lets_in[a][side])
        cf_scalars_open(&m->scalars, a, side);
}

static cf_status make(cf_flow *m, cf_registry *r) {
  const cf_scene *scene = m->scene;
  const int word = scene->flow.given.advection ? scene->flow.advection : scene->advection.scheme;
  m->scheme = cf_scalars_scheme(word);
  CF_TRY(cf_obstacles_create(&m->solids, scene, m->grid));
  m->scalars.obstacles = &m->solids;
  CF_TRY(cf_scalars_create(&m->scalars, scene, m->grid));
  CF_TRY(cf_scalars_carry(&m->scalars, (int)m->scheme));
  CF_TRY(cf_flow_walls_of_scene(m));
  CF_TRY(make_fields(m));
  CF_TRY(make_equations(m));
  CF_TRY(cf_flow_make_solids(m));
  CF_TRY(start(m));
  open_scalars(m);
  CF_TRY(cf_scalars_make(&m->scalars, isnan(scene->time.dt) ? cf_flow_natural_dt(m, 0) : scene->time.dt, r));
  CF_TRY(register_flow(m, r));
  CF_TRY(cf_obstacles_register(&m->solids, r));
  CF_TRY(cf_drifters_create(&m->points, scene, m->grid));
  m->points.solids = &m->solids;
  return cf_drifters_start(&m->points, r);
}

void cf_flow_destroy(void *model) {
  cf_flow *m = model;
  if (m == NULL) return;
  const cf_box *b = &m->grid->box;
  cf_scalars_destroy(&m->scalars);
  cf_drifters_destroy(&m->points);
  cf_obstacles_destroy(&m->solids);
  cf_region_destroy(m->fluid);
  cf_region_destroy(m->felt);
  cf_project_destroy(m->project);
  cf_force_destroy(m->force);
  cf_viscosity_destroy(m->viscosity);
  cf_confine_destroy(m->confine);
  cf_flow_walls_destroy(&m->walls);
  cf_face_destroy(&m->given, b);
  cf_face_destroy(&m->u, b);
  cf_face_destroy(&m->before, b);
  cf_face_destroy(&m->middle, b);
  cf_face_destroy(&m->push, b);
  cf_cell_destroy(&m->pressure, b);
  cf_free(m->lift);
  cf_free(m);
}

cf_status cf_flow_create(void **model, const cf_scene *scene, cf_registry *registry) {
  cf_flow *m;
  CF_TRY(CF_NEW(&m, 1));
  m->scene = scene;
  m->grid = m->scalars.grid = registry->grid;
  const cf_status s = make(m, registry);
  if (s != CF_OK) {
    cf_flow_destroy(m);
    return s;
  }
  *model = m;
  return CF_OK;
}

cf_status cf_flow_restored(void *model) {
  cf_flow *m = model;
  CF_TRY(cf_flow_solids_restored(m));
  CF_TRY(cf_scalars_restored(&m->scalars));
  return cf_flow_find_rate(m);
}
