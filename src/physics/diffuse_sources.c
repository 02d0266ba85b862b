/* SPDX-License-Identifier: MIT
 *
 * What acts on the scalar from outside, and what is counted of it: the same for every scheme.
 */
#include <math.h>

#include "grid/halo.h"
#include "physics/diffuse_part.h"
#include "stencil/front.h"

cf_status cf_diffuse_sample(cf_diffuse *d, const cf_source_times *t) {
  const cf_source *source = &d->source;
  cf_wall_values_sample(&d->walls, t->walls);
  if (source->rate != NULL) CF_TRY(source->rate(source->context, t->rate, d->W));
  if (source->flux_rate != NULL) CF_TRY(source->flux_rate(source->context, t->flux_rate, d->B));
  if (source->hold != NULL) CF_TRY(source->hold(source->context, t->hold, d->fraction, d->value));
  if (d->p.region == NULL) return CF_OK;
  if (source->held != NULL) CF_TRY(source->held(source->context, t->walls, d->p.region->value));
  if (source->rate != NULL) cf_diffuse_clear_outside(d, d->W);
  if (source->hold != NULL) cf_diffuse_clear_outside(d, d->fraction);
  return CF_OK;
}

void cf_diffuse_close_seams(const cf_diffuse *d, const cf_face q) {
  cf_halo halo = {0};
  for (int a = 0; a < d->grid->box.dim; ++a)
    if (d->walls.walls.kind[a][0] == CF_WALL_PERIODIC) {
      halo.rule[a][0] = halo.rule[a][1] = CF_HALO_WRAP;
      cf_halo_fill(&d->grid->box, &halo, 0, a, q.at[a]);
      halo.rule[a][0] = halo.rule[a][1] = CF_HALO_NONE;
    }
}

void cf_diffuse_add_flux_source(const cf_diffuse *d, const double factor, const cf_face q) {
  const cf_box *box = &d->grid->box;
  if (d->source.flux_rate == NULL || factor == 0) return;
  for (int a = 0; a < box->dim; ++a) {
    for (int k = 0; k < cf_box_extent(box, 2, a); ++k)
      for (int j = 0; j < cf_box_extent(box, 1, a); ++j)
        for (int i = 0; i < cf_box_extent(box, 0, a); ++i) {
          const ptrdiff_t p = cf_box_at(box, i, j, k);
          q.at[a][p] += (cf_real)(factor * (double)d->B.at[a][p]);
        }
    for (int side = 0; side < 2; ++side) { /* no flux passes an insulated wall */
      if (d->walls.walls.kind[a][side] != CF_WALL_INSULATED) continue;
      const cf_wall_side w = cf_wall_side_of(box, a, side);
      for (int i_c = 0; i_c < w.n_c; ++i_c)
        for (int i_b = 0; i_b < w.n_b; ++i_b)
          q.at[a][cf_wall_cell(box, &w, i_b, i_c) + (side == 0 ? 0 : w.outward)] = 0;
    }
  }
  cf_diffuse_close_faces(d, q);
  cf_diffuse_close_seams(d, q);
}

/* --- walls ------------------------------------------------------------------------------------------------ */

cf_radiation cf_diffuse_radiation(const cf_diffuse *d, const cf_flux_law *law, const int axis,
                                  const ptrdiff_t p, const ptrdiff_t f) {
  const double k = d->k_varies ? (double)d->k.at[axis][f] : d->p.k.value;
  const double c = d->c_varies ? (double)d->capacity.at[p] : 1, carried = (1 - d->p.f_t) * k;
  const double Z = sqrt(c * carried / d->p.tau), K = law->per * 2 * k / d->grid->h;
  if (!(Z > 0)) return (cf_radiation){0, 0};
  return (cf_radiation){Z / (K + Z), 1 / (K + Z)};
}

void cf_diffuse_visit_radiating(const cf_diffuse *d, cf_wall_visit *visit, void *context) {
  const cf_box *box = &d->grid->box;
  for (int a = 0; a < box->dim; ++a)
    for (int side = 0; side < 2; ++side) {
      if (!d->radiates[a][side]) continue;
      const cf_wall_side w = cf_wall_side_of(box, a, side);
      for (int i_c = 0; i_c < w.n_c; ++i_c)
        for (int i_b = 0; i_b < w.n_b; ++i_b) {
          const ptrdiff_t p = cf_wall_cell(box, &w, i_b, i_c);
          visit(d, &w, p, side == 0 ? p : p + w.outward, i_b + (ptrdiff_t)w.n_b * i_c, context);
        }
    }
}

void cf_diffuse_copy_ghosts(const cf_diffuse *d, const cf_cell f) {
  cf_halo halo = {0};
  for (int a = 0; a < 3; ++a)
    for (int side = 0; side < 2; ++side)
      halo.rule[a][side] = d->walls.walls.kind[a][side] == CF_WALL_PERIODIC ? CF_HALO_WRAP : CF_HALO_COPY;
  cf_halo_fill(&d->grid->box, &halo, 1, CF_CENTRES, f.at);
}

typedef struct ghost_context {
  const cf_flux_law *law;
  cf_cell x;
  cf_face q;
} ghost_context;

static void radiation_ghost(const cf_diffuse *d, const cf_wall_side *w, const ptrdiff_t p, const ptrdiff_t f,
                            const ptrdiff_t place, void *context) {
  const ghost_context *c = context;
  const cf_radiation r = cf_diffuse_radiation(d, c->law, w->axis, p, f);
  const double x = (double)c->x.at[p], far = d->walls.at[w->axis][w->side][place];
  const double q_out = (w->side == 0 ? -1 : 1) * (double)c->q.at[w->axis][f];
  const double wall = x + r.share * (far - x) + r.gain * c->law->left * q_out;
  c->x.at[p + w->outward] = (cf_real)(2 * wall - x);
}

void cf_diffuse_ghosts(const cf_diffuse *d, const cf_flux_law *law, const cf_cell x, const cf_face q) {
  cf_wall_ghosts(&d->walls, x);
  if (d->has_radiation) cf_diffuse_visit_radiating(d, radiation_ghost, &(ghost_context){law, x, q});
}

/* --- sums ------------------------------------------------------------------------------------------------- */

void cf_ledger_add(cf_ledger *l, const double amount) {
  if (amount >= 0)
    l->entered += amount;
  else
    l->left -= amount;
}

double cf_ledger_error(const cf_ledger *l, const double inside) {
  const double scale = fabs(l->first) + l->entered + l->left;
  return scale > 0 ? (inside - l->first - l->entered + l->left) / scale : 0;
}

static double content_row(const int n, const cf_real *c, const cf_real *x) {
  double lane[CF_SUM_LANES] = {0};
  if (c == NULL) return cf_sweep_row_sum(n, x);
  for (int i = 0; i < n; ++i) lane[i % CF_SUM_LANES] += (double)c[i] * (double)x[i];
  return cf_sum_lanes(lane);
}

static double integral(const cf_diffuse *d, const cf_real *weight, const cf_cell f) {
  const cf_box *box = &d->grid->box;
  CF_PARALLEL_ROWS (box, d->grid->threads, r) {
    const ptrdiff_t p = cf_box_row(box, r);
    d->rows[r] = content_row(box->n[0], weight != NULL ? weight + p : NULL, f.at + p);
  }
  return cf_grid_volume(d->grid) * cf_sum_ordered(d->rows, cf_box_rows(box));
}

double cf_diffuse_integral(const cf_diffuse *d, const cf_cell f) {
  return integral(d, d->c_varies ? d->capacity.at : NULL, f);
}

double cf_diffuse_plain_integral(const cf_diffuse *d, const cf_cell f) { return integral(d, NULL, f); }

double cf_diffuse_content(const cf_diffuse *d, const cf_cell phi) {
  return d->p.region != NULL ? cf_diffuse_sum_inside(d, phi) : cf_diffuse_integral(d, phi);
}

CF_CLONES static void copy_row(const int n, const cf_real *from, cf_real *to) {
  CF_ROW_LOOP
  for (int i = 0; i < n; ++i) to[i] = from[i];
}

void cf_diffuse_copy(const cf_diffuse *d, const cf_real *from, cf_real *to) {
  const cf_box *box = &d->grid->box;
  CF_PARALLEL_ROWS (box, d->grid->threads, r)
    copy_row(box->n[0], from + cf_box_row(box, r), to + cf_box_row(box, r));
}

double cf_diffuse_hold(const cf_diffuse *d, const double from, const cf_cell phi) {
  const cf_box *box = &d->grid->box;
  CF_PARALLEL_ROWS (box, d->grid->threads, r) {
    const ptrdiff_t start = cf_box_row(box, r);
    double sum = 0;
    for (int i = 0; i < box->n[0]; ++i) {
      const ptrdiff_t p = start + i;
      if (d->fraction.at[p] == 0 || (double)d->fraction.at[p] < from) continue;
      const double before = (double)phi.at[p];
      phi.at[p] = (cf_real)(before + (double)d->fraction.at[p] * ((double)d->value.at[p] - before));
      sum += (d->c_varies ? (double)d->capacity.at[p] : 1) * ((double)phi.at[p] - before);
    }
    d->rows[r] = sum;
  }
  return cf_grid_volume(d->grid) * cf_sum_ordered(d->rows, cf_box_rows(box));
}

/* --- the front filter ------------------------------------------------------------------------------------- */

static double strength(const cf_diffuse *d, const double weight, const double dt) {
  return cf_front_strength(d->axes, d->speed_max * dt / d->grid->h, weight);
}

void cf_diffuse_filter_phi(const cf_diffuse *d, const double weight, const double dt, const cf_cell phi,
                           cf_ledger *ledger) {
  if (!d->p.front_filter) return;
  if (d->p.region != NULL) cf_rim_fill(&d->rim, phi);
  cf_front_cell(d->grid, &d->walls.walls, d->p.region, strength(d, weight, dt), phi, d->filtered);
  cf_diffuse_set_outside(d, phi);
  if (d->source.hold != NULL) cf_ledger_add(ledger, cf_diffuse_hold(d, 1, phi));
}

void cf_diffuse_filter_flux(const cf_diffuse *d, const double weight, const double dt, const cf_face q) {
  if (!d->p.front_filter || q.at[0] == NULL) return;
  cf_front_face(d->grid, &d->walls.walls, strength(d, weight, dt), q, d->filtered);
  cf_diffuse_close_faces(d, q);
}
