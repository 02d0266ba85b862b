/* SPDX-License-Identifier: MIT
 *
 * One implicit stage of length d serves every scheme: with m = tau/(tau + d), what is left of a flux after d,
 *
 *     beta = d (1 - m + F_T m) k,     (C - div beta grad) phi~ = C phi* - d m div q* + d C W               (17)
 *     q    = m q* - (1 - m)(1 - F_T) k grad phi~                                                           (18)
 *     phi  = phi* - (d/C) div(q - F_T k grad phi~) + d W
 *
 * and the last line (in place of phi = phi~) keeps sum C phi to round-off whatever the solver's tolerance.
 *
 *   CF_DIFFUSE_PAPER   one stage of backward Euler, W taken at the old time, phi = phi~.
 *   CF_DIFFUSE_SDIRK2  two stages of g dt, g = 1 - 1/sqrt(2), the second from -sqrt(2) y + (1 + sqrt(2)) Y1
 *                      (Alexander 1977): second order, L-stable, no history.
 *
 * k lives on faces: the harmonic mean of its cells, the cell's own on a held wall.
 * Not done here: advection, the front filter, explicit schemes.
 *
 * A stage in four sweeps:
 *
 *     right_side   b = C phi - d m div q + d C W (+ held walls)
 *     solve        phi~
 *     cells        phi <- phi + w (stage's phi - phi)
 *     faces        q   <- q + w (stage's q - q)
 *
 * w = 1 gives the stage itself and w = 1 + sqrt(2) the start of SDIRK2's second stage, so no copy of the old
 * state is ever kept. The fluxes through walls are summed for the ledger with the same w. phi~ gets a layer of
 * ghosts (grid/wall.h), so faces on walls are faces like any other.
 */
#include "physics/diffuse.h"

#include <math.h>

#include "base/mem.h"
#include "grid/halo.h"
#include "grid/sweep.h"

/* A held cell's equation is phi = value with this weight beside the rest. */
#define HOLD_MAX 1e9

struct cf_diffuse {
  const cf_grid *grid;
  cf_diffuse_params p;
  cf_source source;
  cf_wall_values walls;
  cf_helmholtz *A;
  bool k_varies, c_varies;
  double k_max, speed_max;
  double delta;            /* for which A is set; -1: none */
  cf_face k, beta;         /* on faces, and its multiple for the operator; where k varies */
  cf_cell capacity, alpha; /* C where it varies; C plus what holds, where something holds */
  cf_cell x, b, W;         /* phi~, right side, source */
  cf_cell fraction, value; /* of held cells */
  cf_face B;               /* source of the flux */
  double *rows;
};

/* m: what is left of a flux after `delta`. 0 for tau = 0, 1 for tau = infinity. */
static double flux_memory(const double delta, const double tau) {
  return tau > 0 ? 1 / (1 + delta / tau) : 0;
}

/* One stage: its numbers, and what the kernels of a row read and write. */
typedef struct stage {
  double t, delta, w;
  ptrdiff_t stride[3];
  cf_real k, d, weight;
  cf_real rhs;            /* d m/h, on differences of q */
  cf_real flux_q, flux_k; /* d/h (q_C + q_F) of the stage = flux_q q* - flux_k k (x_p - x_{p-a}) */
  cf_real face_q, face_k; /* q of the stage = face_q q* - face_k k (x_p - x_{p-a}) */
  const cf_real *x, *W, *capacity, *k_face[3], *fraction, *value;
  cf_real *b, *phi, *q[3];
} stage;

CF_KERNEL cf_real k_at(const int varies, const stage *s, const int a, const ptrdiff_t p) {
  return varies ? s->k_face[a][p] : s->k;
}

CF_KERNEL cf_real capacity_at(const stage *s, const ptrdiff_t p) {
  return s->capacity != NULL ? s->capacity[p] : 1;
}

CF_KERNEL cf_real gain_at(const stage *s, const ptrdiff_t p) { return s->W != NULL ? s->d * s->W[p] : 0; }

/* The flux over the low face of axis a of cell p during the stage, times d/h. */
CF_KERNEL cf_real flux_at(const int varies, const stage *s, const int a, const ptrdiff_t p) {
  return s->flux_q * s->q[a][p] - s->flux_k * k_at(varies, s, a, p) * (s->x[p] - s->x[p - s->stride[a]]);
}

CF_KERNEL void right_side_row(const int dim, const int n, const stage *s, const ptrdiff_t start) {
  CF_ROW_LOOP
  for (int i = 0; i < n; ++i) {
    const ptrdiff_t p = start + i;
    cf_real div = 0;
    CF_AXIS_LOOP
    for (int a = 0; a < dim; ++a) div += s->q[a][p + s->stride[a]] - s->q[a][p];
    s->b[p] = capacity_at(s, p) * (s->phi[p] + gain_at(s, p)) - s->rhs * div;
  }
}
CF_CLONED(right_side_row, const stage *, const ptrdiff_t)

CF_KERNEL void cells_row(const int dim, const int varies, const int n, const stage *s,
                         const ptrdiff_t start) {
  CF_ROW_LOOP
  for (int i = 0; i < n; ++i) {
    const ptrdiff_t p = start + i;
    cf_real div = 0;
    CF_AXIS_LOOP
    for (int a = 0; a < dim; ++a) div += flux_at(varies, s, a, p + s->stride[a]) - flux_at(varies, s, a, p);
    s->phi[p] += s->weight * (gain_at(s, p) - div / capacity_at(s, p));
  }
}
CF_CLONED_FORMS(cells_row, const stage *, const ptrdiff_t)

/* One axis' faces; which axis is told by the row's number (see update_faces). */
CF_KERNEL void faces_of_axis(const int varies, const int n, const stage *s, const int a,
                             const ptrdiff_t start) {
  CF_ROW_LOOP
  for (int i = 0; i < n; ++i) {
    const ptrdiff_t p = start + i;
    const cf_real q = s->q[a][p];
    const cf_real fresh =
        s->face_q * q - s->face_k * k_at(varies, s, a, p) * (s->x[p] - s->x[p - s->stride[a]]);
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

/* --- creation --------------------------------------------------------------------------------------------- */

static cf_status check_params(const cf_diffuse_params *p) {
  if (!(p->tau >= 0)) return cf_fail(CF_BAD_ARGUMENT, "tau = %g s: must be >= 0", p->tau);
  if (!(p->f_t >= 0 && p->f_t <= 1))
    return cf_fail(CF_BAD_ARGUMENT, "f_t = %g: must be between 0 and 1", p->f_t);
  if (!(p->solver.tolerance > 0 && p->solver.tolerance < 1))
    return cf_fail(CF_BAD_ARGUMENT, "tolerance = %g: must be between 0 and 1", p->solver.tolerance);
  return CF_OK;
}

static double harmonic(const double a, const double b) { return a + b > 0 ? 2 * a * b / (a + b) : 0; }

/* k of the cells (with ghosts wrapped or copied) to faces. */
static void faces_from_cells(const cf_box *box, const cf_real *cell, const cf_face face) {
  for (int a = 0; a < box->dim; ++a)
    for (int k = 0; k < cf_box_extent(box, 2, a); ++k)
      for (int j = 0; j < cf_box_extent(box, 1, a); ++j)
        for (int i = 0; i < cf_box_extent(box, 0, a); ++i) {
          const ptrdiff_t p = cf_box_at(box, i, j, k);
          face.at[a][p] = (cf_real)harmonic((double)cell[p - box->stride[a]], (double)cell[p]);
        }
}

static cf_status sample_positive(const cf_diffuse *d, const cf_fn *f, const char *what,
                                 const bool zero_is_fine, const cf_cell out) {
  CF_TRY(cf_grid_sample(d->grid, f, CF_CENTRES, 0, out.at));
  const cf_range range = cf_sweep_range(&d->grid->box, 1, out.at, d->rows);
  int where[3];
  if (!cf_sweep_finite(&d->grid->box, 1, out.at, where))
    return cf_fail(CF_BAD_ARGUMENT, "%s is not finite in cell (%d, %d, %d)", what, where[0], where[1],
                   where[2]);
  if (range.min < 0 || (range.min == 0 && !zero_is_fine))
    return cf_fail(CF_BAD_ARGUMENT, "%s = %g somewhere in the box: must be %s", what, range.min,
                   zero_is_fine ? ">= 0" : "> 0");
  return CF_OK;
}

static cf_status make_k(cf_diffuse *d) {
  const cf_box *box = &d->grid->box;
  d->k_max = d->p.k.value;
  d->k_varies = !cf_fn_is_constant(&d->p.k);
  if (!d->k_varies) {
    if (!(d->k_max >= 0) || !isfinite(d->k_max))
      return cf_fail(CF_BAD_ARGUMENT, "k = %g: must be >= 0", d->k_max);
    return CF_OK;
  }
  CF_TRY(cf_face_create(&d->k, box));
  CF_TRY(cf_face_create(&d->beta, box));
  CF_TRY(sample_positive(d, &d->p.k, "k", true, d->x));
  d->k_max = cf_sweep_range(box, 1, d->x.at, d->rows).max;
  cf_halo halo;
  for (int a = 0; a < 3; ++a)
    for (int side = 0; side < 2; ++side)
      halo.rule[a][side] = d->walls.walls.kind[a][side] == CF_WALL_PERIODIC ? CF_HALO_WRAP : CF_HALO_COPY;
  cf_halo_fill(box, &halo, 1, CF_CENTRES, d->x.at);
  faces_from_cells(box, d->x.at, d->k);
  return CF_OK;
}

static cf_status make_capacity(cf_diffuse *d, double *c_min) {
  const cf_box *box = &d->grid->box;
  *c_min = d->p.capacity.value;
  d->c_varies = !cf_fn_is_constant(&d->p.capacity) || d->p.capacity.value != 1;
  if (d->c_varies) {
    CF_TRY(cf_cell_create(&d->capacity, box));
    CF_TRY(sample_positive(d, &d->p.capacity, "capacity", false, d->capacity));
    *c_min = cf_sweep_range(box, 1, d->capacity.at, d->rows).min;
  }
  return CF_OK;
}

static cf_status make_fields(cf_diffuse *d) {
  const cf_box *box = &d->grid->box;
  CF_TRY(CF_NEW(&d->rows, 3 * cf_box_rows(box)));
  CF_TRY(cf_cell_create(&d->x, box));
  CF_TRY(cf_cell_create(&d->b, box));
  if (d->source.rate != NULL) CF_TRY(cf_cell_create(&d->W, box));
  if (d->source.flux_rate != NULL) CF_TRY(cf_face_create(&d->B, box));
  if (d->source.hold != NULL) {
    CF_TRY(cf_cell_create(&d->fraction, box));
    CF_TRY(cf_cell_create(&d->value, box));
    CF_TRY(cf_cell_create(&d->alpha, box));
  }
  double c_min;
  CF_TRY(make_k(d));
  CF_TRY(make_capacity(d, &c_min));
  d->speed_max = d->p.tau > 0 ? sqrt((1 - d->p.f_t) * d->k_max / (c_min * d->p.tau)) : 0;
  return CF_OK;
}

cf_status cf_diffuse_create(cf_diffuse **d, const cf_grid *g, const cf_walls *walls,
                            const cf_diffuse_params *p, const cf_source *source) {
  *d = NULL;
  CF_TRY(check_params(p));
  cf_diffuse *fresh;
  CF_TRY(CF_NEW(&fresh, 1));
  fresh->grid = g;
  fresh->p = *p;
  fresh->source = source != NULL ? *source : (cf_source){0};
  fresh->delta = -1;
  cf_status s = cf_wall_values_create(&fresh->walls, g, walls);
  if (s == CF_OK) s = cf_helmholtz_create(&fresh->A, g, walls, p->levels);
  if (s == CF_OK) s = make_fields(fresh);
  if (s != CF_OK) {
    cf_diffuse_destroy(fresh);
    return s;
  }
  *d = fresh;
  return CF_OK;
}

void cf_diffuse_destroy(cf_diffuse *d) {
  if (d == NULL) return;
  const cf_box *box = &d->grid->box;
  cf_cell *cells[] = {&d->capacity, &d->alpha, &d->x, &d->b, &d->W, &d->fraction, &d->value};
  for (size_t i = 0; i < sizeof cells / sizeof *cells; ++i) cf_cell_destroy(cells[i], box);
  cf_face_destroy(&d->k, box);
  cf_face_destroy(&d->beta, box);
  cf_face_destroy(&d->B, box);
  cf_wall_values_destroy(&d->walls);
  cf_helmholtz_destroy(d->A);
  cf_free(d->rows);
  cf_free(d);
}

double cf_diffuse_k_max(const cf_diffuse *d) { return d->k_max; }
double cf_diffuse_speed_max(const cf_diffuse *d) { return d->speed_max; }

/* --- the operator of a stage ------------------------------------------------------------------------------ */

CF_CLONES static void scale_row(const int n, const cf_real factor, const cf_real *from, cf_real *to) {
  CF_ROW_LOOP
  for (int i = 0; i < n; ++i) to[i] = factor * from[i];
}

static void scale_faces(const cf_box *box, const int threads, const cf_real factor, const cf_face from,
                        const cf_face to) {
  for (int a = 0; a < box->dim; ++a) {
    const int n1 = cf_box_extent(box, 1, a), n2 = cf_box_extent(box, 2, a);
#pragma omp parallel for schedule(static) num_threads(cf_sweep_threads(box, threads))
    for (int r = 0; r < n1 * n2; ++r) {
      const ptrdiff_t p = cf_box_at(box, 0, r % n1, r / n1);
      scale_row(cf_box_extent(box, 0, a), factor, from.at[a] + p, to.at[a] + p);
    }
  }
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

static cf_status set_operator(cf_diffuse *d, const stage *s) {
  const double m = flux_memory(s->delta, d->p.tau), per_k = s->delta * (1 - m + d->p.f_t * m);
  if (d->source.hold != NULL)
    alpha_where_held(d);
  else if (s->delta == d->delta)
    return CF_OK; /* the same matrix as last time */
  d->delta = s->delta;
  cf_coefficients c = {.alpha = 1, .beta = d->k_varies ? 0 : per_k * d->p.k.value};
  if (d->k_varies) {
    scale_faces(&d->grid->box, d->grid->threads, (cf_real)per_k, d->k, d->beta);
    c.beta_at = &d->beta;
  }
  if (d->source.hold != NULL)
    c.alpha_at = &d->alpha;
  else if (d->c_varies)
    c.alpha_at = &d->capacity;
  return cf_helmholtz_set(d->A, &c);
}

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

/* --- the ledger ------------------------------------------------------------------------------------------- */

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
  for (int i = 0; i < n; ++i) lane[i % CF_SUM_LANES] += (c != NULL ? (double)c[i] : 1) * (double)x[i];
  return cf_sum_lanes(lane);
}

/* Integral of C f. */
static double integral(const cf_diffuse *d, const cf_cell f) {
  const cf_box *box = &d->grid->box;
  CF_PARALLEL_ROWS (box, d->grid->threads, r) {
    const ptrdiff_t p = cf_box_row(box, r);
    d->rows[r] = content_row(box->n[0], d->c_varies ? d->capacity.at + p : NULL, f.at + p);
  }
  return cf_grid_volume(d->grid) * cf_sum_ordered(d->rows, cf_box_rows(box));
}

double cf_diffuse_content(const cf_diffuse *d, const cf_cell phi) { return integral(d, phi); }

/* What the stage lets through one held wall, inwards. */
static double through_wall(const cf_diffuse *d, const stage *s, const int axis, const int side) {
  const cf_box *box = &d->grid->box;
  const cf_wall_side w = cf_wall_side_of(box, axis, side);
  double sum = 0;
  for (int i_c = 0; i_c < w.n_c; ++i_c) {
    double line = 0;
    for (int i_b = 0; i_b < w.n_b; ++i_b) {
      const ptrdiff_t p = cf_wall_cell(box, &w, i_b, i_c) + (side == 0 ? 0 : w.outward);
      line += (double)(d->k_varies ? flux_at(1, s, axis, p) : flux_at(0, s, axis, p));
    }
    sum += line;
  }
  return (side == 0 ? sum : -sum) * s->w * cf_grid_volume(d->grid);
}

static void account_walls(const cf_diffuse *d, const stage *s, cf_ledger *ledger) {
  for (int a = 0; a < d->grid->box.dim; ++a)
    for (int side = 0; side < 2; ++side)
      if (d->walls.at[a][side] != NULL) cf_ledger_add(ledger, through_wall(d, s, a, side));
}

/* phi moves to the held value by its fraction; phi here is already old + w (Y - old), and the hold acts on Y:
 * old + w ((1 - f) Y + f v - old) = phi + w f (v - Y). W is scratch for Y's change. */
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

static void copy_cells(const cf_diffuse *d, const cf_real *from, cf_real *to) {
  const cf_box *box = &d->grid->box;
  CF_PARALLEL_ROWS (box, d->grid->threads, r)
    scale_row(box->n[0], 1, from + cf_box_row(box, r), to + cf_box_row(box, r));
}

/* --- the stage -------------------------------------------------------------------------------------------- */

/* A stage of length delta; sources are taken at time t (its end, but the paper's beginning). */
typedef struct stage_plan {
  double delta, t_source, t_walls, w;
} stage_plan;

static stage stage_begin(const cf_diffuse *d, const stage_plan *plan, const cf_cell phi, const cf_face q) {
  const double h = d->grid->h, f_t = d->p.f_t, m = flux_memory(plan->delta, d->p.tau);
  stage s = {.t = plan->t_source, .delta = plan->delta, .w = plan->w};
  s.k = d->k_varies ? 1 : (cf_real)d->p.k.value;
  s.d = (cf_real)plan->delta;
  s.weight = (cf_real)plan->w;
  s.rhs = s.flux_q = (cf_real)(plan->delta * m / h);
  s.flux_k = (cf_real)(plan->delta * (1 - m + f_t * m) / (h * h));
  s.face_q = (cf_real)m;
  s.face_k = (cf_real)((1 - m) * (1 - f_t) / h);
  s.x = d->x.at, s.b = d->b.at, s.W = d->W.at, s.phi = phi.at;
  s.capacity = d->c_varies ? d->capacity.at : NULL;
  for (int a = 0; a < d->grid->box.dim; ++a) {
    s.stride[a] = d->grid->box.stride[a];
    s.k_face[a] = d->k.at[a];
    s.q[a] = q.at[a];
  }
  return s;
}

static cf_status sample_sources(cf_diffuse *d, const stage_plan *plan) {
  const cf_source *source = &d->source;
  cf_wall_values_sample(&d->walls, plan->t_walls);
  if (source->rate != NULL) CF_TRY(source->rate(source->context, plan->t_source, d->W));
  if (source->flux_rate != NULL) CF_TRY(source->flux_rate(source->context, plan->t_source, d->B));
  if (source->hold != NULL) CF_TRY(source->hold(source->context, plan->t_walls, d->fraction, d->value));
  return CF_OK;
}

/* On a periodic axis the last layer of faces is the first. */
static void close_seams(const cf_diffuse *d, const cf_face q) {
  cf_halo halo = {0};
  for (int a = 0; a < d->grid->box.dim; ++a)
    if (d->walls.walls.kind[a][0] == CF_WALL_PERIODIC) {
      halo.rule[a][0] = halo.rule[a][1] = CF_HALO_WRAP;
      cf_halo_fill(&d->grid->box, &halo, 0, a, q.at[a]);
      halo.rule[a][0] = halo.rule[a][1] = CF_HALO_NONE;
    }
}

/* q += factor B, on all faces. A flux source acts on q* of the stage. */
static void add_flux_source(const cf_diffuse *d, const double factor, const cf_face q) {
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
  close_seams(d, q);
}

static cf_status solve_stage(cf_diffuse *d, const stage *s, const cf_cell phi, cf_solve_report *report) {
  const cf_box *box = &d->grid->box;
  CF_PARALLEL_ROWS (box, d->grid->threads, r)
    right_side_row_by_dim(box->dim, box->n[0], s, cf_box_row(box, r));
  CF_TRY(set_operator(d, s));
  cf_helmholtz_add_walls(d->A, &d->walls, d->b);
  if (d->source.hold != NULL) right_side_where_held(d);
  copy_cells(d, phi.at, d->x.at);
  cf_solve_report one;
  CF_TRY(cf_helmholtz_solve(d->A, d->b, &d->p.solver, d->x, &one));
  report->iterations += one.iterations;
  report->levels = one.levels;
  report->residual = CF_MAX(report->residual, one.residual);
  report->converged = report->converged && one.converged;
  cf_wall_ghosts(&d->walls, d->x);
  return CF_OK;
}

static cf_status run_stage(cf_diffuse *d, const stage_plan *plan, const cf_cell phi, const cf_face q,
                           cf_ledger *ledger, cf_solve_report *report) {
  const cf_box *box = &d->grid->box;
  CF_TRY(sample_sources(d, plan));
  add_flux_source(d, plan->delta, q);
  const stage s = stage_begin(d, plan, phi, q);
  CF_TRY(solve_stage(d, &s, phi, report));
  if (d->source.hold != NULL) copy_cells(d, phi.at, d->b.at); /* hold_cells needs the old phi */
  if (d->p.scheme == CF_DIFFUSE_PAPER) {
    copy_cells(d, d->x.at, phi.at);
  } else {
    CF_PARALLEL_ROWS (box, d->grid->threads, r)
      cells_row_by_form(box->dim, d->k_varies, box->n[0], &s, cf_box_row(box, r));
  }
  if (d->source.rate != NULL) cf_ledger_add(ledger, plan->w * plan->delta * integral(d, d->W));
  account_walls(d, &s, ledger);
  if (d->source.hold != NULL) cf_ledger_add(ledger, hold_cells(d, &s));
  CF_PARALLEL_ROWS (box, d->grid->threads, r)
    faces_row_by_form(box->dim, d->k_varies, box->n[0], &s, cf_box_row(box, r));
  high_walls(d, &s);
  add_flux_source(d, (plan->w - 1) * plan->delta, q);
  return CF_OK;
}

cf_status cf_diffuse_step(cf_diffuse *d, const double t, const double dt, const cf_cell phi, const cf_face q,
                          cf_ledger *ledger, cf_solve_report *report) {
  *report = (cf_solve_report){.converged = true};
  close_seams(d, q);
  if (d->p.scheme == CF_DIFFUSE_PAPER)
    return run_stage(d, &(stage_plan){dt, t, t + dt, 1}, phi, q, ledger, report);
  const double g = 1 - sqrt(0.5), d1 = g * dt;
  CF_TRY(run_stage(d, &(stage_plan){d1, t + d1, t + d1, 1 + sqrt(2)}, phi, q, ledger, report));
  return run_stage(d, &(stage_plan){d1, t + dt, t + dt, 1}, phi, q, ledger, report);
}
