/* SPDX-License-Identifier: MIT
 *
 * The residual of the solution itself, b - A x, in double; split and scaled it is what cycles start from.
 */
#include "solve/stages_part.h"

CF_KERNEL double square_sum_of_doubles(const int n, const double *f) {
  double lane[CF_SUM_LANES] = {0};
  for (int i = 0; i < n; i += CF_SUM_LANES)
    for (int l = 0; l < CF_SUM_LANES; ++l) lane[l] += f[i + l] * f[i + l];
  return cf_sum_lanes(lane);
}

/* A row from its first cell in the strip on. */
typedef struct forming {
  const cf_real *x, *b;
  const double *lo, *hi; /* along x, without beta */
  ptrdiff_t y, z;
  double alpha, beta, lo_y, hi_y, lo_z, hi_z, shift;
  double *residual;
} forming;

CF_KERNEL void form(const int dim, const int n, const forming *of) {
  const forming f = *of;
  CF_ROW_LOOP
  for (int i = 0; i < n; ++i) {
    const double c = (double)f.x[i];
    double sum = f.beta * (f.lo[i] * (c - (double)f.x[i - 1]) - f.hi[i] * ((double)f.x[i + 1] - c));
    sum += f.lo_y * (c - (double)f.x[i - f.y]) - f.hi_y * ((double)f.x[i + f.y] - c);
    if (dim == 3) sum += f.lo_z * (c - (double)f.x[i - f.z]) - f.hi_z * ((double)f.x[i + f.z] - c);
    f.residual[i] = (double)f.b[i] - f.shift - (f.alpha * c + sum);
  }
}

CF_KERNEL void split_scaled(const int pairs, const double factor, const double *line, float *even,
                            float *odd) {
  CF_ROW_LOOP
  for (int m = 0; m < pairs; ++m) {
    even[m] = (float)(factor * line[2 * m]);
    odd[m] = (float)(factor * line[2 * m + 1]);
  }
}

CF_KERNEL forming forming_of(const int dim, const cf_pass *p, const cf_strip *t, const int j) {
  const cf_level *l = p->at->plain;
  const int i0 = 2 * t->from;
  const ptrdiff_t at = cf_box_at(&l->box, i0, j, t->k);
  return (forming){.x = p->x + at,
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

CF_KERNEL void form_rows(const int dim, const cf_pass *p, const cf_strip *t) {
  const cf_split *s = p->at;
  const int n = cf_natural_count(s, t), whole = 2 * (t->to - t->from);
  CF_FOR_ROWS(j, t) {
    const forming f = forming_of(dim, p, t, j);
    const ptrdiff_t to = j * s->row + t->k * s->plane + t->from;
    form(dim, n, &f);
    for (int i = n; i < whole; ++i) f.residual[i] = 0;
    double *sums = cf_sums_of(p, t, j);
    sums[CF_SUM_RESIDUAL * p->sums] = square_sum_of_doubles(whole, f.residual);
    cf_sum_row(n, f.x, &sums[CF_SUM_X * p->sums], &sums[CF_SUM_X2 * p->sums]);
    cf_sum_row(n, f.b, &sums[CF_SUM_B * p->sums], &sums[CF_SUM_B2 * p->sums]);
    split_scaled(whole / 2, 1 / p->scale, f.residual, s->r + to, s->r + to + s->odd);
  }
}
CF_CLONES static void form_rows_2d(const cf_pass *p, const cf_strip *t) { form_rows(2, p, t); }
CF_CLONES static void form_rows_3d(const cf_pass *p, const cf_strip *t) { form_rows(3, p, t); }

void cf_stage_form(const cf_pass *p, const cf_strip *t) {
  (p->at->dim == 3 ? form_rows_3d : form_rows_2d)(p, t);
}
