/* SPDX-License-Identifier: MIT
 *
 * The sentinel: after every step all of the state is looked at, and the first value that is not finite ends the run
 * with a sentence that says where, when, what stands beside it, and what is the likely cause.
 *
 * The cause is a guess. Values of the field near overflow have grown over many steps: an instability, the likelier the
 * longer the step is beside the one that `dt: auto` takes (which knows the limits of the model: CFL, front speed,
 * stiffness). Values of ordinary size mean that it came at once: an expression that is not finite there and then.
 */
#include <inttypes.h>
#include <math.h>
#include <stdio.h>

#include "grid/sweep.h"
#include "model/sim.h"

/* A ratio of dt to the automatic one that is suspicious, and values that have overflowed next. */
#define DT_SUSPICIOUS 2.0
#define GROWN         (sizeof(cf_real) == sizeof(double) ? 1e30 : 1e12)

/* What is wrong: how, where, and the largest value that is still finite there (NaN: there is none; -1: it is a number
 * by itself). */
typedef struct finding {
  char what[2 * CF_NAME_MAX + 16], place[320];
  double largest;
} finding;

static void cause_text(const cf_sim *sim, const double largest, char *text, const size_t size) {
  const double natural = sim->model->natural_dt(sim->state, sim->time);
  const bool chosen = !isnan(sim->scene->time.dt), grown = !(largest < GROWN);
  if (sim->step == 0)
    snprintf(text, size,
             "look for an initial value that divides by 0 or takes a root of a negative number there");
  else if (grown && chosen && natural > 0 && sim->dt > DT_SUSPICIOUS * natural)
    snprintf(text, size,
             "the step is %.3g times the one that `dt: auto` takes: try time.dt of %.2g s or less",
             sim->dt / natural, natural);
  else if (isnan(largest))
    snprintf(
        text, size,
        "there is no finite value left: look for an expression of t alone that is not finite then, or try %s",
        chosen ? "a smaller time.dt" : "a smaller time.cfl");
  else if (grown)
    snprintf(text, size, "values had grown to %.2g: try %s, or look for a rate that grows with the field",
             largest, chosen ? "a smaller time.dt" : "a smaller time.cfl");
  else {
    char others[64] = "";
    if (largest >= 0) snprintf(others, sizeof others, ", other values are at most %.3g", largest);
    snprintf(
        text, size,
        "it came at once%s: look for an expression (source, wall, velocity, k) that divides by 0 or takes "
        "a root of a negative number there and then",
        others);
  }
}

static cf_status fail(const cf_sim *sim, const finding *f) {
  char cause[256];
  cause_text(sim, f->largest, cause, sizeof cause);
  if (sim->step == 0)
    return cf_fail(CF_NOT_FINITE, "%s is not finite%s at the start: %s", f->what, f->place, cause);
  return cf_fail(CF_NOT_FINITE, "%s stopped being finite%s, step %" PRId64 ", t = %g s, dt = %g s; %s",
                 f->what, f->place, sim->step, sim->time, sim->dt, cause);
}

static double largest_of(const cf_box *b, const cf_real *values) {
  double largest = NAN;
  for (ptrdiff_t r = 0; r < cf_box_rows(b); ++r)
    for (int i = 0; i < b->n[0]; ++i) {
      const double size = fabs((double)values[cf_box_row(b, r) + i]);
      if (isfinite(size) && !(size <= largest)) largest = size;
    }
  return largest;
}

/* " in cell (3, 4), at (0.35, 0.45) m, with nan, 1e+300, 2, 2 beside it": at -x, +x, -y, +y. */
static void place_text(const cf_sim *sim, const cf_real *values, const int where[3], char *text,
                       const size_t size) {
  const cf_box *b = &sim->grid.box;
  const ptrdiff_t p = cf_box_at(b, where[0], where[1], where[2]);
  size_t n = (size_t)snprintf(text, size, " in cell (");
  for (int a = 0; a < b->dim && n < size; ++a)
    n += (size_t)snprintf(text + n, size - n, "%s%d", a > 0 ? ", " : "", where[a]);
  for (int a = 0; a < b->dim && n < size; ++a)
    n += (size_t)snprintf(text + n, size - n, "%s%.4g", a > 0 ? ", " : "), at (",
                          sim->grid.origin[a] + (where[a] + 0.5) * sim->grid.h);
  if (n < size) n += (size_t)snprintf(text + n, size - n, ") m, with");
  for (int i = 0; i < 2 * b->dim && n < size; ++i) {
    const double beside = (double)values[p + (i % 2 == 0 ? -b->stride[i / 2] : b->stride[i / 2])];
    const char *comma = i > 0 ? "," : "";
    if (isnan(beside)) /* its sign says nothing */
      n += (size_t)snprintf(text + n, size - n, "%s nan", comma);
    else
      n += (size_t)snprintf(text + n, size - n, "%s %.3g", comma, beside);
  }
  if (n < size) snprintf(text + n, size - n, " beside it");
}

static cf_status check_values(const cf_sim *sim, const char *name, const cf_real *values) {
  int where[3];
  finding f;
  if (cf_sweep_finite(&sim->grid.box, sim->grid.threads, values, where)) return CF_OK;
  snprintf(f.what, sizeof f.what, "%s", name);
  place_text(sim, values, where, f.place, sizeof f.place);
  f.largest = largest_of(&sim->grid.box, values);
  return fail(sim, &f);
}

static cf_status check_faces(const cf_sim *sim, const cf_entry *e) {
  char name[CF_NAME_MAX + 8];
  for (int a = 0; a < sim->grid.box.dim; ++a) {
    snprintf(name, sizeof name, "%s along %c", e->name, "xyz"[a]);
    CF_TRY(check_values(sim, name, e->face.at[a]));
  }
  return CF_OK;
}

static cf_status check_particles(const cf_sim *sim, const cf_particles *set) {
  cf_particles_place at;
  finding f = {.largest = 0};
  double x[3] = {0};
  if (cf_particles_finite(set, sim->grid.threads, &at)) return CF_OK;
  for (int a = 0; a < set->dim; ++a) x[a] = (double)set->attribute[CF_PARTICLE_POSITION].at[a][at.index];
  snprintf(f.what, sizeof f.what, "%s of %s", set->attribute[at.attribute].name, set->name);
  const int n = snprintf(f.place, sizeof f.place, " at the particle of id %" PRId64, set->id[at.index]);
  if (isfinite(x[0]) && isfinite(x[1]) && isfinite(x[2]))
    snprintf(f.place + n, sizeof f.place - (size_t)n, ", at (%.4g, %.4g, %.4g) m", x[0], x[1], x[2]);
  const cf_real *values = set->attribute[at.attribute].at[at.component];
  for (int64_t i = 0; i < set->count; ++i) {
    const double size = fabs((double)values[i]);
    if (isfinite(size)) f.largest = CF_MAX(f.largest, size);
  }
  return fail(sim, &f);
}

static cf_status check_numbers(const cf_sim *sim, const cf_entry *e) {
  finding f = {.largest = -1};
  for (int c = 0; c < e->components; ++c) {
    if (isfinite(e->number[c])) continue;
    snprintf(f.what, sizeof f.what, "%s (number %d of %d)", e->name, c + 1, e->components);
    return fail(sim, &f);
  }
  return CF_OK;
}

cf_status cf_sim_check_finite(const cf_sim *sim) {
  for (int i = 0; i < sim->registry.count; ++i) {
    const cf_entry *e = &sim->registry.entry[i];
    if (e->kind == CF_KIND_CELL) CF_TRY(check_values(sim, e->name, e->cell.at));
    if (e->kind == CF_KIND_FACE) CF_TRY(check_faces(sim, e));
    if (e->kind == CF_KIND_PARTICLES) CF_TRY(check_particles(sim, e->particles));
    if (e->kind == CF_KIND_NUMBER) CF_TRY(check_numbers(sim, e));
  }
  return CF_OK;
}
