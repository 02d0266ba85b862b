/* SPDX-License-Identifier: MIT
 *
 * The implicit stage, in four sweeps:
 *
 *     right_side   b = C phi - d m div q + d C W (+ walls, held cells)
 *     solve        phi~
 *     cells        phi <- phi + w (stage's phi - phi)
 *     faces        q   <- q + w (stage's q - q)
 *
 * w = 1 gives the stage itself and w = 1 + sqrt(2) the start of SDIRK2's second stage, so no copy of the old
 * state is ever kept. The fluxes through walls are summed for the ledger with the same w. phi~ gets a layer of
 * ghosts, so faces on walls are faces like any other. In the scalar form s stands for div q, and cells and faces
 * are one sweep. The solve and its operator are in diffuse_operator.c.
 */
#include <math.h>
#include <string.h>

#include "physics/diffuse_part.h"

/* m: what is left of a flux after `delta`. 0 for tau = 0, 1 for tau = infinity. */
static double flux_memory(const double delta, const double tau) {
  return tau > 0 ? 1 / (1 + delta / tau) : 0;
}

/* One stage: its numbers, and what the kernels of a row read and write. */
typedef struct stage {
  cf_flux_law law;
  double w;
  ptrdiff_t stride[3];
  cf_real k, d, weight;
  cf_real rhs;            /* d m/h on differences of q, d m on s */
  cf_real flux_q, flux_k; /* d/h (q_C + q_F) of the stage = flux_q q* - flux_k k (x_p - x_{p-a}) */
  cf_real face_q,
      face_k; /* q of the stage = face_q q* - face_k k (x_p - x_{p-a}); likewise s, on sums of them */
  const cf_real *x, *W, *capacity, *k_face[3];
  cf_real *b, *phi, *q[3], *s;
} stage;

CF_KERNEL cf_real k_at(const int varies, const stage *s, const int a, const ptrdiff_t p) {
  return varies ? s->k_face[a][p] : s->k;
}

/* d W, and what a loss of `out` makes of phi; what `acts` says. */
CF_KERNEL cf_real gain_at(const int acts, const stage *s, const ptrdiff_t p) {
  return acts == CF_ACTS_SOURCE || (acts == CF_ACTS_ALL && s->W != NULL) ? s->d * s->W[p] : 0;
}

CF_KERNEL cf_real lost_at(const int acts, const stage *s, const ptrdiff_t p, const cf_real out) {
  return acts == CF_ACTS_ALL ? out / s->capacity[p] : out;
}

CF_KERNEL cf_real content_at(const int acts, const stage *s, const ptrdiff_t p, const cf_real phi) {
  return acts == CF_ACTS_ALL ? s->capacity[p] * phi : phi;
}

/* k (x_p - x_{p-a}) on the low face of axis a of cell p. */
CF_KERNEL cf_real slope_at(const int varies, const stage *s, const int a, const ptrdiff_t p) {
  return k_at(varies, s, a, p) * (s->x[p] - s->x[p - s->stride[a]]);
}

/* The flux over that face during the stage, times d/h. */
CF_KERNEL cf_real flux_at(const int varies, const stage *s, const int a, const ptrdiff_t p) {
  return s->flux_q * s->q[a][p] - s->flux_k * slope_at(varies, s, a, p);
}

CF_KERNEL void right_side_row(const int dim, const int scalar, const int acts, const int n, const stage *s,
                              const ptrdiff_t start) {
  CF_ROW_LOOP
  for (int i = 0; i < n; ++i) {
    const ptrdiff_t p = start + i;
    cf_real div = 0;
    if (scalar) {
      div = s->s[p];
    } else {
      CF_AXIS_LOOP
      for (int a = 0; a < dim; ++a) div += s->q[a][p + s->stride[a]] - s->q[a][p];
    }
    s->b[p] = content_at(acts, s, p, s->phi[p] + gain_at(acts, s, p)) - s->rhs * div;
  }
}
CF_CLONED_ACTS(right_side_row, const stage *)

CF_KERNEL void cells_row(const int dim, const int varies, const int acts, const int n, const stage *s,
                         const ptrdiff_t start) {
  CF_ROW_LOOP
  for (int i = 0; i < n; ++i) {
    const ptrdiff_t p = start + i;
    cf_real div = 0;
    CF_AXIS_LOOP
    for (int a = 0; a < dim; ++a) div += flux_at(varies, s, a, p + s->stride[a]) - flux_at(varies, s, a, p);
    s->phi[p] += s->weight * (gain_at(acts, s, p) - lost_at(acts, s, p, div));
  }
}
CF_CLONED_ACTS(cells_row, const stage *)

/* Cells and memory of the scalar form. */
CF_KERNEL void scalar_row(const int dim, const int varies, const int acts, const int n, const stage *s,
                          const ptrdiff_t start) {
  CF_ROW_LOOP
  for (int i = 0; i < n; ++i) {
    const ptrdiff_t p = start + i;
    const cf_real old = s->s[p];
    cf_real bend = 0; /* h^2 div k grad phi~ */
    CF_AXIS_LOOP
    for (int a = 0; a < dim; ++a)
      bend += slope_at(varies, s, a, p + s->stride[a]) - slope_at(varies, s, a, p);
    const cf_real fresh = s->face_q * old - s->face_k * bend;
    const cf_real div = s->flux_q * old - s->flux_k * bend;
    s->phi[p] += s->weight * (gain_at(acts, s, p) - lost_at(acts, s, p, div));
    s->s[p] = old + s->weight * (fresh - old);
  }
}
CF_CLONED_ACTS(scalar_row, const stage *)

/* One axis' faces. */
CF_KERNEL void faces_of_axis(const int varies, const int n, const stage *s, const int a,
                             const ptrdiff_t start) {
  CF_ROW_LOOP
  for (int i = 0; i < n; ++i) {
    const ptrdiff_t p = start + i;
    const cf_real q = s->q[a][p];
    const cf_real fresh = s->face_q * q - s->face_k * slope_at(varies, s, a, p);
    s->q[a][p] = q + s->weight * (fresh - q);
  }
}

/* All faces that the cells of a row own, and the row's high wall in x. */
CF_KERNEL void faces_row(const int dim, const int varies, const int n, const stage *s,
                         const ptrdiff_t start) {
  faces_of_axis(varies, n + 1, s, 0, start);
  for (int a = 1; a < dim; ++a) faces_of_axis(varies, n, s, a, start);
}
CF_CLONED_FORMS(faces_row, const stage *, const ptrdiff_t)

/* The high walls of y and z: rows of faces that no cell of the box owns. */
static void high_walls(const cf_diffuse *d, const stage *s) {
  const cf_box *box = &d->grid->box;
  for (int a = 1; a < box->dim; ++a) {
    const int other = a == 1 ? 2 : 1;
    for (int o = 0; o < box->n[other]; ++o) {
      const ptrdiff_t start = box->n[a] * box->stride[a] + o * box->stride[other];
      if (d->k_varies)
        faces_of_axis(1, box->n[0], s, a, start);
      else
        faces_of_axis(0, box->n[0], s, a, start);
    }
  }
}

/* Of m q_w on a radiating wall only the share theta leaves the cell; the rest goes into phi_w. */
static void radiation_right_side(const cf_diffuse *d, const cf_wall_side *w, const ptrdiff_t p,
                                 const ptrdiff_t f, const ptrdiff_t place, void *context) {
  (void)place;
  const stage *s = context;
  const cf_radiation r = cf_diffuse_radiation(d, &s->law, w->axis, p, f);
  const double q_out = (w->side == 0 ? -1 : 1) * (double)s->q[w->axis][f];
  d->b.at[p] += (cf_real)(s->law.delta / d->grid->h * (1 - r.share) * s->law.left * q_out);
}

/* --- the ledger ------------------------------------------------------------------------------------------- */

/* What the stage lets through one wall, inwards. In the scalar form without what q* carries. */
static double through_wall(const cf_diffuse *d, const stage *s, const int axis, const int side) {
  const cf_box *box = &d->grid->box;
  const cf_wall_side w = cf_wall_side_of(box, axis, side);
  double sum = 0;
  for (int i_c = 0; i_c < w.n_c; ++i_c) {
    double line = 0;
    for (int i_b = 0; i_b < w.n_b; ++i_b) {
      const ptrdiff_t p = cf_wall_cell(box, &w, i_b, i_c) + (side == 0 ? 0 : w.outward);
      const cf_real slope = d->k_varies ? slope_at(1, s, axis, p) : slope_at(0, s, axis, p);
      line += (double)((s->s != NULL ? 0 : s->flux_q * s->q[axis][p]) - s->flux_k * slope);
    }
    sum += line;
  }
  return (side == 0 ? sum : -sum) * s->w * cf_grid_volume(d->grid);
}

static void account_walls(const cf_diffuse *d, const stage *s, const cf_cell memory, cf_ledger *ledger) {
  double all = 0;
  if (!d->has_open) return;
  for (int a = 0; a < d->grid->box.dim; ++a)
    for (int side = 0; side < 2; ++side) {
      if (d->walls.at[a][side] == NULL) continue;
      const double amount = through_wall(d, s, a, side);
      if (s->s == NULL) cf_ledger_add(ledger, amount);
      all += amount;
    }
  if (s->s == NULL) return;
  /* What q* carries out through all walls together is the integral of its divergence. */
  cf_ledger_add(ledger, all - s->w * (double)s->flux_q * cf_diffuse_plain_integral(d, memory));
}

/* phi moves to the held value by its fraction; phi here is already old + w (Y - old), and the hold acts on Y:
 * old + w ((1 - f) Y + f v - old) = phi + w f (v - Y). b holds the old phi. */
static double hold_cells(const cf_diffuse *d, const stage *s) {
  const cf_box *box = &d->grid->box;
  CF_PARALLEL_ROWS (box, d->grid->threads, r) {
    const ptrdiff_t start = cf_box_row(box, r);
    double sum = 0;
    for (int i = 0; i < box->n[0]; ++i) {
      const ptrdiff_t p = start + i;
      if (d->fraction.at[p] == 0) continue;
      const double before = (double)s->phi[p], old = (double)d->b.at[p], y = old + (before - old) / s->w;
      s->phi[p] = (cf_real)(before + s->w * (double)d->fraction.at[p] * ((double)d->value.at[p] - y));
      sum += (d->c_varies ? (double)d->capacity.at[p] : 1) * ((double)s->phi[p] - before);
    }
    d->rows[r] = sum;
  }
  return cf_grid_volume(d->grid) * cf_sum_ordered(d->rows, cf_box_rows(box));
}

/* --- the stage -------------------------------------------------------------------------------------------- */

/* A stage of length delta; sources are taken at time t (its end, but the paper's beginning). `fourier`: only the
 * part of the flux without memory moves, and nothing else acts. */
typedef struct stage_plan {
  double delta, t_source, t_walls, w;
  bool paper, fourier;
} stage_plan;

static stage stage_begin(const cf_diffuse *d, const stage_plan *plan, const cf_diffused *y) {
  const double h = d->grid->h, f_t = d->p.f_t, delta = plan->delta;
  const double m = plan->fourier ? 1 : flux_memory(delta, d->p.tau), per = 1 - m + f_t * m;
  const bool scalar = y->s.at != NULL;
  const double q_part = plan->fourier ? 0 : delta * m / (scalar ? 1 : h);
  stage s = {.law = {delta, m, per}, .w = plan->w};
  s.k = d->k_varies ? 1 : (cf_real)d->p.k.value;
  s.d = (cf_real)delta;
  s.weight = (cf_real)plan->w;
  s.rhs = s.flux_q = (cf_real)q_part;
  s.flux_k = (cf_real)(delta * per / (h * h));
  s.face_q = (cf_real)m;
  s.face_k = (cf_real)((1 - m) * (1 - f_t) / (scalar ? h * h : h));
  s.x = d->x.at, s.b = d->b.at, s.W = plan->fourier ? NULL : d->W.at, s.phi = y->phi.at, s.s = y->s.at;
  s.capacity = d->c_varies ? d->capacity.at : NULL;
  for (int a = 0; a < d->grid->box.dim; ++a) {
    s.stride[a] = d->grid->box.stride[a];
    s.k_face[a] = d->k.at[a];
    s.q[a] = y->q.at[a];
  }
  return s;
}

static cf_status solve_stage(cf_diffuse *d, stage *s, const cf_diffused *y, cf_solve_report *report) {
  const cf_box *box = &d->grid->box;
  cf_diffuse_set_outside(d, y->phi);
  CF_PARALLEL_ROWS (box, d->grid->threads, r) { /* the guess is the old phi, copied while it is near */
    const ptrdiff_t start = cf_box_row(box, r);
    right_side_row_by_form(box->dim, s->s != NULL, box->n[0], s, start);
    memcpy(d->x.at + start, y->phi.at + start, (size_t)box->n[0] * sizeof *d->x.at);
  }
  CF_TRY(cf_diffuse_set_operator(d, &s->law));
  cf_helmholtz_add_walls(d->A, &d->walls, d->b);
  cf_diffuse_clear_outside(d, d->b);
  if (d->p.region != NULL) cf_helmholtz_add_held(d->A, d->b);
  if (d->has_radiation) cf_diffuse_visit_radiating(d, radiation_right_side, s);
  cf_solve_report one;
  CF_TRY(cf_diffuse_solve(d, &one));
  report->iterations += one.iterations;
  report->levels = one.levels;
  report->residual = CF_MAX(report->residual, one.residual);
  report->converged = report->converged && one.converged;
  report->method = one.method;
  cf_diffuse_ghosts(d, &s->law, d->x, y->q);
  return CF_OK;
}

static void update_cells(const cf_diffuse *d, const stage *s, const bool paper) {
  const cf_box *box = &d->grid->box;
  CF_PARALLEL_ROWS (box, d->grid->threads, r) {
    const ptrdiff_t start = cf_box_row(box, r);
    if (s->s != NULL)
      scalar_row_by_form(box->dim, d->k_varies, box->n[0], s, start);
    else if (!paper)
      cells_row_by_form(box->dim, d->k_varies, box->n[0], s, start);
  }
  if (paper) cf_diffuse_copy(d, d->x.at, s->phi);
}

static void update_faces(const cf_diffuse *d, const stage *s) {
  const cf_box *box = &d->grid->box;
  CF_PARALLEL_ROWS (box, d->grid->threads, r)
    faces_row_by_form(box->dim, d->k_varies, box->n[0], s, cf_box_row(box, r));
  high_walls(d, s);
}

static cf_status run_stage(cf_diffuse *d, const stage_plan *plan, const cf_diffused *y, cf_ledger *ledger,
                           cf_solve_report *report) {
  const bool scalar = y->s.at != NULL;
  CF_TRY(
      cf_diffuse_sample(d, &(cf_source_times){plan->t_source, plan->t_source, plan->t_walls, plan->t_walls}));
  if (!plan->fourier) cf_diffuse_add_flux_source(d, plan->delta, y->q);
  stage s = stage_begin(d, plan, y);
  CF_TRY(solve_stage(d, &s, y, report));
  account_walls(d, &s, y->s, ledger);
  if (d->source.hold != NULL) cf_diffuse_copy(d, y->phi.at, d->b.at); /* hold_cells needs the old phi */
  /* The paper knows no held cells; phi = phi~ would hide what they bring from the ledger. */
  cf_diffuse_clear_outside(d, y->phi);
  update_cells(d, &s, plan->paper && d->source.hold == NULL && d->p.region == NULL);
  cf_diffuse_take_outside(d, y->phi, ledger);
  if (s.W != NULL) cf_ledger_add(ledger, plan->w * plan->delta * cf_diffuse_integral(d, d->W));
  if (d->source.hold != NULL) cf_ledger_add(ledger, hold_cells(d, &s));
  if (plan->fourier) return CF_OK;
  if (!scalar) update_faces(d, &s);
  cf_diffuse_add_flux_source(d, (plan->w - 1) * plan->delta, y->q);
  return CF_OK;
}

/* Two stages of g dt, g = 1 - 1/sqrt(2), the second from -sqrt(2) y + (1 + sqrt(2)) Y1 (Alexander 1977). */
static cf_status two_stages(cf_diffuse *d, const double t, const double dt, const bool fourier,
                            const cf_diffused *y, cf_ledger *ledger, cf_solve_report *report) {
  const double g = 1 - sqrt(0.5), d1 = g * dt;
  CF_TRY(run_stage(d, &(stage_plan){d1, t + d1, t + d1, 1 + sqrt(2), false, fourier}, y, ledger, report));
  return run_stage(d, &(stage_plan){d1, t + dt, t + dt, 1, false, fourier}, y, ledger, report);
}

cf_status cf_diffuse_paper(cf_diffuse *d, const double t, const double dt, const cf_diffused *y,
                           cf_ledger *ledger, cf_solve_report *report) {
  return run_stage(d, &(stage_plan){dt, t, t + dt, 1, true, false}, y, ledger, report);
}

cf_status cf_diffuse_sdirk2(cf_diffuse *d, const double t, const double dt, const cf_diffused *y,
                            cf_ledger *ledger, cf_solve_report *report) {
  return two_stages(d, t, dt, false, y, ledger, report);
}

cf_status cf_diffuse_fourier_part(cf_diffuse *d, const double t, const double dt, const cf_diffused *y,
                                  cf_ledger *ledger, cf_solve_report *report) {
  return two_stages(d, t, dt, true, y, ledger, report);
}
