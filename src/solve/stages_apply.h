/* SPDX-License-Identifier: MIT
 *
 * What FORM, LAST and UPDATE do to a row or one half of it: shared by the files that do so in the whole box and on segments.
 */
#ifndef CF_SOLVE_STAGES_APPLY_H
#define CF_SOLVE_STAGES_APPLY_H

#include "solve/stages_part.h"

/* What an axis adds to A' e where its couplings differ: the smaller one times the second difference, and the rest. */
CF_KERNEL float cf_skewed(const float lo, const float hi, const float below, const float here,
                          const float above) {
  const float least = lo < hi ? lo : hi;
  return least * ((here - below) - (above - here)) +
         ((lo - least) * (here - below) - (hi - least) * (above - here));
}

/* A' e from second differences, which are exact in single precision where e is smooth. inner: no wall in y and z. */
CF_KERNEL float cf_applied(const int dim, const int inner, const cf_half *h, const int m) {
  const float *e = h->e + m, *side = h->side + m;
  const float c = e[0], x = (c - side[0]) - (side[1] - c);
  if (inner) {
    const float y = (c - e[h->y[0]]) - (e[h->y[1]] - c);
    const float z = dim == 3 ? (c - e[h->z[0]]) - (e[h->z[1]] - c) : 0;
    return h->alpha * c + h->coupling * (dim == 3 ? (x + y) + z : x + y);
  }
  float sum = h->coupling * x + cf_skewed(h->lo_y, h->hi_y, e[h->y[0]], c, e[h->y[1]]);
  if (dim == 3) sum += cf_skewed(h->lo_z, h->hi_z, e[h->z[0]], c, e[h->z[1]]);
  return h->alpha * c + sum;
}

CF_KERNEL int cf_half_is_inner(const int dim, const cf_half *h) {
  return h->lo_y == h->coupling && h->hi_y == h->coupling &&
         (dim == 2 || (h->lo_z == h->coupling && h->hi_z == h->coupling));
}

/* The first element of the padding has heard of the last cell. */
CF_KERNEL void cf_clear_pad(const cf_split *s, const cf_strip *t, const cf_half *h) {
  if (t->to == s->width && s->half[h->parity] < s->width) h->r[s->half[h->parity]] = 0;
}

/* What the change of e, as stored, leaves of the residual. */
CF_KERNEL void cf_last_half(const int dim, const int inner, const cf_half *of, const cf_strip *t,
                            const float omega) {
  const cf_half h = *of;
  CF_FOR_PIECE(m, t) {
    const float residual = h.r[m] - cf_applied(dim, inner, &h, m);
    const float old = h.e[m], fresh = old + omega * h.inverse[m] * residual;
    h.r[m] = residual - h.diagonal[m] * (fresh - old);
    h.e[m] = fresh;
  }
}

/* r -= A' e, then a first half sweep on it. */
CF_KERNEL void cf_restart_half(const int dim, const int inner, const cf_half *of, const cf_strip *t,
                               const float omega) {
  const cf_half h = *of;
  CF_FOR_PIECE(m, t) {
    const float r = h.r[m] - cf_applied(dim, inner, &h, m);
    h.r[m] = r;
    h.e[m] = omega * h.inverse[m] * r;
  }
}

/* A sum that was taken in single precision, 16 lanes apart. */
CF_KERNEL double cf_sum_sixteen(const cf_sixteen *sum) {
  float lane[2 * CF_SUM_LANES];
  double wide[CF_SUM_LANES];
  memcpy(lane, sum, sizeof lane);
  const cf_eight both = CF_EIGHT_OF_FLOATS(lane) + CF_EIGHT_OF_FLOATS(lane + CF_SUM_LANES);
  memcpy(wide, &both, sizeof wide);
  return cf_sum_lanes(wide);
}

/* The sum of squares along a piece of both halves: along a row in single precision, beyond it in double. */
CF_KERNEL double cf_squares(const int n, const float *even, const float *odd) {
  cf_sixteen sum = {0};
  for (int m = 0; m < n; m += CF_SPLIT_LANES) {
    const cf_sixteen a = CF_SIXTEEN_OF(even + m), b = CF_SIXTEEN_OF(odd + m);
    sum += a * a + b * b;
  }
  return cf_sum_sixteen(&sum);
}

/* x += gain e + lift, the halves of e woven together. */
CF_KERNEL void cf_add_woven(const int n, const double gain, const double lift, const float *even,
                            const float *odd, cf_real *x) {
  int i = 0;
  for (; i + 2 * CF_SUM_LANES <= n; i += 2 * CF_SUM_LANES) {
    const cf_eight a = CF_EIGHT_OF_FLOATS(even + i / 2), b = CF_EIGHT_OF_FLOATS(odd + i / 2);
    const cf_eight low = CF_EIGHT_WOVEN_LOW(a, b), high = CF_EIGHT_WOVEN_HIGH(a, b);
    cf_real *here = x + i, *beyond = here + CF_SUM_LANES;
    CF_EIGHT_INTO(here, CF_EIGHT_OF(here) + (gain * low + lift));
    CF_EIGHT_INTO(beyond, CF_EIGHT_OF(beyond) + (gain * high + lift));
  }
  for (; i < n; ++i)
    x[i] = (cf_real)((double)x[i] + (gain * (double)(i % 2 == 0 ? even : odd)[i / 2] + lift));
}

CF_KERNEL void cf_fetch_x(const cf_pass *p, const cf_strip *t, const int j) {
  const cf_real *x = p->x + cf_box_at(&p->at->plain->box, 2 * t->from, t->next_j + j - t->j, t->next_k);
  for (int i = 0; i < 2 * (t->to - t->from); i += CF_LANES) __builtin_prefetch(x + i, 1);
}

/* --- FORM --------------------------------------------------------------------------------------------- */

/* A row from its first cell in the strip on. */
typedef struct cf_forming {
  const cf_real *x, *b;
  const double *lo, *hi; /* along x, without beta */
  ptrdiff_t y, z;
  double alpha, beta, lo_y, hi_y, lo_z, hi_z, shift;
  double *residual;
} cf_forming;

CF_KERNEL void cf_form_row(const int dim, const int n, const cf_forming *of) {
  const cf_forming f = *of;
  CF_ROW_LOOP
  for (int i = 0; i < n; ++i) {
    const double c = (double)f.x[i];
    double sum = f.beta * (f.lo[i] * (c - (double)f.x[i - 1]) - f.hi[i] * ((double)f.x[i + 1] - c));
    sum += f.lo_y * (c - (double)f.x[i - f.y]) - f.hi_y * ((double)f.x[i + f.y] - c);
    if (dim == 3) sum += f.lo_z * (c - (double)f.x[i - f.z]) - f.hi_z * ((double)f.x[i + f.z] - c);
    f.residual[i] = (double)f.b[i] - f.shift - (f.alpha * c + sum);
  }
}

CF_KERNEL void cf_split_scaled(const int pairs, const double factor, const double *line, float *even,
                               float *odd) {
  CF_ROW_LOOP
  for (int m = 0; m < pairs; ++m) {
    even[m] = (float)(factor * line[2 * m]);
    odd[m] = (float)(factor * line[2 * m + 1]);
  }
}

CF_KERNEL cf_forming cf_forming_of(const int dim, const cf_pass *p, const cf_strip *t, const int j) {
  const cf_level *l = p->at->plain;
  const int i0 = 2 * t->from;
  const ptrdiff_t at = cf_box_at(&l->box, i0, j, t->k);
  return (cf_forming){.x = p->x + at,
                      .b = p->b + at,
                      .lo = l->axis[0].lo1 + i0,
                      .hi = l->axis[0].hi1 + i0,
                      .y = l->box.stride[1],
                      .z = l->box.stride[2],
                      .alpha = p->alpha,
                      .beta = p->beta,
                      .lo_y = p->beta * l->axis[1].lo1[j],
                      .hi_y = p->beta * l->axis[1].hi1[j],
                      .lo_z = dim == 3 ? p->beta * l->axis[2].lo1[t->k] : 0,
                      .hi_z = dim == 3 ? p->beta * l->axis[2].hi1[t->k] : 0,
                      .shift = p->shift,
                      .residual = t->scratch};
}

#endif
