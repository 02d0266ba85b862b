/* SPDX-License-Identifier: MIT
 *
 * What one wants to know of a crystal: how much there is, how far it reaches, and its energy.
 */
#include <math.h>
#include <omp.h>
#include <string.h>

#include "physics/phase_part.h"
#include "stencil/arctan.h"

#define PI 3.14159265358979323846

static double sum_rows(const cf_phase *p) {
  return cf_sum_ordered(p->sums, cf_box_rows(&p->grid->box)) * cf_grid_volume(p->grid);
}

double cf_phase_solid(const cf_phase *p, const cf_cell eta) {
  return cf_sweep_sum(&p->grid->box, p->grid->threads, eta.at, p->sums) * cf_grid_volume(p->grid);
}

CF_CLONES static double heat_in_row(const int n, const double latent, const cf_real *T, const cf_real *eta) {
  double lane[CF_SUM_LANES] = {0};
  int i = 0;
  for (; i + CF_SUM_LANES <= n; i += CF_SUM_LANES)
    for (int l = 0; l < CF_SUM_LANES; ++l) lane[l] += (double)T[i + l] - latent * (double)eta[i + l];
  for (int l = 0; i < n; ++i, ++l) lane[l] += (double)T[i] - latent * (double)eta[i];
  return cf_sum_lanes(lane);
}

double cf_phase_heat_content(const cf_phase *p, const cf_phase_state *y) {
  const cf_box *box = &p->grid->box;
  CF_PARALLEL_ROWS (box, p->grid->threads, r)
    p->sums[r] =
        heat_in_row(box->n[0], p->p.latent, y->T.at + cf_box_row(box, r), y->eta.at + cf_box_row(box, r));
  return sum_rows(p);
}

/* --- energy ----------------------------------------------------------------------------------------------- */

/* What the density of a row reads; everything but the rows A2 and beta are fields. */
typedef struct density {
  ptrdiff_t stride[3];
  const cf_real *eta, *T, *r;
  const cf_real *A2, *beta;
  cf_real half_star2[3]; /* Gamma^2/(2 h^2) */
  cf_real half_eps2, alpha_pi, gamma, coupling, inertia;
  cf_real *out;
} density;

/* g(eta) with psi frozen, eta^2 (1 - eta)^2/4 - psi (eta^2/2 - eta^3/3); for Karma and Rappel's psi four times
 * eta^2 (1 - eta)^2/4 + 2 lambda T (eta^3/3 - eta^4/2 + eta^5/5). */
CF_KERNEL cf_real well(const int karma, const density *d, const cf_real e, const cf_real T,
                       const cf_real beta) {
  const cf_real bump = e * (1 - e), half = (cf_real)0.5, third = (cf_real)(1.0 / 3), fifth = (cf_real)0.2;
  if (karma) return bump * bump + 8 * d->coupling * T * (e * e * e) * (third + e * (fifth * e - half));
  const cf_real psi = -(d->alpha_pi * cf_arctan(d->gamma * beta * T));
  return bump * bump / 4 - psi * (e * e) * (half - third * e);
}

/* Half the squares of the differences on either side: the energy whose gradient the five-point Laplacian is. */
CF_KERNEL void density_row(const int dim, const int karma, const int n, const density *d,
                           const ptrdiff_t start) {
  CF_ROW_LOOP
  for (int i = 0; i < n; ++i) {
    const ptrdiff_t q = start + i;
    const cf_real here = d->eta[q];
    cf_real slope2 = 0;
    CF_AXIS_LOOP
    for (int a = 0; a < dim; ++a) {
      const cf_real low = here - d->eta[q - d->stride[a]], high = d->eta[q + d->stride[a]] - here;
      slope2 += d->half_star2[a] * (low * low + high * high);
    }
    d->out[i] = d->half_eps2 * d->A2[i] * slope2 + well(karma, d, here, d->T[q], d->beta[i]);
  }
}
CF_CLONED_FORMS(density_row, const density *, const ptrdiff_t)

CF_CLONES static void inertia_row(const int n, const density *d, const ptrdiff_t start) {
  CF_ROW_LOOP
  for (int i = 0; i < n; ++i) d->out[i] += d->inertia * (d->r[start + i] * d->r[start + i]);
}

static density density_of(const cf_phase *p, const cf_phase_state *y) {
  const cf_phase_params *q = &p->p;
  density d = {.eta = y->eta.at, .T = y->T.at, .r = y->r.at};
  d.half_eps2 = (cf_real)(q->width * q->width / 2);
  d.alpha_pi = (cf_real)(q->alpha / PI), d.gamma = (cf_real)q->gamma, d.coupling = (cf_real)q->coupling;
  if (p->has_r && q->form == CF_PHASE_STABLE && q->tau_eta > 0)
    d.inertia = (cf_real)(q->tau_1 / (2 * (1 - q->f_eta) * q->tau_eta));
  for (int a = 0; a < p->grid->box.dim; ++a) {
    const double star = (a == 2 ? q->star : 1) / p->grid->h;
    d.stride[a] = p->grid->box.stride[a];
    d.half_star2[a] = (cf_real)(star * star / 2);
  }
  return d;
}

/* The density of row r into w->react. */
static void density_of_row(const cf_phase *p, const density *all, const cf_phase_rows *w, const ptrdiff_t r) {
  const cf_box *box = &p->grid->box;
  const int n = box->n[0];
  const ptrdiff_t start = cf_box_row(box, r);
  density d = *all;
  d.A2 = w->A2, d.beta = w->beta, d.out = w->react;
  const cf_span busy = cf_phase_busy(p, (int)(r % box->n[1]), (int)(r / box->n[1]));
  const int some = busy.to - busy.from;
  memset(d.out, 0, (size_t)n * sizeof *d.out);
  d.out += busy.from;
  cf_phase_A2_row(p, some, d.eta, start + busy.from, w->A2);
  if (p->p.drive_strength != 0)
    cf_phase_beta_row(p, some, d.eta, start + busy.from, w->beta);
  else
    for (int i = 0; i < some; ++i) w->beta[i] = 1;
  density_row_by_form(box->dim, p->p.karma_rappel, some, &d, start + busy.from);
  d.out -= busy.from;
  if (d.inertia > 0) inertia_row(n, &d, start);
}

double cf_phase_energy(cf_phase *p, const cf_phase_state *y) {
  const cf_box *box = &p->grid->box;
  const density d = density_of(p, y);
  const ptrdiff_t rows = cf_box_rows(box);
  cf_phase_ghosts(p, y->eta);
  cf_phase_find_filled(p, y->eta);
  CF_PARALLEL_ROWS (box, p->threads, r) {
    const cf_phase_rows *w = &p->rows[omp_get_thread_num()];
    density_of_row(p, &d, w, r);
    p->sums[rows + r] = cf_sweep_row_sum(box->n[0], w->react);
  }
  return cf_sum_ordered(p->sums + rows, rows) * cf_grid_volume(p->grid);
}

/* --- the tip ---------------------------------------------------------------------------------------------- */

/* Crossings of eta = 1/2 between cells and their neighbours in +a of one row. */
typedef struct crossings {
  const cf_real *eta, *next;
  double first[3]; /* of the row's first cell, from where the reach is counted */
  double h;
  int along, axis; /* a; the axis to reach along, or -1 */
} crossings;

/* How far the place (x, y, z) from where the reach is counted is: squared, or along the axis. */
CF_KERNEL double reach_of(const int axis, const double x, const double y, const double z) {
  return axis < 0 ? x * x + (y * y + z * z) : axis == 0 ? x : axis == 1 ? y : z;
}

/* Of the crossing after cell i, or -INFINITY. */
static double reach_at(const crossings *c, const int i) {
  const double low = (double)c->eta[i] - 0.5, high = (double)c->next[i] - 0.5;
  if ((low < 0) == (high < 0)) return -INFINITY;
  const double part = c->h * (low / (low - high));
  return reach_of(c->axis, c->first[0] + i * c->h + (c->along == 0 ? part : 0),
                  c->first[1] + (c->along == 1 ? part : 0), c->first[2] + (c->along == 2 ? part : 0));
}

/* What no crossing in the row exceeds, without a division: from both ends of the edges that have one. */
CF_CLONES static double bound_of_row(const int n, const crossings *c) {
  const double dx = c->along == 0 ? c->h : 0, dy = c->along == 1 ? c->h : 0, dz = c->along == 2 ? c->h : 0;
  const double y = c->first[1], z = c->first[2], none = -INFINITY;
  const cf_real half = (cf_real)0.5;
  double most = none;
#pragma omp simd reduction(max : most)
  for (int i = 0; i < n; ++i) {
    const double x = c->first[0] + i * c->h;
    const double here = reach_of(c->axis, x, y, z), there = reach_of(c->axis, x + dx, y + dy, z + dz);
    const double far = here > there ? here : there;
    const double reach = (c->eta[i] < half) != (c->next[i] < half) ? far : none;
    most = reach > most ? reach : most;
  }
  return most;
}

/* Of row r towards +a; there are *n of them. */
static crossings crossings_of(const cf_phase *p, const cf_real *eta, const double from[3], const ptrdiff_t r,
                              const int a, int *n) {
  const cf_box *box = &p->grid->box;
  const int at[3] = {0, (int)(r % box->n[1]), (int)(r / box->n[1])};
  crossings c = {.eta = eta + cf_box_row(box, r), .h = p->grid->h, .along = a, .axis = -1};
  c.next = c.eta + box->stride[a];
  for (int b = 0; b < box->dim; ++b) c.first[b] = cf_grid_place(p->grid, b, at[b], 0) - from[b];
  *n = a == 0 ? box->n[0] - 1 : at[a] + 1 < box->n[a] ? box->n[0] : 0;
  return c;
}

/* Into `far` and *i the farthest crossing of row r, if it is farther than *best. */
static void look_in_row(const cf_phase *p, const crossings *like, const double from[3], const ptrdiff_t r,
                        double *best, crossings *far, int *at) {
  for (int a = 0; a < p->grid->box.dim; ++a) {
    int n;
    crossings c = crossings_of(p, like->eta, from, r, a, &n);
    c.axis = like->axis;
    for (int i = 0; i < n; ++i) {
      const double reach = reach_at(&c, i);
      if (!(reach > *best)) continue;
      *best = reach;
      *far = c;
      *at = i;
    }
  }
}

CF_CLONES static cf_real largest_in_row(const int n, const cf_real *row) {
  cf_real most = 0;
#pragma omp simd reduction(max : most)
  for (int i = 0; i < n; ++i) most = row[i] > most ? row[i] : most;
  return most;
}

static double bound_of(const cf_phase *p, const crossings *like, const double from[3], const ptrdiff_t r) {
  const cf_box *box = &p->grid->box;
  double most = -INFINITY;
  for (int a = 0; a < box->dim; ++a) {
    int n;
    crossings c = crossings_of(p, like->eta, from, r, a, &n);
    const ptrdiff_t next = a == 1 ? 1 : a == 2 ? box->n[1] : 0;
    if (n == 0 || (p->sums[r] < 0.5 && p->sums[r + next] < 0.5)) continue;
    c.axis = like->axis;
    most = fmax(most, bound_of_row(n, &c));
  }
  return most;
}

double cf_phase_tip(const cf_phase *p, const cf_cell eta, const double from[3], const int axis,
                    double where[3]) {
  const cf_box *box = &p->grid->box;
  const ptrdiff_t rows = cf_box_rows(box);
  const crossings like = {.eta = eta.at, .axis = axis};
  double *bound = p->sums + rows, best = 0;
  crossings far = {.first = {0}};
  ptrdiff_t farthest = 0;
  int i = 0;
  for (int b = 0; b < 3; ++b) where[b] = b < box->dim ? from[b] : 0;
  CF_PARALLEL_ROWS (box, p->grid->threads, r)
    p->sums[r] = (double)largest_in_row(box->n[0], eta.at + cf_box_row(box, r));
  CF_PARALLEL_ROWS (box, p->grid->threads, r) bound[r] = bound_of(p, &like, from, r);
  for (ptrdiff_t r = 0; r < rows; ++r)
    if (bound[r] > bound[farthest]) farthest = r;
  look_in_row(p, &like, from, farthest, &best, &far, &i);
  for (ptrdiff_t r = 0; r < rows; ++r)
    if (bound[r] > best && r != farthest) look_in_row(p, &like, from, r, &best, &far, &i);
  if (!(best > 0)) return 0;
  for (int b = 0; b < box->dim; ++b) where[b] = from[b] + far.first[b] + (b == 0 ? i * far.h : 0);
  where[far.along] += far.h * ((double)far.eta[i] - 0.5) / ((double)far.eta[i] - (double)far.next[i]);
  return axis < 0 ? sqrt(best) : best;
}
