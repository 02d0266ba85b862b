/* SPDX-License-Identifier: MIT
 *
 * Level 2: steps C-F diffusion on arrays of its own. A cosine between insulated walls swings and decays,
 *
 *     phi = cos(pi x) exp(-t/(2 tau)) (cos(w t) + sin(w t)/(2 tau w)),   w^2 = k pi^2/tau - 1/(4 tau^2),
 *
 * and is compared with that after one period.
 *
 *     cc diffuse_step.c -o diffuse_step $(pkg-config --cflags --libs cattaneo) -lm
 */
#include <cattaneo.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#define N     128
#define STEPS 200

static void must(const cf_status status) {
  if (status == CF_OK) return;
  fprintf(stderr, "%s\n", cf_status_sentence());
  exit(cf_status_exit_code(status));
}

int main(void) {
  const double pi = acos(-1.0), k = 1, tau = 0.5, w = sqrt(k * pi * pi / tau - 1 / (4 * tau * tau));
  const int cells[2] = {N, 4};
  cf_grid grid;
  cf_cell phi;
  cf_face q;
  must(cf_grid_init(&grid, 2, cells, 1.0 / N, NULL));
  must(cf_cell_create(&phi, &grid.box));
  must(cf_face_create(&q, &grid.box));
  for (int j = 0; j < cells[1]; ++j)
    for (int i = 0; i < N; ++i) phi.at[i + j * grid.box.stride[1]] = (cf_real)cos(pi * (i + 0.5) / N);

  cf_diffuse *diffuse;
  const cf_walls walls = {0}; /* insulated */
  const cf_diffuse_params params = {.k = {.value = k},
                                    .capacity = {.value = 1},
                                    .tau = tau,
                                    .scheme = CF_DIFFUSE_SDIRK2,
                                    .solver = {1e-6, 100}};
  must(cf_diffuse_create(&diffuse, &grid, &walls, &params, NULL));

  const double period = 2 * pi / w, dt = period / STEPS;
  cf_ledger ledger = {.first = cf_diffuse_content(diffuse, phi)};
  cf_solve_report report;
  for (int i = 0; i < STEPS; ++i) must(cf_diffuse_step(diffuse, i * dt, dt, phi, q, &ledger, &report));

  const double exact = exp(-period / (2 * tau)) * cos(0.5 * pi / N);
  printf("after one period of %.3f s: phi at the wall %.4f, exact %.4f\n", period, (double)phi.at[0], exact);
  cf_diffuse_destroy(diffuse);
  cf_face_destroy(&q, &grid.box);
  cf_cell_destroy(&phi, &grid.box);
  return 0;
}
