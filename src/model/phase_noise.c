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

typedef struct noise {
  uint64_t seed, period;
} noise;

static double number_at(const noise *s, const double i, const double j, const double k) {
  return cf_random(s->seed, 7, s->period, lattice(i, j, k)) - 0.5;
}

/* Between the eight lattice points around x (in cells). */
static double between(const noise *s, const double x[3]) {
  double sum = 0, low[3], part[3];
  for (int a = 0; a < 3; ++a) low[a] = floor(x[a]), part[a] = x[a] - low[a];
  for (int c = 0; c < 8; ++c) {
    const int up[3] = {c & 1, c >> 1 & 1, c >> 2};
    double weight = 1;
    for (int a = 0; a < 3; ++a) weight *= up[a] ? part[a] : 1 - part[a];
    if (weight > 0) sum += weight * number_at(s, low[0] + up[0], low[1] + up[1], low[2] + up[2]);
  }
  return sum;
}

/* The place in the sector 0 <= theta <= pi/n; exact for n = 2 and 4. */
static void fold(const int n, const double angle, double x[3]) {
  if (angle == 0 && (n == 2 || n == 4)) {
    const double a = fabs(x[0]), b = fabs(x[1]);
    x[0] = n == 4 ? fmax(a, b) : a;
    x[1] = n == 4 ? fmin(a, b) : b;
    return;
  }
  const double r = hypot(x[0], x[1]), sector = 2 * acos(-1) / n;
  const double theta = fabs(remainder(atan2(x[1], x[0]) - angle, sector));
  x[0] = r * cos(theta);
  x[1] = r * sin(theta);
}

static double noise_at(const cf_crystal *m, const noise *s, const int at[3]) {
  const int symmetric = (int)m->scene->phase.noise.symmetric;
  double x[3] = {at[0], at[1], at[2]};
  if (m->window_axis >= 0) x[m->window_axis] += m->window_cells;
  if (symmetric == 0) return number_at(s, x[0], x[1], x[2]);
  for (int a = 0; a < 3; ++a)
    x[a] = a < m->grid->box.dim ? (cf_grid_place(m->grid, a, at[a], 0) - cf_crystal_centre(m, a)) / m->grid->h
                                : 0;
  fold(symmetric, m->params.anisotropy.angle, x);
  x[2] = fabs(x[2]);
  return between(s, x);
}

void cf_crystal_make_noise(cf_crystal *m, const double t) {
  const cf_scene_phase_noise *keys = &m->scene->phase.noise;
  const cf_box *box = &m->grid->box;
  if (m->places.noise.at == NULL) return;
  const int64_t period = (int64_t)floor(t / keys->period * (1 + 1e-12));
  if (period == m->noise_of) return;
  m->noise_of = period;
  const noise s = {(uint64_t)keys->seed, (uint64_t)period};
  CF_PARALLEL_ROWS (box, m->grid->threads, r) {
    int at[3] = {0, (int)(r % box->n[1]), (int)(r / box->n[1])};
    for (at[0] = 0; at[0] < box->n[0]; ++at[0])
      m->places.noise.at[cf_box_at(box, at[0], at[1], at[2])] =
          (cf_real)(keys->amplitude * noise_at(m, &s, at));
  }
}
