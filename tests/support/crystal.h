/* SPDX-License-Identifier: MIT
 *
 * A crystal in a closed box, for tests of physics/phase.h: Kobayashi's scales unless a test says otherwise.
 */
#ifndef CF_TESTS_CRYSTAL_H
#define CF_TESTS_CRYSTAL_H

#include <math.h>
#include <string.h>

#include "grid/sweep.h"
#include "physics/phase.h"
#include "testing.h"

typedef struct crystal {
  cf_grid g;
  cf_phase *p;
  cf_phase_state y;
} crystal;

static inline cf_phase_params crystal_params(void) {
  return (cf_phase_params){.width = 0.01,
                           .tau_eta = 3e-4,
                           .f_eta = 1,
                           .alpha = 0.9,
                           .gamma = 10,
                           .latent = 1.8,
                           .D = 1,
                           .f_t = 1,
                           .star = 1,
                           .solver = {1e-6, 100}};
}

static inline void crystal_make(crystal *c, const int dim, const int n[3], const double h,
                                const cf_phase_params *q, const cf_phase_places *places, const bool implicit,
                                const int threads) {
  const cf_phase_walls walls = {{.value = {{{0}}}}, {.value = {{{0}}}}};
  const double origin[3] = {-n[0] * h / 2, -n[1] * h / 2, dim == 3 ? -n[2] * h / 2 : 0};
  memset(c, 0, sizeof *c);
  OK(cf_grid_init(&c->g, dim, n, h, origin));
  c->g.threads = threads;
  OK(cf_phase_create(&c->p, &c->g, &walls, q, places, implicit));
  OK(cf_cell_create(&c->y.eta, &c->g.box));
  OK(cf_cell_create(&c->y.T, &c->g.box));
  OK(cf_cell_create(&c->y.r, &c->g.box));
  OK(cf_cell_create(&c->y.w, &c->g.box));
}

static inline void crystal_free(crystal *c) {
  cf_cell *cells[] = {&c->y.eta, &c->y.T, &c->y.r, &c->y.w};
  for (int i = 0; i < 4; ++i) cf_cell_destroy(cells[i], &c->g.box);
  cf_phase_destroy(c->p);
}

#define CRYSTAL_CELLS(c, i, j, k, q)            \
  for (int k = 0; k < (c)->g.box.n[2]; ++k)     \
    for (int j = 0; j < (c)->g.box.n[1]; ++j)   \
      for (int i = 0; i < (c)->g.box.n[0]; ++i) \
        for (ptrdiff_t q = cf_box_at(&(c)->g.box, i, j, k), once_ = 1; once_; once_ = 0)

/* A ball about the middle of the box, and T everywhere. */
static inline void crystal_ball(const crystal *c, const double radius, const double eps, const double T) {
  CRYSTAL_CELLS(c, i, j, k, q) {
    const double h = c->g.h; /* exactly as far on one side as on the other */
    const double x = (i + 0.5 - c->g.box.n[0] / 2.0) * h, y = (j + 0.5 - c->g.box.n[1] / 2.0) * h;
    const double z = c->g.box.dim == 3 ? (k + 0.5 - c->g.box.n[2] / 2.0) * h : 0;
    const double eta = (1 - tanh((sqrt(x * x + y * y + z * z) - radius) / (2 * sqrt(2) * eps))) / 2;
    c->y.eta.at[q] = (cf_real)(eta < 1e-16 ? 0 : eta);
    c->y.T.at[q] = (cf_real)T;
  }
}

static inline void crystal_grow(const crystal *c, const double dt, const int steps) {
  const cf_phase_explicit how = {.order = 3, .substeps = 1};
  for (int s = 0; s < steps; ++s) OK(cf_phase_step_explicit(c->p, s * dt, dt, &how, &c->y, NULL));
}

/* |sum of (r - mean) e^{i m theta}| over the mean, of the radius at which eta = 1/2 along 720 rays; and the phase in
 * degrees of the crystal, 0 ... 360/m. */
static inline double crystal_harmonic(const crystal *c, const int m, double *phase) {
  enum { RAYS = 720 };
  double r[RAYS], mean = 0, re = 0, im = 0;
  const double pi = acos(-1), h = c->g.h;
  for (int a = 0; a < RAYS; ++a) {
    const double theta = 2 * pi * a / RAYS, ux = cos(theta), uy = sin(theta);
    double last = 1, at = 0;
    for (double s = 0; s < c->g.box.n[0] * h; s += h / 4) {
      const double x = (s * ux - c->g.origin[0]) / h - 0.5, y = (s * uy - c->g.origin[1]) / h - 0.5;
      const int i = (int)floor(x), j = (int)floor(y);
      if (i < 0 || j < 0 || i + 1 >= c->g.box.n[0] || j + 1 >= c->g.box.n[1]) break;
      const double fx = x - i, fy = y - j;
      const cf_real *e = c->y.eta.at + cf_box_at(&c->g.box, i, j, 0);
      const ptrdiff_t up = c->g.box.stride[1];
      const double eta = (1 - fy) * ((1 - fx) * (double)e[0] + fx * (double)e[1]) +
                         fy * ((1 - fx) * (double)e[up] + fx * (double)e[up + 1]);
      if (last >= 0.5 && eta < 0.5) at = s - h / 4 * (0.5 - eta) / (last - eta);
      last = eta;
    }
    r[a] = at;
    mean += at / RAYS;
  }
  for (int a = 0; a < RAYS; ++a) {
    re += 2 * r[a] * cos(2 * pi * a * m / RAYS) / RAYS;
    im += 2 * r[a] * sin(2 * pi * a * m / RAYS) / RAYS;
  }
  if (phase != NULL) *phase = atan2(im, re) / m * 180 / pi;
  return hypot(re, im) / mean;
}

#endif
