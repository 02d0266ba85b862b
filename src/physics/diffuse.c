/* SPDX-License-Identifier: MIT
 *
 * Making the object, and which scheme takes a step; see diffuse_part.h for the other files.
 *
 * k lives on faces: the harmonic mean of its cells, the cell's own on a held wall.
 */
#include <math.h>

#include "base/mem.h"
#include "grid/halo.h"
#include "physics/diffuse_part.h"
#include "stencil/explicit.h"

/* --- parameters ------------------------------------------------------------------------------------------- */

static cf_status check_wave(const cf_diffuse_params *p) {
  if (!cf_fn_is_constant(&p->k) || !cf_fn_is_constant(&p->capacity))
    return cf_fail(CF_BAD_ARGUMENT, "scheme wave needs k and capacity that are one number each");
  if (p->f_t > 0) return cf_fail(CF_BAD_ARGUMENT, "f_t = %g: scheme wave needs f_t = 0", p->f_t);
  if (!(p->tau > 0) || isinf(p->tau))
    return cf_fail(CF_BAD_ARGUMENT, "tau = %g s: scheme wave needs a finite tau > 0", p->tau);
  return CF_OK;
}

static cf_status check_params(const cf_diffuse_params *p) {
  if (!(p->tau >= 0)) return cf_fail(CF_BAD_ARGUMENT, "tau = %g s: must be >= 0", p->tau);
  if (!(p->f_t >= 0 && p->f_t <= 1))
    return cf_fail(CF_BAD_ARGUMENT, "f_t = %g: must be between 0 and 1", p->f_t);
  if (!(p->solver.tolerance > 0 && p->solver.tolerance < 1))
    return cf_fail(CF_BAD_ARGUMENT, "tolerance = %g: must be between 0 and 1", p->solver.tolerance);
  if (p->positive && p->scheme != CF_DIFFUSE_LEAPFROG)
    return cf_fail(CF_BAD_ARGUMENT, "positivity needs scheme leapfrog");
  if (p->scheme == CF_DIFFUSE_WAVE && p->region != NULL)
    return cf_fail(CF_BAD_ARGUMENT, "scheme wave knows no obstacles: take default, leapfrog or sdirk2");
  return p->scheme == CF_DIFFUSE_WAVE ? check_wave(p) : CF_OK;
}

/* --- creation --------------------------------------------------------------------------------------------- */

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
  int where[3];
  if (!cf_sweep_finite(&d->grid->box, 1, out.at, where))
    return cf_fail(
        CF_BAD_ARGUMENT,
        "%s is not finite in cell (%d, %d, %d): is there a division by 0, or a root of a negative number?",
        what, where[0], where[1], where[2]);
  const cf_box *b = &d->grid->box;
  for (ptrdiff_t r = 0; r < cf_box_rows(b); ++r)
    for (int i = 0; i < b->n[0]; ++i) {
      const double value = (double)out.at[cf_box_row(b, r) + i];
      if (value < 0 || (value == 0 && !zero_is_fine))
        return cf_fail(CF_BAD_ARGUMENT, "%s = %g in cell (%d, %d, %d): must be %s", what, value, i,
                       (int)(r % b->n[1]), (int)(r / b->n[1]), zero_is_fine ? ">= 0" : "> 0");
    }
  return CF_OK;
}

static cf_status make_k(cf_diffuse *d) {
  const cf_box *box = &d->grid->box;
  const bool constant = cf_fn_is_constant(&d->p.k);
  d->k_max = d->p.k.value;
  d->k_varies = !constant || d->p.region != NULL;
  if (constant && (!(d->k_max >= 0) || !isfinite(d->k_max)))
    return cf_fail(CF_BAD_ARGUMENT, "k = %g: must be >= 0", d->k_max);
  if (d->k_varies) CF_TRY(cf_face_create(&d->k, box));
  if (constant) return CF_OK;
  CF_TRY(sample_positive(d, &d->p.k, "k", true, d->x));
  d->k_max = cf_sweep_range(box, 1, d->x.at, d->rows).max;
  cf_diffuse_copy_ghosts(d, d->x);
  faces_from_cells(box, d->x.at, d->k);
  if (d->p.region == NULL) return CF_OK;
  CF_TRY(cf_cell_create(&d->k_cells, box));
  cf_diffuse_copy(d, d->x.at, d->k_cells.at);
  return CF_OK;
}

static cf_status make_capacity(cf_diffuse *d) {
  const cf_box *box = &d->grid->box;
  d->c_min = d->p.capacity.value;
  d->c_varies = !cf_fn_is_constant(&d->p.capacity) || d->p.capacity.value != 1;
  if (d->c_varies) {
    CF_TRY(cf_cell_create(&d->capacity, box));
    CF_TRY(sample_positive(d, &d->p.capacity, "capacity", false, d->capacity));
    d->c_min = cf_sweep_range(box, 1, d->capacity.at, d->rows).min;
    cf_diffuse_copy_ghosts(d, d->capacity);
  }
  return CF_OK;
}

static bool is_implicit(const cf_diffuse_params *p) {
  return p->scheme == CF_DIFFUSE_PAPER || p->scheme == CF_DIFFUSE_SDIRK2 ||
         (p->scheme == CF_DIFFUSE_LEAPFROG && p->f_t > 0 && !p->positive);
}

/* Fields of which the scheme and the coefficients decide whether they are needed. */
static cf_status make_scratch(cf_diffuse *d) {
  const cf_box *box = &d->grid->box;
  const bool implicit = is_implicit(&d->p);
  if ((implicit && (!cf_fn_is_constant(&d->p.k) || d->has_radiation)) || (d->p.positive && d->p.f_t > 0))
    CF_TRY(cf_face_create(&d->beta, box));
  if (d->p.front_filter) CF_TRY(cf_cell_create(&d->filtered, box));
  if (d->p.scheme == CF_DIFFUSE_WAVE) {
    CF_TRY(cf_cell_create(&d->kept.phi, box));
    CF_TRY(cf_cell_create(&d->kept.phi_rate, box));
    CF_TRY(cf_face_create(&d->kept.q, box));
  }
  return implicit ? cf_helmholtz_create(&d->A, d->grid, &d->walls.walls, d->p.levels) : CF_OK;
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
    CF_TRY(cf_cell_create(&d->change, box));
  }
  CF_TRY(make_k(d));
  CF_TRY(make_capacity(d));
  d->speed_max = d->p.tau > 0 ? sqrt((1 - d->p.f_t) * d->k_max / (d->c_min * d->p.tau)) : 0;
  if (d->p.region != NULL && d->p.front_filter) CF_TRY(cf_rim_create(&d->rim, box));
  if (d->p.region != NULL) CF_TRY(cf_diffuse_region_changed(d));
  return make_scratch(d);
}

/* Radiating walls become held ones; where there are no waves to leave, for good. */
static cf_status make_walls(cf_diffuse *d, const cf_walls *walls) {
  cf_walls as_held = *walls;
  const bool waves = d->p.tau > 0 && d->p.f_t < 1;
  for (int a = 0; a < d->grid->box.dim; ++a) {
    bool open = false;
    for (int side = 0; side < 2; ++side) {
      const cf_wall kind = walls->kind[a][side];
      if (kind == CF_WALL_RADIATE) as_held.kind[a][side] = CF_WALL_VALUE;
      d->radiates[a][side] = kind == CF_WALL_RADIATE && waves;
      d->has_radiation = d->has_radiation || d->radiates[a][side];
      open = open || cf_wall_is_held(as_held.kind[a][side]);
    }
    d->has_open = d->has_open || open;
    if (open || d->grid->box.n[a] > 1) ++d->axes;
  }
  d->axes = CF_MAX(1, d->axes);
  return cf_wall_values_create(&d->walls, d->grid, &as_held);
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
  cf_status s = make_walls(fresh, walls);
  if (s == CF_OK) s = make_fields(fresh);
  if (s != CF_OK) {
    cf_diffuse_destroy(fresh);
    return s;
  }
  *d = fresh;
  return CF_OK;
}

void cf_diffuse_let_through(cf_diffuse *d) { d->has_open = true; }

void cf_diffuse_destroy(cf_diffuse *d) {
  if (d == NULL) return;
  const cf_box *box = &d->grid->box;
  cf_cell *cells[] = {&d->k_cells,  &d->capacity, &d->alpha,         &d->x,
                      &d->b,        &d->W,        &d->fraction,      &d->value,
                      &d->filtered, &d->kept.phi, &d->kept.phi_rate, &d->change};
  cf_face *faces[] = {&d->k, &d->beta, &d->B, &d->kept.q};
  for (size_t i = 0; i < sizeof cells / sizeof *cells; ++i) cf_cell_destroy(cells[i], box);
  for (size_t i = 0; i < sizeof faces / sizeof *faces; ++i) cf_face_destroy(faces[i], box);
  cf_wall_values_destroy(&d->walls);
  cf_rim_destroy(&d->rim);
  cf_helmholtz_destroy(d->A);
  cf_free(d->rows);
  cf_free(d);
}

double cf_diffuse_k_max(const cf_diffuse *d) { return d->k_max; }
double cf_diffuse_speed_max(const cf_diffuse *d) { return d->speed_max; }

/* --- a step ----------------------------------------------------------------------------------------------- */

double cf_diffuse_substeps(const cf_diffuse *d, const double dt) {
  const double tau = d->p.tau, h = d->grid->h, D = (1 - d->p.f_t) * d->k_max / d->c_min;
  if (d->p.scheme == CF_DIFFUSE_WAVE) return cf_explicit_wave_substeps(d->axes, d->speed_max, tau, h, dt);
  if (d->p.scheme != CF_DIFFUSE_LEAPFROG) return 1;
  const double n = cf_explicit_substeps(d->axes, D, tau, h, dt);
  /* The explicit steps of Fourier's part that keep phi >= 0. */
  return d->p.positive ? CF_MAX(n, ceil(4 * d->axes * d->p.f_t * d->k_max / d->c_min * dt / (h * h))) : n;
}

static cf_status step(cf_diffuse *d, const double t, const double dt, const cf_diffused *y, cf_ledger *ledger,
                      cf_solve_report *report) {
  *report = (cf_solve_report){.converged = true};
  cf_diffuse_set_outside(d, y->phi);
  switch (d->p.scheme) {
    case CF_DIFFUSE_PAPER:
      CF_TRY(cf_diffuse_paper(d, t, dt, y, ledger, report));
      break;
    case CF_DIFFUSE_LEAPFROG:
      return cf_diffuse_leapfrog(d, t, dt, y, ledger, report);
    case CF_DIFFUSE_WAVE:
      return cf_diffuse_wave(d, t, dt, y, ledger, report);
    default:
      CF_TRY(cf_diffuse_sdirk2(d, t, dt, y, ledger, report));
  }
  cf_diffuse_filter_phi(d, 1, dt, y->phi, ledger);
  cf_diffuse_filter_flux(d, 1, dt, y->q);
  return CF_OK;
}

cf_status cf_diffuse_step(cf_diffuse *d, const double t, const double dt, const cf_cell phi, const cf_face q,
                          cf_ledger *ledger, cf_solve_report *report) {
  cf_diffuse_close_seams(d, q);
  cf_diffuse_close_faces(d, q);
  return step(d, t, dt, &(cf_diffused){.phi = phi, .q = q}, ledger, report);
}

cf_status cf_diffuse_step_scalar(cf_diffuse *d, const double t, const double dt, const cf_cell phi,
                                 const cf_cell s, cf_ledger *ledger, cf_solve_report *report) {
  const char *needs = d->source.flux_rate != NULL      ? "a source of the flux"
                      : d->has_radiation               ? "a wall that radiates"
                      : d->p.positive                  ? "positivity"
                      : d->p.scheme == CF_DIFFUSE_WAVE ? "scheme wave"
                                                       : NULL;
  if (needs != NULL) return cf_fail(CF_BAD_ARGUMENT, "%s needs the flux on faces, not its divergence", needs);
  return step(d, t, dt, &(cf_diffused){.phi = phi, .s = s}, ledger, report);
}
