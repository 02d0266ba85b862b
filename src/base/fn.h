/* SPDX-License-Identifier: MIT
 *
 * Functions of place and time, W(x, y, z, t): what a scene gives as a number or as an expression.
 * Physics knows only this; where the values come from (a constant, a parsed expression, a C function
 * of the caller) is the business of whoever filled it in.
 */
#ifndef CF_BASE_FN_H
#define CF_BASE_FN_H

#include "cattaneo.h"

static inline cf_fn cf_fn_constant(const double value) { return (cf_fn){.value = value}; }

static inline bool cf_fn_is_constant(const cf_fn *f) { return f->eval == 0; }

static inline void cf_fn_row(const cf_fn *f, const int n, const double *x, const double *y, const double *z,
                             const double t, double *out) {
  if (f->eval != 0) {
    f->eval(f->context, n, x, y, z, t, out);
    return;
  }
  for (int i = 0; i < n; ++i) out[i] = f->value;
}

static inline double cf_fn_at(const cf_fn *f, const double x, const double y, const double z,
                              const double t) {
  double value;
  cf_fn_row(f, 1, &x, &y, &z, t, &value);
  return value;
}

#endif
