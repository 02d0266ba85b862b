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

/* Cells of a row that go together, with room for what is in between. */
#define TOGETHER 128

typedef struct places {
  double x[3][TOGETHER];
} places;

/* Lattice points may be negative. */
CF_KERNEL uint64_t lattice(const double i, const double j, const double k) {
  const int64_t far = INT64_C(1) << 20;
  return ((uint64_t)((int64_t)k + far) << 42) ^ ((uint64_t)((int64_t)j + far) << 21) ^
         (uint64_t)((int64_t)i + far);
}

/* Between the four or eight lattice points around each place (in cells). */
CF_KERNEL void between(const int dim, const int n, const uint64_t key, const double amplitude,
                       const places *at, cf_real *noise) {
  CF_ROW_LOOP
  for (int i = 0; i < n; ++i) {
    double sum = 0, low[3] = {0}, part[3] = {0};
    for (int a = 0; a < dim; ++a) low[a] = floor(at->x[a][i]), part[a] = at->x[a][i] - low[a];
    for (int c = 0; c < 1 << dim; ++c) {
      const int up_x = c & 1, up_y = c >> 1 & 1, up_z = c >> 2;
      double weight = (up_x ? part[0] : 1 - part[0]) * (up_y ? part[1] : 1 - part[1]);
      if (dim == 3) weight *= up_z ? part[2] : 1 - part[2];
      const uint64_t point = lattice(low[0] + up_x, low[1] + up_y, low[2] + up_z);
      sum += weight * (cf_random_at(key, point) - 0.5);
    }
    noise[i] = (cf_real)(amplitude * sum);
  }
}

CF_CLONES static void between_row(const int dim, const int n, const uint64_t key, const double amplitude,
                                  const places *at, cf_real *noise) {
  if (dim == 2)
    between(2, n, key, amplitude, at, noise);
  else
    between(3, n, key, amplitude, at, noise);
}

CF_CLONES static void lattice_row(const int n, const uint64_t key, const double amplitude, const places *at,
                                  cf_real *noise) {
  CF_ROW_LOOP
  for (int i = 0; i < n; ++i)
    noise[i] =
        (cf_real)(amplitude * (cf_random_at(key, lattice(at->x[0][i], at->x[1][i], at->x[2][i])) - 0.5));
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

/* The places in the sector, by reflections in its two mirrors in turn; exact for n = 2 and 4 along the axes. */
CF_CLONES static void fold_row(const int n, const sector *m, double *x, double *y) {
  const sector s = *m;
  if (s.S == 0 && (s.n == 2 || s.n == 4)) {
    const bool four = s.n == 4;
    CF_ROW_LOOP
    for (int i = 0; i < n; ++i) {
      const double a = x[i] < 0 ? -x[i] : x[i], b = y[i] < 0 ? -y[i] : y[i];
      const bool turned = four && a < b;
      x[i] = turned ? b : a;
      y[i] = turned ? a : b;
    }
    return;
  }
  CF_ROW_LOOP
  for (int i = 0; i < n; ++i) {
    const double u = s.C * x[i] + s.S * y[i], v = s.C * y[i] - s.S * x[i];
    x[i] = u;
    y[i] = v < 0 ? -v : v;
  }
  for (int k = 0; k < s.n; ++k) {
    CF_ROW_LOOP
    for (int i = 0; i < n; ++i) {
      const double u = x[i], v = y[i], over = s.s_2 * u - s.c_2 * v;
      const bool outside = v * s.c > u * s.s;
      x[i] = outside ? s.c_2 * u + s.s_2 * v : u;
      y[i] = !outside ? v : over < 0 ? -over : over;
    }
  }
}

typedef struct noise {
  uint64_t key;
  double amplitude;
  bool folds;
  sector mirrors;
  double centre[3]; /* of the crystal, m */
} noise;

/* Of the cells i, ..., i + n - 1 of a row. */
static void noise_of_cells(const cf_crystal *m, const noise *w, const int i, const int j, const int k,
                           const int n) {
  const int dim = m->grid->box.dim;
  cf_real *to = m->places.noise.at + cf_box_at(&m->grid->box, i, j, k);
  places at;
  for (int a = 0; a < 3; ++a)
    for (int l = 0; l < n; ++l) {
      const int cell = a == 0 ? i + l : a == 1 ? j : k;
      at.x[a][l] = w->folds && a < dim ? (cf_grid_place(m->grid, a, cell, 0) - w->centre[a]) / m->grid->h
                                       : cell + (a == m->window_axis ? m->window_cells : 0);
    }
  if (!w->folds) {
    lattice_row(n, w->key, w->amplitude, &at, to);
    return;
  }
  fold_row(n, &w->mirrors, at.x[0], at.x[1]);
  for (int l = 0; l < n; ++l) at.x[2][l] = fabs(at.x[2][l]);
  between_row(dim, n, w->key, w->amplitude, &at, to);
}

void cf_crystal_make_noise(cf_crystal *m, const double t) {
  const cf_scene_phase_noise *keys = &m->scene->phase.noise;
  const cf_box *box = &m->grid->box;
  if (m->places.noise.at == NULL) return;
  const int64_t period = (int64_t)floor(t / keys->period * (1 + 1e-12));
  if (period == m->noise_of) return;
  m->noise_of = period;
  noise w = {cf_random_key((uint64_t)keys->seed, 7, (uint64_t)period),
             keys->amplitude,
             keys->symmetric > 0,
             sector_of((int)(keys->symmetric > 0 ? keys->symmetric : 1), m->params.anisotropy.angle),
             {0}};
  for (int a = 0; a < box->dim; ++a) w.centre[a] = cf_crystal_centre(m, a);
  CF_PARALLEL_ROWS (box, m->grid->threads, r)
    for (int i = 0; i < box->n[0]; i += TOGETHER)
      noise_of_cells(m, &w, i, (int)(r % box->n[1]), (int)(r / box->n[1]), CF_MIN(TOGETHER, box->n[0] - i));
}
