/* SPDX-License-Identifier: MIT
 *
 * What the files of the material point method share: mpm.c makes the object and steps particles, mpm_nodes.c moves
 * nodes, mpm_implicit.c solves (35), mpm_water.c mixes and filters, mpm_sums.c sums, mpm_split.c cuts what is long.
 */
#ifndef CF_PHYSICS_MPM_PART_H
#define CF_PHYSICS_MPM_PART_H

#include "physics/mpm.h"
#include "stencil/elastic.h"

/* Eight particles as the kernels see them. */
typedef struct cf_mpm_eight {
  int n; /* of them that are there */
  int64_t first;
  cf_reach reach;
  cf_lanes x[3], F[9];
  cf_lanes volume, plastic;                            /* V0, J_P */
  cf_lanes mu, lambda, chi, density, water_per_volume; /* of their materials, hardened */
} cf_mpm_eight;

static inline cf_real *cf_mpm_at(const cf_mpm *m, const int attribute, const int c) {
  return m->set->attribute[attribute].at[c];
}

CF_SMALL void cf_mpm_load(const int n, const cf_mpm *m, const int attribute, const int components,
                          const int64_t first, cf_lanes *x) {
  CF_SMALL_LOOP
  for (int c = 0; c < components; ++c) cf_lanes_load(n, cf_mpm_at(m, attribute, c), first, &x[c]);
}

CF_SMALL void cf_mpm_store(const int n, const cf_mpm *m, const int attribute, const int components,
                           const int64_t first, const cf_lanes *x) {
  CF_SMALL_LOOP
  for (int c = 0; c < components; ++c) cf_lanes_store(n, &x[c], cf_mpm_at(m, attribute, c), first);
}

/* The material of a particle; the first where what is written there is none (not finite: found after the step). */
static inline const cf_mpm_material *cf_mpm_material_of(const cf_mpm *m, const cf_real kind) {
  return &m->p.material[kind >= 0 && kind < (cf_real)m->p.materials ? (int)kind : 0];
}

/* Place, weights, deformation and material of particles first ... first + 7 of block b (fewer at its end). */
CF_SMALL void cf_mpm_eight_load(const int dim, const cf_mpm *m, const cf_block *b, const int64_t first,
                                cf_mpm_eight *e) {
  const int64_t left = b->first + b->count - first;
  e->n = left < CF_WIDE ? (int)left : CF_WIDE;
  e->first = first;
  cf_mpm_load(e->n, m, m->at.position, dim, first, e->x);
  cf_reach_set(dim, m->grid, b, e->x, &e->reach);
  cf_mpm_load(e->n, m, m->at.deformation, dim * dim, first, e->F);
  cf_mpm_load(e->n, m, m->at.volume, 1, first, &e->volume);
  cf_mpm_load(e->n, m, m->at.plastic, 1, first, &e->plastic);
  cf_lanes kind;
  cf_mpm_load(e->n, m, m->at.material, 1, first, &kind);
  cf_real of[5][CF_WIDE];
  for (int l = 0; l < CF_WIDE; ++l) {
    const cf_mpm_material *a = cf_mpm_material_of(m, kind[l]);
    const cf_real harder =
        a->hardening > 0 ? (cf_real)exp(a->hardening * (1 - (double)e->plastic[l])) : (cf_real)1;
    of[0][l] = harder * (cf_real)a->mu;
    of[1][l] = harder * (cf_real)a->lambda;
    of[2][l] = (cf_real)a->swelling;
    of[3][l] = (cf_real)a->density;
    of[4][l] = (cf_real)a->water;
  }
  e->mu = CF_LANES_AT(of[0]), e->lambda = CF_LANES_AT(of[1]), e->chi = CF_LANES_AT(of[2]);
  e->density = CF_LANES_AT(of[3]), e->water_per_volume = CF_LANES_AT(of[4]);
}

/* Whether all of the eight obey one law, and which. */
CF_SMALL bool cf_mpm_law_of(const cf_mpm *m, const cf_mpm_eight *e, const cf_mpm_law law) {
  if (m->p.materials == 1) return m->p.material[0].law == law;
  const cf_real *kind = cf_mpm_at(m, m->at.material, 0) + e->first;
  for (int l = 0; l < e->n; ++l)
    if (cf_mpm_material_of(m, kind[l])->law == law) return true;
  return false;
}

/* T of the elastic law and J of the elastic part. Where laws are mixed both are worked out. */
CF_SMALL void cf_mpm_elastic(const int dim, const cf_mpm *m, const cf_mpm_eight *e, cf_lanes *T,
                             cf_lanes *J) {
  const bool corotated = cf_mpm_law_of(m, e, CF_MPM_COROTATED), neo = cf_mpm_law_of(m, e, CF_MPM_NEO_HOOKEAN);
  if (!corotated) {
    cf_elastic_neo_hookean(dim, e->F, &e->mu, &e->lambda, T, J);
    return;
  }
  cf_elastic_corotated(dim, e->F, &e->mu, &e->lambda, T, J);
  if (!neo) return;
  cf_lanes other[9];
  cf_elastic_neo_hookean(dim, e->F, &e->mu, &e->lambda, other, J);
  const cf_real *kind = cf_mpm_at(m, m->at.material, 0) + e->first;
  for (int l = 0; l < e->n; ++l)
    if (cf_mpm_material_of(m, kind[l])->law == CF_MPM_NEO_HOOKEAN)
      for (int c = 0; c < dim * dim; ++c) T[c][l] = other[c][l];
}

/* c = c_0 J J_P: the water that fits in. */
CF_SMALL void cf_mpm_capacity(const cf_mpm_eight *e, const cf_lanes *J, cf_lanes *c) {
  *c = e->water_per_volume * e->volume * *J * e->plastic;
  cf_lanes_at_least((cf_real)1e-30, c); /* a body without pores holds none */
}

/* (35): nodes' velocities v* become v. */
cf_status cf_mpm_implicit(cf_mpm *m, double dt, cf_solve_report *report);

/* What obstacles make of the velocity of a node at `place`. held: 0 nothing, 1 normal part, 2 all of it; NULL: do not
 * care. */
void cf_mpm_collide(const cf_mpm *m, const cf_pose *pose, double t, const double place[3], double v[3],
                    double normal[3], int *held);

#define CF_MPM_BY_DIM(name, dim, ...) \
  do {                                \
    if ((dim) == 3)                   \
      name##_in_3d(__VA_ARGS__);      \
    else                              \
      name##_in_2d(__VA_ARGS__);      \
  } while (0)

#endif
