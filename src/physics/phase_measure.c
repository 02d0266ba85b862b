/* SPDX-License-Identifier: MIT
 *
 * What one wants to know of a crystal: how much there is, how far it reaches, and its energy.
 */
#include <math.h>

#include "physics/phase_part.h"
#include "stencil/arctan.h"

#define PI 3.14159265358979323846

static double sum_rows(const cf_phase *p) {
  return cf_sum_ordered(p->sums, cf_box_rows(&p->grid->box)) * cf_grid_volume(p->grid);
}

double cf_phase_solid(const cf_phase *p, const cf_cell eta) {
  return cf_sweep_range(&p->grid->box, p->grid->threads, eta.at, p->sums).sum * cf_grid_volume(p->grid);
}

double cf_phase_heat_content(const cf_phase *p, const cf_phase_state *y) {
  const cf_box *box = &p->grid->box;
  CF_PARALLEL_ROWS (box, p->grid->threads, r) {
    const cf_real *T = y->T.at + cf_box_row(box, r), *eta = y->eta.at + cf_box_row(box, r);
    double lane[CF_SUM_LANES] = {0};
    for (int i = 0; i < box->n[0]; ++i) lane[i % CF_SUM_LANES] += (double)T[i] - p->p.latent * (double)eta[i];
    p->sums[r] = cf_sum_lanes(lane);
  }
  return sum_rows(p);
}

/* --- energy ----------------------------------------------------------------------------------------------- */

/* g(eta) with psi frozen, eta^2 (1 - eta)^2/4 - psi (eta^2/2 - eta^3/3); for Karma and Rappel's psi four times
 * eta^2 (1 - eta)^2/4 + 2 lambda T (eta^3/3 - eta^4/2 + eta^5/5). */
static double well(const cf_phase *p, const double e, const double T, const double beta) {
  const double bump = e * (1 - e);
  if (p->p.karma_rappel)
    return bump * bump + 8 * p->p.coupling * T * e * e * e * (1.0 / 3 + e * (-1.0 / 2 + e / 5));
  const double psi = -p->p.alpha / PI * (double)cf_arctan((cf_real)(p->p.gamma * beta * T));
  return bump * bump / 4 - psi * e * e * (0.5 - e / 3);
}

double cf_phase_energy(cf_phase *p, const cf_phase_state *y) {
  const cf_box *box = &p->grid->box;
  const double eps2 = p->p.width * p->p.width, h = p->grid->h;
  const double inertia = p->has_r && p->p.form == CF_PHASE_STABLE && p->p.tau_eta > 0
                             ? p->p.tau_1 / (2 * (1 - p->p.f_eta) * p->p.tau_eta)
                             : 0;
  cf_phase_ghosts(p, y->eta);
  for (ptrdiff_t r = 0; r < cf_box_rows(box); ++r) {
    cf_phase_rows *w = &p->rows[0];
    const ptrdiff_t start = cf_box_row(box, r);
    cf_phase_A2_row(p, y->eta.at, start, w->A2);
    if (p->p.drive_strength != 0) cf_phase_beta_row(p, y->eta.at, start, w->beta);
    double sum = 0;
    for (int i = 0; i < box->n[0]; ++i) {
      const ptrdiff_t q = start + i;
      double slope2 = 0;
      for (int a = 0; a < box->dim; ++a) {
        const ptrdiff_t s = box->stride[a];
        const double star = (a == 2 ? p->p.star : 1) / h, here = (double)y->eta.at[q];
        const double low = star * (here - (double)y->eta.at[q - s]),
                     high = star * ((double)y->eta.at[q + s] - here);
        slope2 += (low * low + high * high) / 2;
      }
      const double beta = p->p.drive_strength != 0 ? (double)w->beta[i] : 1;
      sum += eps2 / 2 * (double)w->A2[i] * slope2 + well(p, (double)y->eta.at[q], (double)y->T.at[q], beta);
      if (inertia > 0) sum += inertia * (double)y->r.at[q] * (double)y->r.at[q];
    }
    p->sums[r] = sum;
  }
  return sum_rows(p);
}

/* --- the tip ---------------------------------------------------------------------------------------------- */

typedef struct crossing {
  double reach, place[3];
} crossing;

/* The crossing between cell q and its neighbour in +a, if it reaches farther. */
static void look(const cf_phase *p, const cf_real *eta, const int at[3], const int a, const double from[3],
                 const int axis, crossing *best) {
  const cf_box *box = &p->grid->box;
  const ptrdiff_t q = cf_box_at(box, at[0], at[1], at[2]);
  const double low = (double)eta[q] - 0.5, high = (double)eta[q + box->stride[a]] - 0.5;
  if ((low < 0) == (high < 0)) return;
  double place[3] = {0, 0, 0}, reach = 0;
  for (int b = 0; b < box->dim; ++b) {
    place[b] = cf_grid_place(p->grid, b, at[b], 0) + (b == a ? low / (low - high) * p->grid->h : 0);
    reach += (place[b] - from[b]) * (place[b] - from[b]);
  }
  reach = axis < 0 ? sqrt(reach) : place[axis] - from[axis];
  if (reach <= best->reach) return;
  *best = (crossing){reach, {place[0], place[1], place[2]}};
}

double cf_phase_tip(const cf_phase *p, const cf_cell eta, const double from[3], const int axis,
                    double where[3]) {
  const cf_box *box = &p->grid->box;
  crossing best = {0, {from[0], from[1], box->dim == 3 ? from[2] : 0}};
  int at[3];
  for (at[2] = 0; at[2] < box->n[2]; ++at[2])
    for (at[1] = 0; at[1] < box->n[1]; ++at[1]) {
      const cf_real *row = eta.at + cf_box_at(box, 0, at[1], at[2]);
      for (at[0] = 0; at[0] < box->n[0]; ++at[0])
        for (int a = 0; a < box->dim; ++a) {
          const cf_real next = at[a] + 1 < box->n[a] ? row[at[0] + box->stride[a]] : row[at[0]];
          if ((row[at[0]] < (cf_real)0.5) != (next < (cf_real)0.5)) look(p, eta.at, at, a, from, axis, &best);
        }
    }
  for (int b = 0; b < 3; ++b) where[b] = best.place[b];
  return best.reach;
}
