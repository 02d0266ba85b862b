/* SPDX-License-Identifier: MIT
 *
 * The residual of the solution itself, b - A x, in double; split and scaled it is what cycles start from. Sixteen cells at a
 * time go through everything, down to the sums, while they are in registers.
 */
#include "solve/stages_apply.h"

#define SIXTEEN (2 * CF_SUM_LANES)

/* The lanes of the sums of a row. */
typedef struct sums {
  cf_eight rr, x, xx, b, bb;
} sums;

/* The residual of eight cells from number i on, and what they add to the sums. inner: no wall next to any of them, and
 * `coupling` on all sides: a third less arithmetic, of which this stage has the most. */
CF_KERNEL void form_eight(const int dim, const int inner, const cf_forming *f, const double coupling,
                          const int i, cf_eight *residual, sums *s) {
  const cf_real *x = f->x + i;
  const cf_eight c = CF_EIGHT_OF(x), b = CF_EIGHT_OF(f->b + i);
  cf_eight sum;
  if (inner) {
    sum = (c - CF_EIGHT_OF(x - 1)) - (CF_EIGHT_OF(x + 1) - c);
    sum += (c - CF_EIGHT_OF(x - f->y)) - (CF_EIGHT_OF(x + f->y) - c);
    if (dim == 3) sum += (c - CF_EIGHT_OF(x - f->z)) - (CF_EIGHT_OF(x + f->z) - c);
    sum *= coupling;
  } else {
    sum = f->beta * (CF_EIGHT_OF_DOUBLES(f->lo + i) * (c - CF_EIGHT_OF(x - 1)) -
                     CF_EIGHT_OF_DOUBLES(f->hi + i) * (CF_EIGHT_OF(x + 1) - c));
    sum += f->lo_y * (c - CF_EIGHT_OF(x - f->y)) - f->hi_y * (CF_EIGHT_OF(x + f->y) - c);
    if (dim == 3) sum += f->lo_z * (c - CF_EIGHT_OF(x - f->z)) - f->hi_z * (CF_EIGHT_OF(x + f->z) - c);
  }
  *residual = b - f->shift - (f->alpha * c + sum);
  s->rr += *residual * *residual;
  s->x += c;
  s->xx += c * c;
  s->b += b;
  s->bb += b * b;
}

/* The cells from number i on, fewer than sixteen, and the padding up to `whole`. */
CF_KERNEL void form_rest(const int dim, const cf_forming *of, const int i, const int n, const int whole,
                         double lane[5][CF_SUM_LANES]) {
  cf_forming f = *of;
  f.x += i, f.b += i, f.lo += i, f.hi += i;
  cf_form_row(dim, n - i, &f);
  for (int v = 0; v < n - i; ++v) {
    const double rest[] = {f.residual[v], (double)f.x[v], (double)f.b[v]};
    const int l = v % CF_SUM_LANES;
    lane[0][l] += rest[0] * rest[0];
    lane[1][l] += rest[1];
    lane[2][l] += rest[1] * rest[1];
    lane[3][l] += rest[2];
    lane[4][l] += rest[2] * rest[2];
  }
  for (int v = n - i; v < whole - i; ++v) f.residual[v] = 0;
}

CF_KERNEL void form_row(const int dim, const cf_pass *p, const cf_strip *t, const int j) {
  static const cf_pass_sum kind[5] = {CF_SUM_RESIDUAL, CF_SUM_X, CF_SUM_X2, CF_SUM_B, CF_SUM_B2};
  const cf_forming f = cf_forming_of(dim, p, t, j);
  const int n = cf_natural_count(p->at, t), whole = 2 * (t->to - t->from);
  const double factor = 1 / p->scale;
  float *even = p->at->r + j * p->at->row + t->k * p->at->plane + t->from, *odd = even + p->at->odd;
  const double coupling = n > SIXTEEN ? f.beta * f.lo[SIXTEEN - 1] : 0;
  const bool inner =
      f.lo_y == coupling && f.hi_y == coupling && (dim == 2 || (f.lo_z == coupling && f.hi_z == coupling));
  double lane[5][CF_SUM_LANES];
  sums s = {0};
  int i = 0;
  for (; i + SIXTEEN <= n; i += SIXTEEN) {
    cf_eight low, high;
    if (inner && i > 0 && i + SIXTEEN < n) {
      form_eight(dim, 1, &f, coupling, i, &low, &s);
      form_eight(dim, 1, &f, coupling, i + CF_SUM_LANES, &high, &s);
    } else {
      form_eight(dim, 0, &f, coupling, i, &low, &s);
      form_eight(dim, 0, &f, coupling, i + CF_SUM_LANES, &high, &s);
    }
    CF_EIGHT_INTO_FLOATS(even + i / 2, factor * CF_EIGHT_EVEN(low, high));
    CF_EIGHT_INTO_FLOATS(odd + i / 2, factor * CF_EIGHT_ODD(low, high));
  }
  memcpy(lane, &s, sizeof lane);
  if (i < whole) {
    form_rest(dim, &f, i, n, whole, lane);
    cf_split_scaled((whole - i) / 2, factor, f.residual, even + i / 2, odd + i / 2);
  }
  double *sums_here = cf_sums_of(p, t, j);
  for (int v = 0; v < 5; ++v) sums_here[kind[v] * p->sums] = cf_sum_lanes(lane[v]);
}

CF_KERNEL void form_rows(const int dim, const cf_pass *p, const cf_strip *t) {
  CF_FOR_ROWS(j, t) form_row(dim, p, t, j);
}
CF_CLONES static void form_rows_2d(const cf_pass *p, const cf_strip *t) { form_rows(2, p, t); }
CF_CLONES static void form_rows_3d(const cf_pass *p, const cf_strip *t) { form_rows(3, p, t); }

void cf_stage_form(const cf_pass *p, const cf_strip *t) {
  (p->at->dim == 3 ? form_rows_3d : form_rows_2d)(p, t);
}
