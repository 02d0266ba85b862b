/* SPDX-License-Identifier: MIT
 *
 * The lid-driven cavity, run until it is steady, beside Ghia, Ghia and Shin's centrelines.
 */
#ifndef CF_TESTS_CAVITY_H
#define CF_TESTS_CAVITY_H

#include "reference.h"
#include "scene_run.h"

/* Along the line of faces in the middle (component c across it), linear between the two values beside `at`. */
static inline double cavity_at(const cf_view *v, const int c, const int n, const double at) {
  const int along = 1 - c;
  const double place = at * n - 0.5;
  int i = (int)floor(place);
  i = i < 0 ? 0 : i > n - 2 ? n - 2 : i;
  const cf_real *p = v->at + n / 2 * v->stride[c] + i * v->stride[along];
  return (double)p[0] + (place - i) * ((double)p[v->stride[along]] - (double)p[0]);
}

/* The largest difference on both lines. */
static inline double cavity_off(const int n, const double re, const double end, const char *column) {
  char text[1024];
  scene_run r;
  cf_view v[2];
  double worst = 0;
  snprintf(text, sizeof text,
           "cattaneo: 1\nmodel: flow\n"
           "domain: {size: [1, 1], cells: [%d, %d]}\n"
           "time: {end: %g, cfl: 0.9}\n"
           "flow:\n  viscosity: %g\n"
           "  walls: [{side: x-, slip: off}, {side: x+, slip: off}, {side: y-, slip: off}, "
           "{side: y+, velocity: [1, 0]}]\n"
           "solver: {tolerance: 1e-4}\n",
           n, n, end, 1 / re);
  scene_open(&r, "cavity", text, 2);
  OK(cf_sim_run(r.sim, INFINITY, NULL, NULL));
  for (int c = 0; c < 2; ++c) OK(cf_sim_field(r.sim, "velocity", c, &v[c]));
  table t = table_read("ghia_cavity.csv");
  for (int i = 0; i < t.rows; ++i) {
    const int c = table_is(&t, i, "line", "u") ? 0 : 1;
    worst = fmax(worst, fabs(cavity_at(&v[c], c, n, table_at(&t, i, "at")) - table_at(&t, i, column)));
  }
  table_free(&t);
  scene_close(&r);
  return worst;
}

#endif
