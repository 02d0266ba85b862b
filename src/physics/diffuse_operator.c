/* SPDX-License-Identifier: MIT
 *
 * The equation of an implicit stage of length delta,
 *
 *     (C - delta per div k grad) phi~ = b.
 *
 * Where a fraction f of a cell is held at a value, C f/(1 - f) (phi~ - value) stands beside the rest: at f = 1 a weight
 * so large that phi~ is the value to what single precision can tell. A radiating wall conducts its share of beta.
 */
#include <math.h>

#include "physics/diffuse_part.h"

/* A held cell's equation is phi = value with this weight beside the rest; from this fraction on the value is
 * known. */
#define HOLD_MAX 1e6
#define HOLD_ALL (1 - 1 / HOLD_MAX)

/* --- the operator ----------------------------------------------------------------------------------------- */

CF_CLONES static void scale_row(const int n, const cf_real factor, const cf_real *from, const cf_real all,
                                cf_real *to) {
  CF_ROW_LOOP
  for (int i = 0; i < n; ++i) to[i] = factor * (from != NULL ? from[i] : all);
}

/* beta = per k on all faces. */
static void scale_faces(const cf_diffuse *d, const cf_real per) {
  const cf_box *box = &d->grid->box;
  for (int a = 0; a < box->dim; ++a) {
    const int n1 = cf_box_extent(box, 1, a), n2 = cf_box_extent(box, 2, a);
#pragma omp parallel for schedule(static) num_threads(cf_sweep_threads(box, d->grid->threads))
    for (int r = 0; r < n1 * n2; ++r) {
      const ptrdiff_t p = cf_box_at(box, 0, r % n1, r / n1);
      scale_row(cf_box_extent(box, 0, a), per, d->k_varies ? d->k.at[a] + p : NULL, (cf_real)d->p.k.value,
                d->beta.at[a] + p);
    }
  }
}

static void radiation_beta(const cf_diffuse *d, const cf_wall_side *w, const ptrdiff_t p, const ptrdiff_t f,
                           const ptrdiff_t place, void *law) {
  (void)place;
  cf_real *beta = &d->beta.at[w->axis][f];
  *beta = (cf_real)((double)*beta * cf_diffuse_radiation(d, law, w->axis, p, f).share);
}

/* alpha = C (1 + f/(1 - f)) where a fraction f of the cell is held. */
static void alpha_where_held(cf_diffuse *d) {
  const cf_box *box = &d->grid->box;
  CF_PARALLEL_ROWS (box, d->grid->threads, r)
    for (int i = 0; i < box->n[0]; ++i) {
      const ptrdiff_t p = cf_box_row(box, r) + i;
      const double f = (double)d->fraction.at[p], hold = f < 1 ? CF_MIN(f / (1 - f), HOLD_MAX) : HOLD_MAX;
      d->alpha.at[p] = (cf_real)((d->c_varies ? (double)d->capacity.at[p] : 1) * (1 + hold));
    }
}

cf_status cf_diffuse_set_operator(cf_diffuse *d, const cf_flux_law *law) {
  if (d->source.hold != NULL)
    alpha_where_held(d);
  else if (law->delta == d->delta && law->per == d->per)
    return CF_OK; /* the same matrix as last time */
  d->delta = -1;  /* until all is well: after a failure the operator must be set again */
  const double beta = law->delta * law->per;
  cf_coefficients c = {
      .alpha = 1, .beta = d->beta.at[0] != NULL ? 0 : beta * d->p.k.value, .region = d->p.region};
  if (d->beta.at[0] != NULL) {
    scale_faces(d, (cf_real)beta);
    cf_diffuse_halve_held(d, d->beta);
    if (d->has_radiation) {
      cf_flux_law own = *law;
      cf_diffuse_visit_radiating(d, radiation_beta, &own);
    }
    c.beta_at = &d->beta;
  }
  if (d->source.hold != NULL)
    c.alpha_at = &d->alpha;
  else if (d->c_varies)
    c.alpha_at = &d->capacity;
  CF_TRY(cf_helmholtz_set(d->A, &c));
  d->delta = law->delta;
  d->per = law->per;
  return CF_OK;
}

/* --- the solve -------------------------------------------------------------------------------------------- */

/* b += C f/(1 - f) value, to match alpha. */
static void right_side_where_held(const cf_diffuse *d) {
  const cf_box *box = &d->grid->box;
  CF_PARALLEL_ROWS (box, d->grid->threads, r)
    for (int i = 0; i < box->n[0]; ++i) {
      const ptrdiff_t p = cf_box_row(box, r) + i;
      const double c = d->c_varies ? (double)d->capacity.at[p] : 1;
      d->b.at[p] += (cf_real)(((double)d->alpha.at[p] - c) * (double)d->value.at[p]);
    }
}

static double norm(const cf_diffuse *d, const cf_cell f) {
  const cf_box *box = &d->grid->box;
  CF_PARALLEL_ROWS (box, d->grid->threads, r) {
    double lane[CF_SUM_LANES] = {0};
    const cf_real *row = f.at + cf_box_row(box, r);
    for (int i = 0; i < box->n[0]; ++i) lane[i % CF_SUM_LANES] += (double)row[i] * (double)row[i];
    d->rows[r] = cf_sum_lanes(lane);
  }
  return sqrt(cf_sum_ordered(d->rows, cf_box_rows(box)));
}

/* Where cells are held, for the change from a guess that has the held values: against their weights the other
 * cells' equations would not count in the norms of the solver. The residual is meant, and told, in terms of the right
 * side without those weights. */
static cf_status solve_held(cf_diffuse *d, cf_solve_report *one) {
  const cf_box *box = &d->grid->box;
  const double plain = norm(d, d->b);
  cf_solve_options o = d->p.solver;
  right_side_where_held(d);
  CF_PARALLEL_ROWS (box, d->grid->threads, r)
    for (int i = 0; i < box->n[0]; ++i) {
      const ptrdiff_t p = cf_box_row(box, r) + i;
      if ((double)d->fraction.at[p] >= HOLD_ALL) d->x.at[p] = d->value.at[p];
    }
  cf_helmholtz_apply(d->A, d->x, d->change);
  CF_PARALLEL_ROWS (box, d->grid->threads, r)
    for (int i = 0; i < box->n[0]; ++i) {
      const ptrdiff_t p = cf_box_row(box, r) + i;
      const bool known = (double)d->fraction.at[p] >= HOLD_ALL;
      d->b.at[p] = known ? 0 : d->b.at[p] - d->change.at[p];
      d->change.at[p] = 0;
    }
  const double size = norm(d, d->b), scale = size > 0 && plain > 0 ? plain / size : 1;
  o.tolerance = CF_MIN(0.5, CF_MAX(o.tolerance * scale, 64 * CF_REAL_EPSILON));
  CF_TRY(cf_helmholtz_solve(d->A, d->b, &o, d->change, one));
  one->residual /= scale;
  CF_PARALLEL_ROWS (box, d->grid->threads, r)
    for (int i = 0; i < box->n[0]; ++i) {
      const ptrdiff_t p = cf_box_row(box, r) + i;
      d->x.at[p] += d->change.at[p];
    }
  return CF_OK;
}

cf_status cf_diffuse_solve(cf_diffuse *d, cf_solve_report *one) {
  if (d->source.hold != NULL) return solve_held(d, one);
  return cf_helmholtz_solve(d->A, d->b, &d->p.solver, d->x, one);
}
