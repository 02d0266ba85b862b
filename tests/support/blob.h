/* SPDX-License-Identifier: MIT
 *
 * A scalar at rest in a box, started from a function with q = 0, stepped by any scheme; and exact solutions to
 * hold it against: in a periodic box of one axis by its Fourier modes, each of which follows
 *
 *     tau p'' + (1 + tau F k K^2) p' + k K^2 p = 0,    p'(0) = -F k K^2 p(0).
 */
#ifndef CF_TESTS_BLOB_H
#define CF_TESTS_BLOB_H

#include <complex.h>
#include <math.h>

#include "physics/diffuse.h"
#include "testing.h"

#define PI 3.14159265358979323846

typedef struct blob {
  cf_grid g;
  cf_walls walls;
  cf_diffuse_params p;
  cf_source source;
  cf_diffuse *d;
  cf_cell phi, s;
  cf_face q;
  bool scalar;
  cf_ledger ledger;
  cf_solve_report report;
  double t;
} blob;

static inline cf_walls walls_of(const cf_wall kind) {
  cf_walls w = {0};
  for (int a = 0; a < 3; ++a)
    for (int side = 0; side < 2; ++side) w.kind[a][side] = kind;
  return w;
}

/* Grid and fields; p, walls and source as set before. */
static inline void blob_open(blob *b, const int dim, const int *n, const double h, const double *origin) {
  OK(cf_grid_init(&b->g, dim, n, h, origin));
  if (b->p.capacity.eval == NULL && b->p.capacity.value == 0) b->p.capacity.value = 1;
  if (b->p.solver.tolerance == 0) b->p.solver = (cf_solve_options){1e-10, 500};
  OK(cf_cell_create(&b->phi, &b->g.box));
  OK(cf_cell_create(&b->s, &b->g.box));
  OK(cf_face_create(&b->q, &b->g.box));
  OK(cf_diffuse_create(&b->d, &b->g, &b->walls, &b->p, &b->source));
}

static inline void blob_close(blob *b) {
  cf_diffuse_destroy(b->d);
  cf_cell_destroy(&b->phi, &b->g.box);
  cf_cell_destroy(&b->s, &b->g.box);
  cf_face_destroy(&b->q, &b->g.box);
}

#define FOR_CELLS(b, i, j, k)                 \
  for (int k = 0; k < (b)->g.box.n[2]; ++k)   \
    for (int j = 0; j < (b)->g.box.n[1]; ++j) \
      for (int i = 0; i < (b)->g.box.n[0]; ++i)

static inline cf_real *blob_at(const blob *b, const int i, const int j, const int k) {
  return &b->phi.at[cf_box_at(&b->g.box, i, j, k)];
}

static inline void blob_start(blob *b) { b->ledger.first = cf_diffuse_content(b->d, b->phi); }

static inline void blob_step(blob *b, const double dt) {
  if (b->scalar)
    OK(cf_diffuse_step_scalar(b->d, b->t, dt, b->phi, b->s, &b->ledger, &b->report));
  else
    OK(cf_diffuse_step(b->d, b->t, dt, b->phi, b->q, &b->ledger, &b->report));
  b->t += dt;
}

static inline void blob_run(blob *b, const double end, const int steps) {
  const double dt = (end - b->t) / steps;
  for (int i = 0; i < steps; ++i) blob_step(b, dt);
}

static inline double blob_error(const blob *b) {
  return cf_ledger_error(&b->ledger, cf_diffuse_content(b->d, b->phi));
}

/* The factor by which mode K has changed at time t. */
static inline double mode_factor(const double K, const double k, const double tau, const double F,
                                 const double t) {
  const double a = k * K * K, b = 1 + tau * F * a;
  const double complex root = csqrt(b * b - 4 * tau * a);
  const double complex fast = -(b + root) / (2 * tau), slow = -2 * a / (b + root);
  if (cabs(root) < 1e-9) return exp(-b / (2 * tau) * t) * (1 + (b / (2 * tau) - F * a) * t);
  /* p = A exp(slow t) + B exp(fast t), A + B = 1, A slow + B fast = -F a */
  const double complex A = (-F * a - fast) / (slow - fast);
  return creal(A * cexp(slow * t) + (1 - A) * cexp(fast * t));
}

/* out = exact solution at time t in a periodic axis of length n h that starts from in. */
static inline void exact_axis(const int n, const double h, const double *in, const double t, const blob *b,
                              double *out) {
  for (int i = 0; i < n; ++i) out[i] = 0;
  for (int m = 0; m <= n / 2; ++m) {
    double re = 0, im = 0;
    for (int i = 0; i < n; ++i) {
      re += in[i] * cos(2 * PI * (double)((long)m * i % n) / n);
      im += in[i] * sin(2 * PI * (double)((long)m * i % n) / n);
    }
    const double share = (m == 0 || 2 * m == n ? 1.0 : 2.0) / n *
                         mode_factor(2 * PI * m / (n * h), b->p.k.value, b->p.tau, b->p.f_t, t);
    for (int i = 0; i < n; ++i)
      out[i] += share * (re * cos(2 * PI * (double)((long)m * i % n) / n) +
                         im * sin(2 * PI * (double)((long)m * i % n) / n));
  }
}

#endif
