/* SPDX-License-Identifier: MIT
 *
 * The residual of the solution itself, b - A x, in double; split and scaled it is what cycles start from.
 */
#include "solve/stages_apply.h"

CF_KERNEL void form_rows(const int dim, const cf_pass *p, const cf_strip *t) {
  const cf_split *s = p->at;
  const int n = cf_natural_count(s, t), whole = 2 * (t->to - t->from);
  CF_FOR_ROWS(j, t) {
    const cf_forming f = cf_forming_of(dim, p, t, j);
    const ptrdiff_t to = j * s->row + t->k * s->plane + t->from;
    cf_form_row(dim, n, &f);
    for (int i = n; i < whole; ++i) f.residual[i] = 0;
    double *sums = cf_sums_of(p, t, j);
    sums[CF_SUM_RESIDUAL * p->sums] = cf_square_sum(whole, f.residual);
    cf_sum_row(n, f.x, &sums[CF_SUM_X * p->sums], &sums[CF_SUM_X2 * p->sums]);
    cf_sum_row(n, f.b, &sums[CF_SUM_B * p->sums], &sums[CF_SUM_B2 * p->sums]);
    cf_split_scaled(whole / 2, 1 / p->scale, f.residual, s->r + to, s->r + to + s->odd);
  }
}
CF_CLONES static void form_rows_2d(const cf_pass *p, const cf_strip *t) { form_rows(2, p, t); }
CF_CLONES static void form_rows_3d(const cf_pass *p, const cf_strip *t) { form_rows(3, p, t); }

void cf_stage_form(const cf_pass *p, const cf_strip *t) {
  (p->at->dim == 3 ? form_rows_3d : form_rows_2d)(p, t);
}
