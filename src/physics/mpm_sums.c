/* SPDX-License-Identifier: MIT
 *
 * What is asked of all particles: how long a step may be, sums for metrics, and the saturation, volume and stress that
 * pictures show. Particles are taken in parts of fixed length, whose results are joined in their order.
 */
#include <math.h>

#include "base/mem.h"
#include "physics/mpm_part.h"

#define PART 4096

/* Eight particles without their nodes. */
CF_SMALL void load_alone(const int dim, const cf_mpm *m, const int64_t first, const int64_t end,
                         cf_mpm_eight *e) {
  const cf_block all = {.first = 0, .count = end};
  cf_mpm_eight_load(dim, m, &all, first, e);
}

/* --- limits ------------------------------------------------------------------------------------------------ */

/* The square of the speed of pressure waves: over the initial density, T's slope in ln F with stretches s along the
 * longest row of F, 2 mu s (2s - 1) + lambda J (2J - 1) + chi S for either law. */
CF_KERNEL void limits_part(const int dim, const cf_mpm *m, const int64_t from, const int64_t to,
                           cf_mpm_limits *most) {
  cf_lanes v[3], C[9], J, c, water;
  double speed = 0, waves = 0;
  for (int64_t i = from; i < to; i += CF_WIDE) {
    cf_mpm_eight e;
    load_alone(dim, m, i, to, &e);
    cf_mpm_load(e.n, m, m->at.velocity, dim, i, v);
    cf_mpm_load(e.n, m, m->at.water, 1, i, &water);
    cf_small_cofactor(dim, e.F, C, &J);
    cf_mpm_capacity(&e, &J, &c);
    cf_lanes longest = {0};
    for (int a = 0; a < dim; ++a) {
      cf_lanes row = e.F[a * dim] * e.F[a * dim];
      for (int k = 1; k < dim; ++k) row += e.F[a * dim + k] * e.F[a * dim + k];
      for (int l = 0; l < CF_WIDE; ++l) longest[l] = CF_MAX(longest[l], row[l]);
      for (int l = 0; l < CF_WIDE; ++l) speed = fmax(speed, fabs((double)v[a][l]));
    }
    cf_lanes s = longest;
    cf_lanes_sqrt(&s);
    cf_lanes_at_least(1, &s);
    cf_lanes_at_least(1, &J);
    const cf_lanes modulus = 2 * e.mu * s * (2 * s - 1) + e.lambda * J * (2 * J - 1) + e.chi * water / c;
    for (int l = 0; l < CF_WIDE; ++l) waves = fmax(waves, (double)modulus[l] / (double)e.density[l]);
  }
  *most = (cf_mpm_limits){speed, sqrt(waves)};
}
CF_CLONES static void limits_in_2d(const cf_mpm *m, const int64_t from, const int64_t to,
                                   cf_mpm_limits *most) {
  limits_part(2, m, from, to, most);
}
CF_CLONES static void limits_in_3d(const cf_mpm *m, const int64_t from, const int64_t to,
                                   cf_mpm_limits *most) {
  limits_part(3, m, from, to, most);
}

cf_mpm_limits cf_mpm_limits_of(const cf_mpm *m) {
  double speed = 0, waves = 0;
#pragma omp parallel for schedule(static) num_threads(m->grid->threads) reduction(max : speed, waves)
  for (int64_t from = 0; from < m->set->count; from += PART) {
    cf_mpm_limits one;
    CF_MPM_BY_DIM(limits, m->grid->box.dim, m, from, CF_MIN(from + PART, m->set->count), &one);
    speed = CF_MAX(speed, one.speed), waves = CF_MAX(waves, one.waves);
  }
  return (cf_mpm_limits){speed, waves};
}

/* --- sums -------------------------------------------------------------------------------------------------- */

static void add_particle(const cf_mpm *m, const int64_t i, const double density, const double J,
                         const double c, cf_mpm_sums *s) {
  const int dim = m->grid->box.dim;
  double x[3] = {0, 0, 0}, v[3] = {0, 0, 0}, spin[3] = {0, 0, 0};
  const double volume = (double)cf_mpm_at(m, m->at.volume, 0)[i], mass = density * volume;
  const double water = (double)cf_mpm_at(m, m->at.water, 0)[i], S = water / c;
  for (int a = 0; a < dim; ++a) {
    x[a] = (double)cf_mpm_at(m, m->at.position, a)[i];
    v[a] = (double)cf_mpm_at(m, m->at.velocity, a)[i];
  }
  /* sum w (x_i - x)(x_i - x)^T = (h^2/4) I: the affine part's share of the angular momentum */
  const double inertia = m->grid->h * m->grid->h / CF_BSPLINE_INERTIA;
  for (int a = 0; a < 3; ++a) {
    const int b = (a + 1) % 3, d = (a + 2) % 3;
    if (b < dim && d < dim && m->old == NULL)
      spin[a] = inertia * ((double)cf_mpm_at(m, m->at.affine, d * dim + b)[i] -
                           (double)cf_mpm_at(m, m->at.affine, b * dim + d)[i]);
    s->momentum[a] += mass * v[a];
    s->angular[a] += mass * (x[b] * v[d] - x[d] * v[b] + spin[a]);
    s->kinetic += mass * v[a] * v[a] / 2;
    s->center[a] += mass * x[a];
  }
  s->mass += mass;
  s->volume += volume * J;
  s->water += water;
  s->capacity += c;
  s->memory += (double)cf_mpm_at(m, m->at.memory, 0)[i];
  s->saturation_min = CF_MIN(s->saturation_min, S), s->saturation_max = CF_MAX(s->saturation_max, S);
  s->jacobian_min = CF_MIN(s->jacobian_min, J), s->jacobian_max = CF_MAX(s->jacobian_max, J);
}

CF_KERNEL void sums_part(const int dim, const cf_mpm *m, const int64_t from, const int64_t to,
                         cf_mpm_sums *s) {
  cf_lanes C[9], J, c;
  for (int64_t i = from; i < to; i += CF_WIDE) {
    cf_mpm_eight e;
    load_alone(dim, m, i, to, &e);
    cf_small_cofactor(dim, e.F, C, &J);
    cf_mpm_capacity(&e, &J, &c);
    for (int l = 0; l < e.n; ++l)
      add_particle(m, i + l, (double)e.density[l], (double)(J[l] * e.plastic[l]), (double)c[l], s);
  }
}

static void join(cf_mpm_sums *a, const cf_mpm_sums *b) {
  double *to = &a->mass;
  const double *from = &b->mass;
  for (size_t i = 0; i < offsetof(cf_mpm_sums, saturation_min) / sizeof(double); ++i) to[i] += from[i];
  a->saturation_min = CF_MIN(a->saturation_min, b->saturation_min);
  a->saturation_max = CF_MAX(a->saturation_max, b->saturation_max);
  a->jacobian_min = CF_MIN(a->jacobian_min, b->jacobian_min);
  a->jacobian_max = CF_MAX(a->jacobian_max, b->jacobian_max);
}

#define PARTS_AT_ONCE 64

cf_mpm_sums cf_mpm_sums_of(const cf_mpm *m) {
  const cf_mpm_sums none = {.saturation_min = HUGE_VAL,
                            .saturation_max = -HUGE_VAL,
                            .jacobian_min = HUGE_VAL,
                            .jacobian_max = -HUGE_VAL};
  cf_mpm_sums all = none, part[PARTS_AT_ONCE];
  for (int64_t start = 0; start < m->set->count; start += (int64_t)PART * PARTS_AT_ONCE) {
#pragma omp parallel for schedule(static) num_threads(m->grid->threads)
    for (int p = 0; p < PARTS_AT_ONCE; ++p) {
      const int64_t from = start + (int64_t)p * PART, to = CF_MIN(from + PART, m->set->count);
      part[p] = none;
      if (m->grid->box.dim == 3)
        sums_part(3, m, from, to, &part[p]);
      else
        sums_part(2, m, from, to, &part[p]);
    }
    for (int p = 0; p < PARTS_AT_ONCE; ++p) join(&all, &part[p]);
  }
  for (int a = 0; a < 3; ++a) all.center[a] /= all.mass > 0 ? all.mass : 1;
  return all;
}

/* --- pictures ---------------------------------------------------------------------------------------------- */

CF_KERNEL void derive_part(const int dim, const cf_mpm *m, const int64_t from, const int64_t to,
                           cf_real *saturation, cf_real *jacobian, cf_real *const *stress) {
  for (int64_t i = from; i < to; i += CF_WIDE) {
    cf_mpm_eight e;
    cf_lanes T[9], J, c, water, S;
    load_alone(dim, m, i, to, &e);
    cf_mpm_load(e.n, m, m->at.water, 1, i, &water);
    cf_mpm_elastic(dim, m, &e, T, &J);
    cf_mpm_capacity(&e, &J, &c);
    S = water / c;
    J = J * e.plastic;
    if (saturation != NULL) cf_lanes_store(e.n, &S, saturation, i);
    if (jacobian != NULL) cf_lanes_store(e.n, &J, jacobian, i);
    if (stress == NULL) continue;
    for (int a = 0; a < dim; ++a) T[a * dim + a] -= e.chi * S;
    for (int k = 0; k < dim * dim; ++k) cf_lanes_store(e.n, &T[k], stress[k], i);
  }
}

void cf_mpm_derive(const cf_mpm *m, cf_real *saturation, cf_real *jacobian, cf_real *const *stress) {
#pragma omp parallel for schedule(static) num_threads(m->grid->threads)
  for (int64_t from = 0; from < m->set->count; from += PART) {
    const int64_t to = CF_MIN(from + PART, m->set->count);
    if (m->grid->box.dim == 3)
      derive_part(3, m, from, to, saturation, jacobian, stress);
    else
      derive_part(2, m, from, to, saturation, jacobian, stress);
  }
}
