/* SPDX-License-Identifier: MIT
 *
 * Particles to nodes and back: the two passes over the particles that make up nearly all of a step. A pass visits
 * blocks; a block's particles go eight at a time, side by side for what is per particle (weights, stress), one after
 * another for their nodes, whose eight numbers are side by side instead (stencil/nodes.h).
 */
#include "physics/mpm.h"

#include <math.h>

#include "base/mem.h"
#include "physics/mpm_part.h"

/* --- the object -------------------------------------------------------------------------------------------- */

cf_status cf_mpm_attributes_add(cf_particles *set, cf_mpm_attributes *at) {
  const int dim = set->dim;
  at->position = CF_PARTICLE_POSITION;
  CF_TRY(cf_particles_attribute(set, "velocity", "m/s", dim, CF_CARRIED, &at->velocity));
  CF_TRY(cf_particles_attribute(set, "velocity_gradient", "1/s", dim * dim, CF_CARRIED, &at->affine));
  CF_TRY(cf_particles_attribute(set, "F", "", dim * dim, CF_CARRIED, &at->deformation));
  CF_TRY(cf_particles_attribute(set, "volume", dim == 3 ? "m^3" : "m^2", 1, CF_CARRIED, &at->volume));
  CF_TRY(cf_particles_attribute(set, "side", "m", dim, CF_CARRIED, &at->side));
  CF_TRY(cf_particles_attribute(set, "body", "", 1, CF_CARRIED, &at->material));
  CF_TRY(cf_particles_attribute(set, "J_P", "", 1, CF_CARRIED, &at->plastic));
  CF_TRY(cf_particles_attribute(set, "water", "kg", 1, CF_CARRIED, &at->water));
  return cf_particles_attribute(set, "A", "kg/s", 1, CF_CARRIED, &at->memory);
}

static cf_status check(const cf_mpm_params *p) {
  if (p->materials < 1) return cf_fail(CF_BAD_ARGUMENT, "bodies need at least one material");
  if (p->obstacles > CF_MPM_OBSTACLES_MAX)
    return cf_fail(CF_BAD_ARGUMENT, "%d obstacles: at most %d", p->obstacles, CF_MPM_OBSTACLES_MAX);
  if (!(p->implicitness >= 0 && p->implicitness <= 1))
    return cf_fail(CF_BAD_ARGUMENT, "implicitness = %g: must be between 0 and 1", p->implicitness);
  if (!(p->flip <= 1)) return cf_fail(CF_BAD_ARGUMENT, "flip = %g: must be at most 1", p->flip);
  for (int i = 0; i < p->materials; ++i) {
    const cf_mpm_material *a = &p->material[i];
    if (!(a->mu >= 0 && a->lambda >= 0 && a->density > 0 && a->water >= 0 && a->swelling >= 0))
      return cf_fail(
          CF_BAD_ARGUMENT,
          "material %d: mu = %g, lambda = %g, density = %g, water = %g, swelling = %g: none may be "
          "negative, and density must be > 0",
          i, a->mu, a->lambda, a->density, a->water, a->swelling);
  }
  return CF_OK;
}

static size_t vectors_bytes(const cf_mpm *m) {
  return sizeof(cf_lanes) * CF_BLOCK_NODES * (size_t)m->nodes->room;
}

static size_t rest_bytes(const cf_mpm *m) { return sizeof(cf_real) * (size_t)(m->set->room + CF_WIDE); }

static cf_status make_vectors(cf_mpm *m) {
  cf_lanes **flip[] = {&m->force, &m->old}, **implicit[] = {&m->residual, &m->along, &m->applied, &m->normal};
  for (size_t i = 0; m->p.flip >= 0 && i < sizeof flip / sizeof *flip; ++i)
    CF_TRY(cf_pages_reserve((void **)flip[i], vectors_bytes(m), false));
  for (size_t i = 0; m->p.implicitness > 0 && i < sizeof implicit / sizeof *implicit; ++i)
    CF_TRY(cf_pages_reserve((void **)implicit[i], vectors_bytes(m), false));
  if (m->p.mixture) CF_TRY(cf_pages_reserve((void **)&m->mixture, vectors_bytes(m), false));
  for (int i = 0; i < 2; ++i) CF_TRY(cf_pages_reserve((void **)&m->rest[i], rest_bytes(m), false));
  return CF_OK;
}

cf_status cf_mpm_create(cf_mpm **m, const cf_grid *lattice, cf_particles *set, const cf_mpm_attributes *at,
                        const cf_mpm_params *p) {
  *m = NULL;
  CF_TRY(check(p));
  cf_mpm *fresh;
  CF_TRY(CF_NEW(&fresh, 1));
  fresh->grid = lattice;
  fresh->set = set;
  fresh->at = *at;
  fresh->p = *p;
  for (int i = 0; i < p->materials; ++i)
    fresh->plastic =
        fresh->plastic || isfinite(p->material[i].stretch) || isfinite(p->material[i].compression);
  cf_status s = cf_nodes_create(&fresh->nodes, lattice, set->room);
  if (s == CF_OK) s = make_vectors(fresh);
  if (s != CF_OK) {
    cf_mpm_destroy(fresh);
    return s;
  }
  *m = fresh;
  return CF_OK;
}

void cf_mpm_destroy(cf_mpm *m) {
  if (m == NULL) return;
  cf_lanes *all[] = {m->force, m->old, m->residual, m->along, m->applied, m->normal, m->mixture};
  for (size_t i = 0; i < sizeof all / sizeof *all; ++i)
    if (all[i] != NULL) cf_pages_release(all[i], vectors_bytes(m));
  for (int i = 0; i < 2; ++i) cf_pages_release(m->rest[i], rest_bytes(m));
  cf_nodes_destroy(m->nodes);
  cf_free(m);
}

/* --- particles to nodes ------------------------------------------------------------------------------------ */

/* What a block's particles add to its window. The force goes with the momentum, or to a window of its own. */
typedef struct windows {
  cf_lanes sum[CF_WINDOW_NODES], force[CF_WINDOW_NODES];
} windows;

CF_KERNEL void scatter_eight(const int dim, const cf_mpm *m, const cf_block *b, const int64_t first,
                             const double dt, windows *to) {
  cf_mpm_eight e;
  cf_lanes v[3], C[9], T[9], J, capacity, water, memory;
  const cf_real h = (cf_real)m->grid->h;
  const bool apart = m->force != NULL;
  cf_mpm_eight_load(dim, m, b, first, &e);
  cf_mpm_load(e.n, m, m->at.velocity, dim, first, v);
  cf_mpm_load(e.n, m, m->at.affine, dim * dim, first, C);
  cf_mpm_load(e.n, m, m->at.water, 1, first, &water);
  cf_mpm_load(e.n, m, m->at.memory, 1, first, &memory);
  cf_mpm_elastic(dim, m, &e, T, &J);
  cf_mpm_capacity(&e, &J, &capacity);
  const cf_lanes swelling = e.chi * water / capacity, mass = e.density * e.volume;
  const cf_lanes push = e.volume * ((cf_real)(-dt) * CF_BSPLINE_INERTIA / h);
  const cf_lanes fill =
      e.volume * J * e.plastic *
      (cf_real)(1 / (dim == 3 ? m->grid->h * m->grid->h * m->grid->h : m->grid->h * m->grid->h));
  CF_SMALL_LOOP
  for (int a = 0; a < dim; ++a) T[a * dim + a] -= swelling;
  CF_SMALL_LOOP
  for (int c = 0; c < dim * dim; ++c) {
    T[c] = push * T[c];
    C[c] = mass * h * C[c];
    if (!apart) C[c] += T[c];
  }
  for (int l = 0; l < e.n; ++l) {
    cf_lanes value = {mass[l], 0, 0, 0, capacity[l], water[l], memory[l], fill[l]}, slope[3] = {{0}};
    CF_SMALL_LOOP
    for (int i = 0; i < dim; ++i) {
      value[CF_NODE_VELOCITY + i] = mass[l] * v[i][l];
      CF_SMALL_LOOP
      for (int a = 0; a < dim; ++a) slope[a][CF_NODE_VELOCITY + i] = C[i * dim + a][l];
    }
    cf_reach_scatter(dim, &e.reach, l, &value, slope, to->sum);
    if (!apart) continue;
    const cf_lanes none = {0};
    CF_SMALL_LOOP
    for (int i = 0; i < dim; ++i) CF_SMALL_LOOP
    for (int a = 0; a < dim; ++a) slope[a][CF_NODE_VELOCITY + i] = T[i * dim + a][l];
    cf_reach_scatter(dim, &e.reach, l, &none, slope, to->force);
  }
}

CF_KERNEL void scatter_block(const int dim, cf_mpm *m, const cf_block *b, const double dt) {
  windows to;
  memset(&to.sum, 0, sizeof to.sum);
  if (m->force != NULL) memset(&to.force, 0, sizeof to.force);
  for (int64_t i = b->first; i < b->first + b->count; i += CF_WIDE) scatter_eight(dim, m, b, i, dt, &to);
  cf_nodes_add(m->nodes, b, m->nodes->at, to.sum);
  if (m->force != NULL) cf_nodes_add(m->nodes, b, m->force, to.force);
}
CF_CLONES static void scatter_in_2d(cf_mpm *m, const cf_block *b, const double dt) {
  scatter_block(2, m, b, dt);
}
CF_CLONES static void scatter_in_3d(cf_mpm *m, const cf_block *b, const double dt) {
  scatter_block(3, m, b, dt);
}

void cf_mpm_scatter(cf_mpm *m, const double dt) {
  const int threads = m->grid->threads;
  cf_nodes_update(m->nodes, m->set, threads);
  cf_nodes_clear(m->nodes, m->nodes->at, threads);
  if (m->force != NULL) cf_nodes_clear(m->nodes, m->force, threads);
  for (int c = 0; c < 8; ++c) CF_PARALLEL_VISITS(m->nodes, threads, c, v)
  CF_MPM_BY_DIM(scatter, m->grid->box.dim, m, &m->nodes->block[m->nodes->visit[v]], dt);
}

/* --- nodes to particles ------------------------------------------------------------------------------------ */

/* Stretches beyond what the material bears become lasting: S = V e V^T, e clipped, F <- R S, J_P takes the volume. */
static void yield(const int dim, const cf_mpm_material *a, cf_mpm_eight *e, const cf_lanes *R, const int l) {
  double S[9], V[9], stretch[3], before = 1, after = 1;
  for (int i = 0; i < dim; ++i)
    for (int j = 0; j < dim; ++j) {
      S[i * dim + j] = 0;
      for (int k = 0; k < dim; ++k)
        S[i * dim + j] += ((double)R[k * dim + i][l] * (double)e->F[k * dim + j][l] +
                           (double)R[k * dim + j][l] * (double)e->F[k * dim + i][l]) /
                          2;
    }
  cf_symmetric_eigen(dim, S, V, stretch);
  bool yields = false;
  for (int i = 0; i < dim; ++i) {
    const double kept = CF_MAX(1 - a->compression, CF_MIN(1 + a->stretch, stretch[i]));
    yields = yields || kept != stretch[i];
    before *= stretch[i], after *= kept;
    stretch[i] = kept;
  }
  if (!yields) return;
  for (int i = 0; i < dim; ++i)
    for (int j = 0; j < dim; ++j) {
      S[i * dim + j] = 0;
      for (int k = 0; k < dim; ++k) S[i * dim + j] += V[i * dim + k] * stretch[k] * V[j * dim + k];
    }
  for (int i = 0; i < dim; ++i)
    for (int j = 0; j < dim; ++j) {
      double sum = 0;
      for (int k = 0; k < dim; ++k) sum += (double)R[i * dim + k][l] * S[k * dim + j];
      e->F[i * dim + j][l] = (cf_real)sum;
    }
  e->plastic[l] *= (cf_real)(before / after);
}

CF_SMALL void flow_plastically(const int dim, const cf_mpm *m, cf_mpm_eight *e) {
  cf_lanes R[9];
  cf_polar(dim, e->F, R);
  const cf_real *kind = cf_mpm_at(m, m->at.material, 0) + e->first;
  for (int l = 0; l < e->n; ++l) {
    const cf_mpm_material *a = cf_mpm_material_of(m, kind[l]);
    if (isfinite(a->stretch) || isfinite(a->compression)) yield(dim, a, e, R, l);
  }
  cf_mpm_store(e->n, m, m->at.plastic, 1, e->first, &e->plastic);
}

/* The water that a particle takes; near held cells no more (or no less) than they hold. Returns what went back. */
CF_SMALL double take_water(const cf_mpm *m, const cf_mpm_eight *e, const cf_lanes *J, const cf_lanes *got) {
  cf_lanes capacity, water, memory;
  double returned = 0;
  cf_mpm_capacity(e, J, &capacity);
  cf_mpm_load(e->n, m, m->at.water, 1, e->first, &water);
  cf_mpm_load(e->n, m, m->at.memory, 1, e->first, &memory);
  for (int l = 0; l < e->n; ++l) {
    cf_real next = water[l] + capacity[l] * got[l][CF_NODE_WATER];
    if (got[l][CF_NODE_FILL] > 0) {
      const cf_real full = capacity[l] * (got[l][CF_NODE_CAPACITY] / got[l][CF_NODE_FILL]);
      const cf_real most = CF_MAX(full, water[l]), least = CF_MIN(full, water[l]);
      const cf_real kept = CF_MIN(most, CF_MAX(least, next));
      returned += (double)next - (double)kept;
      next = kept;
    }
    water[l] = next;
    memory[l] += capacity[l] * got[l][CF_NODE_MEMORY];
  }
  cf_mpm_store(e->n, m, m->at.water, 1, e->first, &water);
  cf_mpm_store(e->n, m, m->at.memory, 1, e->first, &memory);
  return returned;
}

CF_KERNEL double gather_eight(const int dim, const cf_mpm *m, const cf_block *b, const int64_t first,
                              const double dt, const windows *from) {
  cf_mpm_eight e;
  cf_lanes got[CF_WIDE], moment[CF_WIDE][3], v[3], C[9], F[9], J;
  const cf_real per_h = (cf_real)(CF_BSPLINE_INERTIA / m->grid->h);
  cf_mpm_eight_load(dim, m, b, first, &e);
  for (int l = 0; l < CF_WIDE; ++l) cf_reach_gather(dim, &e.reach, l, from->sum, &got[l], moment[l]);
  CF_SMALL_LOOP
  for (int i = 0; i < dim; ++i)
    for (int l = 0; l < CF_WIDE; ++l) {
      v[i][l] = got[l][CF_NODE_VELOCITY + i];
      CF_SMALL_LOOP
      for (int a = 0; a < dim; ++a) C[i * dim + a][l] = per_h * moment[l][a][CF_NODE_VELOCITY + i];
    }
  cf_small_cofactor(dim, e.F, F, &J);
  const double returned = take_water(m, &e, &J, got);
  CF_SMALL_LOOP
  for (int a = 0; a < dim; ++a) e.x[a] += (cf_real)dt * v[a];
  cf_mpm_store(e.n, m, m->at.position, dim, first, e.x);
  cf_small_mul(dim, C, e.F, F);
  CF_SMALL_LOOP
  for (int c = 0; c < dim * dim; ++c) e.F[c] += (cf_real)dt * F[c];
  if (m->plastic) flow_plastically(dim, m, &e);
  cf_mpm_store(e.n, m, m->at.deformation, dim * dim, first, e.F);
  if (m->old != NULL) { /* (36) */
    const cf_real share = (cf_real)m->p.flip;
    cf_lanes old[3], change;
    cf_mpm_load(e.n, m, m->at.velocity, dim, first, old);
    for (int l = 0; l < CF_WIDE; ++l) {
      cf_reach_gather(dim, &e.reach, l, from->force, &change, NULL);
      CF_SMALL_LOOP
      for (int i = 0; i < dim; ++i)
        v[i][l] = (1 - share) * v[i][l] + share * (old[i][l] + change[CF_NODE_VELOCITY + i]);
    }
  } else {
    cf_mpm_store(e.n, m, m->at.affine, dim * dim, first, C);
  }
  cf_mpm_store(e.n, m, m->at.velocity, dim, first, v);
  return returned;
}

CF_KERNEL double gather_block(const int dim, const cf_mpm *m, const cf_block *b, const double dt) {
  windows from;
  double returned = 0;
  cf_nodes_load(m->nodes, b, m->nodes->at, from.sum);
  if (m->old != NULL) cf_nodes_load(m->nodes, b, m->old, from.force);
  for (int64_t i = b->first; i < b->first + b->count; i += CF_WIDE)
    returned += gather_eight(dim, m, b, i, dt, &from);
  return returned;
}
CF_CLONES static void gather_in_2d(const cf_mpm *m, const cf_block *b, const double dt, double *returned) {
  *returned = gather_block(2, m, b, dt);
}
CF_CLONES static void gather_in_3d(const cf_mpm *m, const cf_block *b, const double dt, double *returned) {
  *returned = gather_block(3, m, b, dt);
}

void cf_mpm_gather(cf_mpm *m, const double dt) {
  CF_PARALLEL_ALL_VISITS(m->nodes, m->grid->threads, v)
  CF_MPM_BY_DIM(gather, m->grid->box.dim, m, &m->nodes->block[m->nodes->visit[v]], dt, &m->nodes->partial[v]);
  m->returned = cf_sum_ordered(m->nodes->partial, m->nodes->colour[8]);
}
