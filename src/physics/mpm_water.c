/* SPDX-License-Identifier: MIT
 *
 * What water needs of the particles besides the scatter: how the bodies' k and F_T mix on nodes where they differ, and
 * the filter of what the grid cannot see. A gather of increments never touches the part of m_f/c that vanishes on
 * all nodes (there are more particles than nodes), so noise there stays for good and grows with the motion; a blend with
 * the gathered value itself would smooth what the grid does see. (1 - P)^2 does neither.
 *
 * Two rounds to the nodes and back: eta (1 - P) z is kept per particle, and then once more. P is self-adjoint in the product
 * with c and leaves constants alone, so no eta that varies changes sum c z.
 */
#include "physics/mpm_part.h"

/* --- mixtures ---------------------------------------------------------------------------------------------- */

CF_KERNEL void mix_block(const int dim, cf_mpm *m, const cf_block *b) {
  cf_lanes to[CF_WINDOW_NODES], C[9], J, c;
  memset(to, 0, sizeof to);
  const cf_real *kind = cf_mpm_at(m, m->at.material, 0);
  for (int64_t i = b->first; i < b->first + b->count; i += CF_WIDE) {
    cf_mpm_eight e;
    cf_mpm_eight_load(dim, m, b, i, &e);
    cf_small_cofactor(dim, e.F, C, &J);
    cf_mpm_capacity(&e, &J, &c);
    for (int l = 0; l < e.n; ++l) {
      const cf_mpm_material *a = cf_mpm_material_of(m, kind[i + l]);
      const cf_lanes value = {c[l], c[l] * (cf_real)a->k, c[l] * (cf_real)(a->k * a->f_t), 0, 0, 0, 0, 0};
      cf_reach_scatter_plain(dim, &e.reach, l, &value, to);
    }
  }
  cf_nodes_add(m->nodes, b, m->mixture, to);
}
CF_CLONES static void mix_in_2d(cf_mpm *m, const cf_block *b) { mix_block(2, m, b); }
CF_CLONES static void mix_in_3d(cf_mpm *m, const cf_block *b) { mix_block(3, m, b); }

void cf_mpm_mix(cf_mpm *m) {
  cf_nodes_clear(m->nodes, m->mixture, m->grid->threads);
  for (int c = 0; c < 8; ++c) CF_PARALLEL_VISITS(m->nodes, m->grid->threads, c, v)
  CF_MPM_BY_DIM(mix, m->grid->box.dim, m, &m->nodes->block[m->nodes->visit[v]]);
}

/* --- the filter -------------------------------------------------------------------------------------------- */

/* Values of z = m_f/c, A/c in the first round, what is left of them in the second. */
CF_KERNEL void water_of(const int round, const cf_mpm *m, const cf_mpm_eight *e, const cf_lanes *c,
                        cf_lanes *z) {
  if (round == 0) {
    cf_mpm_load(e->n, m, m->at.water, 1, e->first, &z[0]);
    cf_mpm_load(e->n, m, m->at.memory, 1, e->first, &z[1]);
    z[0] /= *c, z[1] /= *c;
  } else {
    for (int i = 0; i < 2; ++i) cf_lanes_load(e->n, m->rest[i], e->first, &z[i]);
  }
}

CF_KERNEL void filter_scatter(const int dim, const int round, cf_mpm *m, const cf_block *b) {
  cf_lanes to[CF_WINDOW_NODES], C[9], J, c, z[2];
  memset(to, 0, sizeof to);
  for (int64_t i = b->first; i < b->first + b->count; i += CF_WIDE) {
    cf_mpm_eight e;
    cf_mpm_eight_load(dim, m, b, i, &e);
    cf_small_cofactor(dim, e.F, C, &J);
    cf_mpm_capacity(&e, &J, &c);
    water_of(round, m, &e, &c, z);
    for (int l = 0; l < e.n; ++l) {
      const cf_lanes value = {0, 0, 0, 0, c[l], c[l] * z[0][l], c[l] * z[1][l], 0};
      cf_reach_scatter_plain(dim, &e.reach, l, &value, to);
    }
  }
  cf_nodes_add(m->nodes, b, m->nodes->at, to);
}

/* eta of eight particles. */
CF_SMALL void share_of(const cf_mpm *m, const cf_mpm_eight *e, const double *eta, cf_lanes *share) {
  const cf_real *kind = cf_mpm_at(m, m->at.material, 0) + e->first;
  for (int l = 0; l < e->n; ++l) (*share)[l] = (cf_real)eta[cf_mpm_material_of(m, kind[l]) - m->p.material];
}

CF_KERNEL void filter_gather(const int dim, const int round, cf_mpm *m, const cf_block *b,
                             const double *eta) {
  cf_lanes from[CF_WINDOW_NODES], C[9], J, c, z[2], seen[2];
  cf_nodes_load(m->nodes, b, m->nodes->at, from);
  for (int64_t i = b->first; i < b->first + b->count; i += CF_WIDE) {
    cf_mpm_eight e;
    cf_mpm_eight_load(dim, m, b, i, &e);
    cf_small_cofactor(dim, e.F, C, &J);
    cf_mpm_capacity(&e, &J, &c);
    water_of(round, m, &e, &c, z);
    for (int l = 0; l < CF_WIDE; ++l) {
      cf_lanes got;
      cf_reach_gather(dim, &e.reach, l, from, &got, NULL);
      seen[0][l] = got[CF_NODE_WATER], seen[1][l] = got[CF_NODE_MEMORY];
    }
    if (round == 0) {
      cf_lanes share = {0};
      share_of(m, &e, eta, &share);
      for (int a = 0; a < 2; ++a) {
        z[a] = share * (z[a] - seen[a]);
        cf_lanes_store(e.n, &z[a], m->rest[a], i);
      }
    } else {
      cf_lanes water, memory;
      cf_mpm_load(e.n, m, m->at.water, 1, i, &water);
      cf_mpm_load(e.n, m, m->at.memory, 1, i, &memory);
      water -= c * (z[0] - seen[0]);
      memory -= c * (z[1] - seen[1]);
      cf_mpm_store(e.n, m, m->at.water, 1, i, &water);
      cf_mpm_store(e.n, m, m->at.memory, 1, i, &memory);
    }
  }
}

CF_CLONES static void to_nodes_in_2d(cf_mpm *m, const cf_block *b, const int round) {
  filter_scatter(2, round, m, b);
}
CF_CLONES static void to_nodes_in_3d(cf_mpm *m, const cf_block *b, const int round) {
  filter_scatter(3, round, m, b);
}
CF_CLONES static void back_in_2d(cf_mpm *m, const cf_block *b, const int round, const double *eta) {
  filter_gather(2, round, m, b, eta);
}
CF_CLONES static void back_in_3d(cf_mpm *m, const cf_block *b, const int round, const double *eta) {
  filter_gather(3, round, m, b, eta);
}

static void over_capacity(const cf_mpm *m) {
  CF_PARALLEL_BLOCKS(m->nodes, m->grid->threads, b)
  for (ptrdiff_t at = (ptrdiff_t)b * CF_BLOCK_NODES; at < ((ptrdiff_t)b + 1) * CF_BLOCK_NODES; ++at) {
    cf_real *node = (cf_real *)&m->nodes->at[at];
    const cf_real per = node[CF_NODE_CAPACITY] > 0 ? 1 / node[CF_NODE_CAPACITY] : 0;
    node[CF_NODE_WATER] *= per, node[CF_NODE_MEMORY] *= per;
  }
}

void cf_mpm_filter(cf_mpm *m, const double *eta) {
  const int dim = m->grid->box.dim, threads = m->grid->threads;
  cf_nodes_update(m->nodes, m->set, threads);
  for (int round = 0; round < 2; ++round) {
    cf_nodes_clear(m->nodes, m->nodes->at, threads);
    for (int c = 0; c < 8; ++c) CF_PARALLEL_VISITS(m->nodes, threads, c, v)
    CF_MPM_BY_DIM(to_nodes, dim, m, &m->nodes->block[m->nodes->visit[v]], round);
    over_capacity(m);
    CF_PARALLEL_ALL_VISITS(m->nodes, threads, v)
    CF_MPM_BY_DIM(back, dim, m, &m->nodes->block[m->nodes->visit[v]], round, eta);
  }
}
