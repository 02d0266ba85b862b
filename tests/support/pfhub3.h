/* SPDX-License-Identifier: MIT
 *
 * PFHub's benchmark 3: a quarter of a dendrite in a box of 960, which is cut to what has felt anything by the end.
 *
 * The benchmark's phi is 2 eta - 1, and its free energy
 *
 *     F = integral of A^2 |grad phi|^2/2 - phi^2/2 + phi^4/4 + lambda T phi (1 - 2 phi^2/3 + phi^4/5)
 *       = 4 E - integral of 1/4 + 8/15 lambda T,
 *
 * E being that of physics/phase.h.
 */
#ifndef CF_TESTS_PFHUB3_H
#define CF_TESTS_PFHUB3_H

#include "crystal.h"
#include "reference.h"

#define DENDRITE_BOX    960.0
#define DENDRITE_LAMBDA (10 / 0.6267)
#define DENDRITE_ENERGY 2122248.958 /* at time 0 */

typedef struct dendrite {
  double tip, solid, energy; /* solid: the part of the whole box */
} dendrite;

typedef struct dendrite_case {
  double h, dt, end, side; /* side of the box */
  bool plain;              /* five points, and Euler's steps */
} dendrite_case;

static inline void dendrite_print(const dendrite *d) {
  print_message("tip %.3f, solid %.7f, free energy %.1f\n", d->tip, d->solid, d->energy);
}

static inline dendrite dendrite_measured(const crystal *c) {
  const double corner[3] = {c->g.origin[0], c->g.origin[1], 0}, area = DENDRITE_BOX * DENDRITE_BOX;
  double where[3], warm = 0;
  CRYSTAL_CELLS(c, i, j, k, p) warm += (double)c->y.T.at[p] + 0.3;
  const double heat = warm * c->g.h * c->g.h - 0.3 * area;
  return (dendrite){cf_phase_tip(c->p, c->y.eta, corner, 0, where), cf_phase_solid(c->p, c->y.eta) / area,
                    4 * cf_phase_energy(c->p, &c->y) - area / 4 - 8.0 / 15 * DENDRITE_LAMBDA * heat};
}

static inline void dendrite_make(crystal *c, const dendrite_case *of, const int threads) {
  const cf_phase_params q = {.plain = of->plain,
                             .width = 1,
                             .tau_eta = 1,
                             .f_eta = 1,
                             .karma_rappel = true,
                             .coupling = DENDRITE_LAMBDA,
                             .latent = 1,
                             .D = 10,
                             .f_t = 1,
                             .star = 1,
                             .anisotropy = {.n = 4, .strength = 0.05},
                             .solver = {1e-6, 100}};
  const int n = (int)(of->side / of->h + 0.5);
  crystal_make(c, 2, (int[3]){n, n, 1}, of->h, &q, NULL, false, threads);
  CRYSTAL_CELLS(c, i, j, k, p) {
    const double r = hypot((i + 0.5) * of->h, (j + 0.5) * of->h);
    c->y.eta.at[p] = (cf_real)((1 - tanh((r - 8) / sqrt(2))) / 2);
    c->y.T.at[p] = (cf_real)-0.3;
  }
}

/* From t to `end`. */
static inline void dendrite_grow(crystal *c, const dendrite_case *of, const double t, const double end) {
  const int steps = (int)ceil((end - t) / of->dt * (1 - 1e-12));
  const cf_phase_explicit how = {.order = of->plain ? 1 : 3, .substeps = steps};
  OK(cf_phase_step_explicit(c->p, t, end - t, &how, &c->y, NULL));
}

static inline dendrite dendrite_grown(const dendrite_case *of) {
  crystal c;
  dendrite_make(&c, of, 1);
  dendrite_grow(&c, of, 0, of->end);
  const dendrite found = dendrite_measured(&c);
  crystal_free(&c);
  return found;
}

#endif
