/* SPDX-License-Identifier: MIT
 *
 * Small systems solved directly: a matrix of at most MOST unknowns, and the numbering of the cells of a box.
 */
#ifndef CF_TESTS_ELIMINATION_H
#define CF_TESTS_ELIMINATION_H

#include <math.h>
#include <stdbool.h>

#include "grid/box.h"

enum { MOST = 7 * 7 * 7 };

static double matrix[MOST][MOST + 1];

static inline void cell_place(const cf_box *box, const int cell, int at[3]) {
  at[0] = cell % box->n[0];
  at[1] = cell / box->n[0] % box->n[1];
  at[2] = cell / (box->n[0] * box->n[1]);
}

static inline ptrdiff_t cell_index(const cf_box *box, const int cell) {
  int at[3];
  cell_place(box, cell, at);
  return cf_box_at(box, at[0], at[1], at[2]);
}

/* Row reduction with the right side in the last column; false where a pivot is small. */
static inline bool eliminate(const int n, const double *b, double *x) {
  double largest = 0;
  for (int i = 0; i < n; ++i) {
    matrix[i][n] = b[i];
    for (int j = 0; j < n; ++j) largest = fmax(largest, fabs(matrix[i][j]));
  }
  for (int j = 0; j < n; ++j) {
    int p = j;
    for (int i = j + 1; i < n; ++i)
      if (fabs(matrix[i][j]) > fabs(matrix[p][j])) p = i;
    if (!(fabs(matrix[p][j]) > 1e-9 * largest)) return false;
    for (int k = j; k <= n; ++k) {
      const double swap = matrix[j][k];
      matrix[j][k] = matrix[p][k];
      matrix[p][k] = swap;
    }
    for (int i = j + 1; i < n; ++i) {
      const double f = matrix[i][j] / matrix[j][j];
      if (f != 0)
        for (int k = j; k <= n; ++k) matrix[i][k] -= f * matrix[j][k];
    }
  }
  for (int i = n - 1; i >= 0; --i) {
    double sum = matrix[i][n];
    for (int j = i + 1; j < n; ++j) sum -= matrix[i][j] * x[j];
    x[i] = sum / matrix[i][i];
  }
  return true;
}

#endif
