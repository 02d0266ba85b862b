/* SPDX-License-Identifier: MIT
 *
 * One solve with the installed library: (1 - div grad/16) x = 1 in a box without flux has x = 1.
 */
#include <cattaneo.h>
#include <math.h>
#include <stdio.h>

static cf_status solve(const cf_grid *grid, cf_cell b, cf_cell x, cf_helmholtz **A) {
  static const cf_walls insulated;
  cf_solve_report report;
  for (int j = 0; j < 16; ++j)
    for (int i = 0; i < 16; ++i) b.at[i + j * grid->box.stride[1]] = 1;
  cf_status s = cf_helmholtz_create(A, grid, &insulated, 0);
  if (s == CF_OK) s = cf_helmholtz_set(*A, &(cf_coefficients){.alpha = 1, .beta = 1.0 / 16});
  if (s == CF_OK) s = cf_helmholtz_solve(*A, b, &(cf_solve_options){1e-6, 50}, x, &report);
  return s;
}

int main(void) {
  cf_grid grid;
  cf_cell b = {NULL}, x = {NULL};
  cf_helmholtz *A = NULL;
  cf_status s = cf_grid_init(&grid, 2, (int[]){16, 16}, 1.0 / 16, NULL);
  if (s == CF_OK) s = cf_cell_create(&b, &grid.box);
  if (s == CF_OK) s = cf_cell_create(&x, &grid.box);
  if (s == CF_OK) s = solve(&grid, b, x, &A);
  const double wrong = s == CF_OK ? fabs((double)x.at[5 + 7 * grid.box.stride[1]] - 1) : 1;
  if (s != CF_OK) fprintf(stderr, "%s\n", cf_status_sentence());
  cf_helmholtz_destroy(A);
  cf_cell_destroy(&x, &grid.box);
  cf_cell_destroy(&b, &grid.box);
  printf("cattaneo %s, %zu bytes a number, %s\n", cf_version(), sizeof(cf_real),
         wrong < 1e-5 ? "right" : "wrong");
  return wrong < 1e-5 ? 0 : 1;
}
