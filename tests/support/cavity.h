/* SPDX-License-Identifier: MIT
 *
 * The lid-driven cavity, run until it is steady, beside published values on its centrelines.
 */
#ifndef CF_TESTS_CAVITY_H
#define CF_TESTS_CAVITY_H

#include "reference.h"
#include "scene_run.h"

/* It is steady when within CAVITY_WAIT nothing on the centrelines changes by more than this. */
#define CAVITY_WAIT   4
#define CAVITY_STEADY 1e-4
#define CAVITY_CELLS  256

/* u on the faces of the vertical centreline and v on those of the horizontal one, cell by cell. */
typedef struct cavity {
  int n;
  double line[2][CAVITY_CELLS], t;
} cavity;

/* Reads the lines; returns their largest change. */
static inline double cavity_read(const scene_run *r, cavity *c) {
  double change = 0;
  for (int d = 0; d < 2; ++d) {
    cf_view v;
    OK(cf_sim_field(r->sim, "velocity", d, &v));
    for (int i = 0; i < c->n; ++i) {
      const double now = (double)v.at[c->n / 2 * v.stride[d] + i * v.stride[1 - d]];
      change = fmax(change, fabs(now - c->line[d][i]));
      c->line[d][i] = now;
    }
  }
  return change;
}

static inline cavity cavity_steady(const int n, const double re) {
  cavity c = {.n = n};
  char text[1024];
  scene_run r;
  assert_true(n <= CAVITY_CELLS && n % 2 == 0);
  snprintf(text, sizeof text,
           "cattaneo: 1\nmodel: flow\n"
           "domain: {size: [1, 1], cells: [%d, %d]}\n"
           "time: {end: 200, cfl: 0.9}\n"
           "flow:\n  viscosity: %g\n"
           "  walls: [{side: x-, slip: off}, {side: x+, slip: off}, {side: y-, slip: off}, "
           "{side: y+, velocity: [1, 0]}]\n"
           "solver: {tolerance: 1e-4}\n",
           n, n, 1 / re);
  scene_open(&r, "cavity", text, 1);
  do {
    c.t += CAVITY_WAIT;
    OK(cf_sim_run(r.sim, c.t, NULL, NULL));
  } while (cavity_read(&r, &c) > CAVITY_STEADY && c.t < 200);
  scene_close(&r);
  return c;
}

/* Linear between the two values beside a place. */
static inline double cavity_at(const cavity *c, const int d, const double at) {
  const double place = at * c->n - 0.5;
  int i = (int)floor(place);
  i = i < 0 ? 0 : i > c->n - 2 ? c->n - 2 : i;
  return c->line[d][i] + (place - i) * (c->line[d][i + 1] - c->line[d][i]);
}

/* Of the parabola through the largest value (side 1) or the least (-1) of a line and its two neighbours. */
static inline double cavity_extreme(const cavity *c, const int d, const double side) {
  const double *f = c->line[d];
  int at = 1;
  for (int i = 1; i < c->n - 1; ++i)
    if (side * f[i] > side * f[at]) at = i;
  const double slope = (f[at + 1] - f[at - 1]) / 2, bend = f[at + 1] - 2 * f[at] + f[at - 1];
  return f[at] - slope * slope / (2 * bend);
}

/* The largest difference from Ghia, Ghia and Shin's lines. */
static inline double cavity_off_ghia(const cavity *c, const char *column) {
  table t = table_read("ghia_cavity.csv");
  double worst = 0;
  for (int i = 0; i < t.rows; ++i) {
    const int d = table_is(&t, i, "line", "u") ? 0 : 1;
    worst = fmax(worst, fabs(cavity_at(c, d, table_at(&t, i, "at")) - table_at(&t, i, column)));
  }
  table_free(&t);
  return worst;
}

/* And from the extremes of finer solutions. */
static inline double cavity_off_extremes(const cavity *c, const char *column) {
  table t = table_read("cavity_extremes.csv");
  double worst = 0;
  for (int i = 0; i < t.rows; ++i) {
    const int d = table_is(&t, i, "line", "u") ? 0 : 1;
    const double found = cavity_extreme(c, d, table_at(&t, i, "side"));
    worst = fmax(worst, fabs(found - table_at(&t, i, column)));
  }
  table_free(&t);
  return worst;
}

#endif
