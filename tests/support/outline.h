/* SPDX-License-Identifier: MIT
 *
 * The outline of a crystal that an example has grown.
 */
#ifndef CF_TESTS_OUTLINE_H
#define CF_TESTS_OUTLINE_H

#include "crystal.h"
#include "example.h"

/* crystal_harmonic of an example in the plane whose box is about 0. */
static inline double outline_harmonic(const example *e, const int m, double *phase) {
  const cf_view v = example_field(e, "eta", 0);
  const double origin[2] = {v.place[0] - v.h / 2, v.place[1] - v.h / 2};
  crystal c = {.p = NULL};
  OK(cf_grid_init(&c.g, 2, v.shape, v.h, origin));
  OK(cf_cell_create(&c.y.eta, &c.g.box));
  CRYSTAL_CELLS(&c, i, j, k, p) c.y.eta.at[p] = (cf_real)view_at(&v, i, j, k);
  const double middle[2] = {v.shape[0] * v.h / 2, v.shape[1] * v.h / 2};
  for (int a = 0; a < 2; ++a) c.g.origin[a] = -middle[a];
  const double size = crystal_harmonic(&c, m, phase);
  cf_cell_destroy(&c.y.eta, &c.g.box);
  return size;
}

#endif
