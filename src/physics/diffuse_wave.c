/* SPDX-License-Identifier: MIT
 *
 * Waves with the sharpest fronts: C phi_t = -div q, q_t = -(k/tau) grad phi - q/tau on the staggered grid, with
 * differences of fourth order and dissipation only where a reconstruction of fifth order (stencil/weno.h) sees
 * the fields jump. Along each axis, with J(f) = f^R - f^L at a face (of phi) or in a cell (of q),
 *
 *     C phi_t = -(f_{i+1} - f_i)/h,       f = (26 q_i - q_{i-1} - q_{i+1})/24 - (C c/2) J(phi)
 *     q_t = -(k/tau) (g_i - g_{i-1})/h,   g = (26 phi_i - phi_{i-1} - phi_{i+1})/24 - J(q)/(2 C c)
 *
 * so phi is conserved, and all axes act at once. Three Runge-Kutta stages (Shu, Osher 1988) make a substep; the
 * decay of q, exp(-dt/(2 tau)), is taken exactly before and after them (Strang). Substeps: stencil/explicit.h.
 *
 * Ghosts: insulated walls reflect phi evenly and q oddly; held ones phi - phi_w oddly and q evenly, radiating ones
 * as well, with phi_w = phi_inf + q_w/(C c) from the flux on the wall.
 */
#include <math.h>
#include <string.h>

#include "grid/halo.h"
#include "physics/diffuse_part.h"
#include "stencil/weno.h"

#define SUBSTEPS_MAX 100000

/* A Runge-Kutta stage: u <- share u_0 + (1 - share)(u + dt rate). `weight`: of its rate in the whole substep. */
typedef struct stage {
  double t, dt, share, weight;
} stage;

/* --- rows ------------------------------------------------------------------------------------------------- */

/* J between element p - stride and p. */
CF_KERNEL cf_real jump_at(const cf_real *f, const ptrdiff_t p, const ptrdiff_t s) {
  const cf_real low = cf_weno5(f[p - 3 * s], f[p - 2 * s], f[p - s], f[p], f[p + s]);
  const cf_real high = cf_weno5(f[p + 2 * s], f[p + s], f[p], f[p - s], f[p - 2 * s]);
  return high - low;
}

CF_KERNEL cf_real mean_at(const cf_real *f, const ptrdiff_t p, const ptrdiff_t s) {
  return f[p] - ((f[p + s] - f[p]) - (f[p] - f[p - s])) / 24;
}

/* out = mean of `smooth` - factor J(`rough`), J taken `shift` elements further on. */
CF_CLONES static void flux_row(const int n, const ptrdiff_t stride, const ptrdiff_t shift,
                               const cf_real factor, const cf_real *smooth, const cf_real *rough,
                               cf_real *out) {
  CF_ROW_LOOP
  for (int i = 0; i < n; ++i)
    out[i] = mean_at(smooth, i, stride) - factor * jump_at(rough, i + shift, stride);
}

/* rate (= or +=) factor (f_i+1 - f_i). */
CF_CLONES static void difference_row(const int n, const ptrdiff_t stride, const cf_real factor,
                                     const bool adds, const cf_real *f, cf_real *rate) {
  CF_ROW_LOOP
  for (int i = 0; i < n; ++i) rate[i] = (adds ? rate[i] : 0) + factor * (f[i + stride] - f[i]);
}

CF_CLONES static void source_row(const int n, const cf_real *from, cf_real *rate) {
  CF_ROW_LOOP
  for (int i = 0; i < n; ++i) rate[i] += from[i];
}

/* u <- share old + (1 - share)(u + dt rate). */
CF_CLONES static void combine_row(const int n, const cf_real share, const cf_real dt, const cf_real *old,
                                  const cf_real *rate, cf_real *u) {
  const cf_real rest = 1 - share;
  CF_ROW_LOOP
  for (int i = 0; i < n; ++i) u[i] = share * old[i] + rest * (u[i] + dt * rate[i]);
}

CF_CLONES static void decay_row(const int n, const cf_real factor, cf_real *q) {
  CF_ROW_LOOP
  for (int i = 0; i < n; ++i) q[i] *= factor;
}

/* Rows of the faces of an axis, the high wall's included; `component` CF_CENTRES: rows of cells. */
#define FOR_ROWS(d, component, p)                                                                                 \
  CF_PRAGMA(omp parallel for schedule(static) num_threads(cf_sweep_threads(&(d)->grid->box, (d)->grid->threads))) \
  for (int r_ = 0;                                                                                                \
       r_ < cf_box_extent(&(d)->grid->box, 1, component) * cf_box_extent(&(d)->grid->box, 2, component);          \
       ++r_)                                                                                                      \
    for (ptrdiff_t p = cf_box_at(&(d)->grid->box, 0, r_ % cf_box_extent(&(d)->grid->box, 1, component),           \
                                 r_ / cf_box_extent(&(d)->grid->box, 1, component)),                              \
                   once_ = 1;                                                                                     \
         once_; once_ = 0)

/* --- ghosts ----------------------------------------------------------------------------------------------- */

/* Beyond one wall: three layers of phi, two of q (component of the wall's axis). */
static void reflect(const cf_diffuse *d, const int a, const int side, const cf_cell phi, const cf_face q) {
  const cf_box *box = &d->grid->box;
  const cf_wall_side w = cf_wall_side_of(box, a, side);
  const bool held = d->walls.at[a][side] != NULL;
  const double Z = sqrt(d->p.capacity.value * d->p.k.value / d->p.tau);
  for (int i_c = 0; i_c < w.n_c; ++i_c)
    for (int i_b = 0; i_b < w.n_b; ++i_b) {
      const ptrdiff_t p = cf_wall_cell(box, &w, i_b, i_c), f = side == 0 ? p : p + w.outward;
      const double q_out = (side == 0 ? -1 : 1) * (double)q.at[a][f];
      double wall = held ? d->walls.at[a][side][i_b + (ptrdiff_t)w.n_b * i_c] : 0;
      if (d->radiates[a][side] && Z > 0) wall += q_out / Z;
      for (int l = 1; l <= 3; ++l) {
        const cf_real inside = phi.at[p - CF_MIN(l - 1, box->n[a] - 1) * w.outward];
        phi.at[p + l * w.outward] = held ? (cf_real)(2 * wall) - inside : inside;
      }
      for (int l = 1; l <= 2; ++l) {
        const cf_real inside = q.at[a][f - CF_MIN(l, box->n[a]) * w.outward];
        q.at[a][f + l * w.outward] = held ? inside : -inside;
      }
    }
}

static void fill_ghosts(const cf_diffuse *d, const int a, const cf_cell phi, const cf_face q) {
  cf_halo halo = {0};
  if (d->walls.walls.kind[a][0] != CF_WALL_PERIODIC) {
    for (int side = 0; side < 2; ++side) reflect(d, a, side, phi, q);
    return;
  }
  halo.rule[a][0] = halo.rule[a][1] = CF_HALO_WRAP;
  cf_halo_fill(&d->grid->box, &halo, 3, CF_CENTRES, phi.at);
  cf_halo_fill(&d->grid->box, &halo, 3, a, q.at[a]);
}

/* g beyond the walls of axis a, as phi there; radiating walls from the flux on the wall. */
static void close_potential(const cf_diffuse *d, const int a, const cf_cell g, const cf_face q) {
  const cf_box *box = &d->grid->box;
  const double Z = sqrt(d->p.capacity.value * d->p.k.value / d->p.tau);
  cf_wall_ghosts(&d->walls, g);
  for (int side = 0; side < 2; ++side) {
    if (!d->radiates[a][side] || !(Z > 0)) continue;
    const cf_wall_side w = cf_wall_side_of(box, a, side);
    for (int i_c = 0; i_c < w.n_c; ++i_c)
      for (int i_b = 0; i_b < w.n_b; ++i_b) {
        const ptrdiff_t p = cf_wall_cell(box, &w, i_b, i_c), f = side == 0 ? p : p + w.outward;
        const double q_out = (side == 0 ? -1 : 1) * (double)q.at[a][f];
        g.at[p + w.outward] += (cf_real)(2 * q_out / Z);
      }
  }
}

/* --- a stage ---------------------------------------------------------------------------------------------- */

/* What f lets in through one wall. */
static double through_wall(const cf_diffuse *d, const cf_real *f, const int axis, const int side) {
  const cf_wall_side w = cf_wall_side_of(&d->grid->box, axis, side);
  double sum = 0;
  for (int i_c = 0; i_c < w.n_c; ++i_c) {
    double line = 0;
    for (int i_b = 0; i_b < w.n_b; ++i_b)
      line += (double)f[cf_wall_cell(&d->grid->box, &w, i_b, i_c) + (side == 0 ? 0 : w.outward)];
    sum += line;
  }
  return (side == 0 ? sum : -sum) * cf_grid_area(d->grid);
}

static void rate_of_phi(const cf_diffuse *d, const stage *s, const cf_diffused *y, cf_ledger *ledger) {
  const cf_box *box = &d->grid->box;
  const double C = d->p.capacity.value;
  const cf_real *phi = y->phi.at;
  cf_real *f = d->b.at, *rate = d->kept.phi_rate.at;
  for (int a = 0; a < box->dim; ++a) {
    const cf_real *q = y->q.at[a];
    FOR_ROWS(d, a, p)
    flux_row(cf_box_extent(box, 0, a), box->stride[a], 0, (cf_real)(C * d->speed_max / 2), q + p, phi + p,
             f + p);
    FOR_ROWS(d, CF_CENTRES, p)
    difference_row(box->n[0], box->stride[a], (cf_real)(-1 / (C * d->grid->h)), a > 0, f + p, rate + p);
    for (int side = 0; side < 2; ++side)
      if (d->walls.at[a][side] != NULL)
        cf_ledger_add(ledger, s->weight * s->dt * through_wall(d, f, a, side));
  }
  if (d->source.rate == NULL) return;
  FOR_ROWS(d, CF_CENTRES, p) source_row(box->n[0], d->W.at + p, rate + p);
  cf_ledger_add(ledger, s->weight * s->dt * cf_diffuse_integral(d, d->W));
}

/* q of one axis; g in x, its rate in b. On insulated walls g is mirrored, so q stays 0. */
static void move_flux(const cf_diffuse *d, const stage *s, const int a, const cf_diffused *y) {
  const cf_box *box = &d->grid->box;
  const int n = cf_box_extent(box, 0, a);
  const ptrdiff_t stride = box->stride[a];
  const double C = d->p.capacity.value, c = d->speed_max, k = d->p.k.value;
  cf_real *q = y->q.at[a], *rate = d->b.at;
  FOR_ROWS(d, CF_CENTRES, p)
  flux_row(box->n[0], stride, stride, (cf_real)(c > 0 ? 1 / (2 * C * c) : 0), y->phi.at + p, q + p,
           d->x.at + p);
  close_potential(d, a, d->x, y->q);
  FOR_ROWS(d, a, p) {
    difference_row(n, stride, (cf_real)(-k / (d->p.tau * d->grid->h)), false, d->x.at + p - stride, rate + p);
    if (d->source.flux_rate != NULL) source_row(n, d->B.at[a] + p, rate + p);
    combine_row(n, (cf_real)s->share, (cf_real)s->dt, d->kept.q.at[a] + p, rate + p, q + p);
  }
}

/* A flux source acts on no insulated wall. */
static void clear_insulated(const cf_diffuse *d, const cf_face q) {
  for (int a = 0; a < d->grid->box.dim; ++a)
    for (int side = 0; side < 2; ++side) {
      if (d->walls.walls.kind[a][side] != CF_WALL_INSULATED) continue;
      const cf_wall_side w = cf_wall_side_of(&d->grid->box, a, side);
      for (int i_c = 0; i_c < w.n_c; ++i_c)
        for (int i_b = 0; i_b < w.n_b; ++i_b)
          q.at[a][cf_wall_cell(&d->grid->box, &w, i_b, i_c) + (side == 0 ? 0 : w.outward)] = 0;
    }
}

static cf_status run_stage(cf_diffuse *d, const stage *s, const cf_diffused *y, cf_ledger *ledger) {
  const cf_box *box = &d->grid->box;
  CF_TRY(cf_diffuse_sample(d, &(cf_source_times){s->t, s->t, s->t, s->t}));
  for (int a = 0; a < box->dim; ++a) fill_ghosts(d, a, y->phi, y->q);
  rate_of_phi(d, s, y, ledger);
  for (int a = 0; a < box->dim; ++a) move_flux(d, s, a, y);
  if (d->source.flux_rate != NULL) clear_insulated(d, y->q);
  FOR_ROWS(d, CF_CENTRES, p)
  combine_row(box->n[0], (cf_real)s->share, (cf_real)s->dt, d->kept.phi.at + p, d->kept.phi_rate.at + p,
              y->phi.at + p);
  return CF_OK;
}

/* --- a step ----------------------------------------------------------------------------------------------- */

static void decay(const cf_diffuse *d, const double dt, const cf_face q) {
  const cf_box *box = &d->grid->box;
  for (int a = 0; a < box->dim; ++a)
    FOR_ROWS(d, a, p) decay_row(cf_box_extent(box, 0, a), (cf_real)exp(-dt / d->p.tau), q.at[a] + p);
}

static void keep(const cf_diffuse *d, const cf_diffused *y) {
  const cf_box *box = &d->grid->box;
  cf_diffuse_copy(d, y->phi.at, d->kept.phi.at);
  for (int a = 0; a < box->dim; ++a) FOR_ROWS(d, a, p)
  memcpy(d->kept.q.at[a] + p, y->q.at[a] + p, (size_t)cf_box_extent(box, 0, a) * sizeof(cf_real));
}

static cf_status substep(cf_diffuse *d, const double t, const double dt, const cf_diffused *y,
                         cf_ledger *ledger) {
  decay(d, dt / 2, y->q);
  keep(d, y);
  CF_TRY(run_stage(d, &(stage){t, dt, 0, 1.0 / 6}, y, ledger));
  CF_TRY(run_stage(d, &(stage){t + dt, dt, 0.75, 1.0 / 6}, y, ledger));
  CF_TRY(run_stage(d, &(stage){t + dt / 2, dt, 1.0 / 3, 2.0 / 3}, y, ledger));
  decay(d, dt / 2, y->q);
  if (d->source.hold == NULL) return CF_OK;
  CF_TRY(cf_diffuse_sample(d, &(cf_source_times){t + dt, t + dt, t + dt, t + dt}));
  cf_ledger_add(ledger, cf_diffuse_hold(d, 0, y->phi));
  return CF_OK;
}

cf_status cf_diffuse_wave(cf_diffuse *d, const double t, const double dt, const cf_diffused *y,
                          cf_ledger *ledger, cf_solve_report *report) {
  const double n = cf_diffuse_substeps(d, dt), sub = dt / n;
  report->method = "wave";
  if (n > SUBSTEPS_MAX)
    return cf_fail(CF_OVER_LIMIT,
                   "scheme wave needs %.3g substeps in a step of %g s (tau = %g s): take scheme sdirk2", n,
                   dt, d->p.tau);
  for (int i = 0; i < (int)n; ++i) CF_TRY(substep(d, t + i * sub, sub, y, ledger));
  return CF_OK;
}
