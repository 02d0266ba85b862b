/* SPDX-License-Identifier: MIT
 *
 * Against numerical fracture: a body is whole for the grid as long as its particles are no further apart than cells
 * are. What is stretched more than that comes apart, although no law of the material says so: nodes between its
 * particles see nobody, and no force goes through them. So a particle knows the sides e_a of the piece of the undeformed
 * body that it stands for, and where one of them, stretched, is longer than a number of cells, the particle becomes
 * two, each in the middle of its half:
 *
 *     l = F e_a,  d = l/4:     x +- d,  v +- C d,  C (I - d d^T/D),  V0/2, m_f/2, A/2, e_a/2;  F, J_P as they were
 *
 * with D = h^2/4. Mass and water are halved and nothing else, momentum is kept because the two differences cancel, and
 * angular momentum because what the places of the two carry of it, m d x C d, is taken from their C. S stays what it
 * was. A new particle comes after all others; they are made in the order of those they come from, so that the number of
 * threads does not matter.
 *
 * Does not do: the way back. Particles of a body that shrinks again stay as many as they are.
 */
#include "physics/mpm_part.h"

#define PART 4096

/* The square of the length of side a of eight particles. */
CF_SMALL void length_of(const int dim, const cf_lanes *F, const cf_lanes *side, const int a,
                        cf_lanes *square) {
  *square = F[a] * F[a];
  CF_SMALL_LOOP
  for (int r = 1; r < dim; ++r) *square += F[r * dim + a] * F[r * dim + a];
  *square *= side[a] * side[a];
}

/* key: 0, or 1 + the axis to cut across, of particles from ... to - 1. Returns how many are not 0. */
CF_KERNEL int64_t mark_part(const int dim, const cf_mpm *m, const int64_t from, const int64_t to,
                            const cf_real most) {
  int64_t found = 0;
  for (int64_t i = from; i < to; i += CF_WIDE) {
    const int n = to - i < CF_WIDE ? (int)(to - i) : CF_WIDE;
    uint32_t *key = m->set->key + i;
    cf_lanes F[9], side[3], square, longest = {0};
    cf_real any = 0;
    cf_mpm_load(n, m, m->at.deformation, dim * dim, i, F);
    cf_mpm_load(n, m, m->at.side, dim, i, side);
    CF_SMALL_LOOP
    for (int a = 0; a < dim; ++a) {
      length_of(dim, F, side, a, &square);
      for (int l = 0; l < CF_WIDE; ++l) longest[l] = CF_MAX(longest[l], square[l]);
    }
    memset(key, 0, sizeof *key * (size_t)n);
    for (int l = 0; l < CF_WIDE; ++l) any = CF_MAX(any, longest[l]);
    if (!(any > most * most)) continue; /* nearly always */
    for (int a = dim - 1; a >= 0; --a) {
      length_of(dim, F, side, a, &square);
      for (int l = 0; l < n; ++l)
        if (longest[l] > most * most && square[l] >= longest[l]) key[l] = (uint32_t)a + 1;
    }
    for (int l = 0; l < n; ++l) found += key[l] != 0;
  }
  return found;
}
CF_CLONES static void mark_in_2d(const cf_mpm *m, const int64_t from, const int64_t to, const cf_real most,
                                 int64_t *found) {
  *found = mark_part(2, m, from, to, most);
}
CF_CLONES static void mark_in_3d(const cf_mpm *m, const int64_t from, const int64_t to, const cf_real most,
                                 int64_t *found) {
  *found = mark_part(3, m, from, to, most);
}

/* A new particle like particle i. */
static int64_t copy_of(const cf_mpm *m, const int64_t i) {
  cf_particles *set = m->set;
  int64_t p;
  if (cf_particles_append(set, 1, &p) != CF_OK) return -1; /* only where there is no room, which is seen to */
  for (int a = 0; a < set->attributes; ++a)
    for (int c = 0; c < set->attribute[a].components; ++c)
      set->attribute[a].at[c][p] = set->attribute[a].at[c][i];
  return p;
}

static void move_by(const cf_mpm *m, const int64_t i, const double sign, const double *d, const double *Cd) {
  for (int a = 0; a < m->grid->box.dim; ++a) {
    cf_mpm_at(m, m->at.position, a)[i] += (cf_real)(sign * d[a]);
    cf_mpm_at(m, m->at.velocity, a)[i] += (cf_real)(sign * Cd[a]);
  }
}

static void cut(const cf_mpm *m, const int64_t i, const int axis) {
  const int dim = m->grid->box.dim, halved[] = {m->at.volume, m->at.water, m->at.memory};
  const double per_D = CF_BSPLINE_INERTIA / (m->grid->h * m->grid->h);
  double d[3], Cd[3];
  cf_real *side = &cf_mpm_at(m, m->at.side, axis)[i];
  for (int a = 0; a < dim; ++a)
    d[a] = (double)cf_mpm_at(m, m->at.deformation, a * dim + axis)[i] * (double)*side / 4;
  for (int a = 0; a < dim; ++a) {
    Cd[a] = 0;
    for (int b = 0; b < dim; ++b) Cd[a] += (double)cf_mpm_at(m, m->at.affine, a * dim + b)[i] * d[b];
  }
  for (int a = 0; a < dim; ++a)
    for (int b = 0; b < dim; ++b)
      cf_mpm_at(m, m->at.affine, a * dim + b)[i] -= (cf_real)(per_D * Cd[a] * d[b]);
  for (int k = 0; k < 3; ++k) cf_mpm_at(m, halved[k], 0)[i] /= 2;
  *side /= 2;
  const int64_t other = copy_of(m, i);
  move_by(m, i, -1, d, Cd);
  move_by(m, other, 1, d, Cd);
}

int64_t cf_mpm_split(cf_mpm *m, const double most) {
  const int64_t count = m->set->count;
  int64_t found = 0;
#pragma omp parallel for schedule(static) num_threads(m->grid->threads) reduction(+ : found)
  for (int64_t from = 0; from < count; from += PART) {
    int64_t here;
    CF_MPM_BY_DIM(mark, m->grid->box.dim, m, from, CF_MIN(from + PART, count), (cf_real)(most * m->grid->h),
                  &here);
    found += here;
  }
  for (int64_t i = 0; i < count && found > 0 && m->set->count < m->set->room; ++i)
    if (m->set->key[i] != 0) cut(m, i, (int)m->set->key[i] - 1);
  return m->set->count - count;
}
