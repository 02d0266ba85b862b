/* SPDX-License-Identifier: MIT
 *
 * The exponential leapfrog: explicit, in place, second order, without a solve. With E = exp(-dt/tau),
 *
 *     kick    q   <- E q - (1 - E)(1 - F_T) k grad phi + tau (1 - E) B
 *     drift   phi <- phi + dt (W - div q/C)
 *
 * and half a kick at both ends of a step, so that phi and q belong to the same time there. Two half kicks are one
 * kick exactly, so only the ends cost more. A step takes as many substeps as keep it stable
 * (stencil/explicit.h); at the limit in 1D it moves waves exactly.
 *
 * With F_T > 0 the part without memory goes before and after in implicit steps of half the length (Strang).
 *
 * In the scalar form s = div q is kicked by -div k grad phi.
 *
 * `positive`: q on a face is limited to c times the larger phi of its two cells, |q| <= c phi, and what leaves a
 * cell in a drift to what is in it. Neither binds in 1D on the exact solution that starts from phi >= 0, q = 0;
 * in 2D and 3D they take away the trough below zero that Cattaneo's law has behind its front.
 */
#include <math.h>

#include "physics/diffuse_part.h"
#include "stencil/explicit.h"

#define SUBSTEPS_MAX 100000

/* What the kernels of a row read and write. */
typedef struct leap {
  ptrdiff_t stride[3];
  cf_real k, d, decay, gain; /* q <- decay q - gain k (difference of phi); on s the sum of them */
  cf_real out;               /* phi <- phi + d W - out div/C */
  const cf_real *W, *capacity, *k_face[3];
  cf_real *phi, *q[3], *s;
} leap;

CF_KERNEL cf_real slope_at(const int varies, const leap *l, const int a, const ptrdiff_t p) {
  return (varies ? l->k_face[a][p] : l->k) * (l->phi[p] - l->phi[p - l->stride[a]]);
}

CF_KERNEL void kick_axis(const int varies, const int n, const leap *l, const int a, const ptrdiff_t start) {
  CF_ROW_LOOP
  for (int i = 0; i < n; ++i) {
    const ptrdiff_t p = start + i;
    l->q[a][p] = l->decay * l->q[a][p] - l->gain * slope_at(varies, l, a, p);
  }
}

CF_KERNEL void kick_row(const int dim, const int varies, const int n, const leap *l, const ptrdiff_t start) {
  kick_axis(varies, n + 1, l, 0, start);
  for (int a = 1; a < dim; ++a) kick_axis(varies, n, l, a, start);
}
CF_CLONED_FORMS(kick_row, const leap *, const ptrdiff_t)

CF_KERNEL void kick_scalar_row(const int dim, const int varies, const int n, const leap *l,
                               const ptrdiff_t start) {
  CF_ROW_LOOP
  for (int i = 0; i < n; ++i) {
    const ptrdiff_t p = start + i;
    cf_real bend = 0;
    CF_AXIS_LOOP
    for (int a = 0; a < dim; ++a)
      bend += slope_at(varies, l, a, p + l->stride[a]) - slope_at(varies, l, a, p);
    l->s[p] = l->decay * l->s[p] - l->gain * bend;
  }
}
CF_CLONED_FORMS(kick_scalar_row, const leap *, const ptrdiff_t)

CF_KERNEL void drift_row(const int dim, const int scalar, const int acts, const int n, const leap *l,
                         const ptrdiff_t start) {
  CF_ROW_LOOP
  for (int i = 0; i < n; ++i) {
    const ptrdiff_t p = start + i;
    cf_real div = 0;
    if (scalar) {
      div = l->s[p];
    } else {
      CF_AXIS_LOOP
      for (int a = 0; a < dim; ++a) div += l->q[a][p + l->stride[a]] - l->q[a][p];
    }
    const cf_real lost = l->out * div,
                  W = acts == CF_ACTS_SOURCE || (acts == CF_ACTS_ALL && l->W != NULL) ? l->W[p] : 0;
    l->phi[p] += l->d * W - (acts == CF_ACTS_ALL ? lost / l->capacity[p] : lost);
  }
}
CF_CLONED_ACTS(drift_row, const leap *)

static leap leap_of(const cf_diffuse *d, const cf_diffused *y) {
  leap l = {.k = (cf_real)d->p.k.value, .phi = y->phi.at, .s = y->s.at, .W = d->W.at};
  l.capacity = d->c_varies ? d->capacity.at : NULL;
  for (int a = 0; a < d->grid->box.dim; ++a) {
    l.stride[a] = d->grid->box.stride[a];
    l.k_face[a] = d->k.at[a];
    l.q[a] = y->q.at[a];
  }
  return l;
}

/* --- positivity ------------------------------------------------------------------------------------------- */

/* |q| <= limit max(C phi of the two cells) on the faces [0, n) of a row. */
static void cap_axis(const int n, const leap *l, const double limit, const int a, const ptrdiff_t start) {
  for (int i = 0; i < n; ++i) {
    const ptrdiff_t p = start + i, o = p - l->stride[a];
    const double here = (double)l->phi[p] * (l->capacity != NULL ? (double)l->capacity[p] : 1);
    const double there = (double)l->phi[o] * (l->capacity != NULL ? (double)l->capacity[o] : 1);
    const double most = limit * CF_MAX(CF_MAX(here, there), 0), q = (double)l->q[a][p];
    l->q[a][p] = (cf_real)CF_MAX(-most, CF_MIN(q, most));
  }
}

/* share[p]: of what would leave cell p, what is there to leave. */
static void shares_row(const int dim, const int n, const leap *l, const ptrdiff_t start, cf_real *share) {
  for (int i = 0; i < n; ++i) {
    const ptrdiff_t p = start + i;
    double leaves = 0;
    for (int a = 0; a < dim; ++a)
      leaves += CF_MAX((double)l->q[a][p + l->stride[a]], 0) + CF_MAX(-(double)l->q[a][p], 0);
    const double C = l->capacity != NULL ? (double)l->capacity[p] : 1;
    leaves *= (double)l->out / C * (1 + 16 * CF_REAL_EPSILON);
    const double there = CF_MAX((double)l->phi[p], 0);
    share[p] = (cf_real)(leaves > there ? there / leaves : 1);
  }
}

static void share_axis(const int n, const leap *l, const int a, const ptrdiff_t start, const cf_real *share) {
  for (int i = 0; i < n; ++i) {
    const ptrdiff_t p = start + i;
    l->q[a][p] *= l->q[a][p] > 0 ? share[p - l->stride[a]] : share[p];
  }
}

/* Runs `visit` over the rows of all faces of axis a, insulated walls as well (0 stays 0 there). */
#define FOR_FACE_ROWS(d, a, start)                                    \
  for (int k_ = 0; k_ < cf_box_extent(&(d)->grid->box, 2, a); ++k_)   \
    for (int j_ = 0; j_ < cf_box_extent(&(d)->grid->box, 1, a); ++j_) \
      for (ptrdiff_t start = cf_box_at(&(d)->grid->box, 0, j_, k_), once_ = 1; once_; once_ = 0)

/* Called after a full kick and before the drift; phi's ghosts are filled. */
static void make_positive(const cf_diffuse *d, const leap *l) {
  const cf_box *box = &d->grid->box;
  for (int a = 0; a < box->dim; ++a)
    FOR_FACE_ROWS(d, a, start) cap_axis(cf_box_extent(box, 0, a), l, d->speed_max, a, start);
  CF_PARALLEL_ROWS (box, d->grid->threads, r) shares_row(box->dim, box->n[0], l, cf_box_row(box, r), d->x.at);
  cf_diffuse_fill_outside(d, 1, d->x); /* what is held never runs out */
  cf_diffuse_copy_ghosts(d, d->x);
  for (int a = 0; a < box->dim; ++a)
    FOR_FACE_ROWS(d, a, start) share_axis(cf_box_extent(box, 0, a), l, a, start, d->x.at);
}

/* --- kick and drift --------------------------------------------------------------------------------------- */

static void high_walls(const cf_diffuse *d, const leap *l) {
  const cf_box *box = &d->grid->box;
  for (int a = 1; a < box->dim; ++a) {
    const int other = a == 1 ? 2 : 1;
    for (int o = 0; o < box->n[other]; ++o) {
      const ptrdiff_t start = box->n[a] * box->stride[a] + o * box->stride[other];
      if (d->k_varies)
        kick_axis(1, box->n[0], l, a, start);
      else
        kick_axis(0, box->n[0], l, a, start);
    }
  }
}

/* tau (1 - E), also for an infinite tau. */
static double source_time(const double tau, const double dt) {
  return isinf(tau) ? dt : tau > 0 ? -tau * expm1(-dt / tau) : 0;
}

/* The flux over dt, which ends or starts at time t, with phi of that time. */
static cf_status kick(cf_diffuse *d, const double t, const double dt, const cf_diffused *y) {
  const cf_box *box = &d->grid->box;
  const double tau = d->p.tau, h = d->grid->h, E = tau > 0 ? exp(-dt / tau) : 0;
  const double gain = (tau > 0 ? -expm1(-dt / tau) : 1) * (1 - d->p.f_t);
  CF_TRY(cf_diffuse_sample(d, &(cf_source_times){t, t, t, t}));
  cf_diffuse_set_outside(d, y->phi);
  cf_diffuse_ghosts(d, &(cf_flux_law){dt, E, gain}, y->phi, y->q);
  leap l = leap_of(d, y);
  l.decay = (cf_real)E;
  l.gain = (cf_real)(gain / (y->s.at != NULL ? h * h : h));
  CF_PARALLEL_ROWS (box, d->grid->threads, r) {
    if (y->s.at != NULL)
      kick_scalar_row_by_form(box->dim, d->k_varies, box->n[0], &l, cf_box_row(box, r));
    else
      kick_row_by_form(box->dim, d->k_varies, box->n[0], &l, cf_box_row(box, r));
  }
  if (y->s.at == NULL) high_walls(d, &l);
  cf_diffuse_add_flux_source(d, source_time(tau, dt), y->q);
  return CF_OK;
}

/* Outflow of q through one wall, inwards positive, times dt. */
static double through_wall(const cf_diffuse *d, const cf_face q, const int axis, const int side,
                           const double dt) {
  const cf_wall_side w = cf_wall_side_of(&d->grid->box, axis, side);
  double sum = 0;
  for (int i_c = 0; i_c < w.n_c; ++i_c) {
    double line = 0;
    for (int i_b = 0; i_b < w.n_b; ++i_b)
      line += (double)q.at[axis][cf_wall_cell(&d->grid->box, &w, i_b, i_c) + (side == 0 ? 0 : w.outward)];
    sum += line;
  }
  return (side == 0 ? sum : -sum) * dt * cf_grid_area(d->grid);
}

static void account_walls(const cf_diffuse *d, const cf_diffused *y, const double dt, cf_ledger *ledger) {
  if (!d->has_open) return;
  if (y->s.at != NULL) {
    cf_ledger_add(ledger, -dt * cf_diffuse_plain_integral(d, y->s));
    return;
  }
  for (int a = 0; a < d->grid->box.dim; ++a)
    for (int side = 0; side < 2; ++side)
      if (d->walls.at[a][side] != NULL) cf_ledger_add(ledger, through_wall(d, y->q, a, side, dt));
}

/* phi from t to t + dt with the flux of the middle. */
static cf_status drift(cf_diffuse *d, const double t, const double dt, const cf_diffused *y,
                       cf_ledger *ledger) {
  const cf_box *box = &d->grid->box;
  const double middle = t + dt / 2;
  CF_TRY(cf_diffuse_sample(d, &(cf_source_times){middle, middle, middle, t + dt}));
  leap l = leap_of(d, y);
  l.d = (cf_real)dt;
  l.out = (cf_real)(y->s.at != NULL ? dt : dt / d->grid->h);
  if (d->p.positive && y->s.at == NULL) make_positive(d, &l);
  cf_diffuse_clear_outside(d, y->phi);
  CF_PARALLEL_ROWS (box, d->grid->threads, r)
    drift_row_by_form(box->dim, y->s.at != NULL, box->n[0], &l, cf_box_row(box, r));
  cf_diffuse_take_outside(d, y->phi, ledger);
  account_walls(d, y, dt, ledger);
  if (d->source.rate != NULL) cf_ledger_add(ledger, dt * cf_diffuse_integral(d, d->W));
  if (d->source.hold != NULL) cf_ledger_add(ledger, cf_diffuse_hold(d, 0, y->phi));
  return CF_OK;
}

/* Fourier's part with explicit steps, where phi must not fall below 0: the flux stands in beta's memory. */
static void fourier_step(cf_diffuse *d, const double dt, const cf_diffused *y, cf_ledger *ledger) {
  const cf_box *box = &d->grid->box;
  const cf_diffused only = {.phi = y->phi, .q = d->beta};
  cf_diffuse_ghosts(d, &(cf_flux_law){dt, 0, d->p.f_t}, y->phi, d->beta);
  leap l = leap_of(d, &only);
  l.W = NULL;
  l.gain = (cf_real)(d->p.f_t / d->grid->h);
  l.out = (cf_real)(dt / d->grid->h);
  CF_PARALLEL_ROWS (box, d->grid->threads, r)
    kick_row_by_form(box->dim, d->k_varies, box->n[0], &l, cf_box_row(box, r));
  high_walls(d, &l);
  cf_diffuse_clear_outside(d, y->phi);
  CF_PARALLEL_ROWS (box, d->grid->threads, r)
    drift_row_by_form(box->dim, 0, box->n[0], &l, cf_box_row(box, r));
  cf_diffuse_take_outside(d, y->phi, ledger);
  account_walls(d, &only, dt, ledger);
}

cf_status cf_diffuse_leapfrog(cf_diffuse *d, const double t, const double dt, const cf_diffused *y,
                              cf_ledger *ledger, cf_solve_report *report) {
  const double wanted = cf_diffuse_substeps(d, dt);
  const bool mixed = d->p.f_t > 0 && d->k_max > 0, fourier = mixed && !d->p.positive;
  if (wanted > SUBSTEPS_MAX)
    return cf_fail(
        CF_OVER_LIMIT,
        "the explicit scheme needs %.3g substeps in a step of %g s (k up to %g m^2/s, h = %g m): take "
        "scheme sdirk2, which has no such limit",
        wanted, dt, d->k_max, d->grid->h);
  const int n = (int)wanted;
  const double sub = dt / n;
  report->method = "leapfrog";
  if (fourier) CF_TRY(cf_diffuse_fourier_part(d, t, dt / 2, y, ledger, report));
  CF_TRY(kick(d, t, sub / 2, y));
  for (int i = 0; i < n; ++i) {
    const double now = t + i * sub, next = i + 1 < n ? t + (i + 1) * sub : t + dt;
    CF_TRY(drift(d, now, sub, y, ledger));
    if (mixed && !fourier) fourier_step(d, sub, y, ledger);
    cf_diffuse_filter_phi(d, 0.5, sub, y->phi, ledger);
    CF_TRY(kick(d, next, i + 1 < n ? sub : sub / 2, y));
    cf_diffuse_filter_flux(d, 0.5, sub, y->q);
  }
  if (fourier) CF_TRY(cf_diffuse_fourier_part(d, t + dt / 2, dt / 2, y, ledger, report));
  return CF_OK;
}
