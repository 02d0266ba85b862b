/* SPDX-License-Identifier: MIT
 *
 * One run of the diffusion step for the tests: a box, walls, parameters, and the state that a step moves.
 *
 *     diffuse_case c = diffuse_case_of(2, (int[3]){64, 1, 1}, 1.0 / 64);
 *     c.p.tau = 0.5;
 *     diffuse_begin(&c);
 *     diffuse_fill(&c, my_function, NULL);
 *     diffuse_run(&c, dt, steps);
 *     diffuse_end(&c);
 */
#ifndef CF_TESTS_DIFFUSE_CASE_H
#define CF_TESTS_DIFFUSE_CASE_H

#include <complex.h>
#include <math.h>

#include "physics/diffuse.h"
#include "testing.h"

typedef struct diffuse_case {
  cf_grid g;
  cf_walls walls;
  cf_diffuse_params p;
  cf_source source;
  cf_diffuse *d;
  cf_cell phi;
  cf_face q;
  cf_ledger ledger;
  cf_solve_report report;
  int iterations;
  double t;
} diffuse_case;

/* k = 1, C = 1, tau = 0, F_T = 0, SDIRK2 solved to round-off, insulated, the origin in the low corner. */
static inline diffuse_case diffuse_case_of(const int dim, const int n[3], const double h) {
  diffuse_case c = {0};
  OK(cf_grid_init(&c.g, dim, n, h, NULL));
  c.p = (cf_diffuse_params){.k = cf_fn_constant(1),
                            .capacity = cf_fn_constant(1),
                            .scheme = CF_DIFFUSE_SDIRK2,
                            .solver = {1e-13, 100}};
  return c;
}

static inline void diffuse_begin(diffuse_case *c) {
  OK(cf_diffuse_create(&c->d, &c->g, &c->walls, &c->p, &c->source));
  OK(cf_cell_create(&c->phi, &c->g.box));
  OK(cf_face_create(&c->q, &c->g.box));
}

static inline void diffuse_end(diffuse_case *c) {
  cf_diffuse_destroy(c->d);
  cf_cell_destroy(&c->phi, &c->g.box);
  cf_face_destroy(&c->q, &c->g.box);
}

typedef double (*place_function)(const void *context, double x, double y, double z);

static inline void fill_cells(const cf_grid *g, const place_function f, const void *context,
                              const cf_cell out) {
  for (int k = 0; k < g->box.n[2]; ++k)
    for (int j = 0; j < g->box.n[1]; ++j)
      for (int i = 0; i < g->box.n[0]; ++i)
        out.at[cf_box_at(&g->box, i, j, k)] =
            (cf_real)f(context, cf_grid_place(g, 0, i, 0), cf_grid_place(g, 1, j, 0),
                       g->box.dim == 3 ? cf_grid_place(g, 2, k, 0) : 0);
}

/* The ledger starts with what is filled in. */
static inline void diffuse_fill(diffuse_case *c, const place_function f, const void *context) {
  fill_cells(&c->g, f, context, c->phi);
  c->ledger = (cf_ledger){.first = cf_diffuse_content(c->d, c->phi)};
}

static inline void diffuse_run(diffuse_case *c, const double dt, const int steps) {
  const double start = c->t;
  for (int s = 0; s < steps; ++s) {
    OK(cf_diffuse_step(c->d, start + s * dt, dt, c->phi, c->q, &c->ledger, &c->report));
    if (!c->report.converged)
      fail_msg("step %d: residual %.3g after %d iterations", s, c->report.residual, c->report.iterations);
    c->iterations += c->report.iterations;
    c->t = start + (s + 1) * dt;
  }
}

static inline double diffuse_ledger_error(const diffuse_case *c) {
  return cf_ledger_error(&c->ledger, cf_diffuse_content(c->d, c->phi));
}

static inline double cell_at(const diffuse_case *c, const int i, const int j, const int k) {
  return (double)c->phi.at[cf_box_at(&c->g.box, i, j, k)];
}

/* Exact evolution of one mode: P' = -kap Q - F k kap^2 P, tau Q' = -Q + (1 - F) k kap P, where kap is the wave
 * number (or (2/h) sin(K h/2), then exact in time on the grid). Written with the slow exponent in a form that
 * keeps its digits. */
static inline void exact_mode(const double k, const double tau, const double F, const double kap,
                              const double t, double *P, double *Q) {
  const double P0 = *P, Q0 = *Q, kk = k * kap * kap;
  if (tau == 0) {
    *P = P0 * exp(-kk * t);
    *Q = (1 - F) * k * kap * *P;
    return;
  }
  const double b = 1 + tau * F * kk;
  const double complex root = csqrt(b * b - 4 * tau * kk), slow = -2 * kk / (b + root),
                       fast = -(b + root) / (2 * tau);
  const double slope = -kap * Q0 - F * kk * P0;
  const double complex gap = slow - fast, mean = 0.5 * (slow + fast), z = 0.5 * gap * t;
  double complex A = (slope - fast * P0) / gap, B = (slow * P0 - slope) / gap;
  double complex p = A * cexp(slow * t) + B * cexp(fast * t);
  double complex dp = slow * A * cexp(slow * t) + fast * B * cexp(fast * t);
  if (cabs(z) < 1e-3) { /* (nearly) a double exponent: sinh(z)/z and cosh(z) in powers of z */
    const double complex s = t * (1 + z * z / 6), c = 1 + z * z / 2, d = slope - mean * P0;
    p = cexp(mean * t) * (c * P0 + s * d);
    dp = mean * p + cexp(mean * t) * (z * z / (t * t) * s * P0 + c * d);
  }
  *P = creal(p);
  *Q = kap > 0 ? -(creal(dp) + F * kk * *P) / kap : Q0 * exp(-t / tau);
}

static inline double order_of(const double coarse, const double fine) { return log2(coarse / fine); }

#endif
