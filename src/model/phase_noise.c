/* SPDX-License-Identifier: MIT
 *
 * Noise in psi: counted random numbers (base/rng.h), one a cell and period, so that it is the same for any number
 * of threads, any dt, and after a resume. With a symmetry the place is folded into one sector of the dihedral group
 * about the first seed, and the noise read there between the numbers of a lattice of cells.
 */
#include <math.h>

#include "base/rng.h"
#include "grid/sweep.h"
#include "model/phase_part.h"

/* Lattice points may be negative. */
static uint64_t lattice(const double i, const double j, const double k) {
  const uint64_t far = UINT64_C(1) << 20;
  return ((uint64_t)((int64_t)k + (int64_t)far) << 42) ^ ((uint64_t)((int64_t)j + (int64_t)far) << 21) ^
         (uint64_t)((int64_t)i + (int64_t)far);
}

static double number_at(const uint64_t key, const double i, const double j, const double k) {
  return cf_random_at(key, lattice(i, j, k)) - 0.5;
}

/* Between the four or eight lattice points around x (in cells). */
static double between(const uint64_t key, const int dim, const double x[3]) {
  double sum = 0, low[3] = {0}, part[3] = {0};
  for (int a = 0; a < dim; ++a) low[a] = floor(x[a]), part[a] = x[a] - low[a];
  for (int c = 0; c < 1 << dim; ++c) {
    const int up[3] = {c & 1, c >> 1 & 1, c >> 2};
    double weight = 1;
    for (int a = 0; a < dim; ++a) weight *= up[a] ? part[a] : 1 - part[a];
    if (weight > 0) sum += weight * number_at(key, low[0] + up[0], low[1] + up[1], low[2] + up[2]);
  }
  return sum;
}

/* The mirrors that bound a sector 0 <= theta <= pi/n, one the x axis and one at pi/n, seen from axes at `angle`. */
typedef struct sector {
  int n;
  double C, S;           /* of the axes */
  double c, s, c_2, s_2; /* of pi/n, and of twice that */
} sector;

static sector sector_of(const int n, const double angle) {
  const double half = acos(-1) / n;
  return (sector){n, cos(angle), sin(angle), cos(half), sin(half), cos(2 * half), sin(2 * half)};
}

/* The place in the sector, by reflections in its two mirrors in turn; exact for n = 2 and 4 along the axes. */
static void fold(const sector *m, double x[3]) {
  if (m->S == 0 && (m->n == 2 || m->n == 4)) {
    const double a = fabs(x[0]), b = fabs(x[1]);
    x[0] = m->n == 4 ? fmax(a, b) : a;
    x[1] = m->n == 4 ? fmin(a, b) : b;
    return;
  }
  double u = m->C * x[0] + m->S * x[1], v = fabs(m->C * x[1] - m->S * x[0]);
  for (int i = 0; i < m->n && v * m->c > u * m->s; ++i) {
    const double mirrored = m->c_2 * u + m->s_2 * v;
    v = fabs(m->s_2 * u - m->c_2 * v);
    u = mirrored;
  }
  x[0] = u;
  x[1] = v;
}

static double noise_at(const cf_crystal *m, const uint64_t key, const sector *mirrors, const int at[3]) {
  const int symmetric = (int)m->scene->phase.noise.symmetric;
  double x[3] = {at[0], at[1], at[2]};
  if (m->window_axis >= 0) x[m->window_axis] += m->window_cells;
  if (symmetric == 0) return number_at(key, x[0], x[1], x[2]);
  for (int a = 0; a < 3; ++a)
    x[a] = a < m->grid->box.dim ? (cf_grid_place(m->grid, a, at[a], 0) - cf_crystal_centre(m, a)) / m->grid->h
                                : 0;
  fold(mirrors, x);
  x[2] = fabs(x[2]);
  return between(key, m->grid->box.dim, x);
}

void cf_crystal_make_noise(cf_crystal *m, const double t) {
  const cf_scene_phase_noise *keys = &m->scene->phase.noise;
  const cf_box *box = &m->grid->box;
  if (m->places.noise.at == NULL) return;
  const int64_t period = (int64_t)floor(t / keys->period * (1 + 1e-12));
  if (period == m->noise_of) return;
  m->noise_of = period;
  const uint64_t key = cf_random_key((uint64_t)keys->seed, 7, (uint64_t)period);
  const sector mirrors =
      sector_of((int)(keys->symmetric > 0 ? keys->symmetric : 1), m->params.anisotropy.angle);
  CF_PARALLEL_ROWS (box, m->grid->threads, r) {
    int at[3] = {0, (int)(r % box->n[1]), (int)(r / box->n[1])};
    for (at[0] = 0; at[0] < box->n[0]; ++at[0])
      m->places.noise.at[cf_box_at(box, at[0], at[1], at[2])] =
          (cf_real)(keys->amplitude * noise_at(m, key, &mirrors, at));
  }
}
