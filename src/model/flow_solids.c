/* SPDX-License-Identifier: MIT
 *
 * Solid bodies in a flow: where they are, and what each equation must know of it.
 *
 * They are where they were at the beginning of a step while things move in it, and where they will be at its end for
 * the last push and the projection. Where one moves, the velocity that carries things is that of the beginning of the step:
 * the one in its middle would be that of no place of the body.
 */
#include "grid/sweep.h"
#include "model/flow_part.h"

/* The kinds of cells for friction: held where the fluid sticks. */
static void fill_felt(cf_flow *m) {
  const cf_box *b = &m->grid->box;
  unsigned char *kind = cf_region_kinds(m->felt);
  CF_PARALLEL_ROWS (b, m->grid->threads, r)
    for (ptrdiff_t p = cf_box_row(b, r), end = p + b->n[0]; p < end; ++p) {
      const int owner = m->solids.owner[p];
      const bool sticks = owner > 0 && m->solids.item[owner - 1].keys->contact == CF_OBSTACLE_STICKY;
      kind[p] = (unsigned char)(owner == 0 ? CF_CELL_INSIDE : sticks ? CF_CELL_HELD : CF_CELL_WALL);
    }
}

static cf_status set_regions(cf_flow *m) {
  CF_TRY(cf_obstacles_region(&m->solids, CF_OBSTACLES_SOLID, m->fluid));
  CF_TRY(cf_project_set_region(m->project, m->fluid));
  if (m->force != NULL) cf_force_set_region(m->force, m->fluid);
  if (m->viscosity == NULL) return CF_OK;
  fill_felt(m);
  return cf_viscosity_set_region(m->viscosity, m->felt);
}

cf_status cf_flow_make_solids(cf_flow *m) {
  if (m->solids.count == 0) return CF_OK;
  CF_TRY(cf_region_create(&m->fluid, m->grid));
  if (m->viscosity != NULL) CF_TRY(cf_region_create(&m->felt, m->grid));
  return set_regions(m);
}

cf_status cf_flow_place(cf_flow *m, const double t, const double dt) {
  if (!m->solids.changes) return CF_OK;
  CF_TRY(cf_obstacles_place(&m->solids, t, dt));
  CF_TRY(set_regions(m));
  return cf_scalars_place(&m->scalars);
}

cf_status cf_flow_solids_restored(cf_flow *m) {
  if (!m->solids.changes) return CF_OK;
  CF_TRY(cf_obstacles_restored(&m->solids));
  return set_regions(m);
}

void cf_flow_hold(const cf_flow *m, const cf_face u) {
  cf_flow_walls_hold(&m->walls, u);
  if (m->solids.count == 0) return;
  cf_obstacles_push(&m->solids, u);
  for (int a = 0; a < m->grid->box.dim; ++a)
    if (m->walls.kind[a][0] == CF_FLOW_PERIODIC) cf_obstacles_join(&m->solids, a, u);
}
