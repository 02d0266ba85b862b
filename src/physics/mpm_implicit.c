/* SPDX-License-Identifier: MIT
 *
 * The semi-implicit step (35): with f linearised about the state at the start of the step,
 *
 *     m_i v_i + beta dt^2 (K v)_i = m_i v*_i,    (K v)_i = sum_p V_p dP(G F) F^T (4/h^2) w_ip (x_i - x_p),
 *     G = (4/h^2) sum_i w_ip v_i (x_i - x_p)^T
 *
 * (dP: stencil/elastic.h, the swelling stress included: eq. 35 gives that part the wrong sign and no volume). Nothing is
 * assembled: K v is a gather and a scatter over the particles. Conjugate gradients with the masses as preconditioner,
 * on velocities that obey the obstacles: those nodes' residuals are projected. K can be indefinite where a body is
 * pressed hard; at a direction of negative curvature the iteration ends with what it has.
 *
 * Unknowns are vectors on nodes in the layout of cf_nodes.at, in the places of the velocity.
 */
#include <math.h>

#include "physics/mpm_part.h"

/* --- K ----------------------------------------------------------------------------------------------------- */

CF_SMALL void stress_change(const int dim, const cf_mpm *m, const cf_mpm_eight *e, const cf_lanes *dF,
                            cf_lanes *dP) {
  const bool corotated = cf_mpm_law_of(m, e, CF_MPM_COROTATED), neo = cf_mpm_law_of(m, e, CF_MPM_NEO_HOOKEAN);
  if (!corotated) {
    cf_elastic_neo_hookean_change(dim, e->F, &e->mu, &e->lambda, dF, dP);
    return;
  }
  cf_elastic_corotated_change(dim, e->F, &e->mu, &e->lambda, dF, dP);
  if (!neo) return;
  cf_lanes other[9];
  cf_elastic_neo_hookean_change(dim, e->F, &e->mu, &e->lambda, dF, other);
  const cf_real *kind = cf_mpm_at(m, m->at.material, 0) + e->first;
  for (int l = 0; l < e->n; ++l)
    if (cf_mpm_material_of(m, kind[l])->law == CF_MPM_NEO_HOOKEAN)
      for (int c = 0; c < dim * dim; ++c) dP[c][l] = other[c][l];
}

CF_KERNEL void apply_eight(const int dim, const cf_mpm *m, const cf_block *b, const int64_t first,
                           const double weight, const cf_lanes *from, cf_lanes *to) {
  cf_mpm_eight e;
  cf_lanes G[9], dF[9], dP[9], Q[9], J, c, water, chi_s, got, moment[3];
  const cf_real per_h = (cf_real)(CF_BSPLINE_INERTIA / m->grid->h);
  cf_mpm_eight_load(dim, m, b, first, &e);
  cf_mpm_load(e.n, m, m->at.water, 1, first, &water);
  for (int l = 0; l < CF_WIDE; ++l) {
    cf_reach_gather(dim, &e.reach, l, from, &got, moment);
    for (int i = 0; i < dim; ++i)
      for (int a = 0; a < dim; ++a) G[i * dim + a][l] = per_h * moment[a][CF_NODE_VELOCITY + i];
  }
  cf_small_mul(dim, G, e.F, dF);
  stress_change(dim, m, &e, dF, dP);
  cf_small_cofactor(dim, e.F, Q, &J);
  cf_mpm_capacity(&e, &J, &c);
  chi_s = e.chi * water / c;
  cf_elastic_swelling_change(dim, e.F, &chi_s, dF, dP);
  cf_small_mul_t(dim, dP, e.F, Q);
  const cf_lanes push = e.volume * (per_h * (cf_real)weight);
  CF_SMALL_LOOP
  for (int k = 0; k < dim * dim; ++k) Q[k] *= push;
  for (int l = 0; l < e.n; ++l) {
    const cf_lanes none = {0};
    cf_lanes slope[3] = {{0}};
    for (int i = 0; i < dim; ++i)
      for (int a = 0; a < dim; ++a) slope[a][CF_NODE_VELOCITY + i] = Q[i * dim + a][l];
    cf_reach_scatter(dim, &e.reach, l, &none, slope, to);
  }
}

CF_KERNEL void apply_block(const int dim, const cf_mpm *m, const cf_block *b, const double weight,
                           const cf_lanes *x, cf_lanes *y) {
  cf_lanes from[CF_WINDOW_NODES], to[CF_WINDOW_NODES];
  cf_nodes_load(m->nodes, b, x, from);
  memset(to, 0, sizeof to);
  for (int64_t i = b->first; i < b->first + b->count; i += CF_WIDE)
    apply_eight(dim, m, b, i, weight, from, to);
  cf_nodes_add(m->nodes, b, y, to);
}
CF_CLONES static void apply_in_2d(const cf_mpm *m, const cf_block *b, const double weight, const cf_lanes *x,
                                  cf_lanes *y) {
  apply_block(2, m, b, weight, x, y);
}
CF_CLONES static void apply_in_3d(const cf_mpm *m, const cf_block *b, const double weight, const cf_lanes *x,
                                  cf_lanes *y) {
  apply_block(3, m, b, weight, x, y);
}

/* --- vectors on nodes -------------------------------------------------------------------------------------- */

/* What obstacles leave of a node's vector. */
static void project(const cf_mpm *m, const ptrdiff_t at, cf_real *y) {
  const cf_lanes *n = &m->normal[at];
  const cf_real held = (*n)[3];
  if (held == 0) return;
  cf_real along = 0;
  for (int a = 0; a < m->grid->box.dim; ++a) along += (*n)[a] * y[a];
  for (int a = 0; a < m->grid->box.dim; ++a) y[a] = held == 1 ? y[a] - along * (*n)[a] : 0;
}

static cf_real *vector_at(cf_lanes *y, const ptrdiff_t at) { return (cf_real *)&y[at] + CF_NODE_VELOCITY; }

#define FOR_NODES(m, b, at)                             \
  CF_PARALLEL_BLOCKS((m)->nodes, (m)->grid->threads, b) \
  for (ptrdiff_t at = (ptrdiff_t)b * CF_BLOCK_NODES; at < ((ptrdiff_t)b + 1) * CF_BLOCK_NODES; ++at)

/* y = M x + weight K x on free nodes. */
static void apply(cf_mpm *m, const double weight, cf_lanes *x, cf_lanes *y) {
  cf_nodes_clear(m->nodes, y, m->grid->threads);
  for (int c = 0; c < 8; ++c) CF_PARALLEL_VISITS(m->nodes, m->grid->threads, c, v)
  CF_MPM_BY_DIM(apply, m->grid->box.dim, m, &m->nodes->block[m->nodes->visit[v]], weight, x, y);
  FOR_NODES(m, b, at) {
    cf_real *to = vector_at(y, at);
    const cf_real *from = vector_at(x, at), mass = m->nodes->at[at][CF_NODE_MASS];
    for (int a = 0; a < m->grid->box.dim; ++a) to[a] += mass * from[a];
    project(m, at, to);
  }
}

/* The sum of x y, with the inverse masses between if `over`. */
static double dot(cf_mpm *m, cf_lanes *x, cf_lanes *y, const bool over) {
  CF_PARALLEL_BLOCKS(m->nodes, m->grid->threads, b) {
    double sum = 0;
    for (ptrdiff_t at = (ptrdiff_t)b * CF_BLOCK_NODES; at < ((ptrdiff_t)b + 1) * CF_BLOCK_NODES; ++at) {
      const double mass = (double)m->nodes->at[at][CF_NODE_MASS];
      if (!(mass > 0)) continue;
      const cf_real *u = vector_at(x, at), *v = vector_at(y, at);
      double here = 0;
      for (int a = 0; a < m->grid->box.dim; ++a) here += (double)u[a] * (double)v[a];
      sum += over ? here / mass : here;
    }
    m->nodes->partial[b] = sum;
  }
  return cf_sum_ordered(m->nodes->partial, m->nodes->count);
}

/* y += factor x; with `over` y = x/M + factor y. Velocities live in the nodes themselves. */
static void add(cf_mpm *m, const double factor, cf_lanes *x, cf_lanes *y, const bool over) {
  FOR_NODES(m, b, at) {
    const cf_real mass = m->nodes->at[at][CF_NODE_MASS], f = (cf_real)factor;
    if (!(mass > 0)) continue;
    const cf_real *from = vector_at(x, at);
    cf_real *to = vector_at(y, at);
    for (int a = 0; a < m->grid->box.dim; ++a)
      to[a] = over ? from[a] / mass + f * to[a] : to[a] + f * from[a];
  }
}

/* residual = M v - (M + weight K) v = -weight K v; returns the size of M v, both over M. */
static double begin(cf_mpm *m, const double weight) {
  double size = 0;
  apply(m, weight, m->nodes->at, m->residual);
  CF_PARALLEL_BLOCKS(m->nodes, m->grid->threads, b) {
    double sum = 0;
    for (ptrdiff_t at = (ptrdiff_t)b * CF_BLOCK_NODES; at < ((ptrdiff_t)b + 1) * CF_BLOCK_NODES; ++at) {
      cf_real Mv[3], *r = vector_at(m->residual, at), *along = vector_at(m->along, at);
      const cf_real mass = m->nodes->at[at][CF_NODE_MASS];
      for (int a = 0; a < m->grid->box.dim; ++a) {
        const cf_real v = vector_at(m->nodes->at, at)[a];
        Mv[a] = mass * v;
        sum += (double)Mv[a] * (double)v;
        along[a] = 0;
      }
      project(m, at, Mv);
      for (int a = 0; a < m->grid->box.dim; ++a) r[a] = mass > 0 ? Mv[a] - r[a] : 0;
    }
    m->nodes->partial[b] = sum;
  }
  size = cf_sum_ordered(m->nodes->partial, m->nodes->count);
  return sqrt(size);
}

cf_status cf_mpm_implicit(cf_mpm *m, const double dt, cf_solve_report *report) {
  const double weight = m->p.implicitness * dt * dt, size = begin(m, weight);
  double rr = dot(m, m->residual, m->residual, true), before = 1;
  bool bent = false; /* a direction of negative curvature */
  *report = (cf_solve_report){.converged = true, .method = "cg"};
  while (sqrt(rr) > m->p.solver.tolerance * size && report->iterations < m->p.solver.max_iterations &&
         !bent) {
    add(m, report->iterations > 0 ? rr / before : 0, m->residual, m->along, true);
    apply(m, weight, m->along, m->applied);
    const double curvature = dot(m, m->along, m->applied, false);
    if (!isfinite(curvature)) return cf_fail(CF_NOT_FINITE, "the bodies' forces are not finite");
    bent = curvature <= 0;
    if (bent) break;
    add(m, rr / curvature, m->along, m->nodes->at, false);
    add(m, -rr / curvature, m->applied, m->residual, false);
    before = rr;
    rr = dot(m, m->residual, m->residual, true);
    ++report->iterations;
  }
  report->residual = size > 0 ? sqrt(rr) / size : 0;
  report->converged = !(report->residual > m->p.solver.tolerance);
  return CF_OK;
}
