/* SPDX-License-Identifier: MIT
 *
 * How much a body is bent: its thinnest direction n is where its particles spread least, and through all of them goes
 *
 *     n = a + b . s + kappa |s|^2/2          by least squares, s the place across n, from the middle
 *
 * so kappa is the curvature of a strip, and the mean one of a plate. It counts as positive where the body opens towards
 * growing y (in 3D z). It says little of bodies that are not thin. A part of the particles is enough, those whose ids
 * are multiples of a number: always the same ones.
 */
#include <math.h>

#include "base/polar.h"
#include "model/gel_part.h"

#define ENOUGH 32768

typedef struct bent {
  const cf_gel *g;
  int dim;
  int64_t step;
  double middle[3], axis[3][3]; /* the first one is n */
} bent;

/* Whether particle i is one of those looked at; from the middle of the body then. */
static bool look_at(const bent *b, const int64_t i, double x[3]) {
  const cf_particles *set = b->g->set;
  if (set->id[i] % b->step != 0 || (int)set->attribute[b->g->at.material].at[0][i] != 0) return false;
  for (int a = 0; a < b->dim; ++a) x[a] = (double)set->attribute[b->g->at.position].at[a][i] - b->middle[a];
  return true;
}

static double along(const bent *b, const int axis, const double x[3]) {
  double sum = 0;
  for (int a = 0; a < b->dim; ++a) sum += b->axis[axis][a] * x[a];
  return sum;
}

static void find_middle(bent *b) {
  double sum[3] = {0, 0, 0}, x[3];
  int64_t count = 0;
  for (int64_t i = 0; i < b->g->set->count; ++i) {
    if (!look_at(b, i, x)) continue;
    for (int a = 0; a < b->dim; ++a) sum[a] += x[a];
    ++count;
  }
  for (int a = 0; a < b->dim && count > 0; ++a) b->middle[a] = sum[a] / (double)count;
}

/* Axes in the order of their spread. */
static void find_axes(bent *b) {
  double spread[9] = {0}, V[9], value[3], x[3];
  const int dim = b->dim;
  for (int64_t i = 0; i < b->g->set->count; ++i) {
    if (!look_at(b, i, x)) continue;
    for (int r = 0; r < dim; ++r)
      for (int c = 0; c < dim; ++c) spread[r * dim + c] += x[r] * x[c];
  }
  cf_symmetric_eigen(dim, spread, V, value);
  int order[3] = {0, 1, 2};
  for (int r = 1; r < dim; ++r)
    for (int v = r; v > 0 && value[order[v]] < value[order[v - 1]]; --v) {
      const int swapped = order[v];
      order[v] = order[v - 1], order[v - 1] = swapped;
    }
  for (int r = 0; r < dim; ++r) {
    const double sign = V[(dim - 1) * dim + order[r]] < 0 ? -1 : 1;
    for (int a = 0; a < dim; ++a) b->axis[r][a] = sign * V[a * dim + order[r]];
  }
}

/* The solution's entry `wanted` of n equations with right sides in column n; pivots are sums of squares. */
static double solved(const int n, double M[4][5], const int wanted) {
  for (int p = 0; p < n; ++p) {
    if (!(M[p][p] > 0)) return 0;
    for (int r = 0; r < n; ++r) {
      const double factor = M[r][p] / M[p][p];
      for (int c = 0; c <= n && r != p; ++c) M[r][c] -= factor * M[p][c];
    }
  }
  return M[wanted][n] / M[wanted][wanted];
}

double cf_gel_curvature(const cf_gel *g) {
  bent b = {.g = g, .dim = g->grid->box.dim, .step = 1 + (g->set->count - 1) / ENOUGH};
  double M[4][5] = {{0}}, x[3];
  find_middle(&b);
  find_axes(&b);
  for (int64_t i = 0; i < g->set->count; ++i) {
    if (!look_at(&b, i, x)) continue;
    double basis[5] = {1}, square = 0;
    for (int a = 1; a < b.dim; ++a) {
      basis[a] = along(&b, a, x);
      square += basis[a] * basis[a];
    }
    basis[b.dim] = square / 2;
    basis[b.dim + 1] = along(&b, 0, x);
    for (int r = 0; r <= b.dim; ++r)
      for (int c = 0; c <= b.dim + 1; ++c) M[r][c] += basis[r] * basis[c];
  }
  return solved(b.dim + 1, M, b.dim);
}
