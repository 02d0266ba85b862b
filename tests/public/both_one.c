/* SPDX-License-Identifier: MIT
 *
 * The half of a program that works in one precision: compiled twice, once with CF_SINGLE. Solves
 * (1 - laplace) x = 1 with insulated walls, x = 1, tells how large a number is, and what tiny change of it is seen.
 */
#include <cattaneo.h>

#include "both.h"

static cf_status solve(const cf_grid *grid, cf_cell b, cf_cell x, cf_solve_report *report) {
  const cf_walls walls = {0};
  const cf_coefficients one = {.alpha = 1, .beta = 1};
  const cf_solve_options options = {1e-5, 50};
  cf_helmholtz *A;
  cf_status s = cf_helmholtz_create(&A, grid, &walls, 0);
  if (s == CF_OK) s = cf_helmholtz_set(A, &one);
  if (s == CF_OK) s = cf_helmholtz_solve(A, b, &options, x, report);
  cf_helmholtz_destroy(A);
  return s;
}

both_result RUN(void) {
  both_result result = {.size = sizeof(cf_real)};
  const int cells[3] = {12, 10, 8};
  cf_grid grid;
  cf_cell b = {0}, x = {0};
  cf_solve_report report = {0};
  cf_status s = cf_grid_init(&grid, 3, cells, 1, NULL);
  if (s == CF_OK) s = cf_cell_create(&b, &grid.box);
  if (s == CF_OK) s = cf_cell_create(&x, &grid.box);
  for (int k = 0; s == CF_OK && k < 8; ++k)
    for (int j = 0; j < 10; ++j)
      for (int i = 0; i < 12; ++i) b.at[i + j * grid.box.stride[1] + k * grid.box.stride[2]] = 1;
  if (s == CF_OK) s = solve(&grid, b, x, &report);
  result.ok = s == CF_OK && report.converged;
  if (s == CF_OK) result.x = (double)x.at[5 + 4 * grid.box.stride[1] + 3 * grid.box.stride[2]];
  cf_cell_destroy(&b, &grid.box);
  cf_cell_destroy(&x, &grid.box);

  /* A sentence stays in the library that made it. */
  const int none[2] = {0, 0};
  result.refused = cf_grid_init(&grid, 2, none, 1, NULL) == CF_BAD_ARGUMENT;
  result.sentence = cf_status_sentence();
  return result;
}
