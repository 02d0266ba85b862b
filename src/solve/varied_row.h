/* SPDX-License-Identifier: MIT
 *
 * A run of cells as the kernels of the varied path see it, and the three forms that they are compiled in: which of alpha
 * and beta is a field.
 */
#ifndef CF_SOLVE_VARIED_ROW_H
#define CF_SOLVE_VARIED_ROW_H

#include "grid/sweep.h"
#include "solve/varied_part.h"

enum { CF_ALPHA_NUMBER, CF_BOTH_FIELDS, CF_BETA_NUMBER };

static inline int cf_varied_form_of(const cf_varied *v) {
  return v->beta.at[0] == NULL ? CF_BETA_NUMBER : v->alpha.at != NULL ? CF_BOTH_FIELDS : CF_ALPHA_NUMBER;
}

/* Everything at the run's first cell; 1/h^2 with the walls of the box: tables along x, numbers along y and z. */
typedef struct cf_varied_row {
  cf_real *x;
  const cf_real *alpha, *beta[3], *lo_x, *hi_x;
  cf_real lo[3], hi[3], alpha_number, beta_number;
  ptrdiff_t stride[3];
  const cf_real *b;     /* where it is asked for: the right side, */
  const float *inverse; /* 1/diagonal of level 0, 0 where there is no equation, */
  cf_real *y;           /* what comes out */
} cf_varied_row;

static inline cf_varied_row cf_varied_row_of(const cf_varied *v, const cf_run *run, const int j, const int k,
                                             const cf_cell x) {
  const cf_box *b = &v->A->grid.box;
  const ptrdiff_t p = cf_box_at(b, run->low, j, k);
  cf_varied_row o = {.x = x.at + p,
                     .alpha = v->alpha.at != NULL ? v->alpha.at + p : NULL,
                     .lo_x = v->lo[0] + run->low,
                     .hi_x = v->hi[0] + run->low,
                     .lo = {0, v->lo[1][j], 0},
                     .hi = {0, v->hi[1][j], 0},
                     .alpha_number = (cf_real)v->alpha_number,
                     .beta_number = (cf_real)v->beta_number,
                     .inverse = v->level[0].inverse + p};
  if (b->dim == 3) o.lo[2] = v->lo[2][k], o.hi[2] = v->hi[2][k];
  for (int a = 0; a < b->dim; ++a) {
    o.beta[a] = v->beta.at[0] != NULL ? v->beta.at[a] + p : NULL;
    o.stride[a] = b->stride[a];
  }
  return o;
}

/* alpha of cell i; what its low and its high face along an axis couple. */
CF_KERNEL cf_real cf_alpha_at(const int form, const cf_varied_row *o, const int i) {
  return form == CF_ALPHA_NUMBER ? o->alpha_number : o->alpha[i];
}

CF_KERNEL cf_real cf_low_at(const int form, const cf_varied_row *o, const int a, const int i) {
  return (a == 0 ? o->lo_x[i] : o->lo[a]) * (form == CF_BETA_NUMBER ? o->beta_number : o->beta[a][i]);
}

CF_KERNEL cf_real cf_high_at(const int form, const cf_varied_row *o, const int a, const int i) {
  return (a == 0 ? o->hi_x[i] : o->hi[a]) *
         (form == CF_BETA_NUMBER ? o->beta_number : o->beta[a][i + o->stride[a]]);
}

/* A x of cell i in double, so that of the rounding only that of x itself is seen. */
CF_KERNEL double cf_apply_at(const int dim, const int form, const cf_varied_row *o, const int i) {
  const double x = (double)o->x[i];
  double sum = (double)cf_alpha_at(form, o, i) * x;
  CF_AXIS_LOOP
  for (int a = 0; a < dim; ++a) {
    const ptrdiff_t s = o->stride[a];
    sum += (double)cf_low_at(form, o, a, i) * (x - (double)o->x[i - s]) -
           (double)cf_high_at(form, o, a, i) * ((double)o->x[i + s] - x);
  }
  return sum;
}

/* Makes name##_row(dim, form, n, row, x) of the kernel name(dim, form, n, row, x), for each dim and form. */
#define CF_VARIED_CLONE(name, dim, form, T)                                               \
  CF_CLONES static void name##_##dim##_##form(const int n, const cf_varied_row *o, T x) { \
    name(dim, form, n, o, x);                                                             \
  }
#define CF_VARIED_ROWS(name, T)                                                                              \
  CF_VARIED_CLONE(name, 2, 0, T)                                                                             \
  CF_VARIED_CLONE(name, 2, 1, T)                                                                             \
  CF_VARIED_CLONE(name, 2, 2, T)                                                                             \
  CF_VARIED_CLONE(name, 3, 0, T)                                                                             \
  CF_VARIED_CLONE(name, 3, 1, T)                                                                             \
  CF_VARIED_CLONE(name, 3, 2, T)                                                                             \
  static inline void name##_row(const int dim, const int form, const int n, const cf_varied_row *o, T x) {   \
    static void (*const rows[2][3])(int, const cf_varied_row *, T) = {{name##_2_0, name##_2_1, name##_2_2},  \
                                                                      {name##_3_0, name##_3_1, name##_3_2}}; \
    rows[dim - 2][form](n, o, x);                                                                            \
  }

#endif
