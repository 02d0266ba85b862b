/* SPDX-License-Identifier: MIT
 *
 * The grid's half of a step of the bodies: momenta become velocities, gravity acts, obstacles are met. On every node
 * inside an obstacle, with v_n the normal part of the velocity relative to it (Stomakhin et al. 2013):
 *
 *     sticky    v = that of the obstacle
 *     slip      v_n = 0
 *     separate  v_n = max(v_n, 0)
 *     friction  where v_n was < 0, the tangential part loses min(|v_t|, mu |v_n|)
 */
#include <math.h>

#include "physics/mpm_part.h"

void cf_mpm_collide(const cf_mpm *m, const cf_pose *pose, const double t, const double place[3], double v[3],
                    double normal[3], int *held) {
  for (int o = 0; o < m->p.obstacles; ++o) {
    const cf_mpm_obstacle *b = &m->p.obstacle[o];
    if (cf_shape_distance(b->shape, &pose[o], t, place) >= 0) continue;
    double u[3], n[3], along = 0, slide2 = 0;
    cf_pose_velocity(&pose[o], place, u);
    cf_shape_normal(b->shape, &pose[o], t, place, 0.1 * m->grid->h, n);
    for (int a = 0; a < 3; ++a) v[a] -= u[a], along += v[a] * n[a];
    if (b->contact == CF_MPM_STICKY) {
      for (int a = 0; a < 3; ++a) v[a] = 0;
      if (held != NULL) *held = 2;
    } else if (b->contact == CF_MPM_SLIP || along < 0) {
      for (int a = 0; a < 3; ++a) v[a] -= along * n[a], slide2 += v[a] * v[a];
      const double slide = sqrt(slide2), lost = along < 0 ? CF_MIN(slide, -b->friction * along) : 0;
      for (int a = 0; a < 3 && slide > 0; ++a) v[a] *= 1 - lost / slide;
      if (held != NULL && *held < 2) {
        *held = *held == 1 ? 2 : 1; /* a node in two obstacles is in a corner */
        for (int a = 0; a < 3; ++a) normal[a] = n[a];
      }
    }
    for (int a = 0; a < 3; ++a) v[a] += u[a];
  }
}

/* Obstacles none of whose points come near a block are left out of it: returns how many are near. */
static int obstacles_near(const cf_mpm *m, const cf_pose *pose, const double t, const cf_block *b) {
  const double h = m->grid->h, half = 0.5 * CF_BLOCK_EDGE(m->grid->box.dim);
  double middle[3] = {0, 0, 0};
  for (int a = 0; a < m->grid->box.dim; ++a) middle[a] = m->grid->origin[a] + (b->cell[a] + half) * h;
  int near = 0;
  for (int o = 0; o < m->p.obstacles; ++o)
    near += m->p.obstacle[o].shape->kind == CF_SHAPE_FUNCTION ||
            cf_shape_distance(m->p.obstacle[o].shape, &pose[o], t, middle) < 2 * half * h;
  return near;
}

typedef struct step {
  double t, dt;
  const cf_pose *pose;
} step;

/* Node n of a block, with a mass: v before obstacles to v after them. */
static void meet(cf_mpm *m, const step *s, const cf_block *b, const int n, const ptrdiff_t at,
                 cf_lanes *node) {
  int cell[3], held = 0;
  double place[3] = {0, 0, 0}, v[3] = {0, 0, 0}, normal[3] = {0, 0, 0};
  const int dim = m->grid->box.dim;
  cf_nodes_cell(m->nodes, b, n, cell);
  for (int a = 0; a < dim; ++a) {
    place[a] = cf_grid_place(m->grid, a, cell[a], 0);
    v[a] = (double)(*node)[CF_NODE_VELOCITY + a];
  }
  cf_mpm_collide(m, s->pose, s->t, place, v, normal, &held);
  for (int a = 0; a < dim; ++a) (*node)[CF_NODE_VELOCITY + a] = (cf_real)v[a];
  if (m->normal == NULL) return;
  for (int a = 0; a < dim; ++a) m->normal[at][a] = (cf_real)normal[a];
  m->normal[at][3] = (cf_real)held;
}

/* (33) on the nodes of block `rank`; what is on them besides mass and momentum stays. Leaves the sums of water as they
 * are. */
static void move_block(cf_mpm *m, const step *s, const int32_t rank) {
  const cf_block *b = &m->nodes->block[rank];
  const bool near = obstacles_near(m, s->pose, s->t, b) > 0;
  const int dim = m->grid->box.dim;
  const cf_real keep = (cf_real)exp(-m->p.damping * s->dt);
  for (int n = 0; n < CF_BLOCK_NODES; ++n) {
    const ptrdiff_t at = (ptrdiff_t)rank * CF_BLOCK_NODES + n;
    cf_lanes *node = &m->nodes->at[at];
    if (m->normal != NULL) m->normal[at] *= 0;
    const cf_real mass = (*node)[CF_NODE_MASS];
    if (!(mass > 0)) continue;
    cf_real before[3] = {0, 0, 0};
    for (int a = 0; a < dim; ++a) {
      const int c = CF_NODE_VELOCITY + a;
      before[a] = (*node)[c] / mass;
      (*node)[c] = (before[a] + (cf_real)(s->dt * m->p.gravity[a])) * keep;
      if (m->force != NULL) (*node)[c] += m->force[at][c] / mass;
    }
    if (near) meet(m, s, b, n, at, node);
    if (m->old == NULL) continue;
    for (int a = 0; a < dim; ++a) m->old[at][CF_NODE_VELOCITY + a] = before[a];
  }
}

/* FLIP: what velocities were becomes how they have changed. */
static void note_changes(cf_mpm *m) {
  CF_PARALLEL_BLOCKS(m->nodes, m->grid->threads, b)
  for (ptrdiff_t at = (ptrdiff_t)b * CF_BLOCK_NODES; at < ((ptrdiff_t)b + 1) * CF_BLOCK_NODES; ++at)
    for (int a = 0; a < m->grid->box.dim; ++a) {
      cf_real *old = (cf_real *)&m->old[at] + CF_NODE_VELOCITY + a;
      *old = m->nodes->at[at][CF_NODE_MASS] > 0 ? m->nodes->at[at][CF_NODE_VELOCITY + a] - *old : 0;
    }
}

cf_status cf_mpm_move_nodes(cf_mpm *m, const double t, const double dt, cf_solve_report *report) {
  cf_pose pose[CF_MPM_OBSTACLES_MAX];
  for (int o = 0; o < m->p.obstacles; ++o)
    pose[o] = m->p.obstacle[o].motion != NULL ? cf_motion_at(m->p.obstacle[o].motion, t + dt / 2, dt)
                                              : cf_pose_at_rest();
  const step s = {t + dt, dt, pose};
  *report = (cf_solve_report){.converged = true};
  CF_PARALLEL_BLOCKS(m->nodes, m->grid->threads, b) move_block(m, &s, b);
  if (m->p.implicitness > 0) CF_TRY(cf_mpm_implicit(m, dt, report));
  if (m->old != NULL) note_changes(m);
  return CF_OK;
}
