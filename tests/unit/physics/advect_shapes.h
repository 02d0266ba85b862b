/* SPDX-License-Identifier: MIT
 *
 * Shapes carried about and back, for the tests of how well advection does it: a Gaussian and a disk with a slot
 * (Zalesak 1979), one turn of a rotation that comes to rest towards r = 1/2, and one period of a swirl that
 * deforms and undoes itself (LeVeque 1996). Each returns the relative L1 error.
 */
#ifndef TEST_ADVECT_SHAPES_H
#define TEST_ADVECT_SHAPES_H

#include "advect_flows.h"

static inline double gauss(const double x[3]) {
  const double r2 = (x[0] - 0.5) * (x[0] - 0.5) + (x[1] - 0.75) * (x[1] - 0.75);
  return exp(-r2 / (0.07 * 0.07));
}

static inline double disk(const double x[3]) {
  return (x[0] - 0.5) * (x[0] - 0.5) + (x[1] - 0.75) * (x[1] - 0.75) < 0.15 * 0.15 ? 1 : 0;
}

static inline double slotted(const double x[3]) {
  return fabs(x[0] - 0.5) < 0.025 && x[1] < 0.85 ? 0 : disk(x);
}

/* What share of a cell of a 128th the slotted disk covers. */
static inline double slotted_share(const double x[3]) {
  double covered = 0;
  for (int j = 0; j < 8; ++j)
    for (int i = 0; i < 8; ++i) {
      const double y[3] = {x[0] + ((i + 0.5) / 8 - 0.5) / 128, x[1] + ((j + 0.5) / 8 - 0.5) / 128, 0};
      covered += slotted(y) / 64;
    }
  return covered;
}

/* A turn in unit time, at rest beyond r = 1/2: smooth from r = 0.42 on. */
static inline double turning(const int axis, const int i[3], const double x[3], const void *context) {
  (void)axis, (void)i, (void)context;
  const double r = hypot(x[0] - 0.5, x[1] - 0.5), a = 0.44, b = 0.5;
  if (r < a) return -PI * r * r;
  /* The angular velocity falls from 2 pi to 0 between a and b; the potential is its integral times r. */
  const int steps = 200;
  const double end = r < b ? r : b, width = (end - a) / steps;
  double sum = -PI * a * a;
  for (int s = 0; s < steps; ++s) {
    const double at = a + (s + 0.5) * width, t = (at - a) / (b - a);
    sum -= 2 * PI * at * (1 - t * t * (3 - 2 * t)) * width;
  }
  return sum;
}

static inline double swirl(const int axis, const int i[3], const double x[3], const void *context) {
  (void)axis, (void)i, (void)context;
  const double sx = sin(PI * x[0]), sy = sin(PI * x[1]);
  return sx * sx * sy * sy / PI;
}

static inline double one_turn(const int n, const double courant, const profile f,
                              const cf_advect_scheme scheme) {
  const int cells[2] = {n, n};
  scene s;
  scene_open_scheme(&s, 2, cells, walls_all(CF_WALL_INSULATED), scheme);
  set_curl(&s, turning, NULL);
  set_cells(&s, f);
  OK(cf_advect_set_velocity(s.advect, s.u, &s.walls));
  const double first = range_of(&s).sum;
  const int steps = (int)ceil(PI * n / courant); /* as if it turned rigidly up to r = 1/2 */
  for (int step = 0; step < steps; ++step) move_cells(&s, 0, 1.0 / steps, NULL);
  const double drift = fabs(range_of(&s).sum / first - 1), error = error_against(&s, f);
  if (scheme == CF_ADVECT_PPM || scheme == CF_ADVECT_WENO5) assert_true(drift < 1e-12);
  scene_close(&s);
  return error;
}

/* The flow `full` times cos(pi t/period), at the middle of a step. */
static inline void set_phase(scene *s, const cf_face full, const int step, const int steps) {
  const double g = cos(PI * (step + 0.5) / steps);
  const cf_box *b = &s->grid.box;
  for (int a = 0; a < b->dim; ++a)
    for (ptrdiff_t p = -b->first; p < b->size - b->first; ++p) s->u.at[a][p] = (cf_real)g * full.at[a][p];
  OK(cf_advect_set_velocity(s->advect, s->u, &s->walls));
}

static inline void take_flow(scene *s, cf_face *full, const potential A) {
  set_curl(s, A, NULL);
  *full = s->u;
  OK(cf_face_create(&s->u, &s->grid.box));
}

/* The flow at the middle of each step makes it second order in time. fixed: never reverse the axes. */
static inline double one_swirl_by(const int n, const double courant, const profile f, const int fixed,
                                  const cf_advect_scheme scheme) {
  const int cells[2] = {n, n};
  const double period = 2;
  scene s;
  scene_open_scheme(&s, 2, cells, walls_all(CF_WALL_INSULATED), scheme);
  cf_face full;
  take_flow(&s, &full, swirl);
  set_cells(&s, f);
  const double first = range_of(&s).sum;
  const int steps = (int)ceil(period * n / courant / 2) * 2;
  for (int step = 0; step < steps; ++step) {
    set_phase(&s, full, step, steps);
    if (fixed) *cf_advect_parity(s.advect) = 0;
    move_cells(&s, 0, period / steps, NULL);
  }
  if (scheme == CF_ADVECT_PPM || scheme == CF_ADVECT_WENO5)
    assert_true(fabs(range_of(&s).sum / first - 1) < 1e-12);
  const double error = error_against(&s, f);
  cf_face_destroy(&full, &s.grid.box);
  scene_close(&s);
  return error;
}

static inline double one_swirl(const int n, const double courant, const profile f, const int fixed) {
  return one_swirl_by(n, courant, f, fixed, CF_ADVECT_PPM);
}

#endif
