/* SPDX-License-Identifier: MIT
 *
 * The residual of the solution itself, b - A x, in double and from the caller's fields, where the finest level lies apart by
 * colour: what cycles start from, and what they go on from where the rounding of couplings would be seen.
 */
#include "solve/fields.h"
#include "solve/stages_apply.h"
#include "solve/varied_row.h"

/* A row of it: b - A x goes to r, times `factor`; squares of b - A x, b and x, and sums of b and x. */
typedef struct forming {
  double factor;
  float *even, *odd;
  double rr, bb, xx, b, x;
} forming;

typedef struct lanes {
  cf_eight rr, bb, xx, b, x;
} lanes;

/* Two differences of an axis, at cells i to i + 7; beta is at p (NULL: the number), 1/h^2 with the walls is `low` and `high`. */
CF_KERNEL void add_axis(const int form, const cf_varied_row *o, const int a, const int i, const cf_eight *low,
                        const cf_eight *high, cf_eight *sum) {
  const ptrdiff_t s = o->stride[a];
  const cf_real *x = o->x + i;
  const cf_eight c = CF_EIGHT_OF(x), down = c - CF_EIGHT_OF(x - s), up = CF_EIGHT_OF(x + s) - c;
  if (form == CF_BETA_NUMBER)
    *sum += (double)o->beta_number * (*low * down - *high * up);
  else
    *sum += *low * CF_EIGHT_OF(o->beta[a] + i) * down - *high * CF_EIGHT_OF(o->beta[a] + i + s) * up;
}

/* Of eight cells. */
CF_KERNEL void form_eight(const int dim, const int form, const cf_varied_row *o, const int i, cf_eight *rest,
                          lanes *of) {
  const cf_eight x = CF_EIGHT_OF(o->x + i), b = CF_EIGHT_OF(o->b + i);
  const cf_eight low_x = CF_EIGHT_OF(o->lo_x + i), high_x = CF_EIGHT_OF(o->hi_x + i);
  cf_eight sum = (double)o->alpha_number * x;
  if (form != CF_ALPHA_NUMBER) sum = CF_EIGHT_OF(o->alpha + i) * x;
  add_axis(form, o, 0, i, &low_x, &high_x, &sum);
  CF_AXIS_LOOP
  for (int a = 1; a < dim; ++a) {
    const cf_eight low = (cf_eight){0} + (double)o->lo[a], high = (cf_eight){0} + (double)o->hi[a];
    add_axis(form, o, a, i, &low, &high, &sum);
  }
  *rest = b - sum;
  of->rr += *rest * *rest;
  of->bb += b * b;
  of->xx += x * x;
  of->b += b;
  of->x += x;
}

/* The cells that are left over, in pairs. */
CF_KERNEL void form_rest(const int dim, const int form, const int from, const int n, const cf_varied_row *o,
                         forming *f) {
  for (int i = from; i < n; ++i) {
    const double rest = (double)o->b[i] - cf_apply_at(dim, form, o, i);
    *(i % 2 == 0 ? &f->even[i / 2] : &f->odd[i / 2]) = (float)(f->factor * rest);
    f->rr += rest * rest;
    f->bb += (double)o->b[i] * (double)o->b[i];
    f->xx += (double)o->x[i] * (double)o->x[i];
    f->b += (double)o->b[i];
    f->x += (double)o->x[i];
  }
}

CF_KERNEL double joined(const cf_eight *sum) {
  double lane[CF_SUM_LANES];
  memcpy(lane, sum, sizeof lane);
  return cf_sum_lanes(lane);
}

CF_KERNEL void remain(const int dim, const int form, const int n, const cf_varied_row *of, forming *f) {
  const cf_varied_row o = *of;
  lanes sums = {{0}, {0}, {0}, {0}, {0}};
  int i = 0;
  for (; i + 2 * CF_SUM_LANES <= n; i += 2 * CF_SUM_LANES) {
    cf_eight low, high;
    form_eight(dim, form, &o, i, &low, &sums);
    form_eight(dim, form, &o, i + CF_SUM_LANES, &high, &sums);
    CF_EIGHT_INTO_FLOATS(f->even + i / 2, f->factor * CF_EIGHT_EVEN(low, high));
    CF_EIGHT_INTO_FLOATS(f->odd + i / 2, f->factor * CF_EIGHT_ODD(low, high));
  }
  f->rr = joined(&sums.rr), f->bb = joined(&sums.bb), f->xx = joined(&sums.xx);
  f->b = joined(&sums.b), f->x = joined(&sums.x);
  form_rest(dim, form, i, n, &o, f);
}
CF_VARIED_ROWS(remain, forming *)

void cf_stage_form_on_fields(const cf_pass *p, const cf_strip *t) {
  const cf_split *s = p->at;
  const cf_varied *v = s->fields->of;
  const cf_run run = {2 * t->from, 2 * t->from + cf_natural_count(s, t)};
  CF_FOR_ROWS(j, t) {
    float *even = s->r + j * s->row + t->k * s->plane + t->from;
    forming f = {.factor = 1 / p->scale, .even = even, .odd = even + s->odd};
    cf_varied_row o = cf_varied_row_of(v, &run, j, t->k, (cf_cell){p->x});
    o.b = p->b + cf_box_at(&s->plain->box, run.low, j, t->k);
    remain_row(s->dim, cf_varied_form_of(v), run.high - run.low, &o, &f);
    double *sums = cf_sums_of(p, t, j);
    sums[CF_SUM_RESIDUAL * p->sums] = f.rr;
    sums[CF_SUM_B2 * p->sums] = f.bb;
    sums[CF_SUM_X2 * p->sums] = f.xx;
    sums[CF_SUM_B * p->sums] = f.b;
    sums[CF_SUM_X * p->sums] = f.x;
  }
}
