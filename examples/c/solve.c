/* SPDX-License-Identifier: MIT
 *
 * Level 3: solves -laplace x = b in a square whose walls hold x = 0, for the b of x = sin(pi x) sin(2 pi y).
 *
 *     cc solve.c -o solve $(pkg-config --cflags --libs cattaneo) -lm
 */
#include <cattaneo.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#define N 200

static void must(const cf_status status) {
  if (status == CF_OK) return;
  fprintf(stderr, "%s\n", cf_status_sentence());
  exit(cf_status_exit_code(status));
}

static double exact(const int i, const int j) {
  const double pi = acos(-1.0);
  return sin(pi * (i + 0.5) / N) * sin(2 * pi * (j + 0.5) / N);
}

int main(void) {
  const double pi = acos(-1.0);
  const int cells[2] = {N, N};
  cf_grid grid;
  cf_cell x, b;
  must(cf_grid_init(&grid, 2, cells, 1.0 / N, NULL));
  must(cf_cell_create(&x, &grid.box)); /* zeroed: the first guess */
  must(cf_cell_create(&b, &grid.box));
  for (int j = 0; j < N; ++j)
    for (int i = 0; i < N; ++i) b.at[i + j * grid.box.stride[1]] = (cf_real)(5 * pi * pi * exact(i, j));

  cf_walls walls = {0};
  for (int a = 0; a < 2; ++a) walls.kind[a][0] = walls.kind[a][1] = CF_WALL_OPEN;
  const cf_coefficients poisson = {.alpha = 0, .beta = 1};
  const cf_solve_options options = {.tolerance = 1e-5, .max_iterations = 50};
  cf_helmholtz *A;
  cf_solve_report report;
  must(cf_helmholtz_create(&A, &grid, &walls, 0));
  must(cf_helmholtz_set(A, &poisson));
  must(cf_helmholtz_solve(A, b, &options, x, &report));

  double error = 0;
  for (int j = 0; j < N; ++j)
    for (int i = 0; i < N; ++i)
      error = fmax(error, fabs((double)x.at[i + j * grid.box.stride[1]] - exact(i, j)));
  printf("%s in %d iterations, error %.5f\n", report.converged ? "converged" : "stalled", report.iterations,
         error);
  cf_helmholtz_destroy(A);
  cf_cell_destroy(&b, &grid.box);
  cf_cell_destroy(&x, &grid.box);
  return 0;
}
