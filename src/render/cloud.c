/* SPDX-License-Identifier: MIT */
#include "render/cloud.h"

#include <math.h>
#include <string.h>

/* Cells along the longest side, at most. */
#define LONGEST 640

void cf_cloud_grid(const cf_grid *g, const int64_t points, cf_grid *fine) {
  const int *n = g->box.n;
  const int longest = CF_MAX(n[0], CF_MAX(n[1], n[2]));
  const double wanted = pow(2.5 * (double)points / (double)cf_box_cells(&g->box), 1.0 / g->box.dim);
  const int times = (int)CF_MAX(1, CF_MIN(4, CF_MIN(floor(wanted), LONGEST / longest)));
  int cells[3] = {1, 1, 1};
  *fine = *g;
  for (int a = 0; a < g->box.dim; ++a) cells[a] = n[a] * times;
  fine->h = g->h / times;
  (void)cf_box_init(&fine->box, g->box.dim, cells, 0);
}

/* The three cells around a place in cells, and their weights; those beyond the box have none. */
static void weights_of(const double at, const int n, int cell[3], double w[3]) {
  const int middle = (int)floor(at);
  const double f = at - middle - 0.5;
  w[0] = (0.5 - f) * (0.5 - f) / 2, w[1] = 0.75 - f * f, w[2] = (0.5 + f) * (0.5 + f) / 2;
  for (int i = 0; i < 3; ++i) {
    const int c = middle - 1 + i;
    cell[i] = CF_MAX(0, CF_MIN(n - 1, c));
    if (c < 0 || c >= n) w[i] = 0;
  }
}

static void spread(const cf_grid *g, const double amount, const float place[3], const cf_cell out) {
  const cf_box *b = &g->box;
  int cell[3][3] = {{0}};
  double w[3][3] = {{1, 0, 0}, {1, 0, 0}, {1, 0, 0}};
  for (int a = 0; a < b->dim; ++a) {
    const double at = ((double)place[a] - g->origin[a]) / g->h;
    if (!(at > -2 && at < b->n[a] + 2)) return;
    weights_of(at, b->n[a], cell[a], w[a]);
  }
  for (int k = 0; k < (b->dim == 3 ? 3 : 1); ++k)
    for (int j = 0; j < 3; ++j)
      for (int i = 0; i < 3; ++i)
        out.at[cf_box_at(b, cell[0][i], cell[1][j], cell[2][k])] +=
            (cf_real)(amount * w[0][i] * w[1][j] * w[2][k]);
}

void cf_cloud_density(const cf_grid *fine, const double cell, const int64_t points, const float (*place)[3],
                      const cf_cell out) {
  const cf_box *b = &fine->box;
  const double amount = pow(cell / fine->h, b->dim);
  for (ptrdiff_t r = 0; r < cf_box_rows(b); ++r)
    memset(out.at + cf_box_row(b, r), 0, (size_t)b->n[0] * sizeof *out.at);
  for (int64_t i = 0; i < points; ++i) spread(fine, amount, place[i], out);
}
